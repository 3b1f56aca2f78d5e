"""Measured columns from files, arrays, DataFrames and dicts, and what is wrong with them."""

import numpy as np
import pandas as pd
import pytest

from softffd import SoftffdError
from softffd.fitting.measured import columns_of

TABLE = np.array([(0.0, 1.0), (0.5, 2.0)], dtype=[("time", float), ("plane.press.reaction.z", float)])


def test_each_kind_of_table_gives_the_same_columns(tmp_path):
    (tmp_path / "data.csv").write_text("# of a press\ntime, plane_press_reaction_z\n0, 1\n0.5, 2\n")
    frame = pd.DataFrame({name: TABLE[name] for name in TABLE.dtype.names})
    for data in (tmp_path / "data.csv", TABLE, frame, {name: TABLE[name].tolist() for name in TABLE.dtype.names}):
        found = columns_of(data)
        assert {name: column.tolist() for name, column in found.values.items()} == {"time": [0, 0.5], "plane.press.reaction.z": [1, 2]}


@pytest.mark.parametrize(
    "data, words",
    [
        ({"time": [0, 1], "f": [1, np.nan]}, "data: row 1, f: wanted a finite number, got nan"),
        ({"time": [0, 1], "f": [1]}, "data: wanted columns of one length, got time 2, f 1"),
        ({"time": [1, 0], "f": [1, 2]}, "data: row 1: the times must not decrease"),
        ({"f": ["a", "b"]}, "data: f: wanted a column of numbers"),
        ({}, "data: wanted a CSV file"),
        (3, "data: wanted a CSV file"),
    ],
)
def test_what_is_wrong_is_told(data, words):
    with pytest.raises(SoftffdError, match=words):
        columns_of(data)


@pytest.mark.parametrize(
    "text, words",
    [
        ("x;f\n1;2\n", "wanted a header of names, each once, separated by commas, got semicolons"),
        ("x\n1\n", "wanted a header of names, each once, separated by commas, got 'x' only"),
        ("x,f\n", r"wanted a header line \(names\) and at least one row"),
        ("f,time\n1,1\n2,0\n", "line 3: the times must not decrease, got 0 after 1"),
    ],
)
def test_a_file_is_read_as_inputs_are_but_needs_no_time(text, words, tmp_path):
    (tmp_path / "data.csv").write_text(text)
    with pytest.raises(SoftffdError, match=words):
        columns_of(tmp_path / "data.csv")
