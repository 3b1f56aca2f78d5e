"""Inputs over time: a callable, a structured array as fmpy's simulate_fmu takes, or a CSV file, all read the same way."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from softffd.errors import FmuError
from softffd.motion import derived_velocities

Source = Callable[[float], Mapping[str, float]] | np.ndarray | str | Path


class Inputs:
    """Values of some input variables at any time.

    Arrays and CSV files hold a first column `time` [s], not decreasing, and one column per variable; between rows values are linear,
    before the first and after the last row they are held. A plane or pin whose pose is given but whose
    velocity is not gets the velocity that takes it to the pose of the next communication point.
    """

    def __init__(self, source: Source | None):
        self._at = _reader(source)
        self.names = list(self._at(0.0)) if source is not None else []

    def values(self, time: float, step: float) -> np.ndarray:
        """Values at a communication point, in the order of `names` and then of `derived_names`."""
        now = self._at(time)
        derived = derived_velocities(now, self._at(time + step), step) if step > 0 else {}
        return np.array([*(now[name] for name in self.names), *(derived.get(name, 0.0) for name in self.derived_names)])

    def rates(self, time: float, step: float) -> np.ndarray:
        """Slopes from a communication point to the next, `step` > 0 s later, in the order of `names` [unit per s]."""
        now, then = self._at(time), self._at(time + step)
        return np.array([(then[name] - now[name]) / step for name in self.names])

    @property
    def derived_names(self) -> list[str]:
        """Velocities that follow from given poses."""
        if not self.names:
            return []
        now = self._at(0.0)
        return list(derived_velocities(now, now, 1.0))


def _reader(source: Source | None) -> Callable[[float], Mapping[str, float]]:
    if source is None:
        return lambda time: {}
    if callable(source):
        return source
    table = source if isinstance(source, np.ndarray) else read_csv(Path(source))
    return _interpolation(table)


def _interpolation(table: np.ndarray) -> Callable[[float], Mapping[str, float]]:
    names = table.dtype.names
    if not names or names[0] != "time":
        raise FmuError("inputs: wanted a structured array whose first field is `time`")
    times = table["time"]
    if np.any(np.diff(times) < 0):
        raise FmuError("inputs: the times must not decrease")
    return lambda time: {name: float(np.interp(time, times, table[name])) for name in names[1:]}


def read_csv(path: Path) -> np.ndarray:
    """A structured array (rows,) from a CSV file with a header line; FmuError says which line is wrong and why."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise FmuError(f"{path}: cannot be read: {error}") from None
    rows = list(csv.reader(line for line in text.splitlines() if line.strip() and not line.startswith("#")))
    if len(rows) < 2:
        raise FmuError(f"{path}: wanted a header line (time, names of inputs) and at least one row of numbers")
    names = [name.strip() for name in rows[0]]
    if names[0] != "time" or len(names) < 2 or len(set(names)) != len(names):
        raise FmuError(f"{path}: wanted a header of `time` and names of inputs, each once, got {','.join(names)!r}")
    table = np.zeros(len(rows) - 1, dtype=[(name, float) for name in names])
    for number, row in enumerate(rows[1:]):
        table[number] = _numbers(path, names, number + 1, row)
    return table


def _numbers(path: Path, names: list[str], number: int, row: list[str]) -> tuple[float, ...]:
    if len(row) != len(names):
        raise FmuError(f"{path}: row {number}: wanted {len(names)} numbers as in the header, got {len(row)}")
    numbers: list[Any] = []
    for name, word in zip(names, row, strict=True):
        try:
            numbers.append(float(word))
        except ValueError:
            raise FmuError(f"{path}: row {number}, {name}: wanted a number, got {word.strip()!r}") from None
        if not np.isfinite(numbers[-1]):
            raise FmuError(f"{path}: row {number}, {name}: wanted a finite number, got {word.strip()!r}")
    return tuple(numbers)
