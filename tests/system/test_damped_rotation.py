"""Implicit contact steps damp rotation: a body that turns fast in them says so."""

import numpy as np
import pytest

from stepping import Stepper

ROLLING = """
[material]
stiffness = 1e9
damping = 0.02
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
friction = 0.0
[initial]
angular_velocity = [0.0, 0.0, {spin}]
[outputs]
velocities = "all"
"""


def warnings(box):
    return [text for text in box.messages if "turns at omega" in text]


def numbers(text):
    return [
        float(part.split(before)[1].split()[0].rstrip(";,")) for before, part in ((" omega = ", text), (" h = ", text), ("h / 2 = ", text))
    ]


@pytest.mark.parametrize("H", [0.01, 0.002])
def test_a_fast_turn_in_implicit_steps_is_warned_of_once(scene, H):
    """On the ground without friction: the spin is the start's, and the share is what it loses in the step."""
    spin = 0.2 / H
    with Stepper(scene(ROLLING.format(spin=spin))) as box:
        speed = np.linalg.norm(box.velocities()[0])
        box.step(H, times=5)
        (warning,) = warnings(box)
        omega, h, share = numbers(warning)
        assert omega == pytest.approx(spin, rel=1e-3) and h == H
        assert share == pytest.approx(0.5 * omega * h)
        assert f"communication steps below {0.05 / omega:.6g} s, or solver.method = leapfrog, which resolves it" in warning
        assert np.linalg.norm(box.velocities()[0]) < 0.95 * speed


def test_a_slow_turn_is_not(scene):
    with Stepper(scene(ROLLING.format(spin=4.0))) as box:
        box.step(0.01, times=5)
        assert not warnings(box)


def test_nor_a_fast_one_in_explicit_steps(scene):
    with Stepper(scene(ROLLING.format(spin=20.0)), start_values={"solver.method": "leapfrog"}) as box:
        box.step(0.01)
        assert not warnings(box)
