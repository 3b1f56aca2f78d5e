"""Inputs over time: the three forms, and the velocities that follow from poses."""

import numpy as np
import pytest

from softffd import FmuError
from softffd.inputs import Inputs, read_csv
from softffd.motion import derived_velocities


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
        assert [inputs.values(t, 0.1)[0] for t in (0.0, 0.25, 2.0)] == pytest.approx([1.0, 1.5, 3.0])


def test_a_given_point_brings_the_velocity_that_reaches_its_next_value():
    inputs = Inputs(table(time=[0, 1], **{"plane.p.point.z": [0, 2]}))
    assert inputs.derived_names == [f"plane.p.velocity.{c}" for c in "xyz"]
    np.testing.assert_allclose(inputs.values(0.5, 0.1), [1.0, 0.0, 0.0, 2.0])


def test_a_given_velocity_is_left_alone():
    inputs = Inputs(lambda t: {"plane.p.point.z": t, "plane.p.velocity.z": 7.0})
    assert inputs.derived_names == []


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


@pytest.mark.parametrize(
    "text, message",
    [
        ("", "header line"),
        ("time,a\n", "at least one row"),
        ("t,a\n0,1\n", "wanted a header of `time`"),
        ("time,a,a\n0,1,2\n", "each once"),
        ("time,a\n0,1,2\n", "row 1: wanted 2 numbers"),
        ("time,a\n0,1\n1,x\n", "row 2, a: wanted a number, got 'x'"),
        ("time,a\n0,nan\n", "row 1, a: wanted a finite number"),
    ],
)
def test_a_faulty_file_says_where(tmp_path, text, message):
    (tmp_path / "in.csv").write_text(text)
    with pytest.raises(FmuError, match=message):
        read_csv(tmp_path / "in.csv")


def test_times_must_not_decrease():
    with pytest.raises(FmuError, match="must not decrease"):
        Inputs(table(time=[1, 0], **{"load.a.x": [1, 3]}))
