"""Tables of other programs: inputs from a CSV file or a DataFrame of pandas, and a run as DataFrame or as Dataset of xarray."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import FmuError, SoftffdError
from softffd.names import stem, unit_of
from softffd.run.parts import at_point, places
from softffd.spelling import did_you_mean, nearest_of, number_in

if TYPE_CHECKING:
    import xarray as xr

POINTS = ("time", "i", "j", "k", "axis")  # dimensions of arrays at control points
SEPARATORS = {";": "semicolons", "\t": "tabs"}  # separators that other programs write instead of commas


# ---- input ----


def is_data_frame(source: object) -> bool:
    """True if the source is a DataFrame; the package of the DataFrame is not loaded for the test."""
    return hasattr(source, "columns") and hasattr(source, "to_numpy")


def structured_array(columns: Mapping[str, np.ndarray]) -> np.ndarray:
    """Returns columns (rows,) by name as a structured array (rows,)."""
    table = np.zeros(len(next(iter(columns.values()))), dtype=[(name, values.dtype) for name, values in columns.items()])
    for name, values in columns.items():
        table[name] = values
    return table


def table_of(frame: Any) -> np.ndarray:
    """Returns a DataFrame as a structured array: its column `time`, else its index, and then its other columns."""
    columns = {str(name): np.asarray(frame[name]) for name in frame.columns}
    time = columns.pop("time", None)
    if time is None:
        if not hasattr(frame, "index"):
            raise FmuError("inputs: wanted a column `time` in the DataFrame, got none")
        time = np.asarray(frame.index)
    return structured_array({"time": time, **columns})


def read_csv(path: Path, *, timed: bool = True) -> np.ndarray:
    """Returns a structured array (rows,) from a CSV file: a header line of `time` and names of inputs, then rows of numbers, times not
    decreasing. Without `timed`, the header has names of any variables, with or without a time among them.

    Empty lines and lines that begin with # are skipped. FmuError says which line is wrong and why.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise FmuError(f"{path}: wanted a CSV text in UTF-8, got the byte 0x{error.object[error.start]:02x} in line {line}") from None
    except OSError as error:
        raise FmuError(f"{path}: cannot be read: {error.strerror or error}") from None
    rows = [(f"{path}: line {n}", _words(path, n, line)) for n, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(rows) < 2:
        raise FmuError(f"{path}: wanted a header line ({'time, names of inputs' if timed else 'names'}) and at least one row of numbers")
    names = _header(*rows[0], timed)
    table = np.array([_numbers(where, names, words) for where, words in rows[1:]], dtype=[(name, float) for name in names])
    require_course(table, [where for where, _ in rows[1:]])
    return table


def require_course(table: np.ndarray, what: str | list[str]) -> None:
    """Raises FmuError if a column of a structured array has a number that is not finite, or if the times decrease. what: the name of
    the array in messages, or a name for each row."""
    called = (lambda row: f"{what}: row {row}") if isinstance(what, str) else what.__getitem__
    names = table.dtype.names or ()
    for name in names:
        if len(wrong := np.flatnonzero(~np.isfinite(table[name]))):
            raise FmuError(f"{called(wrong[0])}, {name}: wanted a finite number, got {table[name][wrong[0]]}")
    if "time" in names and len(wrong := np.flatnonzero(np.diff(table["time"].astype(float)) < 0)):
        before, after = table["time"][wrong[0] : wrong[0] + 2]
        raise FmuError(f"{called(wrong[0] + 1)}: the times must not decrease, got {after:g} after {before:g}")


def checked(table: np.ndarray) -> np.ndarray:
    """Returns the structured array itself if it can be inputs over time; raises FmuError otherwise."""
    names = table.dtype.names
    if not names or names[0] != "time":
        raise FmuError(f"inputs: wanted a structured array whose first field is `time`, got {f'fields {names}' if names else table.dtype}")
    if len(table.shape) != 1 or not len(table):
        raise FmuError(f"inputs: wanted a structured array (rows,) of at least one row, got the shape {table.shape}")
    for name in names:
        if table[name].shape != table.shape or table[name].dtype.kind not in "fiu":
            raise FmuError(f"inputs: {name}: wanted a column of numbers, got {table.dtype[name]}")
    require_course(table, "inputs")
    return table


def _words(path: Path, number: int, line: str) -> list[str]:
    try:
        return [word.strip() for word in next(csv.reader([line]))]
    except csv.Error as error:
        raise FmuError(f"{path}: line {number}: is no line of a CSV file: {error}") from None


def _header(where: str, names: list[str], timed: bool) -> list[str]:
    wanted = f"{where}: wanted a header of {'`time` and names of inputs' if timed else 'names'}, each once, separated by commas"
    if len(names) == 1 and (separator := next((each for each in SEPARATORS if each in names[0]), None)):
        raise FmuError(f"{wanted}, got {SEPARATORS[separator]} between them")
    if timed and names[0] != "time":
        hint = "; `time` must be the first" if "time" in names else did_you_mean(nearest_of(names[0], ["time"]))
        raise FmuError(f"{wanted}, got {names[0]!r} as the first name{hint}")
    if len(names) < 2:
        raise FmuError(f"{wanted}, got {'no name of an input' if timed else names[0]!r}{'' if timed else ' only'}")
    if "" in names:
        ends = ": the line ends with a comma" if names.index("") == len(names) - 1 else ""
        raise FmuError(f"{wanted}, got column {names.index('') + 1} without a name{ends}")
    if cut := next((name for name in names if "[" in name and "]" not in name), None):
        raise FmuError(f'{wanted}, got {cut!r}: a name with commas in it stands between quotation marks, "force[0,0,1].z"')
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
    return tuple(numbers)


# ---- output ----


def package(name: str, method: str, extra: str) -> Any:
    """Returns an optional package, for a method of this name; SoftffdError names the extra to install if the package is missing."""
    try:
        return import_module(name)
    except ImportError:
        raise SoftffdError(f"{method} needs {name}, which is not installed here: pip install 'softffd[{extra}]'") from None


def dataset(time: np.ndarray, positions: np.ndarray, values: Mapping[str, np.ndarray], attributes: Mapping[str, Any]) -> xr.Dataset:
    """Returns a run as a Dataset: each vector is one array (time, axis), at control points (time, i, j, k, axis), as the positions are."""
    xarray = package("xarray", "to_xarray", "datasets")
    arrays: dict[str, Any] = {"position": (POINTS, positions, {"units": "m"})}
    for name, members in _together(values).items():
        dimensions, array = _array(members, values, positions.shape)
        arrays[name] = (dimensions, array, {"units": unit_of(members[0])})
    return xarray.Dataset(arrays, {"time": ("time", time, {"units": "s"}), "axis": list("xyz")}, attributes)


def _together(names: Iterable[str]) -> dict[str, list[str]]:
    """Returns names of variables that make one array, by its name: those of a family at control points, and the x, y and z of a vector."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(stem(name), []).append(name)
    arrays: dict[str, list[str]] = {}
    for name, members in groups.items():
        whole = at_point(members[0]) or len(members) == 3
        arrays |= {name.removesuffix("[i,j,k]"): members} if whole else {member: [member] for member in members}
    return arrays


def _array(members: list[str], values: Mapping[str, np.ndarray], shape: tuple[int, ...]) -> tuple[tuple[str, ...], np.ndarray]:
    """Returns dimensions and values of an array; NaN at control points without such a variable."""
    columns = np.stack([values[name] for name in members], axis=1)
    if not at_point(members[0]):
        return (("time", "axis"), columns) if len(members) == 3 else (("time",), columns[:, 0])
    whole = np.full((len(columns), *shape[1:]), np.nan)
    whole[:, *places(members).T] = columns
    return POINTS, whole
