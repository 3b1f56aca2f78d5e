"""Methods in a run: auto takes the cheapest and says why, contact goes to leapfrog."""

from itertools import pairwise

import numpy as np
import pytest

from readings import assert_nothing_is_behind, points
from scenes import falling, let_go
from softffd import load_scene, simulate
from stepping import Stepper

SMOOTH = ["bm4", "rkn12", "dop853", "ros34pw2"]
WORK = {"leapfrog": 1.15, "bm4": 6.6, "rkn12": 20.0, "dop853": 17.0, "ros34pw2": 30.0}  # of a step, in evaluations of the spring forces
CONTACT = ("leapfrog", "an obstacle is near")

MOTIONS = {"still": {}, "rising": {"velocity": [0.0, 0.0, 0.3]}, "tilting": {"angular_velocity": [0.2, -0.1, 0.0]}}

# Contact


@pytest.mark.short("*-tilting", "auto-*")
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("method", [*SMOOTH, "auto"])
def test_a_fall_ends_on_the_ground_where_leapfrog_takes_over(method, motion):
    body = falling(method, **MOTIONS[motion])
    fine = simulate(body, start_values={"solver.method": "leapfrog", "solver.step": 2e-5})
    result = simulate(body, start_values={"solver.method": method, "solver.tolerance": 1e-3})
    assert result.outputs["solver.contacts_resolved"][-1] > 20
    assert_nothing_is_behind(result)
    assert np.abs(points(result) - points(fine)).max() < 1e-3  # the tolerance, of the unit box; measured: 0.9e-4 to 4.2e-4


@pytest.mark.parametrize("method", [*SMOOTH, "auto"])
def test_free_flight_is_the_methods_and_contact_is_leapfrogs(method):
    with Stepper(falling(method), start_values={"solver.method": method, "solver.tolerance": 1e-6}) as stepper:
        stepper.step(0.01, times=5)
        flight = stepper.methods()
        stepper.step(0.01, times=35)
        taken = stepper.methods()
    assert CONTACT not in flight
    assert {name for name, _ in flight} <= ({method} if method != "auto" else {"bm4", "dop853"})
    assert taken[len(flight)] == CONTACT


@pytest.fixture(scope="module")
def furthest():
    """How far the x+ side of the box gets that is let go of 10 % compression, at most in the first 20 ms [m]."""
    with Stepper(let_go("rkn12"), start_values={"solver.method": "leapfrog", "solver.step": 1e-5}) as stepper:
        return float(max(stepper.step(1e-4) or stepper.points()[:, 0].max() for _ in range(200)))


def beside_a_wall(furthest, deep):
    """The box beside a wall that it would pass by `deep` [m] and leave again before 30 ms are over. At rest in the beginning, it gives the
    forecast no reason to expect that."""
    return Stepper(let_go("rkn12", {"name": "wall", "point": [furthest - deep, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]}))


@pytest.mark.short("*-0.003")
@pytest.mark.parametrize("deep", [1e-2, 3e-3, 1e-4])
@pytest.mark.parametrize("method", SMOOTH)
def test_a_step_that_met_a_wall_is_taken_back_and_redone_to_the_bit(furthest, method, deep):
    """A given step, which stability divides, has the same bits then as if leapfrog had been asked for."""
    ends = []
    with beside_a_wall(furthest, deep) as stepper:
        for name in ("leapfrog", method):
            stepper.restart({"solver.method": name, "solver.step": 0.03})
            stepper.step(0.03)
            ends.append([*stepper.outputs(), stepper.number("solver.steps"), stepper.number("solver.contacts_resolved")])
        assert [words for words, _ in stepper.methods()] == ["leapfrog"]
        assert stepper.number("solver.rejected") > 0
    assert ends[0] == ends[1]
    assert ends[0][-1] > 0


@pytest.mark.short("*-0.001", "auto-*")
@pytest.mark.parametrize("deep", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("method", [*SMOOTH, "auto"])
def test_a_wall_that_is_met_for_a_moment_is_not_passed(furthest, method, deep):
    with beside_a_wall(furthest, deep) as stepper:
        ends = []
        for settings in ({"solver.method": "leapfrog", "solver.step": 1e-6}, {"solver.method": method, "solver.tolerance": 1e-4}):
            stepper.restart(settings)
            stepper.step(0.03)
            ends.append(stepper.points())
            assert stepper.number("solver.contacts_resolved") > 0
        assert stepper.methods() == [CONTACT]
    assert np.abs(ends[0] - ends[1]).max() < 1e-3


RAM = {"name": "ram", "point": [-9.5, 0.0, 0.0], "normal": [1.0, 0.0, 0.0], "motion": "input"}


@pytest.mark.short("*-into the box and back", "auto-*")
@pytest.mark.parametrize(
    ("speed", "slowing", "hits"),
    [(100.0, 0.0, True), (80.0, 0.0, False), (400.0, -8000.0, True), (360.0, -7200.0, False)],
    ids=["into the box", "short of it", "into the box and back", "short of it and back"],
)
@pytest.mark.parametrize("method", [*SMOOTH, "auto"])
def test_a_plane_from_far_away_is_met_within_one_communication_step(method, speed, slowing, hits):
    """It starts 9.5 m from the box and comes at 100 m/s and more; in two cases it is back before the communication step of 0.1 s ends."""
    place = -9.5 + 0.1 * speed + 0.005 * slowing
    with Stepper(let_go("rkn12", RAM), start_values={"solver.method": method}) as stepper:
        stepper.set({"plane.ram.velocity.x": speed})
        stepper.set_rates({"plane.ram.velocity.x": slowing})
        stepper.step(0.1)
        assert stepper.points()[:, 0].min() >= place - 1e-12
        assert (stepper.number("solver.contacts_resolved") > 0) == hits
        assert (stepper.point_velocities()[:, 0].mean() > 1.0) == hits  # m/s: it was thrown or pushed
        assert (CONTACT in stepper.methods()) == hits


# Steps


@pytest.mark.short("*-1e-06", "ros34pw2-0.001")
@pytest.mark.parametrize(
    ("method", "tolerance"),
    [*((method, tolerance) for method in ("bm4", "rkn12", "dop853", "auto") for tolerance in (1e-3, 1e-6, 1e-9)), ("ros34pw2", 1e-3)],
)
def test_a_clipped_step_does_not_shrink_the_next_one(method, tolerance):
    """Every communication step of 7 ms is followed by a sliver of a microsecond, which is one internal step more and costs no other."""
    steps, settings = [], {"solver.method": method, "solver.tolerance": tolerance}
    with Stepper(let_go("rkn12"), start_values=settings, stop_time=0.5) as stepper:
        for sliver in (0.0, 1e-6):
            stepper.restart(settings, stop_time=0.5)
            for _ in range(50):
                stepper.step(0.007)
                if sliver:
                    stepper.step(sliver)
            steps.append(stepper.number("solver.steps") + stepper.number("solver.rejected"))
    plain, with_slivers = steps
    assert with_slivers <= 1.03 * plain + 50 + 5


# The choice


def work(stepper):
    """Steps of 0.1 s to 1 s: work of all internal steps, by the method that was said to take each communication step."""
    done, total = 0, 0.0
    for _ in range(10):
        stepper.step(0.1)
        steps = stepper.number("solver.steps") + stepper.number("solver.rejected")
        total += WORK[stepper.methods()[-1][0]] * (steps - done)
        done = steps
    return total


EXPLICIT = {"free_vibration": ["leapfrog", "bm4", "rkn12"], "light_corner": ["leapfrog", "bm4", "dop853"]}


@pytest.mark.short("*-0.0001", "free_vibration-1e-08")
@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        *(("free_vibration", tolerance) for tolerance in (1e-2, 1e-4, 1e-6, 1e-8)),
        *(("light_corner", tolerance) for tolerance in (1e-2, 1e-4, 1e-8)),
    ],
)
def test_auto_does_little_more_work_than_the_best_method(name, tolerance):
    """In evaluations of the spring forces, without the trials. Leapfrog is known to be the slowest below 1e-5 and left out there."""
    with Stepper(load_scene(name)) as stepper:

        def work_of(method):
            stepper.restart({"solver.method": method, "solver.tolerance": tolerance}, stop_time=1.0)
            return work(stepper)

        assert work_of("auto") < 1.5 * min(work_of(method) for method in EXPLICIT[name][tolerance < 1e-5 :])


def test_auto_says_why_once_per_change_and_not_per_step():
    with Stepper(falling("rkn12"), start_values={"solver.method": "auto", "solver.tolerance": 1e-6}) as stepper:
        stepper.step(0.002, times=500)
        taken = stepper.methods()
    assert all(one != other for one, other in pairwise(taken))
    assert taken[0][1].startswith("auto: ")
    assert CONTACT in taken
    assert len(taken) < 60  # of 500 steps; a box that bounces meets the ground some ten times


@pytest.mark.parametrize(
    ("method", "step", "expected"),
    [
        ("bm4", 0.0, ("bm4", "as set")),
        ("bm4", 1e-3, ("bm4", "as set")),
        ("auto", 1e-3, ("leapfrog", "auto with solver.step set")),
        ("rkn12", 0.0, ("dop853", "the method that was set does not handle this damping")),
        ("rkn12", 1e-3, ("dop853", "the method that was set does not handle this damping")),
    ],
)
def test_the_reason_is_said_once_in_a_free_run(method, step, expected):
    with Stepper(let_go("bm4"), start_values={"solver.method": method, "solver.step": step}) as stepper:
        stepper.step(0.01, times=30)
        assert stepper.methods() == [expected]
