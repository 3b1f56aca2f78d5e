"""What `simulate` lets one choose: outputs, start time, tolerance, method."""

from functools import partial

import numpy as np
import pytest

from scenes import box, table_and_press
from softffd import FmuError, MeshError, SoftffdError, simulate
from softffd.fmu.variables import method_value
from softffd.run.drive import communication_points

SCENE = box(plane=table_and_press(), velocities="all", energy=True, stop_time=0.1)


@pytest.mark.parametrize(
    "wanted, found",
    [
        (["plane.press.reaction.z"], ["plane.press.reaction.z"]),
        (["plane.press.reaction"], [f"plane.press.reaction.{c}" for c in "xyz"]),
        ("energy.elastic", ["energy.elastic"]),
        (["energy"], ["energy.kinetic", "energy.elastic", "energy.dissipated", "energy.work"]),
        (["velocity[0,1,2]"], [f"velocity[0,1,2].{c}" for c in "xyz"]),
        (["plane.press.contacts", "velocity_0_1_2_x"], ["velocity[0,1,2].x", "plane.press.contacts"]),
        ([], []),
    ],
)
def test_the_outputs_that_are_named_are_recorded(wanted, found):
    result, everything = simulate(SCENE, output=wanted), simulate(SCENE)
    assert sorted(result.outputs) == sorted(found) and np.isnan(result.positions).all()
    for name in found:
        np.testing.assert_array_equal(result.outputs[name], everything.outputs[name])


def test_positions_are_outputs_too():
    result = simulate(SCENE, output=["position"])
    assert not result.outputs
    np.testing.assert_array_equal(result.positions, simulate(SCENE).positions)
    assert np.isfinite(simulate(SCENE, output=["position[1,2,3]"]).positions).sum() == 3 * 11


def test_a_run_may_start_at_any_time_and_is_the_same():
    course = np.array([(0.0, 1.0), (0.1, 0.9)], dtype=[("time", float), ("plane.press.point.z", float)])
    late = course.copy()
    late["time"] += 512
    at_zero = simulate(SCENE, inputs=course, interpolation="linear")
    later = simulate(SCENE, start_time=512, stop_time=512.1, inputs=late, interpolation="linear")
    np.testing.assert_allclose(later.time - 512, at_zero.time, atol=1e-12)
    assert later.summary["simulated_time_s"] == pytest.approx(0.1) and later.summary["communication_steps"] == 10
    np.testing.assert_allclose(later.positions, at_zero.positions, atol=1e-9)
    assert abs(later.positions - later.positions[0]).max() > 0.01


@pytest.mark.parametrize("stop_time", [np.float32(0.05), 0.05 + 1e-9, 0.05 - 1e-9])
def test_a_stop_time_that_is_rounded_makes_no_step_of_the_remainder(stop_time):
    exact, rounded = (simulate("press", stop_time=end, output="plane.table.reaction.z") for end in (0.05, stop_time))
    assert len(rounded.time) == len(exact.time) == 6 and rounded.time[-1] == stop_time
    assert rounded.outputs["plane.table.reaction.z"][-1] == pytest.approx(exact.outputs["plane.table.reaction.z"][-1], rel=1e-6)


def test_a_run_shorter_than_a_rounding_error_of_its_step_is_one_step():
    assert communication_points(1e-9, 0.01, bytes_each=1).tolist() == [0.0, 1e-9]


@pytest.mark.parametrize("start", [1e15, 1e14])
def test_times_too_late_for_the_communication_step_are_refused(start):
    with pytest.raises(FmuError, match="communication step: wanted one that changes the time"):
        simulate("press", start_time=start, stop_time=start + 1)


def test_a_function_is_asked_from_the_start_time_on():
    asked = []

    def course(time):
        asked.append(time)
        return {"plane.press.point.z": 1.0}

    for interpolation in ("held", "cubic"):
        simulate(SCENE, start_time=3.0, stop_time=3.1, inputs=course, interpolation=interpolation)
    assert min(asked) == 3.0


def test_tolerance_and_method_are_those_of_the_run():
    swinging = box(stretch=[1.2, 1.0, 1.0], stop_time=0.1)
    loose = simulate(swinging, tolerance=1e-2, method="leapfrog").positions
    document = swinging.replace({"solver.method": "leapfrog", "solver.tolerance": 1e-2})
    np.testing.assert_array_equal(loose, simulate(document).positions)
    error = abs(loose - simulate(swinging, tolerance=1e-9, method="dop853").positions).max()
    assert 1e-7 < error < 1e-2


@pytest.mark.parametrize(
    "given, message",
    [
        ({"output": ["plane.press.reacton"]}, 'has no such output, did you mean "plane.press.reaction"'),
        ({"output": 5}, "output: 5: the FMU has no such output"),
        ({"output": ["positions"]}, 'did you mean "position"'),
        ({"output": ["mass"]}, "output: mass: wanted an output of the FMU, got its parameter"),
        ({"start_time": 0.1}, r"stop time: wanted > 0.1 s, the start time, got 0.1 \(in the FMU's default"),
        ({"start_time": float("nan")}, "start time: wanted a finite number of s, got nan"),
        ({"tolerance": 0}, "tolerance: wanted > 0, got 0"),
        ({"method": "leapfog"}, 'did you mean "leapfrog"'),
        ({"start_values": {1: 1}}, "1: the FMU has no such variable"),
        ({"interpolation": "liner"}, "wanted one of held, linear, cubic, got 'liner', did you mean \"linear\""),
    ],
)
def test_what_cannot_be_chosen_is_refused_with_the_nearest_that_can(given, message):
    with pytest.raises(FmuError, match=message):
        simulate(SCENE, **given)


@pytest.mark.parametrize("name", ["stop_time", "step", "start_time", "tolerance"])
@pytest.mark.parametrize("value", [np.array([0.1]), "0.1", [0.1]])
def test_what_is_one_number_is_no_array(name, value):
    with pytest.raises(FmuError, match="wanted one number, got"):
        simulate(SCENE, **{name: value})


def test_parameters_are_all_numbers_that_the_run_had():
    result = simulate(SCENE, method="leapfrog", begun=lambda sim, inputs: sim.component.set_start_values({"stiffness.edge": 123.0}))
    assert result.parameters["solver.method"] == method_value("leapfrog") and result.parameters["stiffness.edge"] == 123


@pytest.mark.parametrize("row", [999, -99, 0.05, np.array([0, 11])])
def test_a_row_that_is_none_is_refused(row):
    result = simulate(SCENE)
    for look in (result.strain, result.stress, partial(result.deformed, np.full((1, 3), 0.5))):
        with pytest.raises(SoftffdError, match="wanted a row of 11"):
            look(row=row)
    for given, words in ((np.full(3, 0.5), r"wanted a Mesh or vertices \(V, 3\), got the shape \(3,\)"), (None, "wanted a mesh")):
        with pytest.raises(MeshError, match=words):
            result.deformed(given)
