"""A run as the tables of other packages: a DataFrame of pandas, a Dataset of xarray."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import SoftffdError
from softffd.names import stem, unit_of
from softffd.run.parts import at_point, places

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

POINTS = ("time", "i", "j", "k", "axis")
"""Dimensions of what there is at control points."""


def data_frame(time: np.ndarray, values: Mapping[str, np.ndarray]) -> pd.DataFrame:
    """Columns (T,) by variable name; the index is the time [s]."""
    pandas = package("pandas", "to_dataframe", "dataframes")
    return pandas.DataFrame(values, index=pandas.Index(time, name="time"))


def dataset(time: np.ndarray, positions: np.ndarray, values: Mapping[str, np.ndarray], attributes: Mapping[str, Any]) -> xr.Dataset:
    """The same with vectors as one array each, (time, axis), those at control points (time, i, j, k, axis), as the positions are."""
    xarray = package("xarray", "to_xarray", "datasets")
    arrays: dict[str, Any] = {"position": (POINTS, positions, {"units": "m"})}
    for name, members in _together(values).items():
        dimensions, array = _array(members, values, positions.shape)
        arrays[name] = (dimensions, array, {"units": unit_of(members[0])})
    return xarray.Dataset(arrays, {"time": ("time", time, {"units": "s"}), "axis": list("xyz")}, attributes)


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
        whole = at_point(members[0]) or len(members) == 3
        arrays |= {name.removesuffix("[i,j,k]"): members} if whole else {member: [member] for member in members}
    return arrays


def _array(members: list[str], values: Mapping[str, np.ndarray], shape: tuple[int, ...]) -> tuple[tuple[str, ...], np.ndarray]:
    """Dimensions and values; NaN at control points that are not there."""
    columns = np.stack([values[name] for name in members], axis=1)
    if not at_point(members[0]):
        return (("time", "axis"), columns) if len(members) == 3 else (("time",), columns[:, 0])
    whole = np.full((len(columns), *shape[1:]), np.nan)
    whole[:, *places(members).T] = columns
    return POINTS, whole
