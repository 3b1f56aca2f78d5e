"""A result as the tables of other packages: a DataFrame of pandas, a Dataset of xarray."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import SoftffdError
from softffd.names import parse_name, stem, unit_of
from softffd.run.points import places

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from softffd.run.result import Result

POINTS = ("time", "i", "j", "k", "axis")
"""Dimensions of what there is at control points."""


def data_frame(result: Result) -> pd.DataFrame:
    """Outputs, positions among them, and inputs in columns by variable name; the index is the time [s]."""
    pandas = package("pandas", "to_dataframe", "dataframes")
    return pandas.DataFrame({**result.columns(), **result.inputs}, index=pandas.Index(result.time, name="time"))


def dataset(result: Result) -> xr.Dataset:
    """The same with vectors as one array each, (time, axis), those at control points (time, i, j, k, axis); parameters are attributes."""
    xarray = package("xarray", "to_xarray", "datasets")
    arrays: dict[str, Any] = {"position": (POINTS, result.positions, {"units": "m"})}
    values = {**result.outputs, **result.inputs}
    for name, members in _together(values).items():
        dimensions, array = _array(members, values, result.positions.shape)
        arrays[name] = (dimensions, array, {"units": unit_of(members[0])})
    coordinates = {"time": ("time", result.time, {"units": "s"}), "axis": list("xyz")}
    return xarray.Dataset(arrays, coordinates, {"title": result.title, **result.parameters})


def package(name: str, method: str, extra: str) -> Any:
    """An optional package, for a method of this name; SoftffdError tells the extra where it is missing."""
    try:
        return import_module(name)
    except ImportError:
        raise SoftffdError(f"{method} needs {name}, which is not installed here: pip install 'softffd[{extra}]'") from None


def _together(names: Iterable[str]) -> dict[str, list[str]]:
    """Names of variables that make one array, by its name: those of a family at control points, and the x, y and z of a vector."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(stem(name), []).append(name)
    arrays: dict[str, list[str]] = {}
    for name, members in groups.items():
        whole = _at_points(members[0]) or len(members) == 3
        arrays |= {name.removesuffix("[i,j,k]"): members} if whole else {member: [member] for member in members}
    return arrays


def _at_points(name: str) -> bool:
    found = parse_name(name)
    return found is not None and found.at_point


def _array(members: list[str], values: dict[str, np.ndarray], shape: tuple[int, ...]) -> tuple[tuple[str, ...], np.ndarray]:
    """Dimensions and values; NaN at control points that are not there."""
    columns = np.stack([values[name] for name in members], axis=1)
    if not _at_points(members[0]):
        return (("time", "axis"), columns) if len(members) == 3 else (("time",), columns[:, 0])
    whole = np.full((len(columns), *shape[1:]), np.nan)
    whole[:, *places(members).T] = columns
    return POINTS, whole
