"""An FMU of FMI 3.0 as this package's host sees it: the scalars of FMI 2.0 in the place of its arrays.

The library answers to both standards whatever the description says, so the host speaks to it as it always does.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from softffd.fmu.arrays import OF_POINTS, TIME
from softffd.fmu.interface import Interface, ScalarVariable, read_interface
from softffd.fmu.model_description3 import KINDS
from softffd.fmu.records import read_points
from softffd.fmu.values import listed_values
from softffd.installed import table
from softffd.names import ByName, variable_names


def read_interface3(description: Any, resources: Path) -> Interface:
    """The interface from fmpy's reading of the modelDescription.xml of an FMU of this package (FMI 3.0)."""
    plain = read_interface(description).plain
    arrays = [array for array in description.modelVariables if array.valueReference != TIME]
    scalars = (scalar for array in arrays for scalar in _scalars(array, resources, plain))
    variables = ByName({scalar.name: scalar for scalar in scalars})
    return replace(read_interface(description), variables=variables, interpolates=True, saves=True, serializes=True)


def _scalars(array: Any, resources: Path, plain: bool) -> list[ScalarVariable]:
    """In the order of their value references, which for control points is that of the scene's list and not of the array."""
    family = next(family for family in table()["family"] if family["id"] == array.valueReference >> 24)
    if family["part"] in OF_POINTS:
        names = variable_names(family["key"], read_points(resources, family["part"]), plain=plain)
    else:
        names = [f"{array.name}.{component}" for component in family["components"]] if array.dimensions else [array.name]
    kind = next(kind for kind, word in KINDS.items() if word == array.type)
    starts: list[Any] = [float(word) if kind == "Real" else int(word) for word in (array.start or "").split()] or [None]
    items = listed_values(array.description) if family.get("named") else None
    return [
        ScalarVariable(
            name, array.valueReference + n, kind, array.causality, array.variability, starts[n % len(starts)], array.unit,
            array.description, items,
        )
        for n, name in enumerate(names)
    ]  # fmt: skip
