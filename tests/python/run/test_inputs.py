"""Inputs over time: the three forms, and the velocities that follow from poses."""

from itertools import pairwise

import numpy as np
import pytest

from scenes import box
from softffd import FmuError, Simulation, load_scene, simulate
from softffd.run.inputs import Inputs, derived_velocities


def table(**columns) -> np.ndarray:
    array = np.zeros(len(next(iter(columns.values()))), dtype=[(name, float) for name in columns])
    for name, values in columns.items():
        array[name] = values
    return array


def test_arrays_callables_and_files_give_the_same_values(tmp_path):
    (tmp_path / "in.csv").write_text("# a comment\ntime, load.a.x\n0, 1\n1, 3\n")
    sources = [table(time=[0, 1], **{"load.a.x": [1, 3]}), lambda t: {"load.a.x": min(3, 1 + 2 * t)}, tmp_path / "in.csv"]
    for source in sources:
        inputs = Inputs(source)
        assert inputs.names == ["load.a.x"]
        assert [inputs.values(t, t + 0.1)[0] for t in (0.0, 0.25, 2.0)] == pytest.approx([1.0, 1.5, 3.0])


def test_a_given_point_brings_the_velocity_that_reaches_its_next_value():
    inputs = Inputs(table(time=[0, 1], **{"plane.p.point.z": [0, 2]}))
    assert inputs.derived_names == [f"plane.p.velocity.{c}" for c in "xyz"]
    np.testing.assert_allclose(inputs.values(0.5, 0.6), [1.0, 0.0, 0.0, 2.0])
    assert Inputs(lambda t: {"plane.p.point.z": t, "plane.p.velocity.z": 7.0}).derived_names == []  # one that is given is left alone


def test_turning_normals_and_quaternions_bring_the_angular_velocity():
    normal = {f"plane.p.normal.{c}": v for c, v in zip("xyz", [0, 0, 2.0], strict=True)}
    turned = {f"plane.p.normal.{c}": v for c, v in zip("xyz", [np.sin(0.2), 0, np.cos(0.2)], strict=True)}
    rates = derived_velocities(normal, turned, 0.1)
    assert rates["plane.p.angular_velocity.y"] == pytest.approx(2.0)
    at_rest = {f"pin.p.orientation.{c}": v for c, v in zip("wxyz", [1.0, 0, 0, 0], strict=True)}
    turned = {f"pin.p.orientation.{c}": v for c, v in zip("wxyz", [np.cos(0.1), 0, 0, np.sin(0.1)], strict=True)}
    assert derived_velocities(at_rest, turned, 0.1)["pin.p.angular_velocity.z"] == pytest.approx(2.0)
    back = {name: -value for name, value in turned.items()}  # the same orientation
    assert derived_velocities(at_rest, back, 0.1)["pin.p.angular_velocity.z"] == pytest.approx(2.0)


JUMPS = [round(0.01 * n, 2) for n in range(5, 13)]


@pytest.mark.parametrize("jump", JUMPS)
def test_a_step_ends_before_a_jump_and_the_next_begins_after_it(jump):
    inputs = Inputs(table(time=[0, jump, jump, 1], **{"plane.p.point.z": [1.2, 1.2, 0.9, 0.9]}))
    times = 0.01 * np.arange(21)
    at = int(np.abs(times - jump).argmin())
    height, *velocity = np.array([inputs.values(*pair) for pair in pairwise(times)]).T
    np.testing.assert_array_equal(height, np.where(np.arange(20) < at, 1.2, 0.9))
    np.testing.assert_array_equal(velocity, 0.0)
    np.testing.assert_array_equal([inputs.rates(*pair) for pair in pairwise(times)], 0.0)


@pytest.mark.parametrize("jump", JUMPS)
def test_cubics_reach_a_jump_from_before_and_leave_it_from_behind(jump):
    """Each side of the jump is a straight line, which the cubic is then too; the other column does not jump."""
    inputs = Inputs(table(time=[0, jump, jump, 1], **{"load.a.x": [0, jump, 5, 5 - 2 * (1 - jump)], "load.a.y": [0, jump, jump, 1]}))
    times = 0.01 * np.arange(21)
    for time, then in pairwise(times):
        slope = 1.0 if then < jump + 1e-6 else -2.0
        np.testing.assert_allclose(inputs.bends(time, then), [[slope, 1.0], [0, 0], [0, 0]], atol=1e-6)


def test_a_cubic_between_steep_neighbours_only_rises():
    """Slopes up to three times a step's mean are the most with which no cubic turns back (Fritsch, Carlson 1980)."""
    inputs = Inputs(table(time=[0, 1, 2, 3], **{"load.a.x": [0, 10, 11, 21]}))
    first, second, third = inputs.bends(1.0, 2.0)[:, 0]
    s = np.linspace(0, 1, 101)
    rate = first + second * s + third * s**2 / 2
    assert rate[0] > 1 and rate.min() > -1e-12


@pytest.mark.parametrize(("step", "ends"), [(2.0, "1.05 and 1.02"), (1.9, "1.05 and 0.88"), (1.2, ""), (1.0, ""), (0.01, "")])
def test_a_peak_between_communication_points_is_a_warning_and_a_mere_fall_or_jump_is_none(step, ends):
    course = table(time=[0, 0.2, 1.2, 1.7, 2.2, 3.3, 3.3, 4], **{"plane.p.point.z": [1.05, 1, 0.6, 0.6, 1.3, 1.3, 1.4, 1.4]})
    warning = f"inputs: plane.p.point.z: the run misses its value 0.6 at 1.2 s, between communication points with {ends}: "
    found = Inputs(course).overseen(np.append(np.arange(0, 4, step), 4.0))
    assert found == ([warning + "take a shorter communication step"] if ends else [])


def test_a_run_says_what_it_misses_of_its_inputs():
    assert "the run misses its value 0.6 at 1.2 s" in simulate("press", step=2.0).summary["warnings"][0]


def test_a_function_must_give_the_same_names_at_every_time():
    for late in ({}, {"plane.p.point.z": 1.0, "load.a.x": 0.0}, {"load.a.x": 0.0}):
        inputs = Inputs(lambda t, late=late: {"plane.p.point.z": 1.0} if t < 0.1 else late)
        inputs.values(0.0, 0.09)
        wrong = ["missing: plane.p.point.z"] * ("plane.p.point.z" not in late) + ["additional: load.a.x"] * ("load.a.x" in late)
        with pytest.raises(FmuError, match=f"at 0.15 s: wanted the same names as at 0 s, got {'; '.join(wrong)}"):
            inputs.values(0.05, 0.15)


@pytest.mark.parametrize(
    "source, message",
    [
        ({1.0}, "wanted a function of time, a dict of constants, a structured array, a DataFrame or a CSV file, got set"),
        ([(0, 1.0)], "got list"),
        (3, "got int"),
        (lambda t: None, "at 0 s: wanted a dict of values by name, got None"),
        (lambda t: {1: 1.1}, "at 0 s: wanted a dict of values by name, got {1: 1.1}"),
        (lambda t: {"load.a.x": "1.1"}, "at 0 s: load.a.x: wanted a finite number or a vector of them, got '1.1'"),
        (lambda t: {"load.a.x": np.nan}, "at 0 s: load.a.x: wanted a finite number or a vector of them, got nan"),
        (np.zeros((2, 2)), "first field is `time`, got float64"),
        (table(time=[], **{"load.a.x": []}), "at least one row"),
        (np.zeros((1, 2), [("time", float), ("load.a.x", float)]), r"got the shape \(1, 2\)"),
        (np.zeros(2, [("time", float), ("load.a.x", "U5")]), "load.a.x: wanted a column of numbers, got <U5"),
        (table(time=[0, np.nan], **{"load.a.x": [0, 1]}), "row 1, time: wanted a finite number, got nan"),
        (table(time=[0, 1, 0.5], **{"load.a.x": [0, 1, 2]}), "row 2: the times must not decrease, got 0.5 after 1"),
        *[({"load.a": value}, r"load\.a: wanted ") for value in ("high", None, [1, 2], [[1, 2, 3]], float("nan"), [1, 2, float("inf")])],
    ],
)
def test_what_is_no_source_is_refused_in_words(source, message):
    with pytest.raises(FmuError, match=f"inputs: .*{message}"):
        Inputs(source)


@pytest.mark.parametrize(
    "text, message",
    [
        ("", "header line"),
        ("time,a\n", "at least one row"),
        ("time,force[3,3,3].z\n0,1\n", r"line 1: .*got 'force\[3': a name with commas in it stands between quotation marks"),
        ("t,a\n0,1\n", "line 1: wanted a header of `time`.*got 't'"),
        ("Time,a\n0,1\n", "got 'Time' as the first name, did you mean \"time\"?"),
        ("time [s],a\n0,1\n", 'did you mean "time"?'),
        ("a,time\n0,1\n", "`time` must be the first"),
        ("time;a\n0;1\n", "separated by commas, got semicolons"),
        ("time\ta\n0\t1\n", "separated by commas, got tabs"),
        ("time,a,a\n0,1,2\n", "each once.*got 'a' again"),
        ("time,a\n0,1,2\n", "line 2: wanted 2 numbers"),
        ("# two\n\ntime,a\n0,1\n\n1,x\n", "line 6, a: wanted a number, got 'x'"),
        ("time,a\n0,nan\n", "line 2, a: wanted a finite number"),
        ("time,a\n0,1\n1,1\n0.5,1\n", "line 4: the times must not decrease, got 0.5 after 1"),
        ("time,a\n0," + "1" * 200000 + "\n", "line 2: is no line of a CSV file"),
        ("time,a\n0,-1_0\n", "line 2, a: wanted a number, got '-1_0'"),
        ("time,a\n0,\u0661\n", "line 2, a: wanted a number"),
        ("time,a,\n0,1,\n", "line 1: .* got column 3 without a name: the line ends with a comma"),
        ("time,a\n0,1,\n", "line 2: wanted 2 numbers as in the header, got 3, for the line ends with a comma"),
        ("time,a\n0,é\n".encode("utf-16"), "wanted a CSV text in UTF-8, got the byte 0xff in line 1"),
        ("time,a\n0,é\n".encode("latin-1"), "wanted a CSV text in UTF-8, got the byte 0xe9 in line 2"),
    ],
)
def test_a_faulty_file_says_where(tmp_path, text, message):
    (tmp_path / "in.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(FmuError, match=rf"in\.csv: .*{message}"):
        Inputs(tmp_path / "in.csv")


def test_a_dict_holds_constants_by_variable_or_vector_and_a_function_gives_the_same():
    given = {"load.a": np.array([1.0, 2, 3]), "plane.p.point.z": 4, "pin.p.orientation": [1, 0, 0, 0]}
    for source in (given, lambda time: given | {"load.a": (1, 2 * time, 3)}):
        inputs = Inputs(source)
        assert inputs.names == [*(f"load.a.{c}" for c in "xyz"), "plane.p.point.z", *(f"pin.p.orientation.{c}" for c in "wxyz")]
        assert inputs.values(1.0, 1.1)[:8].tolist() == [1, 2, 3, 4, 1, 0, 0, 0]


@pytest.mark.parametrize("form", [str, lambda name: name.replace(".", "_")])
def test_a_vector_has_the_components_of_the_fmu_in_either_form_of_its_name(form):
    scene = box(plane=[{"name": "a", "motion": "input"}], stop_time=0.02)
    given = {form("plane.a.point"): (0.0, 0.1, -0.2)}
    for source in (given, lambda _time: given):
        assert [simulate(scene, inputs=source).inputs[f"plane.a.point.{c}"][0] for c in "xyz"] == [0.0, 0.1, -0.2]
    with pytest.raises(FmuError, match=rf"inputs: {form('plane.a.point')}: wanted 3 numbers, got \(0, 0, 1, 1\)"):
        simulate(scene, inputs={form("plane.a.point"): (0, 0, 1, 1)})


def test_a_data_frame_goes_by_its_time_or_its_index():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"load.a.x": [1, 3]}, index=[0.0, 1.0])
    for source in (frame, frame.rename_axis("time").reset_index(), frame.assign(time=[0.0, 1.0])[["load.a.x", "time"]]):
        inputs = Inputs(source)
        assert inputs.names == ["load.a.x"] and inputs.values(0.25, 0.3)[0] == 1.5
    for index in (["a", "b"], [1.0, 0.0], [0.0, float("nan")]):
        with pytest.raises(FmuError, match=r"inputs: .*wanted a column of numbers|must not decrease|wanted a finite number"):
            Inputs(frame.set_index(pandas.Index(index)))


@pytest.mark.parametrize("split", [7, 50])
def test_a_column_of_a_tunable_parameter_sets_it_when_it_changes_and_only_then(tmp_path, split):
    """To the bit as a host does that sets it between two steps: setting a stiffness anew may change how the steps are taken."""
    scene, step = load_scene("press"), 0.01
    course = table(time=step * np.arange(split + 20), **{"stiffness.edge": np.where(np.arange(split + 20) < split, 1e3, 400.0)})
    result = simulate(scene, inputs=course, stop_time=course["time"][-1], open_end=True)
    with Simulation(scene) as host:
        for n in range(len(course) - 1):
            if n == split:
                host["stiffness.edge"] = 400.0
            host.step(step, end=course["time"][n + 1])
        assert (host.positions == result.positions[-1]).all()


def test_a_value_that_a_tunable_parameter_refuses_is_told_with_its_file_and_time(tmp_path):
    (tmp_path / "soft.csv").write_text("time,stiffness.edge\n0,1000\n0.05,-2000\n")
    with pytest.raises(FmuError, match=r"soft\.csv: at 0\.05 s: .*stiffness\.edge: wanted >= 0 N/m, got -2000"):
        simulate("press", stop_time=0.1, inputs=tmp_path / "soft.csv")


def test_a_parameter_in_the_first_row_is_a_start_value():
    course = table(time=[0.0, 0.1], **{"stiffness.edge": [400.0, 400.0]})
    result = simulate("press", inputs=course, stop_time=0.1)
    assert result.parameters["stiffness.edge"] == 400.0
    assert (result.positions == simulate("press", inputs={}, start_values={"stiffness.edge": 400.0}, stop_time=0.1).positions).all()


FIXED = "wanted an input or a tunable parameter of the FMU, got its fixed parameter"


@pytest.mark.parametrize(
    "name, given, words",
    [("mass", {}, FIXED), ("solver.tolerance", {}, FIXED), ("stiffness.edge", {"stiffness.edge": 1.0}, "comes from here over time")],
)
def test_columns_of_fixed_parameters_and_start_values_that_a_column_gives_are_refused(name, given, words):
    with pytest.raises(FmuError, match=rf"{name}:? {words}"):
        simulate("press", inputs=table(time=[0.0, 1.0], **{name: [1.0, 2.0]}), start_values=given, stop_time=0.1)
