"""Spheres, cylinders and boxes as obstacles, through the FMU: no point of the surface is ever inside, and forces balance."""

import numpy as np
import pytest

from readings import deepest, vector, velocities
from scenes import GRAVITY, meshed
from softffd import Simulation, deform, simulate
from softffd.errors import SceneError, SoftffdError
from softffd.fmu.package import scene_masses
from softffd.rotation import turned
from validation import shapes as bodies
from validation.twin import build_twin

G = -GRAVITY[2]
UNDER = {"name": "under", "friction": 0.4}
SOFT, STIFF, RUBBER = {"stiffness": 2e3}, {"stiffness": 1e6}, {"stiffness": 1e4, "internal_damping": 1e-3}
ELEMENTS = {"model": "solid", "youngs_modulus": 1e4, "poissons_ratio": 0.45}
LARGE = {
    "sphere": {"radius": 20.0, "point": [0.5, 0.5, -20.0]},
    "cylinder": {"radius": 20.0, "length": 1.5, "normal": [0.0, 1.0, 0.0], "point": [0.5, 0.5, -20.0]},
    "box": {"size": [1.5, 2.0, 0.5], "point": [0.5, 0.5, -0.25], "rotation": {"axis": [0, 0, 1], "degrees": 25.0}},
}


STEPPED = {
    "leapfrog": ({"method": "leapfrog", "damping": 1.0, "stop_time": 10.0}, 1e-9),
    "backward_euler": ({"method": "backward_euler", "step": 5e-3, "material": RUBBER, "stop_time": 2.0}, 1e-6),
    "sdirk2": ({"method": "sdirk2", "step": 5e-3, "material": RUBBER, "stop_time": 2.0}, 1e-6),
    "elements": ({"method": "auto", "step": 0.0, "material": ELEMENTS | {"internal_damping": 0.02}, "stop_time": 1.0}, 1e-6),
    "elements with drag": ({"method": "auto", "step": 0.0, "material": ELEMENTS, "damping": 1.0, "stop_time": 4.0}, 1e-6),
}
"""Keys of a body of springs or of finite elements, and what is left at the end [N]."""


@pytest.mark.parametrize("case", STEPPED)
@pytest.mark.parametrize("kind", LARGE)
def test_a_cube_rests_on_a_large_solid(body, case, kind):
    """Held in place by nothing but balance: its face lies around the top."""
    keys, left = STEPPED[case]
    scene = body(bodies.cube(5, 0.0), offset=[0.0, 0.0, 0.02], gravity=GRAVITY, **keys, **{kind: [UNDER | LARGE[kind]]})
    result = simulate(scene)
    assert vector(result, f"{kind}.under.reaction")[-1] == pytest.approx([0.0, 0.0, -G], abs=left)
    assert deepest(result, "under") <= 1e-12


FLAT = {
    "disk": ("cylinder", {"radius": 10.0, "length": 2.0, "point": [0.0, 0.0, -1.0]}),
    "box": ("box", {"size": [20.0, 20.0, 2.0], "point": [0.0, 0.0, -1.0]}),
    "turned box": ("box", {"size": [20.0, 2.0, 20.0], "point": [0.0, 0.0, -1.0], "rotation": {"axis": [1, 0, 0], "degrees": 90.0}}),
}


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("flat", FLAT)
def test_a_flat_face_is_as_good_as_a_plane(body, flat, friction):
    """What meets the flat end of a wide cylinder or a wide box moves as on a plane; where a box is not turned only sums are rounded
    in another order. Where it is pressed is on the face."""
    keys = {"gravity": [1.0, 0.0, -9.81], "offset": [0.0, 0.0, 0.05], "rotation": {"axis": [1, 2, 0], "degrees": 3.0}, "stop_time": 1.0}
    shape, (kind, solid) = bodies.cube(5, 0.0), FLAT[flat]
    on_plane = simulate(body(shape, plane=[{"name": "ground", "friction": friction}], **keys))
    on_solid = simulate(body(shape, **{kind: [{"name": "ground", "friction": friction, **solid}]}, **keys))
    assert np.abs(on_plane.positions - on_solid.positions).max() <= (1e-13 if flat == "box" else 1e-9)
    assert np.abs(vector(on_plane, "plane.ground.reaction") - vector(on_solid, f"{kind}.ground.reaction")).max() <= 1e-6
    assert (on_plane.outputs["plane.ground.contacts"] == on_solid.outputs[f"{kind}.ground.contacts"]).all()
    presses, centre = vector(on_solid, f"{kind}.ground.reaction")[:, 2] < 0, vector(on_solid, f"{kind}.ground.centre")
    assert presses.sum() > 20 and np.abs(centre[presses, 2]).max() < 1e-9
    assert np.abs(centre - vector(on_plane, "plane.ground.centre"))[presses].max() < 1e-6


CUBE = {"gravity": GRAVITY, "communication_step": 0.01, "stop_time": 0.1, "method": "auto", "step": 0.0, "mass": {"total": 1.0}}
ON_A_FACE = {
    "stiff, at rest": {"material": STIFF},
    "stiff, dropped": {"material": STIFF, "offset": [0.0, 0.0, 0.05], "velocity": [0.3, 0.0, 0.0]},
    "stiff, sliding": {"material": STIFF, "velocity": [1.0, 0.0, 0.0]},
    "rubber, sliding": {"material": RUBBER, "velocity": [1.0, 0.0, 0.0]},
    "soft, dropped": {"material": SOFT, "offset": [0.0, 0.0, 0.05], "velocity": [0.3, 0.0, 0.0]},
}


@pytest.mark.parametrize("case", ON_A_FACE)
@pytest.mark.parametrize("flat", ["disk", "box"])
def test_on_a_flat_face_the_steps_are_those_on_a_plane(body, case, flat):
    """Flights, impacts, rests and implicit steps."""
    shape, (kind, solid), keys = bodies.cube(4, 0.0), FLAT[flat], CUBE | ON_A_FACE[case] | {"outputs": {"solver": True}}
    on_plane = simulate(body(shape, plane=[{"name": "ground"}], **keys))
    on_solid = simulate(body(shape, **{kind: [{"name": "ground", **solid}]}, **keys))
    assert on_plane.outputs["solver.steps"][-1] == on_solid.outputs["solver.steps"][-1]
    assert np.abs(on_plane.positions - on_solid.positions).max() <= 1e-12


ROUND = {
    "over a ball": ("sphere", {"radius": 2.0, "point": [0.5, 0.5, -2.0]}),
    "over a log": ("cylinder", {"radius": 2.0, "length": 3.0, "normal": [0.0, 1.0, 0.0], "point": [0.5, 0.5, -2.0]}),
    "off an edge": ("box", {"size": [6.0, 6.0, 1.0], "point": [-2.1, 0.5, -0.5]}),
}


SLIDING = {
    "rubber": (RUBBER, 2, 0.3),
    "elements": (ELEMENTS | {"internal_damping": 1e-3}, 2, 0.4),
    "undamped elements": (ELEMENTS, 10, 0.2),
}
"""Material, tolerances of the error, and share of the steps of a fine run"""


@pytest.mark.short("1e-4-*-rubber", "1e-4-*-elements", "1e-4-over a ball-*", "1e-4-off an edge-*")
@pytest.mark.parametrize("of", SLIDING)
@pytest.mark.parametrize("case", ROUND)
@pytest.mark.parametrize("tolerance", ["1e-4", "3e-5", "1e-5"])
def test_a_body_slides_over_what_is_round(body, tolerance, case, of):
    """With few steps, to within some tolerances of explicit ones at 1e-6."""
    (kind, solid), (material, tolerances, share) = ROUND[case], SLIDING[of]
    keys = CUBE | {"material": material, "velocity": [1.0, 0.0, 0.0], "stop_time": 0.2, "outputs": {"solver": True}}
    scene = body(bodies.cube(4, 0.0), **{kind: [{"name": "under", **solid}]}, **keys)
    result = simulate(scene, start_values={"solver.tolerance": float(tolerance)})
    exact = simulate(scene, start_values={"solver.method": "leapfrog", "solver.tolerance": 1e-6})
    assert np.abs(result.positions - exact.positions).max() < tolerances * float(tolerance)
    if tolerance == "1e-4":
        assert result.outputs["solver.steps"][-1] < share * exact.outputs["solver.steps"][-1]
    assert deepest(result, "under") <= 1e-12


def test_a_body_may_start_squeezed_between_round_solids(body):
    """What one of them moves out the other would move back, were it not told of it."""
    balls = [{"name": name, "radius": 2.0, "point": [0.5, 0.5, z]} for name, z in (("below", -2.0), ("above", 2.93))]
    result = simulate(body(bodies.cube(4, 0.0), sphere=balls, damping=1.0, stop_time=0.1))
    assert max(deepest(result, "below"), deepest(result, "above")) <= 1e-12
    forces = [vector(result, f"sphere.{name}.reaction")[-1] for name in ("below", "above")]
    assert forces[1][2] > 1


STEEP = {
    "cylinder": {"radius": 0.5, "length": 0.8, "point": [0.2, 0.5, -0.5], "normal": [0.0, 1.0, 0.0]},
    "box": {"size": [1.0, 1.0, 0.3], "point": [0.1, 0.5, -0.5], "rotation": {"axis": [0, 1, 0], "degrees": 30.0}},
}


@pytest.mark.parametrize("kind", STEEP)
def test_a_body_slides_off(body, kind):
    """Over a cylinder's side, and over a tilted box's face and edge."""
    solid = {"name": "log", "friction": 0.2, **STEEP[kind]}
    ground = {"name": "ground", "point": [0.0, 0.0, -2.0], "friction": 0.2}
    result = simulate(body(bodies.sphere(3), gravity=GRAVITY, damping=0.1, plane=[ground], stop_time=2.0, **{kind: [solid]}))
    assert max(deepest(result, "log"), deepest(result, "ground")) <= 1e-12
    assert np.abs(vector(result, f"{kind}.log.reaction")).max() > 1
    assert vector(result, "probe.centre")[-1][2] < 0.5 - 1


SPIN = np.array([0.5, -1.0, 2.0])
CARRIED = {"motion": "input", "inputs": ["point", "velocity", "angular_velocity"]}
TURNED = {"motion": "input", "inputs": ["point", "rotation", "velocity", "angular_velocity"]}
STRIKING = {"sphere": {"radius": 0.2, **CARRIED}, "box": {"size": [0.4, 0.3, 0.2], "angular_velocity": SPIN.tolist(), **TURNED}}


@pytest.mark.parametrize("kind", STRIKING)
def test_a_moving_solid_gives_the_momentum_that_it_is_charged_with(body, kind):
    """A box turns as it comes, by its rotation vector and angular velocity."""
    solid = {"name": "ram", "point": [-0.5, 0.55, 0.5], "friction": 0.3, "velocity": [1.0, 0.0, 0.0], **STRIKING[kind]}
    scene = body(bodies.sphere(3), damping=0.0, velocities="all", stop_time=1.0, **{kind: [solid]})
    mass, H, least = scene_masses(scene).mass, 0.02, np.inf
    with Simulation(scene) as simulation:
        impulse, ram = np.zeros(3), simulation.obstacle["ram"]
        for step in range(50):
            ram.point = [-0.5 + step * H, 0.55, 0.5]
            if kind == "box":
                ram.rotation = step * H * SPIN
            simulation.step()
            impulse += H * np.array(ram.reaction)
            places = deform(scene.loaded_mesh, simulation.positions, origin=scene.lattice_box.origin, size=scene.lattice_box.size)
            end = (step + 1) * H
            axes = turned(np.eye(3)[[2, 0]], end * SPIN)
            least = min(least, bodies.gap(kind, solid, places, np.array([-0.5 + end, 0.55, 0.5]), *axes).min())
            momentum = mass @ np.array(simulation.velocities).reshape(-1, 3)
            assert np.abs(momentum + impulse).max() <= 1e-12
        assert momentum[0] > 0.1
        assert least >= -1e-12


@pytest.mark.parametrize("interpolation", ["held", "linear"])
def test_a_box_turns_by_its_angular_velocity_as_by_its_rotation(body, interpolation):
    """A fixed one that turns from the start goes where the poses of an input have it, whose course gives the angular velocity, or rates."""
    solid = {"name": "ram", "size": [1.2, 0.3, 0.2], "point": [0.5, 0.5, -0.2], "friction": 0.3}
    keys = {"damping": 0.0, "stop_time": 0.5}
    fixed = simulate(body(bodies.sphere(3), box=[solid | {"angular_velocity": [0.0, 3.0, 0.0]}], **keys))
    assert np.abs(fixed.positions[-1] - fixed.positions[0]).max() > 1e-2
    course = {"inputs": lambda t: {f"box.ram.rotation.{axis}": w * t for axis, w in zip("xyz", (0.0, 3.0, 0.0), strict=True)}}
    led = simulate(body(bodies.sphere(3), box=[solid | TURNED], **keys), interpolation=interpolation, **course)
    assert np.abs(led.positions - fixed.positions).max() <= 1e-12
    assert np.abs(led.edges("ram") - fixed.edges("ram")).max() <= 1e-12
    assert np.abs(led.plane("ram")[1] - fixed.plane("ram")[1]).max() <= 1e-12
    assert fixed.edges("ram")[-1][:, 2] == pytest.approx([np.sin(1.5), 0.0, np.cos(1.5)], abs=1e-12)


def test_rates_of_a_rotation_vector_turn_a_box_about_an_axis_that_turns(body):
    """Linear courses of rotation vectors that do not go through zero, against angular velocities that hold from one to the next: 3.9e-5 m
    apart here, 9e-5 at twice the communication step, 7e-4 at four times."""
    solid = {"name": "ram", "size": [1.2, 0.5, 0.2], "point": [0.5, 0.5, -0.2], "friction": 0.3, **TURNED}
    scene = body(bodies.sphere(3), box=[solid], damping=0.0, stop_time=0.5, communication_step=0.005)
    course = {"inputs": lambda t: {"box.ram.rotation.x": 0.4, "box.ram.rotation.y": 3.0 * t, "box.ram.rotation.z": 1.0 - t}}
    held, linear = (simulate(scene, interpolation=each, **course) for each in ("held", "linear"))
    assert np.abs(linear.positions[-1] - linear.positions[0]).max() > 1e-2
    assert np.abs(held.positions - linear.positions).max() <= 1e-4


INSIDE = {
    "sphere": {"radius": 0.2, "point": [0.5, 0.5, 0.1]},
    "cylinder": {"radius": 0.2, "length": 1.0, "normal": [0.0, 1.0, 0.0], "point": [0.5, 0.5, 0.1]},
    "box": {"size": [0.5, 0.5, 0.3], "point": [0.5, 0.5, 0.1], "rotation": {"axis": [0, 0, 1], "degrees": 20.0}},
}


@pytest.mark.parametrize("kind", INSIDE)
def test_what_starts_inside_is_moved_out_and_said_to_be(body, kind):
    solid, shape = {"name": "thorn", **INSIDE[kind]}, bodies.sphere(3)
    result = simulate(body(shape, stop_time=0.1, **{kind: [solid]}))
    assert deepest(result, "thorn") <= 1e-12
    axis, across = (result.edges("thorn")[0, :, n] if kind == "box" else np.array([0.0, 1.0, 0.0]) for n in (2, 0))
    depth = -bodies.gap(kind, solid, shape[0], np.array(solid["point"]), axis, across).min()
    told = f"start in {kind} thorn, by up to {depth:.2g} m, and are moved out at the start; to start clear of it, change the obstacle"
    assert any(told in text for text in result.summary["warnings"])


THIN = {"cylinder": {"radius": 3.0, "length": 1e-4}, "box": {"size": [6.0, 6.0, 1e-4]}}


@pytest.mark.parametrize("kind", THIN)
def test_a_thin_solid_is_not_passed(body, kind):
    """A fast body meets what is a thousandth as thick as it moves in a step."""
    disk = {"name": "disk", "point": [0.5, 0.5, -0.2], "friction": 0.0, **THIN[kind]}
    result = simulate(body(bodies.sphere(3), velocity=[0.0, 0.0, -100.0], stiffness=1e5, stop_time=0.1, **{kind: [disk]}))
    assert result.deformed(row=slice(None))[..., 2].min() >= -0.2 + 5e-5 - 1e-12


def test_no_vertex_is_in_a_box_that_it_is_thrown_at_whatever_the_corner(body):
    """Faces, edges and corners of boxes in every position, at speeds of several of their sides a step."""
    random = np.random.default_rng(7)
    touched = 0
    for _ in range(12):
        axis, way = random.normal(size=3), random.normal(size=3)
        way /= np.linalg.norm(way)
        solid = {"name": "crate", "size": random.uniform(0.02, 0.6, 3).tolist(), "point": (0.5 + way).tolist(), "friction": 0.3,
                 "rotation": {"axis": axis.tolist(), "degrees": random.uniform(0, 180)}}  # fmt: skip
        result = simulate(body(bodies.sphere(3), box=[solid], velocity=(20 * way).tolist(), step=2e-3, stop_time=0.1))
        assert deepest(result, "crate") <= 1e-12
        touched += np.abs(vector(result, "box.crate.reaction")).max() > 0
    assert touched >= 9


def test_the_lattice_refuses_them(body):
    for kind, solid in (("sphere", {"name": "ball", "radius": 0.2}), ("box", {"name": "crate", "size": [1.0, 1.0, 1.0]})):
        with pytest.raises(SceneError, match=rf"contact.of: .lattice. supports only planes, but the scene has a \[\[{kind}\]\]"):
            body(bodies.sphere(1), contact={"of": "lattice"}, **{kind: [solid]})


def test_the_twin_has_no_solids_and_says_so(body, tmp_path):
    scene = body(bodies.sphere(1), sphere=[{"name": "ball", "radius": 0.2, "point": [0.5, 0.5, -1.0]}])
    with pytest.raises(SoftffdError, match="the twin has planes alone, wanted none of these, got ball"):
        build_twin(scene, tmp_path / "twin.fmu")


@pytest.mark.parametrize("turn", [{"rotation": {"axis": [0, 0, 1], "degrees": 1e300}}, {"angular_velocity": [0.0, 0.0, 1e300]}])
def test_a_box_turned_beyond_all_numbers_is_refused(body, turn):
    """Of an angle whose square overflows no sine is known: neither a crash, nor a box that is not there."""
    box = {"name": "under", "size": [3.0, 3.0, 1.0], "point": [0.5, 0.5, -0.55], **turn}
    scene = body(bodies.cube(2, 0.0), gravity=GRAVITY, box=[box], method="auto", step=0.0, stop_time=0.3)
    with pytest.raises(SoftffdError, match="not finite"):
        simulate(scene)


@pytest.mark.parametrize("speed", [1e8, 1e10])
def test_a_solid_that_pushes_beyond_reason_is_answered(body, speed):
    """Within the work of a call, whichever way: moved, or refused with the state untouched."""
    ram = {"name": "ram", "size": [20.0, 20.0, 2.0], "point": [0.0, 0.0, -1.0], "motion": "input", "inputs": ["point", "velocity"]}
    with Simulation(body(bodies.cube(5, 0.0), method="auto", step=0.0, box=[ram], solver={"most_work": 1e5})) as simulation:
        before = simulation.positions.copy()
        simulation.obstacle["ram"].velocity = [0.0, 0.0, speed]
        try:
            simulation.step(0.01)
        except SoftffdError:
            assert (simulation.positions == before).all()
        assert np.isfinite(simulation.positions).all()


@pytest.mark.parametrize("tolerance", [1e-4, pytest.param(1e-5, marks=pytest.mark.full)])
def test_a_face_that_lands_at_a_communication_point_is_an_impact(tolerance, tmp_path):
    """A stiff cube flies flat at a box; its vertices are on the face where a communication step ends, behind it at no time. A step that
    did not count that as an impact took the rebound at the largest stable step, whatever the tolerance was: 0.6799 m/s."""
    scene = meshed(
        tmp_path, bodies.cube(4, 0.0), points=[4, 4, 4], mass={"total": 1.0}, velocity=[0.0, 0.0, 1.0], velocities="all", stop_time=0.1,
        box=[{"name": "small", "size": [0.4, 0.5, 0.2], "point": [0.5, 0.5, 1.15]}], communication_step=0.01, outputs={"solver": True},
        material={"stiffness": 1e6, "damping": 0.0}, tolerance=tolerance,
    )  # fmt: skip
    result = simulate(scene)
    stable = result.outputs["solver.stable_step"].min()
    finer = simulate(scene, start_values={"solver.method": "leapfrog", "solver.step": stable / 8})
    rebounds = [velocities(each)[-1].mean(axis=0)[2] for each in (result, finer)]
    assert rebounds[0] == pytest.approx(rebounds[1], abs=3e-4)
    assert rebounds[0] == pytest.approx(-0.674, abs=5e-4)
    assert not result.summary["warnings"]
