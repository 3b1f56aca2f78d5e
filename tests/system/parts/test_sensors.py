"""Sensors: forces, pressures and taxels on patches of the surface, against reactions, weights, Hertz and the centre of pressure."""

import math
from contextlib import contextmanager, nullcontext

import numpy as np
import pytest

from scenes import GRAVITY, box
from softffd import FmuError, Simulation, simulate
from softffd.mesh.files import load_mesh, save_mesh
from softffd.mesh.looks import Group, Looks
from softffd.mesh.mesh import Mesh
from solids import face_mean, solid
from validation import shapes
from validation.published import spheres
from validation.published.cases import Body
from validation.published.runs import Course

SIDE, WEIGHT = 0.1, 9.81
"""Of a block of 1 kg [m, N]"""
FOOT = {"name": "foot", "on": "z-", "taxels": [3, 2]}


def block(folder, points=4, *, vertices=9, **keys):
    """A solid of 1 kg whose surface touches, or whose nodes do without vertices."""
    vertices_of, faces = shapes.cube(vertices, 0.0) if vertices else (None, None)
    mesh = {"mesh": {"file": shapes.write(folder / "block.obj", (SIDE * vertices_of, faces))}} if vertices else {}
    given = {"gravity": GRAVITY, "internal_damping": 5e-3, "plane": [{"name": "ground"}], "ratio": 0.0} | mesh | keys
    return solid(points, modulus=1e5, density=1000.0, size=[SIDE] * 3, **given)


def reaction(sim):
    """Of all obstacles [N]."""
    return sum(sim.obstacle[name].reaction for name in sim.obstacle)


def rested(scene, seconds=0.6):
    sim = Simulation(scene)
    for _ in range(round(seconds / 0.05)):
        sim.step(0.05)
    return sim


@pytest.mark.parametrize("vertices", [0, 9], ids=["nodes", "surface"])
def test_a_block_at_rest_presses_evenly_with_its_weight(tmp_path, vertices):
    with rested(block(tmp_path, vertices=vertices, sensor=[FOOT])) as sim:
        foot = sim.sensor["foot"]
        assert foot.force == pytest.approx([0, 0, WEIGHT], abs=1e-6)
        assert foot.torque == pytest.approx([0, 0, 0], abs=1e-8)
        assert foot.area == pytest.approx(SIDE**2, rel=1e-4) and foot.pressure == pytest.approx(WEIGHT / SIDE**2, rel=1e-4)
        assert foot.pressure <= foot.peak_pressure <= 1.05 * foot.pressure
        assert foot.taxels.shape == (3, 2, 3)
        assert foot.taxels[..., 2] == pytest.approx(foot.taxels[::-1, ::-1, 2], abs=0.02 * WEIGHT)


def test_a_reading_that_is_no_number_discards_the_step():
    """Squares of the plane's velocity overflow."""
    turning = {"name": "ground", "angular_velocity": [0.0, 0.0, -9.78e155]}
    for sensors in ([], [FOOT]):
        scene = solid(
            4, modulus=1e5, density=100.0, gravity=GRAVITY, internal_damping=1e-3, tolerance=1e-3, plane=[turning], sensor=sensors
        )
        with Simulation(scene) as sim:
            sim.step(0.01)
            with pytest.raises(FmuError, match=r"discarded the step: .* is not finite") if sensors else nullcontext():
                sim.step(0.01)


MOVING = {"velocity": [0.5, 0.2, 0.0], "angular_velocity": [0.0, 1.0, 0.0], "offset": [0.0, 0.0, 0.004]}


def thrown(folder, kind, method, obstacles):
    everywhere = {"name": "all", "on": {"box": [[-1, -1, -1], [1, 1, 1]]}, "taxels": [4, 3]}
    keys = {"sensor": [everywhere], "method": method} | MOVING | obstacles
    if kind == "nodes":
        return block(folder, vertices=0, **keys)
    if kind == "surface":
        vertices, faces = shapes.cube(9, 0.0)
        keys["mesh"] = {"file": shapes.write(folder / "block.obj", (SIDE * vertices, faces))}
    return box(stiffness=2e3, size=[SIDE] * 3, gravity=GRAVITY, damping=0.05, **keys)


PLANES = {"plane": [{"name": "ground", "friction": 0.3}, {"name": "wall", "point": [0.13, 0, 0], "normal": [-1, 0, 0], "friction": 0.5}]}
BALL = {"plane": [{"name": "ground"}], "sphere": [{"name": "ball", "point": [0.05, 0.05, -0.2], "radius": 0.205, "friction": 0.3}]}


@pytest.mark.short("points-leapfrog-plane", "points-central_difference-plane", "nodes-leapfrog-plane", "surface-leapfrog-plane+sphere")
@pytest.mark.parametrize(
    "kind, method, obstacles",
    [
        *(("points", method, PLANES) for method in ("leapfrog", "central_difference", "auto", "backward_euler")),
        *(("nodes", method, PLANES) for method in ("leapfrog", "auto")),
        *(("surface", method, PLANES) for method in ("leapfrog", "auto", "sdirk2")),
        *(("surface", method, BALL) for method in ("leapfrog", "sdirk2")),
    ],
    ids=lambda given: given if isinstance(given, str) else "+".join(given),
)
def test_the_taxels_sum_to_what_the_obstacles_feel(tmp_path, kind, method, obstacles):
    touched = 0
    with Simulation(thrown(tmp_path, kind, method, obstacles)) as sim:
        for _ in range(20):
            sim.step(0.01)
            felt, sensor = -reaction(sim), sim.sensor["all"]
            size = max(np.linalg.norm(felt), 1e-3)
            assert sensor.force == pytest.approx(felt, abs=1e-12 * size)
            assert sensor.taxels.sum(axis=(0, 1)) == pytest.approx(felt, abs=1e-12 * size)
            assert sensor.area >= 0 and sensor.peak_pressure >= 0.999 * sensor.pressure >= 0
            touched += np.linalg.norm(felt) > 0.1
        assert touched > 5


def test_a_scene_with_sensors_moves_as_one_without(tmp_path):
    plain, sensed = (
        simulate(thrown(tmp_path, "surface", "auto", PLANES | {"sensor": each}), stop_time=0.06, step=0.01) for each in ([], [FOOT])
    )
    assert np.array_equal(plain.positions, sensed.positions)


def test_two_groups_of_the_mesh_share_the_weight(tmp_path):
    vertices, faces = shapes.cube(9, 0.0)
    left = vertices[faces][:, :, 0].mean(axis=1) < 0.5
    groups = Looks(groups=(Group("", "left"), Group("right", "")), group_of=(~left).astype(np.int64))
    save_mesh(Mesh(SIDE * vertices, faces, looks=groups), tmp_path / "halves.obj")
    assert [group.group or group.object for group in load_mesh(tmp_path / "halves.obj").looks.groups] == ["left", "right"]
    sensors = [{"name": each, "on": each} for each in ("left", "right")]
    scene = block(tmp_path, vertices=0, sensor=sensors, mesh={"file": tmp_path / "halves.obj"}, contact={"of": "surface"})
    with rested(scene) as sim:
        left, right = (sim.sensor[each].force[2] for each in ("left", "right"))
        assert left == pytest.approx(right, rel=0.01) and WEIGHT < left + right < 1.2 * WEIGHT  # the vertices between them count in both


def lowered(scene, name, way, seconds=0.2):
    """The scene at rest after an obstacle that inputs move along z went down by `way` [m] from where it was."""
    sim = Simulation(scene)
    begin = sim.obstacle[name].point[2]
    for n in range(20):
        sim[f"{name_of(sim, name)}.point.z"], sim[f"{name_of(sim, name)}.velocity.z"] = begin - way * n / 20, -way * 20 / seconds / 2
        sim.step(seconds / 40)
    sim[f"{name_of(sim, name)}.point.z"], sim[f"{name_of(sim, name)}.velocity.z"] = begin - way, 0.0
    for _ in range(20):
        sim.step(seconds / 40)
    return sim


def name_of(sim, name):
    return sim.obstacle[name].path


LED = {"motion": "input", "inputs": ["point.z", "velocity.z"], "friction": 0.0}
HELD = {"gravity": [0, 0, 0], "pin": [{"name": "base", "points": "z-"}], "ratio": 0.3, "internal_damping": 2e-3}


@pytest.mark.full
def test_a_tilted_plate_presses_where_the_taxels_feel_it(tmp_path):
    tilt = 0.03
    plate = {"name": "press", "point": [0.05, 0.05, 0.102], "normal": [math.sin(tilt), 0, -math.cos(tilt)], **LED}
    scene = block(tmp_path, 4, vertices=9, plane=[plate], sensor=[{"name": "top", "on": "z+", "taxels": [16, 16]}], **HELD)
    with lowered(scene, "press", 0.005) as sim:
        centre, taxels = sim.plane["press"].centre, sim.sensor["top"].taxels[..., 2]
        along = (np.arange(16) + 0.5) * SIDE / 16
        felt = taxels.sum(axis=1) @ along / taxels.sum(), taxels.sum(axis=0) @ along / taxels.sum()
        assert centre[0] < 0.045
        assert felt == pytest.approx(centre[:2], abs=SIDE / 16 / 4)
        middle = [face_mean(sim.positions[:, :, -1, axis]) for axis in range(3)]
        torque = np.cross(centre - middle, sim.sensor["top"].force)
        assert sim.sensor["top"].torque[:2] == pytest.approx(torque[:2], abs=0.02 * abs(torque[1]))


@contextmanager
def pressed(points, folder, way, ball=True):
    """The sensor on the block of the published case, at rest under its ball, or a punch of 16 mm, which went down by `way` [m]; and the
    reaction."""
    body, density = Body("solid", (points,) * 3, 0.25), 1000.0
    scene, slowest, kind = spheres._scene(body, density, str(folder)), spheres._slowest(density), "sphere" if ball else "box"
    given = {key: getattr(scene, key) for key in scene.model_fields_set} | {"sensor": [{"name": "top", "on": "z+", "taxels": [18, 18]}]}
    if not ball:
        given["box"] = [
            {"name": "ball", "point": [0.02, 0.02, spheres.SIDE + spheres.RADIUS], "size": [0.016, 0.016, 2 * spheres.RADIUS], **LED}
        ]
        del given["sphere"]
    scene = type(scene).model_validate(given, context={"path": folder / "scene.toml"})
    with Course(scene) as course:
        course.sim[f"{kind}.ball.velocity.z"] = -way * slowest / 2
        course.step(2 / slowest)
        course.sim[f"{kind}.ball.point.z"], course.sim[f"{kind}.ball.velocity.z"] = spheres.SIDE + spheres.RADIUS - way, 0.0
        course.rest(lambda: float(course.sim.number(f"{kind}.ball.reaction.z")), 1 / slowest)
        sensor = course.sim.sensor["top"]
        yield sensor, course.sim.obstacle["ball"].reaction


@pytest.mark.full
def test_a_ball_presses_as_hertz_says_the_better_the_finer_the_lattice(tmp_path):
    """Peak 3 F / (2 pi a2), area pi a2 with a2 = R d; a cell of 13 points is 3.3 mm, a is 6.3 mm."""
    depth, errors = 0.1, []
    force, radius = spheres.hertz(0.25, depth * spheres.RADIUS), spheres.RADIUS * math.sqrt(depth)
    way = depth * spheres.RADIUS + spheres.GIVES * force / (spheres.MODULUS * spheres.SIDE)
    area, peak = math.pi * radius**2, 1.5 * force / (math.pi * radius**2)
    for points in (7, 13, 19):
        with pressed(points, tmp_path, way) as (sensor, _):
            errors.append([sensor.peak_pressure / peak - 1, sensor.area / area - 1])
    peaks, areas = np.abs(errors).T
    assert peaks[0] > peaks[1] > peaks[2] and peaks[1] < 0.2 and peaks[2] < 0.15
    assert areas.max() < 0.35


@pytest.mark.full
def test_a_flat_punch_presses_with_its_force_on_its_own_area(tmp_path):
    """All of a square punch touches, and its edges press most (Boussinesq)."""
    with pressed(13, tmp_path, 0.001, ball=False) as (sensor, felt):
        assert sensor.force == pytest.approx(-felt, abs=1e-12 * felt[2])
        assert sensor.area == pytest.approx(0.016**2, rel=0.25)
        assert sensor.peak_pressure > 1.2 * sensor.pressure
        side, middle = -sensor.taxels[1, 8:10, 2].sum(), -sensor.taxels[8:10, 8:10, 2].sum() / 2
        assert side > middle


@pytest.mark.parametrize("method", ["leapfrog", "sdirk2"])
def test_a_saved_state_keeps_what_sensors_felt(tmp_path, method):
    scene = block(tmp_path, vertices=9, sensor=[FOOT], method=method, probe=[{"name": "top", "at": [0.05, 0.05, 0.1], **SHOWN}])
    read = ["sensor.foot.force", "sensor.foot.torque", "probe.top.acceleration"]
    scalars = ["sensor.foot.pressure", "sensor.foot.peak_pressure", "probe.top.maximum.acceleration", "probe.top.maximum.velocity"]

    def seen(sim):
        return [*(sim.vector(name).tolist() for name in read), *map(sim.number, scalars), sim.sensor["foot"].taxels.tolist()]

    with Simulation(scene) as sim:
        for _ in range(10):
            sim.step(0.01)
        state, then = sim.save(), seen(sim)
        sim.step(0.01)
        after = seen(sim)
        sim.restore(bytes(state))
        assert seen(sim) == then != after
        sim.step(0.01)
        assert seen(sim) == after


SHOWN = {"velocity": True, "acceleration": True, "maximum": True}


def test_a_point_of_a_turning_body_has_the_speed_and_acceleration_of_its_circle():
    spin, arm = 3.0, 0.5
    probe = {"name": "side", "at": [1.0, 0.5, 0.5], **SHOWN}
    scene = box(stiffness=1e5, damping=0.0, internal_damping=1e-2, angular_velocity=[0, 0, spin], probe=[probe])
    with Simulation(scene) as sim:
        sim.step(0.5)  # it widens under the spin, and that swings out
        for step in (0.001, 0.002, 0.1):
            sim.step(step)
            turned = spin * sim.time
            assert sim.vector("probe.side.velocity") == pytest.approx(
                [-spin * arm * math.sin(turned), spin * arm * math.cos(turned), 0], abs=0.02
            )
            mean = spin * arm * 2 * math.sin(spin * step / 2) / step  # a chord of the circle of velocities
            assert np.linalg.norm(sim.vector("probe.side.acceleration")) == pytest.approx(mean, rel=0.01)
            assert sim.number("probe.side.maximum.velocity") == pytest.approx(spin * arm, rel=0.01)
            assert sim.number("probe.side.maximum.acceleration") == pytest.approx(spin**2 * arm, rel=0.01)


def test_the_largest_within_a_step_is_that_of_shorter_ones():
    """A drop: the same largest values of the top whether one communication step or two hundred see them."""
    probe = {"name": "top", "at": [0.5, 0.5, 1.0], "von_mises": True, **SHOWN}
    scene = solid(
        4, modulus=1e5, density=1000.0, ratio=0.3, internal_damping=1e-4, gravity=GRAVITY, offset=[0, 0, 0.05],
        plane=[{"name": "ground"}], probe=[probe], method="leapfrog", step=1e-4,
    )  # fmt: skip
    names = [f"probe.top.maximum.{each}" for each in ("velocity", "acceleration", "von_mises")]
    with Simulation(scene) as fine, Simulation(scene) as coarse:
        coarse.step(0.4)
        seen = []
        for _ in range(200):
            fine.step(0.002)
            seen.append([fine.number(name) for name in names])
        speed, acceleration, stress = np.max(seen, axis=0)
        assert coarse.number(names[0]) == speed and coarse.number(names[2]) == stress > 5e3
        assert coarse.number(names[1]) == pytest.approx(acceleration, rel=0.02) and acceleration > 4 * 9.81
