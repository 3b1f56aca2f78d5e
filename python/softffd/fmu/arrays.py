"""The variables of a scene's FMU as FMI 3.0 has them: arrays, put together from the table's families (fmu_src/fmi/variables/arrays.cpp).

    position, velocity, force    one array for all control points that the scene lists: (ni, nj, nk, 3) where they fill a box of the
                                 lattice, in ascending order, else (points, 3)
    vectors                      (3,) or (4,); of a pose that is partly input, partly parameter, a scalar each

An array has the value reference that its first element has in FMI 2.0.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.fmu.variables import families_of_one_name, has_component, parts, sizes, value_in
from softffd.lattice import Point, all_points

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

TIME = 0
"""Value reference of the independent variable; no family has the id 0."""

OF_POINTS = ("forces", "positions", "velocities")
"""Parts whose instances are control points."""


@dataclass(frozen=True)
class ArrayVariable:
    """One variable as modelDescription.xml states it."""

    name: str
    reference: int
    family: dict[str, Any]
    shape: tuple[int, ...]
    """Empty for a scalar"""
    start: tuple[float | int, ...]
    """One value for all elements, or theirs row by row; empty for outputs"""
    most: int | None
    """Greatest value allowed"""
    nominal: float | None
    description: str


def of_whole(description: str) -> str:
    """A family's description without the words that tell one component from the others."""
    for behind in ",;:":
        description = description.replace(", {c}" + behind, behind)
    return description.replace("component {c}", "components w, x, y, z").removesuffix(", {c}")


def array_variables(scene: Scene, mass: np.ndarray) -> list[ArrayVariable]:
    """All variables of a scene but time. mass: (n,) kg, the control points' masses after region overrides."""
    present, usual = parts(scene, mass), sizes(scene, mass)
    found: list[ArrayVariable] = []
    counts: Counter[str] = Counter()

    def add(family: dict[str, Any], words: dict[str, Any], shape: tuple[int, ...], components: Sequence[int]) -> None:
        """components: which of the family's there are in the last dimension, or the one that a scalar is."""
        starts = tuple(value_in(family, "start", words, each) for each in components)
        found.append(
            ArrayVariable(
                name=family["name"].format(**words),
                reference=family["id"] << 24 | counts[family["key"]],
                family=family,
                shape=shape,
                start=() if starts[0] is None else starts if len(shape) < 2 else starts[:1],
                most=value_in(family, "max", words, 0),
                nominal=value_in(family, "nominal", usual, 0),
                description=family["description"].format(**words),
            )
        )
        counts[family["key"]] += math.prod(shape)

    for families in families_of_one_name():
        components = families[0].get("components", "")
        if families[0]["part"] in OF_POINTS:
            if points := [(each["i"], each["j"], each["k"]) for each in present[families[0]["part"]]]:
                shape, which = _box(points)
                add(_of_points(families[0], which), {}, (*shape, len(components)), range(len(components)))
            continue
        for instance in present[families[0]["part"]]:
            words = [{**instance, "c": component} for component in components or " "]
            owners = [next(family for family in families if has_component(family, each)) for each in words]
            if all(owner is owners[0] for owner in owners):
                add(_whole(owners[0]), instance, (len(components),) if components else (), range(len(words)))
            else:
                for component, owner in enumerate(owners):
                    add(owner, words[component], (), [component])
    return found


def _whole(family: dict[str, Any]) -> dict[str, Any]:
    """The family's row as it is of a vector."""
    return family | {"name": family["name"].removesuffix(".{c}"), "description": of_whole(family["description"])}


def _of_points(family: dict[str, Any], which: str) -> dict[str, Any]:
    """And of all its control points."""
    description = of_whole(family["description"]).replace("control point ({i},{j},{k})", f"the control points {which}")
    return family | {"name": family["name"].partition("[")[0], "description": description}


def _box(points: list[Point]) -> tuple[tuple[int, ...], str]:
    """The shape of an array of these control points, and which they are, in words."""
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    sides = high - low + 1
    if points == [tuple(low + np.array(point)) for point in all_points(sides)]:
        ranges = (f"{axis} = {first}" + (f" to {last}" if last > first else "") for axis, first, last in zip("ijk", low, high, strict=True))
        return tuple(map(int, sides)), f"(i,j,k), {', '.join(ranges)}"
    return (len(points),), "(i,j,k) = " + ", ".join(f"({i},{j},{k})" for i, j, k in points)
