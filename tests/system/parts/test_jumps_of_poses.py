"""A motion given by poses alone: the component warns once, and says what is missing."""

import numpy as np
import pytest

from scenes import LED, MOVED, box
from softffd import Simulation, simulate

STEP, SPEED = 0.01, -0.5
PRESS = {"name": "press", "point": [0.5, 0.5, 1.0], "normal": [0.0, 0.0, -1.0], **MOVED}
HAND = {"name": "hand", "points": "z+", **LED}
POSE = {"press": "plane.press.point", "hand": "pin.hand.position"}


def scene(name: str, **keys):
    held = {"plane": [PRESS], "pin": [{"name": "base", "points": "z-"}]} if name == "press" else {"pin": [HAND]}
    return box(**{"stiffness": 1e3, "damping": 0.1, "energy": True, "communication_step": STEP, **held, **keys})


def jumps(sim: Simulation) -> list[str]:
    return [text for text in sim.warnings if "jumped" in text]


def moved(name: str, *, speed: float, told: float, **keys) -> tuple[list[str], float]:
    """The warnings of jumps, and the energy in the body at the end [J]. speed: of the poses; told: of the velocity input [m/s]."""
    with Simulation(scene(name, **keys)) as sim:
        pose, velocity = f"{POSE[name]}.z", f"{POSE[name].rpartition('.')[0]}.velocity.z"
        begin = sim[pose]
        for n in range(20):
            sim[pose] = begin + speed * STEP * n
            sim[velocity] = told
            sim.step(STEP)
        return jumps(sim), sim["energy.kinetic"] + sim["energy.elastic"]


@pytest.mark.parametrize("method", ["auto", "leapfrog"])
@pytest.mark.parametrize("name", ["press", "hand"])
def test_poses_without_velocity_are_warned_of_once(name, method):
    (warning,), energy = moved(name, speed=SPEED, told=0.0, method=method)
    part = POSE[name].rpartition(".")[0]
    assert f"at time 0.01 s: the pose of {part} jumped" in warning and f"set {part}.velocity" in warning
    assert "by up to 0.005 m" in warning
    silent, led = moved(name, speed=SPEED, told=SPEED, method=method)
    assert silent == []
    assert abs(energy / led - 1) > 0.03  # what the warning is about
    assert name == "press" or energy > 10 * led


@pytest.mark.parametrize("name", ["press", "hand"])
def test_a_pose_that_stays_is_no_jump(name):
    assert moved(name, speed=0.0, told=0.0)[0] == []


def test_a_plane_that_leaves_the_body_behind_strikes_nothing():
    assert moved("press", speed=0.5, told=0.0)[0] == []


def test_rates_of_a_pose_are_its_velocity():
    with Simulation(scene("hand")) as sim:
        z = sim["pin.hand.position.z"]
        for n in range(5):
            sim["pin.hand.position.z"] = z + SPEED * STEP * n
            sim.set_rates({"pin.hand.position.z": SPEED})
            sim.step(STEP)
        assert jumps(sim) == []


def test_a_turn_given_by_orientations_alone_is_a_jump():
    with Simulation(scene("hand")) as sim:
        for n in range(3):
            half = 0.05 * n
            sim["pin.hand.orientation.w"], sim["pin.hand.orientation.z"] = np.cos(half), np.sin(half)
            sim.step(STEP)
        assert len(jumps(sim)) == 1


def test_simulate_derives_the_velocities_so_that_nothing_jumps():
    def down(time):
        return {"pin.hand.position.z": 1.0 + SPEED * time}

    def said(pin):
        return [text for text in simulate(scene("hand", pin=[pin]), inputs=down, stop_time=0.1).summary["warnings"] if "jumped" in text]

    assert said(HAND) == []
    assert len(said(HAND | {"inputs": ["position"]})) == 1  # there is no velocity to give
