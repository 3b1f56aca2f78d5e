"""Springs without length push in no direction: with automatic steps such a start is refused at once, with its reason."""

import pytest

from scenes import box
from softffd.errors import FmuError
from stepping import Stepper


def start(stretch, *, method="auto", step=0.0):
    return Stepper(box(stretch=stretch, method=method, step=step, outputs={"solver": True}))


@pytest.mark.parametrize("method", ["auto", "leapfrog", "bm4", "rkn12"])
@pytest.mark.parametrize("stretch", [[1.0, 1.0, 0.0], [1.1, 0.0, 1.0], [0.0, 0.0, 2.0]])
def test_a_flat_start_is_refused_with_its_reason(stretch, method):
    with pytest.raises(FmuError, match=r"springs have zero length.*no 0 in initial\.stretch"):
        start(stretch, method=method)


def test_with_a_given_step_it_runs_and_is_warned_of_once():
    with start([1.0, 1.0, 0.0], step=1e-4) as body:
        body.step(0.01, times=3)
        assert len(body.said("springs have zero length")) == 1
        assert abs(body.points()[:, 2]).max() == 0.0


def test_where_nothing_moves_nothing_is_to_be_decided():
    with start([0.0, 0.0, 0.0]) as body:
        body.step(0.1)
        assert abs(body.points()).max() == 0.0


@pytest.mark.parametrize("stretch", [[1.0, 1.0, 1e-6], [1.0, 1.0, -1.0]])
def test_flat_but_not_quite_is_a_start_like_any_other(stretch):
    with start(stretch) as body:
        body.step(0.01)
        assert not body.said("zero length")
