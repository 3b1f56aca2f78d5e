"""Free obstacles and pins through the FMU: variables, starts, loads, flights; alike in both versions of the standard."""

from pathlib import Path

import fmpy
import fmpy.validation
import numpy as np
import pytest

from scenes import GRAVITY, meshed
from softffd import FmuError, Simulation, package_fmu
from softffd.fmu.component import Component
from softffd.fmu.notes import read_notes
from softffd.fmu.package import write_folder
from validation import shapes

G = np.array(GRAVITY)
FAR = 50.0
"""Where nothing is met [m]"""
BALL = {"name": "ball", "radius": 0.1, "point": [0.0, 0.0, FAR], "motion": "free", "mass": 2.0, "velocity": [1.0, 0.0, 3.0]}
BLOCK = {
    **{"name": "block", "size": [0.1, 0.2, 0.3], "point": [FAR, 0.0, 0.0], "motion": "free", "density": 500.0},
    **{"rotation": {"axis": [1, 2, 0], "degrees": 40.0}, "angular_velocity": [3.0, -1.0, 2.0]},
}
SLED = {"name": "sled", "radius": 0.2, "length": 0.1, "point": [0.0, FAR, 0.0], "motion": "free", "mass": 3.0, "guide": [0.0, 3.0, 4.0]}
HELD = {"name": "hand", "points": "z+", "motion": "free", "mass": 2.0, "inertia": [0.1, 0.2, 0.25]}
LOOSE = {"name": "loose", "radius": 0.1, "point": [0.0, 0.0, -FAR]}


@pytest.fixture
def scene(tmp_path):
    return free_bodies(tmp_path)


def free_bodies(folder: Path, **keys):
    """A cube without gravity of its own: nothing happens but flights."""
    parts = {"sphere": [LOOSE, BALL], "cylinder": [SLED], "box": [BLOCK]}
    about = {"gravity": GRAVITY, "stop_time": 1.0, "communication_step": 0.05}
    return meshed(folder, shapes.cube(2, 0.1), **{**parts, **about, "energy": True, "pin": [HELD], **keys})


def names_of(part: str, causality: str, interface) -> list[str]:
    """The vectors and numbers of a part."""
    begin = f"{part}."
    of_it = [name.removeprefix(begin) for name, v in interface.variables.items() if name.startswith(begin) and v.causality == causality]
    return list(dict.fromkeys(name[:-2] if name[-2:-1] == "." else name for name in of_it))


LOADS = ["force", "torque"]
SHAPE = ["point", "normal", "friction", "start_velocity", "mass"]
REACTIONS = ["reaction", "centre", "contacts"]
MOTION = ["position", "orientation", "velocity", "reaction_torque"]
VARIABLES = {
    "sphere.ball": (LOADS, [*SHAPE, "start_angular_velocity"], [*REACTIONS, *MOTION, "angular_velocity"]),
    "cylinder.sled": (["force"], SHAPE, [*REACTIONS, *MOTION]),
    "box.block": (
        LOADS, ["point", "rotation", "friction", "start_velocity", "start_angular_velocity", "mass"],
        [*REACTIONS, *MOTION, "angular_velocity"],
    ),
    "pin.hand": (LOADS, ["mass"], ["reaction", *MOTION, "angular_velocity"]),
    "sphere.loose": ([], ["point", "normal", "velocity", "angular_velocity", "friction"], [*REACTIONS, "torque"]),
}  # fmt: skip


@pytest.mark.parametrize("part", VARIABLES)
def test_a_free_body_has_loads_a_mass_and_its_motion_as_outputs(part, scene, tmp_path):
    interface = write_folder(scene, tmp_path)
    found = tuple(sorted(names_of(part, causality, interface)) for causality in ("input", "parameter", "output"))
    assert found == tuple(map(sorted, VARIABLES[part]))


@pytest.mark.short("3-flat")
@pytest.mark.parametrize(("fmi", "names"), [(2, "structured"), (3, "flat")])
def test_starts_and_names_of_the_description_are_those_of_the_library(fmi, names, scene, tmp_path):
    file = package_fmu(scene.replace({"fmu.names": names}), tmp_path / "free.fmu", fmi=fmi)
    assert not fmpy.validation.validate_fmu(str(file))
    with Component(file) as component:
        component.set_up()
        starts = {name: float(v.start) for name, v in component.by_name.items() if v.start is not None and v.type == "Real"}
        assert dict(zip(starts, component.block(list(starts)).get(), strict=True)) == starts
        for name in (name for name in starts if name.startswith(("sphere", "pin"))):
            component.reset()
            component.set_up()
            with pytest.raises(FmuError) as refused:
                component.set_start_values({name: float("nan")})
            assert f"{name}: wanted a finite number" in str(refused.value)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_free_body_begins_where_its_parameters_say_and_flies(fmi, scene, tmp_path):
    loads = {"sphere.ball.force": (2.0, 0.0, 4.0), "cylinder.sled.force": (0.0, 0.0, 6.0)}
    starts = {"sphere.ball.point": (0.0, 1.0, FAR), "sphere.ball.start_velocity.y": 2.0, "sphere.ball.mass": 4.0}
    with Simulation(package_fmu(scene, tmp_path / "free.fmu", fmi=fmi), start_values={**starts, **loads}) as sim:
        assert sim["sphere.ball.position"].tolist() == [0.0, 1.0, FAR] and sim["sphere.ball.velocity"].tolist() == [1.0, 2.0, 3.0]
        for _ in range(4):
            sim.step(0.25)
        pull = np.array(loads["sphere.ball.force"]) / 4.0 + G
        assert sim["sphere.ball.position"] == pytest.approx(np.array([0.0, 1.0, FAR]) + np.array([1.0, 2.0, 3.0]) + 0.5 * pull, abs=1e-12)
        assert sim["sphere.ball.velocity"] == pytest.approx(np.array([1.0, 2.0, 3.0]) + pull, abs=1e-12)
        along = np.array([0.0, 0.6, 0.8])
        gained = along * (along @ (np.array([0.0, 0.0, 6.0]) / 3.0 + G))
        assert sim["cylinder.sled.velocity"] == pytest.approx(gained, abs=1e-12)
        assert sim["cylinder.sled.position"] == pytest.approx([0.0, FAR, 0.0] + 0.5 * gained, abs=1e-12)
        assert sim["cylinder.sled.orientation"].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_a_free_block_turns_with_its_angular_momentum(scene):
    mass = 500.0 * 0.006
    inertia = mass / 12 * np.array([0.13, 0.10, 0.05])

    def momentum(sim):
        w, *u = sim["box.block.orientation"]
        u = np.array(u)
        axes = np.stack([v + 2 * np.cross(u, np.cross(u, v) + w * v) for v in np.eye(3)], axis=1)
        return axes @ (inertia * (axes.T @ sim["box.block.angular_velocity"]))

    with Simulation(scene) as sim:
        assert sim["box.block.angular_velocity"] == pytest.approx([3.0, -1.0, 2.0], abs=1e-14)
        first = momentum(sim)
        sim.step(0.5)
        assert momentum(sim) == pytest.approx(first, rel=1e-9)
        sim["box.block.torque"] = torque = np.array([0.01, 0.0, -0.02])
        sim.step(0.5)
        assert momentum(sim) == pytest.approx(first + 0.5 * torque, rel=1e-9)


def test_a_force_with_a_derivative_grows_within_the_step(scene):
    with Simulation(scene, start_values={"sphere.ball.force.x": 1.0}) as sim:
        sim.set_rates({"sphere.ball.force.x": 8.0})
        start = sim["sphere.ball.position"][0]
        sim.step(0.5)
        assert sim["sphere.ball.velocity"][0] == pytest.approx(1.0 + 0.5 * 3.0 / 2.0, abs=1e-12)
        assert sim["sphere.ball.position"][0] - start == pytest.approx(0.5 + 0.5**2 / 4 + 8 * 0.5**3 / 12, abs=1e-12)
        sim.step(0.5)
        assert sim["sphere.ball.velocity"][0] == pytest.approx(1.0 + (1.5 + 0.5) / 2.0, abs=1e-12)


def test_a_state_continues_with_the_same_bits(scene):
    parts, vectors = ("sphere.ball", "box.block", "cylinder.sled"), ("position", "orientation", "velocity")
    with Simulation(scene) as sim, Simulation(scene) as other:
        sim["box.block.torque"] = (0.01, 0.0, 0.0)
        sim.step(0.3)
        state = bytes(sim.save())
        other.restore(state)
        for each in (sim, other):
            each.step(0.3)
        assert all((sim[f"{part}.{vector}"] == other[f"{part}.{vector}"]).all() for part in parts for vector in vectors)
        assert bytes(sim.save()) == bytes(other.save())


@pytest.mark.parametrize("number", [2, 4, 5, 6, 7, 8])
def test_a_method_without_free_bodies_cannot_be_set(number, scene):
    with Component(scene) as component:
        component.set_up()
        with pytest.raises(FmuError, match=r"solver.method: wanted one of 1 auto, 3 leapfrog, 9 sdirk2 \(a body is free\), got"):
            component.set_start_values({"solver.method": number})


@pytest.mark.parametrize("names", ["structured", "flat"])
def test_a_foreign_host_runs_it(names, scene, tmp_path):
    file = package_fmu(scene.replace({"fmu.names": names}), tmp_path / "free.fmu")
    height = "sphere.ball.position.z" if names == "structured" else "sphere_ball_position_z"
    rows = fmpy.simulate_fmu(str(file), output=[height], stop_time=0.5, output_interval=0.05)
    t = rows["time"]
    assert rows[height] == pytest.approx(FAR + 3.0 * t + 0.5 * G[2] * t**2, abs=1e-9)


def test_free_obstacles_do_not_meet_each_other_which_the_build_says_once(scene, tmp_path):
    write_folder(scene, tmp_path)
    assert [note for note in read_notes(tmp_path / "resources") if "free" in note] == [
        "free obstacles do not meet each other: sphere.ball, cylinder.sled, box.block"
    ]
