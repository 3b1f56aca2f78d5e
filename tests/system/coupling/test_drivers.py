"""The driver FMUs themselves: a plate with mass, and what moves or pushes by a given course."""

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from coupled_parts import FORCE, MOTION, PLANE, Part, body_fmu
from readings import orders
from scenes import box
from softffd import Result, SoftffdError, package_fmu
from softffd.cli.command import main
from softffd.drivers import build_driver


def test_validation_of_the_drivers_finds_nothing(drivers):
    assert [validate_fmu(str(drivers / f"{name}.fmu")) for name in ("plate", "actuator")] == [[], []]


def test_the_plate_connects_by_name_and_unit(drivers):
    plate = {v.name: v.unit for v in fmpy.read_model_description(str(drivers / "plate.fmu")).modelVariables}
    body = {v.name: v.unit for v in fmpy.read_model_description(str(body_fmu(drivers))).modelVariables}
    names = [*MOTION, *FORCE, "normal.x", "normal.y", "normal.z"]
    assert [plate[name] for name in names] == [body[PLANE + name] for name in names]


def test_the_plate_goes_back_to_a_saved_state_with_the_same_bits(drivers, tmp_path):
    plate = Part(drivers / "plate.fmu", tmp_path, mass=2.0)

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


def test_a_massless_plate_is_refused(drivers, tmp_path):
    with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
        Part(drivers / "plate.fmu", tmp_path, mass=0.0)


GRIP = {"name": "grip", "points": [[0, 0, 0]], "motion": "input"}


def driven_fmu(folder, *pins):
    scene = box(points=[2, 2, 2], damping=0.0, pin=pins, load=[{"name": "push", "points": [[1, 1, 1]]}], velocities="all")
    return package_fmu(scene, folder / "driven.fmu")


@pytest.mark.parametrize("course", [1, 2])
def test_the_actuator_takes_a_pin_where_it_says(drivers, tmp_path, course):
    body = Part(driven_fmu(tmp_path, GRIP), tmp_path)
    start = {"course": course, "duration": 0.2, "travel.x": 0.1, "travel.z": -0.05}
    actuator = Part(drivers / "actuator.fmu", tmp_path, **start)
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


def test_the_impulse_of_the_actuators_force_is_of_second_order(drivers, tmp_path):
    fmu = driven_fmu(tmp_path)

    def error(steps: int) -> float:
        body = Part(fmu, tmp_path / f"body{steps}")
        actuator = Part(drivers / "actuator.fmu", tmp_path / f"actuator{steps}", **{"load.y": 3.0, "duration": 0.8})
        for n in range(steps):
            body.set({"load.push.y": actuator["force.y"]})
            for part in (actuator, body):
                part.fmu.doStep(n * 0.3 / steps, 0.3 / steps)
        momentum = sum(body[f"velocity[{i},{j},{k}].y"] for i in (0, 1) for j in (0, 1) for k in (0, 1)) / 8
        for part in (actuator, body):
            part.fmu.freeInstance()
        return abs(momentum - 3.0 * 0.8 / (2 * np.pi) * (1 - np.cos(2 * np.pi * 0.3 / 0.8)))

    errors = [error(steps) for steps in (20, 40, 80)]
    assert orders(errors) == pytest.approx([2, 2], abs=0.15)


def test_a_driver_runs_by_itself(drivers, tmp_path, capsys):
    assert main(["run", str(drivers / "plate.fmu"), "--stop-time", "0.1", "--step", "0.01", "-o", str(tmp_path)]) == 0
    assert main(["info", str(drivers / "plate.fmu")]) == 0, capsys.readouterr().err
    assert Result.load(tmp_path).positions.size == 0
