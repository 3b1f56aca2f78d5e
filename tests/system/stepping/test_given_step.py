"""A given solver.step is divided where the stability of the present state and method asks for it, and only there."""

import numpy as np
import pytest

from readings import points
from scenes import GRAVITY, box
from softffd import simulate
from stepping import Stepper


def dropped(*, ground, speed=0.0, stretch=1.0, **keys):
    """Onto a plane at a height [m], with a speed [m/s] along it."""
    return box(
        **keys,
        gravity=GRAVITY,
        plane=[{"name": "ground", "friction": 0.4, "point": [0.0, 0.0, ground]}],
        velocity=[speed, 0.0, 0.0],
        stretch=[stretch, 1.0, 1.0],
        outputs={"energy": True, "solver": True},
        stop_time=0.4,
        communication_step=0.01,
    )


PULLED = {
    "stiffness": 1e3,
    "damping": 0.05,
    "pin": [{"name": "left", "points": "x-"}],
    "load": [{"name": "push", "points": "x+"}],
    "method": "leapfrog",
}
SMOOTH = [("bm4", 3.5e-4, 0.1), ("dop853", 4.5e-4, 0.1), ("rkn12", 6e-4, 0.0), ("ros34pw2", 1e-3, 0.1), ("ros34pw2", 5e-3, 0.1)]


@pytest.mark.parametrize("method, step, damping", [("leapfrog", 5e-3, 0.1), *SMOOTH])
def test_steps_that_suit_free_flight_are_divided_where_contact_begins(method, step, damping):
    """Leapfrog takes over at the obstacle; its limit is 1.9e-4 s."""
    body = dropped(stiffness=1e5, damping=damping, ground=-0.05, method=method, step=step)
    fallen = 9.81 * 0.05
    result = simulate(body, step=2 * step)
    energy = result.outputs["energy.kinetic"] + result.outputs["energy.elastic"]
    assert energy.max() <= fallen * 1.02
    assert points(result)[:, :, 2].min() >= -0.05 - 1e-12
    assert points(result)[:, :, 2].max() <= 1 + 1e-3
    assert result.outputs["solver.contacts_resolved"][-1] > 0


def test_a_divided_step_follows_a_body_that_stiffens_within_it():
    """Pulled at once with 1e4 N, the springs double their length within a few internal steps."""
    ends = {}
    for step in (1e-4, 0.02, 0.16):
        with Stepper(box(**PULLED, step=step)) as body:
            body.set({"load.push.x": 1e4})
            body.step(0.16, times=5)
            ends[step] = body.positions()[:, 0].max()
    assert ends[1e-4] > 1.3
    assert ends[0.02] == pytest.approx(ends[1e-4], rel=5e-3)  # 2.1e-3: that of the shorter step is nearer to the limit
    assert ends[0.16] == pytest.approx(ends[1e-4], rel=0.04)  # 2.3e-2: one step of 0.16 s is divided anew only as often as it must be


@pytest.mark.parametrize("method", ["auto", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "central_difference"])
def test_cutting_changes_no_bit_where_an_obstacle_comes_within_reach(method):
    damping = 0.0 if method == "rkn12" else 0.05
    body = dropped(stiffness=1e3, damping=damping, ground=-0.1, speed=0.5, stretch=1.05, method=method, step=5e-4)
    fine, middle, coarse = (points(simulate(body, step=length)) for length in (0.01, 0.04, 0.4))
    assert np.array_equal(fine[::4], middle)
    assert np.array_equal(fine[-1], coarse[-1])
