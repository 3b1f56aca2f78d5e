"""What inputs are given as: constants by name, a DataFrame, a CSV file."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from softffd.errors import FmuError
from softffd.spelling import did_you_mean, nearest_of, number_in

COMPONENTS = {3: "xyz", 4: "wxyz"}
"""Of vectors and quaternions, by how many numbers there are."""


def constants(given: Mapping[str, Any], where: str = "inputs: ") -> dict[str, float]:
    """Numbers by the names of single variables; a vector goes by the name that its components share. FmuError, which begins with `where`,
    for anything else."""
    numbers: dict[str, float] = {}
    for name, value in given.items():
        if isinstance(value, float) and math.isfinite(value):
            numbers[name] = value
            continue
        try:
            values = np.asarray(math.nan if isinstance(value, str | bytes) else value, dtype=float)
        except (TypeError, ValueError):
            values = np.array(math.nan)
        if not np.isfinite(values).all():
            raise FmuError(f"{where}{name}: wanted a finite number or a vector of them, got {value!r:.70}")
        if values.ndim == 0:
            numbers[str(name)] = float(values)
        elif values.ndim == 1 and (components := COMPONENTS.get(len(values))):
            numbers |= {f"{name}.{c}": float(v) for c, v in zip(components, values, strict=True)}
        else:
            raise FmuError(f"{where}{name}: wanted a number or a vector of 3 (of 4 for an orientation), got the shape {values.shape}")
    return numbers


def is_data_frame(source: object) -> bool:
    """Whether this is a DataFrame, without loading the package that it is of."""
    return hasattr(source, "columns") and hasattr(source, "to_numpy")


def table_of(frame: Any) -> np.ndarray:
    """A DataFrame as a structured array: its column `time`, else its index, and then its other columns."""
    columns = {str(name): np.asarray(frame[name]) for name in frame.columns}
    time = columns.pop("time", None)
    if time is None:
        if not hasattr(frame, "index"):
            raise FmuError("inputs: wanted a column `time` in the DataFrame, got none")
        time = np.asarray(frame.index)
    columns = {"time": time, **columns}
    table = np.zeros(len(time), dtype=[(name, values.dtype) for name, values in columns.items()])
    for name, values in columns.items():
        table[name] = values
    return table


SEPARATORS = {";": "semicolons", "\t": "tabs"}
"""What other programs put where a comma is wanted."""


def read_csv(path: Path) -> np.ndarray:
    """A structured array (rows,) from a CSV file: a header line of `time` and names of inputs, then rows of numbers, times not decreasing.

    Empty lines and lines that begin with # are passed over. FmuError says which line is wrong and why.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise FmuError(f"{path}: cannot be read: {error}") from None
    rows = [(f"{path}: line {n}", _words(path, n, line)) for n, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(rows) < 2:
        raise FmuError(f"{path}: wanted a header line (time, names of inputs) and at least one row of numbers")
    names = _header(*rows[0])
    table = np.zeros(len(rows) - 1, dtype=[(name, float) for name in names])
    for number, (where, words) in enumerate(rows[1:]):
        table[number] = _numbers(where, names, words)
        if number and table["time"][number] < table["time"][number - 1]:
            raise FmuError(f"{where}: the times must not decrease, got {words[0].strip()} after {table['time'][number - 1]:g}")
    return table


def _words(path: Path, number: int, line: str) -> list[str]:
    try:
        return [word.strip() for word in next(csv.reader([line]))]
    except csv.Error as error:
        raise FmuError(f"{path}: line {number}: is no line of a CSV file: {error}") from None


def _header(where: str, names: list[str]) -> list[str]:
    wanted = f"{where}: wanted a header of `time` and names of inputs, each once, separated by commas"
    if len(names) == 1 and (separator := next((each for each in SEPARATORS if each in names[0]), None)):
        raise FmuError(f"{wanted}, got {SEPARATORS[separator]} between them")
    if names[0] != "time":
        hint = "; `time` must be the first" if "time" in names else did_you_mean(nearest_of(names[0], ["time"]))
        raise FmuError(f"{wanted}, got {names[0]!r} as the first name{hint}")
    if len(names) < 2:
        raise FmuError(f"{wanted}, got no name of an input")
    if "" in names:
        ends = ": the line ends with a comma" if names.index("") == len(names) - 1 else ""
        raise FmuError(f"{wanted}, got column {names.index('') + 1} without a name{ends}")
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise FmuError(f"{wanted}, got {twice!r} again")
    return names


def _numbers(where: str, names: list[str], words: list[str]) -> tuple[float, ...]:
    if len(words) != len(names):
        ends = "" if words[-1] else ", for the line ends with a comma"
        raise FmuError(f"{where}: wanted {len(names)} numbers as in the header, got {len(words)}{ends}")
    numbers: list[float] = []
    for name, word in zip(names, words, strict=True):
        try:
            numbers.append(number_in(word))
        except ValueError:
            raise FmuError(f"{where}, {name}: wanted a number, got {word[:70]!r}") from None
        if not math.isfinite(numbers[-1]):
            raise FmuError(f"{where}, {name}: wanted a finite number, got {word!r}")
    return tuple(numbers)
