"""The error at the end of a run stays within ten times `solver.tolerance`, with every method, on the shipped scenes.

The error is the largest of all control points, relative to the largest side of the box, against a run that is much more accurate and by
another method. In contact, where all methods hand over to leapfrog, it is leapfrog with small steps.
"""

import numpy as np
import pytest

from end_states import REFERENCES, end
from softffd import load_scene
from stepping import Stepper

SMOOTH = ("bm4", "dop853", "auto")
UNDAMPED = ("bm4", "rkn12", "dop853", "auto")
CONTACT = ("leapfrog", "bm4", "rkn12", "dop853", "auto")
CASES = [
    *[("free_vibration", method, tolerance) for tolerance in (1e-2, 1e-4) for method in ("leapfrog", *UNDAMPED)],
    *[("free_vibration", method, tolerance) for tolerance in (1e-6, 1e-8, 1e-9) for method in UNDAMPED],
    *[("light_corner", method, tolerance) for tolerance in (1e-2, 1e-4) for method in ("leapfrog", *SMOOTH)],
    *[("light_corner", method, tolerance) for tolerance in (1e-6, 1e-8, 1e-9) for method in SMOOTH],
    *[("spin", method, tolerance) for tolerance in (1e-2, 1e-4) for method in ("leapfrog", *UNDAMPED)],
    *[("spin", method, tolerance) for tolerance in (1e-6, 1e-8, 1e-9) for method in UNDAMPED],
    *[("hanging", method, tolerance) for tolerance in (1e-2, 1e-4, 1e-6) for method in ("leapfrog", *SMOOTH)],
    *[("hanging", method, tolerance) for tolerance in (1e-8, 1e-9) for method in SMOOTH],
    *[(scene, "auto", tolerance) for scene in ("stiff_pull", "stiff_layer") for tolerance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-9)],
    *[(scene, "ros34pw2", tolerance) for scene in ("stiff_pull", "stiff_layer") for tolerance in (1e-2, 1e-4, 1e-6, 1e-8)],
    *[("sliding_drop", method, tolerance) for tolerance in (1e-2, 1e-3, 1e-4) for method in CONTACT],
    *[("press", method, tolerance) for tolerance in (1e-2, 1e-4) for method in ("leapfrog", "dop853", "auto")],
    *[("incline", "auto", tolerance) for tolerance in (1e-2, 1e-3, 1e-4)],
    *[(scene, "auto", tolerance) for scene in ("sliding_drop", "incline", "press") for tolerance in (1e-5, 1e-6, 1e-7)],
    *[("car_drop", "auto", tolerance) for tolerance in (1e-2, 1e-3, 1e-4)],
    *[("stiff_bounce", "auto", tolerance) for tolerance in (1e-2, 1e-3, 1e-4, 1e-5)],
    *[("light_bounce", "auto", tolerance) for tolerance in (1e-2, 1e-3, 1e-4)],
]


@pytest.fixture(scope="module")
def exact(golden):
    """exact(scene, method): the stored end of the scene by a method that is not this one, if there is another."""
    ends = golden("ends")

    def end_of(name, method):
        others = [reference for reference, _ in REFERENCES[name] if reference != method]
        return ends[f"{name}-{(others or [REFERENCES[name][0][0]])[0]}"]

    return end_of


@pytest.mark.short(
    "free_vibration-*-0.0001",
    "free_vibration-auto-1e-09",
    "light_corner-*-0.0001",
    "light_corner-auto-1e-08",
    "spin-auto-1e-06",
    "hanging-auto-0.0001",
    "hanging-dop853-1e-09",
    "stiff_*-auto-0.0001",
    "stiff_*-ros34pw2-1e-06",
    "sliding_drop-*-0.001",
    "sliding_drop-auto-1e-05",
    "press-auto-0.0001",
    "incline-auto-0.0001",
    "car_drop-auto-0.01",
    "stiff_bounce-auto-*",
    "light_bounce-auto-0.001",
)
@pytest.mark.parametrize(("name", "method", "tolerance"), CASES)
def test_the_error_at_the_end_is_within_ten_tolerances(exact, name, method, tolerance):
    error = np.abs(end(name, method, {"solver.tolerance": tolerance}) - exact(name, method)).max()
    print(f"{name:15} {method:9} {tolerance:.0e} error / tolerance {error / tolerance:9.3g}")  # a table with pytest -rP
    assert error < 10 * tolerance


@pytest.mark.full
@pytest.mark.parametrize(("name", "method"), [(name, method) for name in REFERENCES for method, _ in REFERENCES[name]])
def test_stored_ends_are_those_of_a_run(golden, name, method):
    """Of the box; below what the smallest tolerance needs, and above what an expression written in another order changes."""
    smallest = min(tolerance for scene, _, tolerance in CASES if scene == name)
    assert np.abs(end(name, method, dict(REFERENCES[name])[method]) - golden("ends")[f"{name}-{method}"]).max() < 0.03 * smallest


@pytest.mark.parametrize("name", [name for name, references in REFERENCES.items() if len(references) == 2])
def test_the_references_agree(exact, name):
    """Far below the smallest tolerance that they are used for."""
    smallest = min(tolerance for scene, _, tolerance in CASES if scene == name)
    assert np.abs(exact(name, REFERENCES[name][0][0]) - exact(name, REFERENCES[name][1][0])).max() < 0.3 * smallest


def test_a_tolerance_given_at_setup_wins_over_the_parameter():
    """fmi2SetupExperiment's tolerance acts as the variable does, to the bit, and reads back as it."""
    ends = {}
    with Stepper(load_scene("free_vibration")) as stepper:
        for setup, parameter in [(None, 1e-3), (None, 1e-8), (1e-8, 1e-3), (1e-8, None)]:
            settings = {"solver.method": "dop853"} | ({"solver.tolerance": parameter} if parameter else {})
            stepper.restart(settings, stop_time=1.0, tolerance=setup)
            assert stepper.read("solver.tolerance")[0] == (setup or parameter)
            stepper.step(0.1, times=10)
            ends[setup, parameter] = stepper.points()
    assert np.array_equal(ends[1e-8, 1e-3], ends[None, 1e-8])
    assert np.array_equal(ends[1e-8, None], ends[None, 1e-8])
    assert not np.array_equal(ends[None, 1e-3], ends[None, 1e-8])


@pytest.mark.parametrize("method", ["leapfrog", "bm4", "rkn12", "dop853"])
def test_a_given_step_is_taken_whatever_the_tolerance(method):
    with Stepper(load_scene("free_vibration")) as stepper:
        ends = []
        for tolerance in (1e-1, 1e-12):
            stepper.restart({"solver.method": method, "solver.step": 1e-3, "solver.tolerance": tolerance}, stop_time=1.0)
            stepper.step(0.1, times=10)
            assert stepper.number("solver.steps") == 1000
            ends.append(stepper.points())
    assert np.array_equal(*ends)


@pytest.mark.parametrize("method", ["leapfrog", "bm4"])
def test_a_longer_run_is_stepped_more_finely(method):
    """The tolerance is for the end of the run: with a later stop time the same second is to be more accurate. Methods with error control
    do not look at the stop time; they keep the error of a single step far enough below the tolerance."""
    with Stepper(load_scene("free_vibration")) as stepper:
        steps = []
        for stop in (1.0, 10.0):
            stepper.restart({"solver.method": method, "solver.tolerance": 1e-4}, stop_time=stop)
            stepper.step(0.1, times=10)
            steps.append(stepper.number("solver.steps"))
    assert steps[1] > 1.05 * steps[0]


@pytest.mark.short("3.0")
@pytest.mark.parametrize("start", [0.0, 3.0])
def test_without_a_stop_time_a_run_is_as_long_as_the_scenes(start):
    """Another master that gives no end takes the same steps; a scene of another length is stepped otherwise."""
    ends = {}
    for stop in (1.0, 10.0):
        with Stepper(load_scene("free_vibration").replace({"experiment.stop_time": stop})) as stepper:
            for given in (start + stop, None):
                stepper.restart({"solver.method": "leapfrog", "solver.tolerance": 1e-4}, start_time=start, stop_time=given)
                stepper.step(0.125, times=8)
                ends[stop, given is None] = stepper.points()
        assert np.array_equal(ends[stop, False], ends[stop, True])
    assert not np.array_equal(ends[1.0, True], ends[10.0, True])


@pytest.mark.parametrize("start", [-8.0, 256.0])
def test_the_length_of_a_run_counts_from_its_start(start):
    """The tolerance is shared out over the same second, to the bit, wherever it lies."""
    with Stepper(load_scene("free_vibration")) as stepper:
        ends = []
        for begin in (0.0, start):
            stepper.restart({"solver.method": "leapfrog", "solver.tolerance": 1e-4}, start_time=begin, stop_time=begin + 1.0)
            stepper.step(0.125, times=8)
            ends.append(stepper.points())
    assert np.array_equal(*ends)
