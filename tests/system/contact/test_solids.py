"""Spheres, cylinders and boxes as obstacles, through the FMU: no point of the surface is ever inside, and forces balance."""

import numpy as np
import pytest

import bodies
from readings import vector
from scenes import GRAVITY, MOVED, box
from softffd import Scene, Simulation, deform, simulate
from softffd.errors import SceneError
from softffd.fmu.package import scene_masses
from softffd.rotation import between_directions, turned
from softffd.scene.obstacle import gap

G = -GRAVITY[2]
UNIT = {"origin": [0.0, 0.0, 0.0], "size": [1.0, 1.0, 1.0]}
CENTRE = {"name": "centre", "at": [0.5, 0.5, 0.5]}


@pytest.fixture
def body(tmp_path):
    """body(vertices and faces, keys) is a scene of a body in the unit box, with contact of its surface and steps of 1 ms."""

    def made(shape, **keys) -> Scene:
        keys = {"contact": {"of": "surface"}, "lattice": UNIT, "method": "leapfrog", "step": 1e-3, "communication_step": 0.02, **keys}
        return box(mesh={"file": bodies.write(tmp_path / "body.obj", shape)}, stiffness=keys.pop("stiffness", 2e3), probe=[CENTRE], **keys)

    return made


def sphere_gap(ball, places, centre=None):
    return gap("sphere", ball, places, ball["point"] if centre is None else centre, None)


def test_a_cube_rests_on_a_large_sphere(body):
    """Held in place by nothing but balance: its face lies around the top."""
    ball = {"name": "ball", "radius": 20.0, "point": [0.5, 0.5, -20.0], "friction": 0.4}
    scene = body(bodies.cube(5, 0.0), gravity=GRAVITY, damping=1.0, sphere=[ball], offset=[0.0, 0.0, 0.02], stop_time=10.0)
    result = simulate(scene)
    assert vector(result, "plane.ball.reaction")[-1] == pytest.approx([0.0, 0.0, -G], abs=1e-9)
    assert sphere_gap(ball, result.deformed(row=slice(None))).min() >= -1e-12


FLAT = {"cylinder": {"radius": 10.0, "length": 2.0}, "box": {"size": [20.0, 16.0, 2.0], "rotation": {"axis": [0, 0, 1], "degrees": 30.0}}}


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("solid", FLAT)
def test_a_flat_face_is_as_good_as_a_plane(body, solid, friction):
    """What meets the flat end of a wide cylinder, or a side of a box, moves as on a plane."""
    keys = {"gravity": [1.0, 0.0, -9.81], "offset": [0.0, 0.0, 0.05], "rotation": {"axis": [1, 2, 0], "degrees": 3.0}, "stop_time": 1.0}
    shape = bodies.cube(5, 0.0)
    plane = simulate(body(shape, plane=[{"name": "ground", "friction": friction}], **keys))
    flat = {"name": "ground", "point": [0.0, 0.0, -1.0], "friction": friction, **FLAT[solid]}
    other = simulate(body(shape, **{solid: [flat]}, **keys))
    assert np.abs(plane.positions - other.positions).max() <= 1e-9
    assert np.abs(vector(plane, "plane.ground.reaction") - vector(other, "plane.ground.reaction")).max() <= 1e-6


def test_a_body_slides_off_a_cylinder(body):
    axis, centre = np.array([0.0, 1.0, 0.0]), np.array([0.2, 0.5, -0.5])
    log = {"name": "log", "radius": 0.5, "length": 0.8, "point": list(centre), "normal": list(axis), "friction": 0.2}
    ground = {"name": "ground", "point": [0.0, 0.0, -2.0], "friction": 0.2}
    scene = body(bodies.sphere(3), gravity=GRAVITY, damping=0.1, cylinder=[log], plane=[ground], stop_time=2.0)
    result = simulate(scene)
    places = result.deformed(row=slice(None))
    assert gap("cylinder", log, places, centre, axis).min() >= -1e-12
    assert places[..., 2].min() >= -2 - 1e-12
    assert np.abs(vector(result, "plane.log.reaction")).max() > 1
    assert vector(result, "probe.centre")[-1][2] < 0.5 - 1


def test_a_moving_sphere_gives_the_momentum_that_it_is_charged_with(body):
    ball = {"name": "ball", "radius": 0.2, "point": [-0.5, 0.55, 0.5], "friction": 0.3, "velocity": [1.0, 0.0, 0.0], **MOVED}
    scene = body(bodies.sphere(3), sphere=[ball], damping=0.0, velocities="all", stop_time=1.0)
    mass, H = scene_masses(scene).mass, 0.02
    with Simulation(scene) as simulation:
        impulse, deepest = np.zeros(3), np.inf
        for step in range(50):
            at = np.array([-0.5 + step * H, 0.55, 0.5])
            simulation.plane["ball"].point = at
            simulation.step()
            impulse += H * np.array(simulation.plane["ball"].reaction)
            places = deform(scene.loaded_mesh, simulation.positions, origin=scene.lattice_box.origin, size=scene.lattice_box.size)
            deepest = min(deepest, sphere_gap(ball, places, at + np.array([H, 0.0, 0.0])).min())
            momentum = mass @ np.array(simulation.velocities).reshape(-1, 3)
            assert np.abs(momentum + impulse).max() <= 1e-12
        assert momentum[0] > 0.1
        assert deepest >= -1e-12


def test_what_starts_inside_is_moved_out(body):
    ball = {"name": "ball", "radius": 0.2, "point": [0.5, 0.5, 0.1]}
    result = simulate(body(bodies.sphere(3), sphere=[ball], stop_time=0.1))
    assert sphere_gap(ball, result.deformed(row=slice(None))).min() >= -1e-12
    assert any("in sphere ball" in message.text for message in result.log)


def test_a_thin_disk_is_not_passed(body):
    """A fast body meets a disk a thousandth of what it moves in a step."""
    disk = {"name": "disk", "radius": 3.0, "length": 1e-4, "point": [0.5, 0.5, -0.2], "friction": 0.0}
    result = simulate(body(bodies.sphere(3), velocity=[0.0, 0.0, -100.0], cylinder=[disk], stiffness=1e5, stop_time=0.1))
    places = result.deformed(row=slice(None))
    assert places[..., 2].min() >= -0.2 + 5e-5 - 1e-12


CRATE = {"name": "crate", "size": [0.8, 1.2, 0.6], "rotation": {"axis": [1.0, 2.0, 0.5], "degrees": 40.0}}


def crate_axes(normal=None):
    """The crate's third axis and its first, where its third is turned to another direction."""
    axis = np.array(CRATE["rotation"]["axis"])
    turn = np.radians(CRATE["rotation"]["degrees"]) * axis / np.linalg.norm(axis)
    third, first = (turned(np.eye(3)[a], turn) for a in (2, 0))
    return (third, first) if normal is None else (normal, turned(first, between_directions(third, normal)))


def test_a_body_tumbles_over_a_box(body):
    """Past its corner, its edges and its sides."""
    crate = {**CRATE, "point": [0.3, 0.6, -0.6], "friction": 0.2}
    ground = {"name": "ground", "point": [0.0, 0.0, -2.0], "friction": 0.2}
    result = simulate(body(bodies.sphere(3), gravity=GRAVITY, damping=0.1, box=[crate], plane=[ground], stop_time=2.0))
    places = result.deformed(row=slice(None))
    assert -1e-12 <= gap("box", crate, places, np.array(crate["point"]), *crate_axes()).min() < 1e-9
    assert np.abs(vector(result, "plane.crate.reaction")).max() > 1
    assert vector(result, "probe.centre")[-1][2] < 0.5 - 1


def test_what_starts_inside_a_box_is_moved_out(body):
    crate = {**CRATE, "point": [0.5, 0.5, -0.2]}
    result = simulate(body(bodies.sphere(3), box=[crate], stop_time=0.1))
    assert gap("box", crate, result.deformed(row=slice(None)), np.array(crate["point"]), *crate_axes()).min() >= -1e-12
    assert any("in box crate" in message.text for message in result.log)


def test_a_thin_box_is_not_passed(body):
    board = {"name": "board", "size": [6.0, 6.0, 1e-4], "point": [0.5, 0.5, -0.2], "friction": 0.0}
    result = simulate(body(bodies.sphere(3), velocity=[0.0, 0.0, -100.0], box=[board], stiffness=1e5, stop_time=0.1))
    assert result.deformed(row=slice(None))[..., 2].min() >= -0.2 + 5e-5 - 1e-12


def test_a_turning_box_gives_the_momentum_that_it_is_charged_with(body):
    """Pushed and tipped by inputs, which are told all; no vertex is inside at any communication point."""
    inputs = ["point", "normal", "velocity", "angular_velocity"]
    crate = {**CRATE, "point": [0.5, 0.6, -0.75], "friction": 0.3, "motion": "input", "inputs": inputs}
    scene = body(bodies.sphere(3), box=[crate], damping=0.0, velocities="all", stop_time=1.0)
    mass, H = scene_masses(scene).mass, 0.02
    up, spin = np.array([0.0, 0.1, 1.0]), np.array([0.3, -0.4, 0.0])
    with Simulation(scene) as simulation:
        impulse, deepest = np.zeros(3), np.inf
        for step in range(50):
            poses = [(np.array(crate["point"]) + n * H * up, turned(crate_axes()[0], n * H * spin)) for n in (step, step + 1)]
            obstacle = simulation.plane["crate"]
            (obstacle.point, obstacle.normal), obstacle.velocity = poses[0], up
            obstacle.angular_velocity = between_directions(poses[0][1], poses[1][1]) / H
            simulation.step()
            impulse += H * np.array(simulation.plane["crate"].reaction)
            places = deform(scene.loaded_mesh, simulation.positions, origin=scene.lattice_box.origin, size=scene.lattice_box.size)
            deepest = min(deepest, gap("box", crate, places, poses[1][0], *crate_axes(poses[1][1])).min())
            momentum = mass @ np.array(simulation.velocities).reshape(-1, 3)
            assert np.abs(momentum + impulse).max() <= 1e-12
        assert momentum[2] > 0.1
        assert deepest >= -1e-12


def test_a_box_that_turns_by_itself_turns_about_all_axes(body):
    """A cube that lies on the middle of a turning table goes round with it."""
    table = {"name": "table", "size": [3.0, 3.0, 0.5], "point": [0.5, 0.5, -0.25], "friction": 2.0, "angular_velocity": [0.0, 0.0, 0.5]}
    start = {"angular_velocity": [0.0, 0.0, 0.5]}
    result = simulate(body(bodies.cube(5, 0.0), gravity=GRAVITY, damping=0.0, box=[table], stop_time=1.0, **start))
    first, last = result.positions[0].reshape(-1, 3), result.positions[-1].reshape(-1, 3)
    middle = np.array([0.5, 0.5, 0.0])
    wanted = middle + turned(first - middle, np.broadcast_to([0.0, 0.0, 0.5], first.shape))
    assert np.abs(wanted - last)[:, :2].max() < 0.02


@pytest.mark.parametrize(("friction", "ratio"), [(0.0, 3.5), (0.3, 1.8)], ids=["smooth", "rough"])
@pytest.mark.parametrize("solid", ["sphere", "cylinder"])
def test_sliding_in_lasting_contact_is_second_order_without_friction(body, solid, friction, ratio):
    """By how much the error against a small step falls when the step is halved: a cube slides on four corners."""
    sphere = {"name": "ball", "radius": 2.0, "point": [0.5, 0.5, -np.sqrt(4 - 0.5)], "friction": friction}
    log = {**sphere, "length": 10.0, "normal": [0.0, 1.0, 0.0], "point": [0.5, 0.5, -np.sqrt(4 - 0.25)]}
    keys = {
        solid: [sphere if solid == "sphere" else log],
        "gravity": GRAVITY,
        "velocity": [0.5, 0.2, 0.0],
        "damping": 0.5,
        "stop_time": 0.2,
    }
    ends = [simulate(body(bodies.cube(2, 0.0), step=h, **keys)).positions[-1] for h in (4e-4, 2e-4, 5e-6)]
    errors = [np.abs(end - ends[-1]).max() for end in ends[:-1]]
    assert errors[0] > ratio * errors[1]


def test_implicit_steps_and_the_lattice_refuse_them(body):
    ball = {"name": "ball", "radius": 0.2}
    with pytest.raises(
        SceneError, match=r'solver.method: wanted "auto", "leapfrog".* beside a sphere, cylinder or box, got "backward_euler"'
    ):
        body(bodies.sphere(1), sphere=[ball], method="backward_euler", step=0.0)
    with pytest.raises(SceneError, match=r"contact.of: .lattice. knows planes alone, but the scene has a \[\[sphere\]\]"):
        body(bodies.sphere(1), sphere=[ball], contact={"of": "lattice"})


def test_a_state_continues_with_the_same_bits(body):
    ball = {"name": "ball", "radius": 1.0, "point": [0.5, 0.5, -1.0]}
    with Simulation(body(bodies.sphere(2), gravity=GRAVITY, sphere=[ball], stop_time=1.0)) as simulation:
        for _ in range(20):
            simulation.step()
        state = simulation.save()
        ends = []
        for _ in range(2):
            simulation.restore(state)
            for _ in range(10):
                simulation.step()
            ends.append(np.array(simulation.positions))
        assert (ends[0] == ends[1]).all()
