"""A given solver.step is divided where the stability of the present state and method asks for it, and only there."""

import pytest

from readings import points
from scenes import GRAVITY, box
from softffd import simulate
from stepping import Stepper

PULLED = {"stiffness": 1e3, "damping": 0.05, "method": "leapfrog"}
PULLED |= {"pin": [{"name": "left", "points": "x-"}], "load": [{"name": "push", "points": "x+"}]}
SMOOTH = [("bm4", 3.5e-4, 0.1), ("dop853", 4.5e-4, 0.1), ("rkn12", 6e-4, 0.0), ("ros34pw2", 1e-3, 0.1), ("ros34pw2", 5e-3, 0.1)]


@pytest.mark.parametrize("method, step, damping", [("leapfrog", 5e-3, 0.1), *SMOOTH])
def test_steps_that_suit_free_flight_are_divided_where_contact_begins(method, step, damping):
    """Leapfrog takes over at the obstacle; its limit is 1.9e-4 s."""
    body = box(
        stiffness=1e5, damping=damping, gravity=GRAVITY, plane=[{"name": "ground", "friction": 0.4, "point": [0.0, 0.0, -0.05]}],
        outputs={"energy": True, "solver": True}, method=method, step=step, stop_time=0.4,
    )  # fmt: skip
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
            ends[step] = body.points()[:, 0].max()
    assert ends[1e-4] > 1.3
    assert ends[0.02] == pytest.approx(ends[1e-4], rel=5e-3)  # 2.1e-3: that of the shorter step is nearer to the limit
    assert ends[0.16] == pytest.approx(ends[1e-4], rel=0.04)  # 2.3e-2: one step of 0.16 s is divided anew only as often as it must be
