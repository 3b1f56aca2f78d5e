"""Parameters and inputs that are set between two steps act from the next step on; time may start anywhere."""

import numpy as np
import pytest

import reference
from readings import points
from scenes import box
from softffd import FmuError, simulate
from stepping import Stepper


def swinging(*, damping=0.02, method="leapfrog"):
    return box(
        stiffness=1e3, damping=damping, gravity=[0.0, 0.0, -1.0], stretch=[1.1, 1.0, 1.0], velocities="all", energy=True,
        forces=[[0, 0, 0]], method=method, step=5e-4,
    )  # fmt: skip


def sliding(*, stiffness=0.0, **floor):
    return box(
        lattice={"points": [2, 2, 2]}, mass={"total": 0.8}, stiffness=stiffness, damping=0.0, gravity=[0.0, 0.0, -10.0],
        plane=[{"name": "floor", "friction": 0.1, **floor}], velocity=[2.0, 0.0, 0.0], velocities="all", step=1e-3,
    )  # fmt: skip


@pytest.mark.parametrize("method", ["leapfrog", "auto"])
@pytest.mark.parametrize(
    ("change", "stiffness", "damping", "gravity", "force"),
    [
        ({"stiffness.edge": 500.0, "stiffness.face": 500.0, "stiffness.body": 500.0}, 500.0, 0.02, -1.0, 0.0),
        ({"damping": 0.4}, 1e3, 0.4, -1.0, 0.0),
        ({"gravity.z": 4.0}, 1e3, 0.02, 4.0, 0.0),
        ({"force[0,0,0].y": 3.0}, 1e3, 0.02, -1.0, 3.0),
    ],
    ids=["stiffness", "damping", "gravity", "force"],
)
def test_a_change_acts_from_the_next_step_on(method, change, stiffness, damping, gravity, force):
    def external(pull, push):
        values = np.tile([0.0, 0.0, pull / 64], (64, 1))
        values[0, 1] += push
        return values

    before, after = reference.cube(damping=0.02), reference.cube(stiffness=stiffness, damping=damping)
    x, v = before.rest * [1.1, 1.0, 1.0], np.zeros_like(before.rest)
    x, v = reference.leapfrog(before, x, v, 5e-4, 40, external=external(-1.0, 0.0))
    with Stepper(swinging(method=method)) as stepper:
        stepper.step(0.02)
        stepper.set(change)
        assert stepper.points() == pytest.approx(x, abs=1e-13)  # setting alone moves nothing
        stepper.step(0.02)
        x, v = reference.leapfrog(after, x, v, 5e-4, 40, external=external(gravity, force))
        assert stepper.points() == pytest.approx(x, abs=1e-12)
        assert stepper.point_velocities() == pytest.approx(v, abs=1e-10)


def test_a_change_of_stiffness_is_work():
    with Stepper(swinging(damping=0.0)) as stepper:
        stored = stepper.read("energy.elastic")[0]
        stepper.set({f"stiffness.{kind}": 2e3 for kind in ("edge", "face", "body")})
        stepper.step(5e-4)
        assert stepper.read("energy.work")[0] == pytest.approx(stored, rel=1e-9)


def test_a_change_of_friction_acts_from_the_next_step_on():
    with Stepper(sliding()) as stepper:
        stepper.step(0.1)
        assert stepper.point_velocities()[:4, 0] == pytest.approx(2.0 - 0.1 * 10 * 0.1, abs=1e-13)
        stepper.set({"plane.floor.friction": 0.5})
        stepper.step(0.1)
        assert stepper.point_velocities()[:4, 0] == pytest.approx(1.9 - 0.5 * 10 * 0.1, abs=1e-12)
        stepper.set({"plane.floor.friction": 0.0})
        stepper.step(0.1)
        assert stepper.point_velocities()[:4, 0] == pytest.approx(1.4, abs=1e-12)


@pytest.mark.parametrize("start", [1000.0, -7.25, 1.7e9])
def test_time_may_start_anywhere(start):
    """Not a bit changes; a plane of the scene stands where it says at the start time, whatever that is."""
    lifted = sliding(stiffness=50.0, velocity=[0.0, 0.0, 0.3])
    expected = points(simulate(lifted, stop_time=0.5, step=0.01))
    with Stepper(lifted, start_time=start) as stepper:
        assert np.array_equal(stepper.points(), expected[0])
        stepper.step(0.01, times=50)
        assert np.array_equal(stepper.points(), expected[-1])


@pytest.mark.parametrize("start, step", [(1.7e9, 0.01), (0.0, 1e-9)])
def test_a_communication_point_that_is_a_step_off_is_refused_anywhere(start, step):
    with Stepper(sliding(), start_time=start) as stepper:
        stepper.step(step)
        stepper.time += step
        with pytest.raises(FmuError, match=r"currentCommunicationPoint: wanted .* off"):
            stepper.step(step)
