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
        self._takes_bends = [name.startswith(("force[", "load.")) for name in self.names]

    def values(self, time: float, step: float) -> np.ndarray:
        """Values at a communication point, in the order of `names` and then of `derived_names`."""
        now = self._at(time)
        derived = derived_velocities(now, self._at(time + step), step) if step > 0 else {}
        return np.array([*(now[name] for name in self.names), *(derived.get(name, 0.0) for name in self.derived_names)])

    def rates(self, time: float, step: float) -> np.ndarray:
        """Slopes from a communication point to the next, `step` > 0 s later, in the order of `names` [unit / s]."""
        return self._slopes(time, time + step)

    def bends(self, time: float, step: float) -> np.ndarray:
        """First to third derivatives at `time` of what goes from a communication point to the next, `step` > 0 s later: (3, names)
        [unit / s, unit / s2, unit / s3]. Forces and loads: cubics whose slopes are continuous and which rise and fall where the values
        do (Fritsch, Carlson 1980), so that nothing overshoots a jump. Others, of which the FMU takes the first derivative only: linear."""
        mean = self._slopes(time, time + step)
        begin, end = self._slope_at(time, step), self._slope_at(time + step, step)
        cubic = np.array([begin, 2 * (3 * mean - 2 * begin - end) / step, 6 * (begin + end - 2 * mean) / step**2])
        return np.where(self._takes_bends, cubic, [mean, 0 * mean, 0 * mean])

    def _slopes(self, time: float, then: float) -> np.ndarray:
        first, last = self._at(time), self._at(then)
        return np.array([(last[name] - first[name]) / (then - time) for name in self.names])

    def _slope_at(self, time: float, step: float) -> np.ndarray:
        """Of the values; limited so that the cubics on both sides follow them. Nothing is asked for before time 0."""
        near, after = step / 256, self._slopes(time, time + step)
        before = self._slopes(time - step, time) if time >= step else after
        slope = self._slopes(max(time - near, 0.0), time + near)
        most = np.where(before * after > 0, 3 * np.minimum(abs(before), abs(after)), 0.0)
        return np.clip(slope, -most, most)

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
