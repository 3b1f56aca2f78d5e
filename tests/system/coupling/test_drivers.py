"""The driver FMUs themselves: a plate with mass, and what moves or pushes by a given course."""

import gc

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

from coupled_parts import FORCE, MOTION, PLANE, body_fmu
from readings import orders
from scenes import box
from softffd import FmuError, SoftffdError, package_fmu
from softffd.drivers import build_driver
from softffd.fmu.component import Component
from stepping import Stepper


def test_validation_of_the_drivers_finds_nothing(drivers):
    assert [validate_fmu(str(drivers / f"{name}.fmu")) for name in ("plate", "actuator")] == [[], []]


def test_the_plate_connects_by_name_and_unit(drivers):
    plate = {v.name: v.unit for v in fmpy.read_model_description(str(drivers / "plate.fmu")).modelVariables}
    body = {v.name: v.unit for v in fmpy.read_model_description(str(body_fmu(drivers))).modelVariables}
    names = [*MOTION, *FORCE, "normal.x", "normal.y", "normal.z"]
    assert [plate[name] for name in names] == [body[PLANE + name] for name in names]


def test_the_plate_goes_back_to_a_saved_state_with_the_same_bits(drivers):
    with Stepper(drivers / "plate.fmu", start_values={"mass": 2.0}) as plate:

        def advance(first: int, last: int) -> list[float]:
            for n in range(first, last):
                plate.set({"reaction.z": 30 * np.sin(n), "reaction.x": 0.1 * n})
                plate.step(0.01)
            return plate.read(*MOTION, "momentum.z").tolist()

        advance(0, 5)
        state = plate.save()
        straight = advance(5, 12)
        for saved in (state, bytes(state)):
            plate.restore(saved)
            assert advance(5, 12) == straight


def test_start_values_are_built_in(tmp_path):
    path = build_driver("plate", tmp_path, start_values={"mass": 0.5, "initial.point": (1.0, 2.0, 0.1)})
    with Stepper(path) as plate:
        assert plate.read("mass", "point.y", "point.z", "momentum.z").tolist() == [0.5, 2.0, 0.1, 0.0]


def test_an_unknown_driver_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match="wanted one of plate, actuator, got 'motor'"):
        build_driver("motor", tmp_path)


def test_a_driver_that_has_failed_for_good_is_called_no_more(drivers, monkeypatch):
    monkeypatch.setattr(FMU2Slave, "freeInstance", lambda _slave: pytest.fail("pythonfmu frees twice then"))
    plate = Component(drivers / "plate.fmu")
    with pytest.raises(FmuError, match="mass: wanted > 0 kg, got 0"):
        plate.initialize({"mass": 0.0})
        plate.exit_initialization()
    for call in (plate.exit_initialization, plate.reset, plate.set_up):
        with pytest.raises(FmuError, match="has failed for good in an earlier call: open it again"):
            call()
    plate.close()
    del plate
    gc.collect()


GRIP = {"name": "grip", "points": [[0, 0, 0]], "motion": "input"}


def driven_fmu(folder, *pins):
    scene = box(points=[2, 2, 2], damping=0.0, pin=pins, load=[{"name": "push", "points": [[1, 1, 1]]}], velocities="all")
    return package_fmu(scene, folder / "driven.fmu")


@pytest.mark.parametrize("course", [1, 2])
def test_the_actuator_takes_a_pin_where_it_says(drivers, tmp_path, course):
    start = {"course": course, "duration": 0.2, "travel.x": 0.1, "travel.z": -0.05}
    names = [f"{name}.{axis}" for name in ("position", "velocity") for axis in "xyz"]
    with Stepper(driven_fmu(tmp_path, GRIP)) as body, Stepper(drivers / "actuator.fmu", start_values=start) as actuator:
        for n in range(30):
            body.set(dict(zip([f"pin.grip.{name}" for name in names], actuator.read(*names), strict=True)))
            for part in (actuator, body):
                part.step(0.01)
            q = (n + 1) / 20
            wanted = np.sin(2 * np.pi * q) if course == 1 else 6 * min(q, 1) ** 5 - 15 * min(q, 1) ** 4 + 10 * min(q, 1) ** 3
            if n:  # before the first step the actuator cannot know how long it is going to be
                reached = body.read("position[0,0,0].x", "position[0,0,0].z")
                assert reached == pytest.approx([0.1 * wanted, -0.05 * wanted], abs=1e-14)


def test_the_impulse_of_the_actuators_force_is_of_second_order(drivers, tmp_path):
    fmu, start = driven_fmu(tmp_path), {"load.y": 3.0, "duration": 0.8}

    def error(steps: int) -> float:
        with Stepper(fmu) as body, Stepper(drivers / "actuator.fmu", start_values=start) as actuator:
            for _ in range(steps):
                body.set({"load.push.y": actuator.read("force.y")[0]})
                for part in (actuator, body):
                    part.step(0.3 / steps)
            momentum = body.point_velocities()[:, 1].sum() / 8
        return abs(momentum - 3.0 * 0.8 / (2 * np.pi) * (1 - np.cos(2 * np.pi * 0.3 / 0.8)))

    assert orders([error(steps) for steps in (20, 40, 80)]) == pytest.approx([2, 2], abs=0.15)
