"""Contact with friction, impacts included, converges with second order."""

import numpy as np
import pytest

from readings import assert_nothing_is_behind, points
from scenes import box
from softffd import simulate

TILTED = np.array([np.sin(np.radians(20)), 0.5 * np.sin(np.radians(20)), np.cos(np.radians(20))])
TILTED /= np.linalg.norm(TILTED)


@pytest.mark.short("flat")
@pytest.mark.parametrize("normal", [np.array([0.0, 0.0, 1.0]), TILTED], ids=["flat", "askew"])
def test_a_dropped_sliding_box_converges_with_order_two(normal):
    dropped = box(
        stiffness=2e3,
        damping=0.1,
        gravity=(-9.81 * normal).tolist(),
        plane=[{"name": "ground", "normal": normal.tolist(), "friction": 0.4}],
        offset=[0.0, 0.0, 0.2],
        velocity=[1.0, 0.0, 0.0],
        method="leapfrog",
        stop_time=2.0,
        communication_step=0.1,
    )
    exact = points(simulate(dropped, start_values={"solver.step": 2e-6}))
    errors = []
    for h in (1e-4, 5e-5, 2.5e-5):
        result = simulate(dropped, start_values={"solver.step": h})
        assert_nothing_is_behind(result)
        errors.append(np.linalg.norm(points(result) - exact, axis=2).max())
    assert np.log2(errors[0] / errors[-1]) / 2 > 1.8  # over both halvings; a rule of first order has 1
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > 1.6  # single halvings scatter with the times of the impacts
    assert errors[0] < 1e-4
