"""Implicit contact steps that pass over impacts damp rotation: a body that turns fast in them says so. Those of auto do not."""

import numpy as np
import pytest

from scenes import GRAVITY, box
from stepping import Stepper


def rolling(spin):
    """On the ground without friction, about a vertical axis [rad/s]."""
    ground = [{"name": "ground", "friction": 0.0}]
    return box(stiffness=1e9, damping=0.02, gravity=GRAVITY, plane=ground, velocities="all", angular_velocity=[0.0, 0.0, spin])


def numbers(text):
    return [
        float(part.split(before)[1].split()[0].rstrip(";,")) for before, part in ((" omega = ", text), (" h = ", text), ("h / 2 = ", text))
    ]


@pytest.mark.parametrize("H", [0.01, 0.002])
def test_a_fast_turn_in_implicit_steps_is_warned_of_once(H):
    """On the ground without friction: the spin is the start's, and the share is what it loses in the step."""
    spin = 0.2 / H
    with Stepper(rolling(spin), start_values={"solver.method": "backward_euler"}) as body:
        speed = np.linalg.norm(body.point_velocities()[0])
        body.step(H, times=5)
        (warning,) = body.said("rotates at omega")
        omega, h, share = numbers(warning)
        assert omega == pytest.approx(spin, rel=1e-3) and h == H
        assert share == pytest.approx(0.5 * omega * h)
        assert "solver.method = leapfrog, which resolves the rotation" in warning
        below = float(warning.split("communication steps below ")[1].split()[0])
        assert 0.97 * 0.05 / omega <= below <= 0.05 / omega  # two digits, and within the bound
        assert np.linalg.norm(body.point_velocities()[0]) < 0.95 * speed


@pytest.mark.short("0.002")
@pytest.mark.parametrize("H", [0.01, 0.002])
def test_auto_keeps_the_spin_of_a_stiff_body_on_the_ground(H):
    spin = 0.2 / H
    with Stepper(rolling(spin)) as body:
        body.step(H)  # the points go out to where the springs hold them against the turning
        speed = np.linalg.norm(body.point_velocities()[0])
        body.step(H, times=20)
        lost = 1 - np.exp(-0.02 / (1 / 64) * 20 * H)  # by the air: 0.02 N s/m on each point of 1/64 kg
        assert np.linalg.norm(body.point_velocities()[0]) == pytest.approx((1 - lost) * speed, rel=2e-3)
        assert not body.said("rotates at omega")


@pytest.mark.parametrize(("method", "spin"), [("backward_euler", 4.0), ("leapfrog", 20.0)])
def test_a_slow_turn_is_not_nor_a_fast_one_in_explicit_steps(method, spin):
    with Stepper(rolling(spin), start_values={"solver.method": method}) as body:
        body.step(0.01, times=5)
        assert not body.said("rotates at omega")
