"""Motions driven by force inputs against stored trajectories."""

import numpy as np
import pytest

import reference
from readings import orders, points
from scenes import GRAVITY, box
from softffd import simulate

STIFF = {"stiffness": 1e7, "damping": 0.5, "gravity": GRAVITY, "forces": "all", "method": "leapfrog", "step": 1.25e-5}
SHAKEN = {"stiffness": 1e3, "damping": 0.02, "forces": [[3, 3, 3]], "method": "leapfrog"}


def ramp(u):
    u = np.clip(u, 0, 1)
    return 6 * u**5 - 15 * u**4 + 10 * u**3


def pull(time):
    """F_x = +-1e5 (1 + j/3) s(t / 0.5) N on the points of i = 3 and i = 0."""
    size = 1e5 * ramp(time / 0.5)
    sides = ((0, -size), (3, size))
    return {f"force[{i},{j},{k}].x": sign * (1 + j / 3) for i, sign in sides for j in range(4) for k in range(4)}


def shake(time):
    """(3 sin(2 pi 3 t), -2 sin(2 pi 5 t), 4 cos(2 pi 2 t)) N."""
    turn = 2 * np.pi * time
    return {"force[3,3,3].x": 3 * np.sin(3 * turn), "force[3,3,3].y": -2 * np.sin(5 * turn), "force[3,3,3].z": 4 * np.cos(2 * turn)}


def largest_error(result, stored):
    every = (len(result.time) - 1) // len(stored)
    return np.linalg.norm(points(result)[every::every] - stored, axis=2).max()


@pytest.mark.short("0.5")
@pytest.mark.parametrize("seconds", [0.5, 1.0])
def test_a_stiff_box_under_a_slow_load_follows_the_stored_trajectory(golden, seconds):
    """Inputs are held over a communication step H. A force taken from its middle is right on average, which leaves H^2 and the
    ringing of modes that are faster than the steps, some 1e-7 m; one taken from its beginning lags by 0.03 m * 3.75/s * H / 2."""
    h = 1.25e-4
    stiff, stored = box(**STIFF, stop_time=seconds), golden("S2")["x"][: round(10 * seconds)]
    middle = simulate(stiff, step=h, inputs=lambda time: pull(time + h / 2))
    assert largest_error(middle, stored) < 5e-7
    late = simulate(stiff, step=5e-4, inputs=pull)
    assert 1e-6 < largest_error(late, stored) < 0.03 * 3.75 * 2.5e-4


def test_a_held_force_gives_the_stored_trajectory_to_second_order(golden):
    shaken, stored, steps = box(**SHAKEN), golden("G_ZOH")["x"], [2.5e-4 / 2**n for n in range(5)]
    errors = [largest_error(simulate(shaken, start_values={"solver.step": h}, inputs=shake), stored) for h in steps]
    assert orders(errors) == pytest.approx([2.0] * 4, abs=0.1)
    assert errors[-1] < 2.5e-7  # a force interpolated over the step instead of held would be 3.5e-2 m off


def test_a_held_force_gives_the_references_trajectory_to_rounding():
    result, model = simulate(box(**SHAKEN), start_values={"solver.step": 5e-4}, inputs=shake), reference.cube(damping=0.02)
    x, v = model.rest, np.zeros_like(model.rest)
    external = np.zeros_like(model.rest)
    for row in range(100):
        external[63] = list(shake(result.time[row]).values())
        x, v = reference.leapfrog(model, x, v, 5e-4, 20, external=external)
        assert points(result)[row + 1] == pytest.approx(x, abs=1e-12)
