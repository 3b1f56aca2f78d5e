"""Numbers of lattice cells along each axis: computed from the box, and limited to what springs with a modulus or a solid can have."""

import math
from collections.abc import Callable, Sequence

MOST = 31  # cells along an axis
PATCH = 3  # cells along an axis of a patch of a solid
LONGEST, FLATTEST = math.sqrt(1.5), math.sqrt(2)
"""Largest ratio of sides of a cell with springs: one side to the other two (LONGEST), two sides to the third (FLATTEST)."""
SLENDER, SLENDER_PATCH = 2.5, 4.0
"""Largest ratio of two sides of a cell of a solid, and of a solid that has a single patch (SLENDER_PATCH)."""
WIDEST = 400
"""Most points across the longest axis of a solid for which there are matrices (fmu_src/core/matrix/lattice_matrix.hpp)."""
Fits = Callable[[Sequence[float], Sequence[int]], bool]  # (sides of the box [m], cells per axis): can a body have these cells?


def cells_of(cells: int | None, spacing: float | None, size: Sequence[float], multiple: int = 1) -> tuple[int, ...]:
    """Returns the number of cells along each axis of a box of sides `size` [m]; the cells are nearly cubic.

    cells: number along the longest side; if it is None, spacing [m] is the edge of a cell. All numbers are multiples of `multiple`.
    """
    groups = cubic_along(size, _nearest(cells / multiple)) if cells is not None else cubic(size, multiple * (spacing or 0.0))
    return tuple(multiple * count for count in groups)


def cubic(size: Sequence[float], spacing: float) -> tuple[int, ...]:
    """Returns the cells per axis that are nearest to cubes of edge `spacing` [m] in a box of sides `size` [m]; may exceed MOST."""
    return tuple(_nearest(side / spacing) if side < 1e9 * spacing else 10**9 for side in size)


def cubic_along(size: Sequence[float], longest: int) -> tuple[int, ...]:
    """Returns the cells per axis that are nearest to cubes, with `longest` cells along the longest side."""
    return cubic(size, max(size) / longest)


def across_longest(points: Sequence[int]) -> int:
    """Returns the number of points in a lattice plane perpendicular to the axis with the most points."""
    return math.prod(points) // max(points)


def _nearest(cells: float) -> int:
    """Returns the whole number >= 1 whose ratio to `cells` is nearest to 1."""
    fewer = max(1, math.floor(cells))
    return fewer if cells * cells < fewer * (fewer + 1) else fewer + 1


def fit_springs(size: Sequence[float], cells: Sequence[int]) -> bool:
    """True if springs of stiffness >= 0 can model an isotropic body with these cells: a^2 / b^2 + a^2 / c^2 <= 3 for every cell side a."""
    sides = [side / max(size) / count for side, count in zip(size, cells, strict=True)]
    squares = [max(side / max(sides), 1e-100) ** 2 for side in sides]
    return all(square * sum(1 / other for other in squares) <= 4 * (1 + 1e-9) for square in squares)


def fit_solid(size: Sequence[float], cells: Sequence[int]) -> bool:
    """True if a solid with these cells is accurate: the ratio of two cell sides is at most SLENDER, for a single patch SLENDER_PATCH."""
    sides = [side / max(size) / count for side, count in zip(size, cells, strict=True)]
    return max(sides) <= (SLENDER_PATCH if max(cells) == PATCH else SLENDER) * (1 + 1e-9) * min(sides)


def nearest_fit(size: Sequence[float], cells: Sequence[int], fits: Fits, multiple: int = 1) -> tuple[int, ...] | None:
    """Returns cells per axis that satisfy `fits`, are close in number to `cells` and nearly cubic, and are multiples of `multiple`.

    Returns None if no cells with at most MOST along the longest side fit.
    """

    def away(found: Sequence[int]) -> float:
        sides = [side / max(size) / count for side, count in zip(size, found, strict=True)]
        return sum(abs(math.log(new / old)) for new, old in zip(found, cells, strict=True)) + 1.5 * math.log(max(sides) / min(sides))

    candidates = [found for most in range(multiple, MOST + 1, multiple) if fits(size, found := cells_of(most, None, size, multiple))]
    return min(candidates, key=away, default=None)
