"""Inputs that are given as Python has them: constants by name, and the tables of pandas and its like."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from softffd.errors import FmuError

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
