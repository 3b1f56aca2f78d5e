"""Results that are not finite: tried again with smaller internal steps, then refused with the state as it was."""

import numpy as np
import pytest

from scenes import box, table_and_press
from softffd.errors import FmuError
from stepping import Stepper

SPEED, H = 10.0, 0.0125


def under_press(step):
    return box(
        stiffness=10.0, damping=0.001, volume_stiffness=1e9, plane=table_and_press(), outputs={"solver": True}, method="leapfrog",
        step=step,
    )  # fmt: skip


def crush(body, steps=range(4)):
    """To half its height at 10 m/s: cells resist, stiffly, from one internal step to the next."""
    for n in steps:
        body.set({"plane.press.point.z": 1 - SPEED * n * H, "plane.press.velocity.z": -SPEED})
        body.step(H)


def test_given_steps_too_long_to_have_a_result_are_divided_with_a_warning():
    with Stepper(under_press(H / 8)) as body:
        crush(body)
        assert np.isfinite(body.points()).all()
        assert body.points()[:, 2].min() >= -1e-12 and body.points()[:, 2].max() <= 0.5 + 1e-12
        (warning,) = body.said("no finite result")
        assert f"no finite result with internal steps of {H / 8:.9g} s" in warning


@pytest.mark.full
def test_a_saved_run_divides_them_again():
    with Stepper(under_press(H / 8)) as body:
        crush(body, range(2))
        before, ends = body.save(), []
        for _ in range(2):
            body.restore(before)
            crush(body, range(2, 4))
            ends.append(body.points())
        assert np.array_equal(*ends)
        assert len(body.said("no finite result")) == 1


@pytest.mark.short("0.0-*", "0.001-auto")
@pytest.mark.parametrize("method", ["auto", "leapfrog", "rkn12", "ros34pw2"])
@pytest.mark.parametrize("step", [0.0, 1e-3])
def test_what_no_step_can_follow_is_refused_by_name_and_changes_nothing(method, step):
    """1e308 N; steps by tolerance are too many before they are too long."""
    pushed = box(stiffness=1e3, stretch=[1.1, 1.0, 1.0], load=[{"name": "push", "points": [[0, 0, 0]]}])
    with Stepper(pushed, start_values={"solver.method": method, "solver.step": step}) as body:
        body.step(0.01)
        before, state = body.points(), body.save()
        body.set({"load.push.x": 1e308})
        with pytest.raises(FmuError, match="not finite, not even with smaller internal steps" + "|most_work" * (step == 0)):
            body.step(10.0)
        assert np.array_equal(body.points(), before)
        body.restore(state)
        body.step(0.01)
        assert np.isfinite(body.points()).all()


def test_outputs_after_a_discarded_step_are_those_of_the_values_before():
    """A stiffness that asks for too many steps waits, in the state saved then too; taken back, it leaves no trace."""
    scene = box(stiffness=1e3, stretch=[1.1, 1.0, 1.0], energy=True, outputs={"solver": True})
    with Stepper(scene) as body, Stepper(scene) as other:
        for each in (body, other):
            each.step(0.01)
        before, state = body.outputs(), body.save()
        body.set({"stiffness.edge": 1e30})
        with pytest.raises(FmuError, match="most_work = 5000000"):
            body.step(0.01)
        assert body.outputs() == before
        body.restore(body.save())
        assert body.outputs() == before
        body.restore(state)
        for each in (body, other):
            each.set({"stiffness.edge": 2e3})
            each.step(0.01)
        assert body.outputs() == other.outputs()


def test_a_reaction_too_large_for_a_number_discards_the_step():
    held = box(stiffness=1e3, pin=[{"name": "hand", "points": "x-", "motion": "input"}])
    with Stepper(held) as body:
        body.set({"pin.hand.velocity.x": 1e20})
        with pytest.raises(FmuError, match="not finite"):
            body.step(1e-289)
        assert np.isfinite(body.outputs()).all()


@pytest.mark.parametrize("speed", [1e200, 1e300])
def test_a_plane_that_goes_beyond_all_numbers_is_refused(speed):
    with Stepper(box(stiffness=10.0, plane=table_and_press())) as body:
        before = body.points()
        body.set({"plane.press.velocity.z": -speed})
        with pytest.raises(FmuError):
            body.step(H)
        assert np.array_equal(body.points(), before)


@pytest.mark.parametrize(("rate", "refused"), [(1e160, False), (1e300, True)])
def test_a_force_that_grows_beyond_all_squares_ends_the_call(rate, refused):
    """The error of a window is no number then, and the next step was not, either."""
    with Stepper(
        box(stiffness=2e3, damping=2.0, gravity=[0, 0, -9.81], plane=table_and_press(), load=[{"name": "push", "points": "z+"}])
    ) as body:
        body.step(0.01)
        body.set_rates({"load.push.z": rate})
        if refused:
            with pytest.raises(FmuError, match="not finite"):
                body.step(0.01)
        else:
            body.step(0.01)
