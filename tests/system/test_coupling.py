"""A plate and a soft body, coupled both ways: explicitly, implicitly, and as a system structure in other people's masters."""

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu

from softffd import SoftffdError, load_scene, package_fmu
from softffd.component import Component

pytest.importorskip("pythonfmu", reason="the driver FMUs are made with pythonfmu")
from softffd.drivers import build_driver, build_drivers
from softffd.drivers.coupled import SCENE, write_ssp

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "fmi"))
import importers
from callbacks import own_callbacks

PLANE = "plane.plate."
MOTION = [f"{family}.{axis}" for family in ("point", "velocity") for axis in "xyz"]
FORCE = [f"reaction.{axis}" for axis in "xyz"]
MECHANICAL = ["energy.kinetic", "energy.elastic", "energy.gravity"]
GRAVITY, BODY_MASS = 9.81, 1.0
REST_ENERGY = -0.5 * BODY_MASS * GRAVITY  # of the body at rest, its centre 0.5 m below the origin


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("coupling")
    build_drivers(folder)
    return folder


@pytest.fixture(scope="module")
def ssp(folder) -> Path:
    return write_ssp(folder / "coupled.ssp")


def body_fmu(folder: Path, *changes: tuple[str, str], step: float = 1e-4, more: str = "") -> Path:
    """The shipped box with pieces of its text replaced."""
    text = SCENE.read_text()
    for old, new in (("step = 1e-4", f"step = {step}"), *changes):
        assert old in text
        text = text.replace(old, new)
    (folder / "body.toml").write_text(text + more)
    return package_fmu(load_scene(folder / "body.toml"), folder / "body.fmu")


# ---- an explicit master: all step, then values are exchanged ----


@dataclass
class Run:
    """What an explicit run left behind, a row per communication point after a step."""

    rows: list[np.ndarray] = field(default_factory=list)

    def column(self, n: int) -> np.ndarray:
        return np.array(self.rows)[:, n]


def run_explicitly(folder, body_path, step, steps, *, body_start=None, plate_start=None, read=()) -> Run:
    """Rows: plate's momentum (3), reaction (3), then the body's variables `read`."""
    run = Run()
    with Component(body_path) as body, Component(folder / "plate.fmu") as plate:
        motion, moved = plate.block(MOTION), body.block([PLANE + name for name in MOTION])
        reaction, pushed = body.block([PLANE + name for name in FORCE]), plate.block(FORCE)
        momentum, observed = plate.block([f"momentum.{axis}" for axis in "xyz"]), body.block(list(read))
        for part, start in ((body, body_start), (plate, plate_start)):
            part.initialize(start or {})
            part.exit_initialization()
        for n in range(steps):
            for source, out, target, into in ((plate, motion, body, moved), (body, reaction, plate, pushed)):
                source.get(out)
                into.values[:] = out.values
                target.set(into)
            for part in (plate, body):
                part.do_step(n * step, step)
            for part, block in ((plate, momentum), (body, reaction), (body, observed)):
                part.get(block)
            run.rows.append(np.concatenate([momentum.values, reaction.values, observed.values]))
    return run


def test_momentum_of_plate_and_body_balances_to_rounding(folder):
    """With friction, a sliding plate, a fall and impacts; the ground's impulse and the weights are part of the balance."""
    nodes = [f"[{i},{j},{k}]" for k in range(4) for j in range(4) for i in range(4)]
    read = [f"plane.ground.reaction.{axis}" for axis in "xyz"] + [f"velocity{node}.{axis}" for node in nodes for axis in "xyz"]
    down = "normal = [0.0, 0.0, -1.0]"
    fmu = body_fmu(folder, ("energy = true", 'velocities = "all"'), (down, f"{down}\nfriction = 0.5"))
    step, mass = 2e-3, 3.0
    start = {"mass": mass, "initial.point.z": 0.02, "initial.velocity.x": 0.4, "initial.velocity.z": -0.5}
    run = run_explicitly(folder, fmu, step, 200, body_start={PLANE + "point.z": 0.02}, plate_start=start, read=read)
    rows = np.array(run.rows)
    plate, reaction, ground = rows[:, :3], rows[:, 3:6], rows[:, 6:9]
    body = BODY_MASS / 64 * rows[:, 9:].reshape(len(rows), 64, 3).sum(axis=1)
    steps = np.arange(1, len(rows) + 1)
    weight = np.outer(step * (BODY_MASS * steps + mass * (steps - 1)), [0, 0, -GRAVITY])
    first = mass * np.array([0.4, 0.0, -0.5])
    left = plate + body + step * reaction + step * np.cumsum(ground, axis=0) - weight - first
    assert abs(reaction[:, 0]).max() > 1 and reaction[:, 2].max() > 50  # there was friction and a hard landing
    assert abs(left).max() < 1e-12 * abs(weight).max(), "momenta of some 20 N s, summed over 200 steps"


def energy_error(folder, fmu, step: float, *, delay: int = 1) -> float:
    """Largest error of energy + losses over 0.5 s, the plate lying on the body from the start [J]."""
    mass, steps = 5.0, round(0.5 / step)
    run = run_explicitly(folder, fmu, step, steps, plate_start={"delay": delay}, read=[*MECHANICAL, "energy.dissipated"])
    rows = np.array(run.rows)
    arrived = rows[:, 2] / mass
    if delay == 1:  # the momentum put out is that before the step; the step's own impulse is the reaction put out
        before, after = arrived, arrived + step * (rows[:, 5] / mass - GRAVITY)
    else:
        before, after = np.append(0.0, arrived[:-1]), arrived
    height = np.cumsum(0.5 * step * (before + after))
    return abs(0.5 * mass * after**2 + mass * GRAVITY * height + rows[:, 6:].sum(axis=1) - REST_ENERGY).max()


def test_the_energy_error_falls_with_the_square_of_the_communication_step(folder):
    fmu = body_fmu(folder, step=2e-5)
    errors = [energy_error(folder, fmu, step) for step in (2e-3, 1e-3, 5e-4, 2.5e-4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2, 2, 2], abs=0.15)
    assert errors[1] < 0.02


def test_a_late_reaction_taken_for_that_of_the_step_is_of_first_order_only(folder):
    fmu = body_fmu(folder, step=2e-5)
    late = [energy_error(folder, fmu, step, delay=0) for step in (1e-3, 5e-4, 2.5e-4)]
    assert all(1.0 < order < 1.5 for order in np.log2(np.array(late[:-1]) / late[1:]))
    assert late[0] > 10 * energy_error(folder, fmu, 1e-3)


def loop_energy_error(fmu: Path, step: float, *, ahead: float) -> float:
    """Largest error of energy + losses over 0.5 s [J] of a loop that sends the velocity `ahead` (share of a step) of the plate's own."""
    mass, z, v, force, errors = 5.0, 0.0, 0.0, 0.0, []
    with Component(fmu) as body:
        moved, reaction = body.block([PLANE + "point.z", PLANE + "velocity.z"]), body.block([PLANE + "reaction.z"])
        energy = body.block([*MECHANICAL, "energy.dissipated"])
        body.initialize({})
        body.exit_initialization()
        for n in range(round(0.5 / step)):
            sent = v + ahead * step * (force / mass - GRAVITY)
            moved.values[:] = z, sent
            body.set(moved)
            body.do_step(n * step, step)
            body.get(reaction)
            force = reaction.values[0]
            z, v = z + step * sent, v + step * (force / mass - GRAVITY)
            body.get(energy)
            errors.append(0.5 * mass * v**2 + mass * GRAVITY * z + energy.values.sum() - REST_ENERGY)
    return max(map(abs, errors))


def test_a_loop_of_a_few_lines_is_of_second_order_with_the_mean_velocity_by_the_last_force(folder):
    fmu = body_fmu(folder, step=2e-5)
    errors = {ahead: [loop_energy_error(fmu, step, ahead=ahead) for step in (1e-3, 5e-4, 2.5e-4)] for ahead in (0.5, 0.0)}
    orders = {ahead: np.log2(np.array(found[:-1]) / found[1:]) for ahead, found in errors.items()}
    assert orders[0.5] == pytest.approx([2, 2], abs=0.15)
    assert all(1.0 < order < 1.3 for order in orders[0.0])
    assert errors[0.5][0] < errors[0.0][0] / 100


# ---- an implicit master: steps are tried again from saved states ----


class Part:
    """One FMU in fmpy, by variable names."""

    def __init__(self, path: Path, scratch: Path, **start: float):
        unpacked = fmpy.extract(str(path), unzipdir=str(scratch / path.stem))
        description = fmpy.read_model_description(unpacked)
        self.variables = {variable.name: variable for variable in description.modelVariables}
        identifier = description.coSimulation.modelIdentifier
        self.fmu = FMU2Slave(guid=description.guid, unzipDirectory=unpacked, modelIdentifier=identifier, instanceName=path.stem)
        self.fmu.instantiate(callbacks=own_callbacks([]))
        self.fmu.setupExperiment()
        self.set(start)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            variable = self.variables[name]
            (self.fmu.setReal if variable.type == "Real" else self.fmu.setInteger)([variable.valueReference], [value])

    def __getitem__(self, name: str) -> float:
        return self.fmu.getReal([self.variables[name].valueReference])[0]

    def read(self, *names: str) -> list[float]:
        return [self[name] for name in names]


class Implicit:
    """Finds the reaction that plate and body agree on, between none and the one that an unmoved plate would get."""

    def __init__(self, body: Part, plate: Part):
        self.body, self.plate, self.time = body, plate, 0.0

    def step(self, length: float) -> int:
        parts = (self.plate, self.body)
        saved = [part.fmu.getFMUstate() for part in parts]
        place = self.plate["point.z"]

        def excess(reaction: float) -> float:
            for part, state in zip(parts, saved, strict=True):
                part.fmu.setFMUstate(state)
            self.plate.set({"reaction.z": reaction})
            self.plate.fmu.doStep(self.time, length)
            self.body.set({PLANE + "point.z": place, PLANE + "velocity.z": (self.plate["point.z"] - place) / length})
            self.body.fmu.doStep(self.time, length)
            return self.body[PLANE + "reaction.z"] - reaction

        tries = self._solve(excess)
        for part, state in zip(parts, saved, strict=True):
            part.fmu.freeFMUstate(state)
        self.time += length
        return tries

    @staticmethod
    def _solve(excess) -> int:
        """False position (Illinois): the body's reaction falls as the plate's grows. Returns the number of tries."""
        low, below = 0.0, excess(0.0)
        if below == 0:
            return 1
        high, above = below, excess(below)
        for tries in range(3, 100):
            middle = (low * above - high * below) / (above - below)
            rest = excess(middle)
            if abs(rest) < 1e-8:
                return tries
            if rest > 0:
                low, below, above = middle, rest, 0.5 * above
            else:
                high, above, below = middle, rest, 0.5 * below
        raise AssertionError(f"no common reaction between {low} and {high}")


LIGHT, LOAD = {"mass": 0.05}, -20.0  # the 16 control points on the plate weigh 0.25 kg


def test_a_light_plate_under_load_diverges_explicitly(folder, tmp_path):
    body, plate = Part(body_fmu(folder), tmp_path), Part(folder / "plate.fmu", tmp_path, **LIGHT)
    plate.set({"force.z": LOAD})
    speeds = []
    for n in range(100):
        plate.set({"reaction.z": body[PLANE + "reaction.z"]})
        body.set({PLANE + name: plate[name] for name in ("point.z", "velocity.z")})
        for part in (plate, body):
            part.fmu.doStep(n * 1e-3, 1e-3)
        speeds.append(abs(plate["velocity.z"]))
    for part in (plate, body):
        part.fmu.freeInstance()
    assert max(speeds) > 20, "m/s, where the load can give it 0.2"


@pytest.mark.parametrize("mass", [0.05, 0.001])
def test_a_light_plate_under_load_is_solved_implicitly(folder, tmp_path, mass):
    body, plate = Part(body_fmu(folder), tmp_path), Part(folder / "plate.fmu", tmp_path, mass=mass, delay=0)
    plate.set({"force.z": LOAD})
    master = Implicit(body, plate)
    errors, heights, speeds = [], [], []
    for _ in range(100):
        assert master.step(1e-3) < 60
        height, speed = plate["point.z"], plate["momentum.z"] / mass
        energy = 0.5 * mass * speed**2 + (mass * GRAVITY - LOAD) * height + sum(body.read(*MECHANICAL, "energy.dissipated"))
        errors.append(energy - REST_ENERGY)
        heights.append(height)
        speeds.append(abs(speed))
    for part in (plate, body):
        part.fmu.freeInstance()
    assert max(map(abs, errors)) < 2e-5, "J; work and kinetic energy balance exactly, the rest is the body's internal step"
    assert max(speeds) < 0.3
    assert -0.003 < min(heights) < -0.001


# ---- other people's masters ----

READ_BACK = ("plate", "point.z"), ("plate", "velocity.z"), ("body", PLANE + "reaction.z"), ("body", "probe.middle.z")
STEP, STEPS = 1e-3, 200

LIBCOSIM = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
path, step, steps, wanted, result = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), json.loads(sys.argv[4]), sys.argv[5]
execution = CosimExecution.from_ssp_file(path, round(step * 1e9))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
parts = {part: execution.slave_index_from_instance_name(part) for part, _ in wanted}
references = {p: {v.name.decode(): v.reference for v in execution.slave_variables(i)} for p, i in parts.items()}
rows = []
for _ in range(steps):
    assert execution.step()
    rows.append([observer.last_real_values(parts[p], [references[p][name]])[0] for p, name in wanted])
json.dump(rows, open(result, "w"))
"""
ECOS = """
import ctypes, json, sys
from pathlib import Path
for library in Path(sys.prefix).glob("lib*/libtbb.so.12"):
    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
from ecospy import EcosLib, EcosSimulation
path, step, steps, wanted, result = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), json.loads(sys.argv[4]), sys.argv[5]
EcosLib.set_log_level("debug")
rows = []
with EcosSimulation(ssp_path=path, step_size=step) as simulation:
    simulation.init()
    for _ in range(steps):
        simulation.step()
        rows.append([simulation.get_real(f"{p}::{name}") for p, name in wanted])
    simulation.terminate()
json.dump(rows, open(result, "w"))
"""


@pytest.fixture(scope="module")
def in_fmpy(ssp) -> np.ndarray:
    """The rows of READ_BACK after every step, the probe (which is no connector) left out."""
    rows = simulate_ssp(str(ssp), stop_time=STEPS * STEP - 0.5 * STEP, step_size=STEP)
    return np.stack([rows[f"{part}.{name}"] for part, name in READ_BACK[:3]], axis=1)


def test_the_system_runs_in_fmpy_as_in_our_own_loop(folder, in_fmpy):
    run = run_explicitly(folder, body_fmu(folder), STEP, STEPS)
    np.testing.assert_allclose(in_fmpy[:, 2], run.column(5), rtol=1e-9, atol=1e-9)  # times are summed up there: the last bits differ
    assert in_fmpy[:, 2].max() > 90 and -0.005 < in_fmpy[:, 0].min() < -0.003  # the plate of 49 N swings about its place of rest


@pytest.mark.parametrize("name, script", [("libcosim", LIBCOSIM), ("ecos", ECOS)])
def test_the_system_runs_elsewhere_as_in_fmpy(name, script, ssp, in_fmpy, tmp_path):
    try:
        tool = getattr(importers, name)()
    except importers.Missing as missing:
        pytest.skip(str(missing))
    result = tmp_path / "rows.json"
    master = importers.Tool((tool.command[0], "-I", "-c", script), tool.environment)
    printed = master.run(ssp, str(STEP), str(STEPS), json.dumps(READ_BACK), result)
    assert result.is_file(), "\n".join(printed)
    rows = np.array(json.loads(result.read_text()))
    np.testing.assert_allclose(rows[:, :3], in_fmpy, rtol=1e-9, atol=1e-9, err_msg="\n".join(printed))
    assert -0.51 < rows[-1, 3] < -0.5


def test_a_plane_that_is_none_of_the_scenes_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match=r'wanted one with motion = "input" \(plate\), got ground'):
        write_ssp(tmp_path / "x.ssp", plane="ground")
    with pytest.raises(SoftffdError, match="there is none"):
        write_ssp(tmp_path / "x.ssp", "free_vibration")


# ---- the drivers themselves ----


def test_validation_of_the_drivers_finds_nothing(folder):
    assert [validate_fmu(str(folder / f"{name}.fmu")) for name in ("plate", "actuator")] == [[], []]


def test_the_plate_connects_by_name_and_unit(folder):
    plate = {v.name: v.unit for v in fmpy.read_model_description(str(folder / "plate.fmu")).modelVariables}
    body = {v.name: v.unit for v in fmpy.read_model_description(str(body_fmu(folder))).modelVariables}
    names = [*MOTION, *FORCE, "normal.x", "normal.y", "normal.z"]
    assert [plate[name] for name in names] == [body[PLANE + name] for name in names]


def test_the_plate_goes_back_to_a_saved_state_with_the_same_bits(folder, tmp_path):
    plate = Part(folder / "plate.fmu", tmp_path, mass=2.0)

    def advance(first: int, last: int) -> list[float]:
        for n in range(first, last):
            plate.set({"reaction.z": 30 * np.sin(n), "reaction.x": 0.1 * n})
            plate.fmu.doStep(n * 0.01, 0.01)
        return plate.read(*MOTION, "momentum.z")

    advance(0, 5)
    state = plate.fmu.getFMUstate()
    blob = bytes(plate.fmu.serializeFMUstate(state))
    straight = advance(5, 12)
    plate.fmu.setFMUstate(state)
    assert advance(5, 12) == straight
    plate.fmu.setFMUstate(plate.fmu.deSerializeFMUstate(blob))
    assert advance(5, 12) == straight
    plate.fmu.freeInstance()


def test_start_values_are_built_in(tmp_path):
    path = build_driver("plate", tmp_path, start_values={"mass": 0.5, "initial.point": (1.0, 2.0, 0.1)})
    plate = Part(path, tmp_path)
    assert plate.read("mass", "point.y", "point.z", "momentum.z") == [0.5, 2.0, 0.1, 0.0]
    plate.fmu.freeInstance()


def test_an_unknown_driver_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match="wanted one of plate, actuator, got 'motor'"):
        build_driver("motor", tmp_path)


def test_a_massless_plate_is_refused(folder, tmp_path):
    with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
        Part(folder / "plate.fmu", tmp_path, mass=0.0)


DRIVEN = """
[lattice]
points = [2, 2, 2]
[material]
damping = 0.0
[[pin]]
name = "grip"
points = [[0, 0, 0]]
motion = "input"
[[load]]
name = "push"
points = [[1, 1, 1]]
[outputs]
velocities = "all"
"""


@pytest.mark.parametrize("course", [1, 2])
def test_the_actuator_takes_a_pin_where_it_says(folder, tmp_path, course):
    (tmp_path / "driven.toml").write_text(DRIVEN)
    body = Part(package_fmu(load_scene(tmp_path / "driven.toml"), tmp_path / "driven.fmu"), tmp_path)
    start = {"course": course, "duration": 0.2, "travel.x": 0.1, "travel.z": -0.05}
    actuator = Part(folder / "actuator.fmu", tmp_path, **start)
    for n in range(30):
        body.set({f"pin.grip.{name}.{axis}": actuator[f"{name}.{axis}"] for name in ("position", "velocity") for axis in "xyz"})
        for part in (actuator, body):
            part.fmu.doStep(n * 0.01, 0.01)
        q = (n + 1) / 20
        wanted = np.sin(2 * np.pi * q) if course == 1 else 6 * min(q, 1) ** 5 - 15 * min(q, 1) ** 4 + 10 * min(q, 1) ** 3
        reached = body.read("position[0,0,0].x", "position[0,0,0].z")
        if n:  # before the first step the actuator cannot know how long it is going to be
            assert reached == pytest.approx([0.1 * wanted, -0.05 * wanted], abs=1e-14)
    for part in (actuator, body):
        part.fmu.freeInstance()


def test_the_impulse_of_the_actuators_force_is_of_second_order(folder, tmp_path):
    (tmp_path / "driven.toml").write_text(DRIVEN.replace('[[pin]]\nname = "grip"\npoints = [[0, 0, 0]]\nmotion = "input"\n', ""))
    fmu = package_fmu(load_scene(tmp_path / "driven.toml"), tmp_path / "driven.fmu")

    def error(steps: int) -> float:
        body = Part(fmu, tmp_path / f"body{steps}")
        actuator = Part(folder / "actuator.fmu", tmp_path / f"actuator{steps}", **{"load.y": 3.0, "duration": 0.8})
        for n in range(steps):
            body.set({"load.push.y": actuator["force.y"]})
            for part in (actuator, body):
                part.fmu.doStep(n * 0.3 / steps, 0.3 / steps)
        momentum = sum(body[f"velocity[{i},{j},{k}].y"] for i in (0, 1) for j in (0, 1) for k in (0, 1)) / 8
        for part in (actuator, body):
            part.fmu.freeInstance()
        return abs(momentum - 3.0 * 0.8 / (2 * np.pi) * (1 - np.cos(2 * np.pi * 0.3 / 0.8)))

    errors = [error(steps) for steps in (20, 40, 80)]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2, 2], abs=0.15)
