"""A call does so much work and no more, whatever it is given; below that the limit changes nothing."""

import re

import numpy as np
import pytest

from scenes import GRAVITY, MOVED, box
from softffd.errors import FmuError
from stepping import Stepper

PLATE = [{"name": "plate", "point": [0.0, 0.0, -0.01], "normal": [0.0, 0.0, 1.0], **MOVED}]


def bounced(most_work, **keys):
    """A box after it has struck a plate, and what it has said. stiffness [N/m]."""
    scene = box(gravity=GRAVITY, damping=0.01, plane=PLATE, solver={"most_work": most_work}, **keys)
    with Stepper(scene, start_values={"plane.plate.velocity.z": 1.0}) as body:
        body.step(0.05, times=2)
        return body.points(), " ".join(body.messages)


@pytest.mark.parametrize("method", ["auto", "leapfrog", "dop853", "ros34pw2", "backward_euler", "sdirk2"])
def test_a_call_that_needs_more_is_discarded_and_says_where(method):
    most = 20_000 if method in ("ros34pw2", "sdirk2") else 2000  # whose steps are solved
    pulled = box(stiffness=1e5, stretch=[1.1, 1.0, 1.0], angular_velocity=[0.0, 30.0, 0.0], method=method, solver={"most_work": most})
    with Stepper(pulled) as body:
        body.step(1e-4)
        before = body.points()
        with pytest.raises(FmuError, match=rf"at time 0.0001 s: a communication step of 1 s needs more work than .*most_work = {most}"):
            body.step(1.0)
        assert np.array_equal(body.points(), before)


def test_a_step_whose_work_is_not_foreseen_says_when_it_was_spent():
    """Error control finds its steps on the way."""
    spun = box(stiffness=1e5, angular_velocity=[0.0, 30.0, 0.0], method="ros34pw2", tolerance=1e-9, solver={"most_work": 20000})
    with Stepper(spun) as body:
        body.step(1e-4)
        with pytest.raises(FmuError) as refused:
            body.step(10.0)
        assert 1e-4 < float(re.search(r"as was found at time (\S+) s", str(refused.value))[1]) < 10


@pytest.mark.parametrize("most", [3000, 30000])
def test_steps_that_are_too_much_in_their_last_attempt_say_so_too(most):
    """And not that there is no finite result: sdirk2 ends where a step is as short as explicit ones."""
    swinging = box(stiffness=1e3, damping=0.0, stretch=[1.2, 0.9, 0.9], method="sdirk2", tolerance=1e-7, solver={"most_work": most})
    with Stepper(swinging) as body, pytest.raises(FmuError, match=rf"needs more work than .*most_work = {most}"):
        body.step(0.3)


@pytest.mark.parametrize("stiffness", [1e3, 1e7])
def test_below_it_the_limit_changes_no_bit(stiffness):
    positions, words = bounced(5e6, stiffness=stiffness)
    again, same = bounced(1e12, stiffness=stiffness)
    assert np.array_equal(positions, again) and words == same


def test_a_stiff_body_at_an_obstacle_ends_its_step_implicitly():
    wanted, _ = bounced(5e6, stiffness=1e8)
    positions, words = bounced(4000, stiffness=1e8)
    assert not np.array_equal(positions, wanted) and np.isfinite(positions).all()
    assert "implicit steps damp its vibrations" in words


@pytest.mark.parametrize("step", [0.0, 1e-3])
@pytest.mark.parametrize("method", ["auto", "leapfrog", "dop853", "ros34pw2", "backward_euler", "sdirk2"])
def test_a_body_so_far_away_that_rounding_is_larger_than_it_is_refused(method, step):
    """All points are pushed alike: no spring feels it, every number is finite, and none means anything."""
    pushed = box(stiffness=1e3, load=[{"name": "push", "points": "all"}], solver={"most_work": 2e5})
    with Stepper(pushed, start_values={"solver.method": method, "solver.step": step}) as body:
        body.set({"load.push.x": 1e18})
        with pytest.raises(FmuError, match=r"not finite|most_work"):
            body.step(1.0)
