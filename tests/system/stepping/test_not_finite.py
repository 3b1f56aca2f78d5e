"""Results that are not finite: tried again with smaller internal steps, then refused with the state as it was."""

import numpy as np
import pytest

from softffd.errors import FmuError
from stepping import Stepper

SPEED, H = 10.0, 0.0125

CRUSH = """
[material]
stiffness = 10.0
damping = 0.001
volume_stiffness = 1e9
[[plane]]
name = "table"
friction = 0.0
[[plane]]
name = "press"
friction = 0.0
point = [0.0, 0.0, 1.0]
normal = [0.0, 0.0, -1.0]
motion = "input"
[outputs]
solver = true
[solver]
method = "{method}"
step = {step}
"""


def crush(box, steps=range(4)):
    """To half its height at 10 m/s: cells resist, stiffly, from one internal step to the next."""
    for n in steps:
        box.set({"plane.press.point.z": 1 - SPEED * n * H, "plane.press.velocity.z": -SPEED})
        box.step(H)


def divided(box):
    return [text for text in box.messages if "not finite" in text]


def test_given_steps_too_long_to_have_a_result_are_divided_with_a_warning(scene):
    with Stepper(scene(CRUSH.format(method="leapfrog", step=H / 8))) as box:
        crush(box)
        assert np.isfinite(box.positions()).all()
        assert box.positions()[:, 2].min() >= -1e-12 and box.positions()[:, 2].max() <= 0.5 + 1e-12
        (warning,) = divided(box)
        assert f"internal steps of {H / 8:.9g} s give a result that is not finite" in warning


@pytest.mark.full
def test_a_saved_run_divides_them_again(scene):
    with Stepper(scene(CRUSH.format(method="leapfrog", step=H / 8))) as box:
        crush(box, range(2))
        before, ends = box.save(), []
        for _ in range(2):
            box.restore(before)
            crush(box, range(2, 4))
            ends.append(box.positions())
        assert np.array_equal(*ends)
        assert len(divided(box)) == 1


@pytest.mark.short("0.0-*", "0.001-auto")
@pytest.mark.parametrize("method", ["auto", "leapfrog", "rkn12", "ros34pw2"])
@pytest.mark.parametrize("step", [0.0, 1e-3])
def test_what_no_step_can_follow_is_refused_by_name_and_changes_nothing(scene, method, step):
    """1e308 N; steps by tolerance are too many before they are too long."""
    text = "[material]\nstiffness = 1e3\n[initial]\nstretch = [1.1, 1.0, 1.0]\n[[load]]\nname = 'push'\npoints = [[0, 0, 0]]\n"
    with Stepper(scene(text), start_values={"solver.method": method, "solver.step": step}) as box:
        box.step(0.01)
        before, state = box.positions(), box.save()
        box.set({"load.push.x": 1e308})
        with pytest.raises(FmuError, match="not finite, and not with smaller internal steps either" + "|more than 20000000" * (step == 0)):
            box.step(10.0)
        assert np.array_equal(box.positions(), before)
        box.restore(state)
        box.step(0.01)
        assert np.isfinite(box.positions()).all()


def test_outputs_after_a_discarded_step_are_those_of_the_values_before(scene):
    """A stiffness that asks for too many steps waits, in the state saved then too; taken back, it leaves no trace."""
    text = "[material]\nstiffness = 1e3\n[initial]\nstretch = [1.1, 1.0, 1.0]\n[outputs]\nenergy = true\nsolver = true\n"
    with Stepper(scene(text)) as box, Stepper(scene(text)) as other:
        for each in (box, other):
            each.step(0.01)
        before, state = box.outputs(), box.save()
        box.set({"stiffness.edge": 1e30})
        with pytest.raises(FmuError, match="more than 20000000"):
            box.step(0.01)
        assert box.outputs() == before
        box.restore(box.save())
        assert box.outputs() == before
        box.restore(state)
        for each in (box, other):
            each.set({"stiffness.edge": 2e3})
            each.step(0.01)
        assert box.outputs() == other.outputs()


def test_a_reaction_too_large_for_a_number_discards_the_step(scene):
    text = "[material]\nstiffness = 1e3\n[[pin]]\nname = 'hand'\npoints = 'x-'\nmotion = 'input'\n"
    with Stepper(scene(text)) as box:
        box.set({"pin.hand.velocity.x": 1e10})
        with pytest.raises(FmuError, match="not finite"):
            box.step(1e-300)
        assert np.isfinite(box.outputs()).all()
