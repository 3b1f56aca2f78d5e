"""Selections: the ways in which a scene file names a set of control points.

A selection is `"all"`, `"none"`, a face `"x-" "x+" "y-" "y+" "z-" "z+"`, a list of indices `[[i, j, k], ...]`, or inclusive ranges
`{ i = [0, 1], j = [2, 3] }`, in which an absent axis means all its indices. Indices start at 0, as p_ijk in Xia & Wang 2009, eq. (1).
"""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, Strict, Tag

from softffd.lattice import index_grid
from softffd.scene.section import Section, holding, key, list_of, list_schema, one_of

FACES = {f"{'xyz'[axis]}{side}": (axis, end) for axis in range(3) for side, end in (("-", 0), ("+", -1))}

Word = Literal["all", "none", "x-", "x+", "y-", "y+", "z-", "z+"]
Index = Annotated[int, Strict(), Field(ge=0)]
Triple = Annotated[tuple[Index, Index, Index], list_of(3, "3 whole numbers [i, j, k]"), list_schema(3, type="integer", minimum=0)]


Range = Annotated[
    tuple[Index, Index], list_of(2, "2 whole numbers [first, last]"),
    holding(lambda ends: ends[0] <= ends[1], "[first, last] with first <= last"), list_schema(2, type="integer", minimum=0),
]  # fmt: skip


class Ranges(Section):
    """Inclusive index ranges per axis; an absent axis means all of it."""

    i: Range | None = key(None, "first and last index along x, both included; absent: all")
    j: Range | None = key(None, "first and last index along y, both included; absent: all")
    k: Range | None = key(None, "first and last index along z, both included; absent: all")


Selection = Annotated[
    Annotated[Word, Tag("<word>")] | Annotated[tuple[Triple, ...], Tag("<list>")] | Annotated[Ranges, Tag("<ranges>")],
    one_of(
        {"<word>": str, "<list>": list | tuple, "<ranges>": dict | Ranges},
        '"all", "none", a face such as "z-", [[i, j, k], ...] or { i = [first, last] }',
    ),
]


def flat_indices(selection: Selection, counts: tuple[int, int, int]) -> np.ndarray:
    """Returns the flat indices (lattice.py) of a selection, (m,) int64: those of a list in the order of the list, others ascending.

    `counts` are the control points per axis.
    Raises ValueError if the selection leaves the lattice or names a point twice.
    """
    grid = index_grid(counts)
    if isinstance(selection, Ranges):
        return _range_indices(selection, grid)
    if isinstance(selection, tuple):
        return _list_indices(selection, grid)
    if selection in FACES:
        axis, position = FACES[selection]
        return np.sort(grid.take(position, axis=axis), axis=None)
    return np.sort(grid, axis=None) if selection == "all" else np.empty(0, np.int64)


def _range_indices(ranges: Ranges, grid: np.ndarray) -> np.ndarray:
    slices = []
    for axis, count in zip("ijk", grid.shape, strict=True):
        first, last = getattr(ranges, axis) or (0, count - 1)
        if last >= count:
            raise ValueError(f"{_inside(grid.shape)}, got {axis} = [{first}, {last}]")
        slices.append(slice(first, last + 1))
    return np.sort(grid[tuple(slices)], axis=None)


def _list_indices(points: tuple[tuple[int, int, int], ...], grid: np.ndarray) -> np.ndarray:
    outside = [point for point in points if any(np.greater_equal(point, grid.shape))]
    if outside:
        raise ValueError(f"{_inside(grid.shape)}, got {', '.join(str(list(point)) for point in outside)}")
    if len(set(points)) < len(points):
        twice = next(point for n, point in enumerate(points) if point in points[:n])
        raise ValueError(f"wanted each control point once, got {list(twice)} again")
    return np.array([grid[point] for point in points], dtype=np.int64)


def _inside(counts: tuple[int, ...]) -> str:
    limits = ", ".join(f"{axis} 0..{count - 1}" for axis, count in zip("ijk", counts, strict=True))
    return f"wanted control points of the {' x '.join(map(str, counts))} lattice ({limits})"
