"""Given steps too long for a vibration lose it, in the run and in its shadow: the error estimate must say so all the same."""

import math

import numpy as np
import pytest

from scenes import box
from stepping import Stepper

STRETCH = 0.01

BOX = {
    "points": [2, 2, 2],
    "stiffness": 1e4,
    "damping": 0.0,
    "stretch": [1 + STRETCH] * 3,
    "outputs": {"solver": True},
    "error_estimate": True,
}


OMEGA = 8 * math.sqrt(1e4)
"""rad/s, 8 sqrt(k / (1 kg)): the box grows and shrinks."""


def misses(body, step, count):
    """How far the points are from the exact motion after each step, (8, 3) [m]: centre + (1 + 0.01 cos(omega t)) (rest - centre)."""
    rest = (body.points() - 0.5 * (1 + STRETCH)) / (1 + STRETCH)
    for _ in range(count):
        body.step(step)
        yield body.points() - (0.5 * (1 + STRETCH) + (1 + STRETCH * math.cos(OMEGA * body.time)) * rest)


@pytest.mark.parametrize("method", ["leapfrog", "central_difference", "bm4", "rkn12", "dop853", "ros34pw2"])
@pytest.mark.parametrize("radians", [3.0, 8.0, 800.0, 8000.0])
def test_the_estimate_tells_of_a_vibration_that_the_steps_lose(method, radians):
    """Stated is 0.41 to 3.3 times the error."""
    step = radians / OMEGA
    with Stepper(box(**BOX, method=method, step=step)) as body:
        error = max(np.linalg.norm(miss, axis=1).max() for miss in misses(body, step, 4))
        stated = body.read("solver.error_estimate")[0]
    assert error / 3 <= stated <= 4 * error


@pytest.mark.parametrize(("method", "radians"), [("leapfrog", 0.1), ("bm4", 0.1), ("rkn12", 3.0), ("dop853", 1.0)])
def test_where_nothing_is_lost_the_estimate_is_what_it_was(method, radians):
    """Steps that resolve the vibration, with errors above rounding: the estimate is the error of the coordinate that has most of it."""
    step = radians / OMEGA
    with Stepper(box(**BOX, method=method, step=step)) as body:
        error = max(np.abs(miss).max() for miss in misses(body, step, 200))
        assert error > 1e-11
        assert body.read("solver.error_estimate")[0] == pytest.approx(error, rel=0.05)
