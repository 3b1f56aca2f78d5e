"""Measured data as columns by name, and the role of each column: time, inputs that drive the run, the curve to be matched."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from softffd.errors import SoftffdError, UnknownName
from softffd.fmu.component import Component
from softffd.names import structured
from softffd.run.tables import is_data_frame, read_csv, require_course, structured_array
from softffd.spelling import did_you_mean, few, nearest_of

if TYPE_CHECKING:
    import pandas as pd


Data = Union[str, Path, np.ndarray, Mapping[str, Sequence[float]], "pd.DataFrame"]


@dataclass(frozen=True)
class Columns:
    """Measured values (m,) by the names of the FMU's variables, in their units, and `time` [s]."""

    where: str  # prefix of messages about the columns
    values: dict[str, np.ndarray]

    def column(self, name: str) -> np.ndarray:
        """Returns the values of a variable. Raises UnknownName, with the nearest name, if there are none."""
        if name not in self.values:
            nearest = did_you_mean(nearest_of(name, self.values))
            raise UnknownName(f"{self.where}wanted a column {name}, got {few(list(self.values))}{nearest}")
        return self.values[name]

    def inputs(self, component: Component, kept: Iterable[str]) -> np.ndarray | None:
        """Returns the columns that are inputs of the FMU with their time, in the form that `Inputs` takes; None if there are none.

        kept: names of columns with another role. Raises FmuError for inputs without a time.
        """
        there = {structured(name) for name in component.numbers("input")}
        names = [name for name in self.values if name in there and name not in kept]
        if not names:
            return None
        return structured_array({"time": self.column("time"), **{name: self.values[name] for name in names}})

    def unused(self, component: Component, used: Iterable[str]) -> list[str]:
        """Returns the columns that are not used, each with the input whose name is nearest."""
        there = component.numbers("input")
        others = [name for name in self.values if name not in {"time", *used}]
        return [f"{name}{did_you_mean(nearest_of(name, there)) if name not in component.by_name else ''}" for name in others]


def columns_of(data: Data) -> Columns:
    """Returns the columns of a CSV file (a header of names, rows of numbers), a structured array, a DataFrame or a dict. Raises
    SoftffdError for other data, for columns of different lengths, and for values that are no finite numbers, with the row."""
    if isinstance(data, str | Path):
        table = read_csv(Path(data), timed=False)
        return Columns(f"{data}: ", {structured(name): table[name] for name in table.dtype.names or ()})
    given: Any = data
    if isinstance(data, np.ndarray):
        given = {name: data[name] for name in data.dtype.names or ()}
    elif is_data_frame(data):
        given = {str(name): given[name].to_numpy() for name in given.columns}
    if not (isinstance(given, Mapping) and given):
        raise SoftffdError(f"data: wanted a CSV file, a structured array, a DataFrame or a dict of columns, got {data!r:.70}")
    columns = {structured(str(name)): _numbers(str(name), column) for name, column in given.items()}
    if len({len(column) for column in columns.values()}) > 1:
        lengths = ", ".join(f"{name} {len(column)}" for name, column in columns.items())
        raise SoftffdError(f"data: wanted columns of one length, got {lengths}")
    require_course(structured_array(columns), "data")
    return Columns("data: ", columns)


def _numbers(name: str, column: Any) -> np.ndarray:
    try:
        values = np.asarray(column, dtype=float)
    except (TypeError, ValueError):
        values = np.zeros(())
    if values.ndim != 1 or not len(values):
        raise SoftffdError(f"data: {name}: wanted a column of numbers, got {column!r:.70}")
    return values
