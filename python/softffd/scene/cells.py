"""How many cells a lattice has along each axis: counts that follow the box, and cells that springs of a modulus or a solid can have."""

import math
from collections.abc import Callable, Sequence

MOST = 31  # cells along an axis
PATCH = 3  # cells along an axis of a solid's patch
LONGEST, FLATTEST = math.sqrt(1.5), math.sqrt(2)
"""How many times longer a cell of springs may be in one direction than in the other two, and in two than in the third."""
SLENDER, SLENDER_PATCH = 2.5, 4.0
"""How many times longer a cell of a solid may be in one direction than in another; those of a single patch"""
WIDEST = 400
"""Points across the longest axis of a solid for which there are matrices (fmu_src/core/matrix/lattice_matrix.hpp)"""
Fits = Callable[[Sequence[float], Sequence[int]], bool]  # whether a body can have so many cells in a box of these sides [m]


def cells_of(cells: int | None, spacing: float | None, size: Sequence[float], multiple: int = 1) -> tuple[int, ...]:
    """Cells along each axis of a box of these sides [m] as a lattice's `cells` along the longest, else its `spacing` [m], ask for.

    multiple: of how many they are multiples.
    """
    groups = cubic_along(size, _nearest(cells / multiple)) if cells is not None else cubic(size, multiple * (spacing or 0.0))
    return tuple(multiple * count for count in groups)


def cubic(size: Sequence[float], spacing: float) -> tuple[int, ...]:
    """Cells along each axis, as nearly cubes of side `spacing` [m] as a box of these sides [m] allows; may be more than MOST."""
    return tuple(_nearest(side / spacing) if side < 1e9 * spacing else 10**9 for side in size)


def cubic_along(size: Sequence[float], longest: int) -> tuple[int, ...]:
    """The same with this number of cells along the longest side."""
    return cubic(size, max(size) / longest)


def across_longest(points: Sequence[int]) -> int:
    """Points of a plane across the axis with the most of them."""
    return math.prod(points) // max(points)


def _nearest(cells: float) -> int:
    """The whole number that a number of cells is by the smaller factor away from."""
    fewer = max(1, math.floor(cells))
    return fewer if cells * cells < fewer * (fewer + 1) else fewer + 1


def fit_springs(size: Sequence[float], cells: Sequence[int]) -> bool:
    """Whether springs of stiffness >= 0 make an isotropic body of these cells: a^2 / b^2 + a^2 / c^2 <= 3 along every axis a."""
    sides = [side / max(size) / count for side, count in zip(size, cells, strict=True)]
    squares = [max(side / max(sides), 1e-100) ** 2 for side in sides]
    return all(square * sum(1 / other for other in squares) <= 4 * (1 + 1e-9) for square in squares)


def fit_solid(size: Sequence[float], cells: Sequence[int]) -> bool:
    """Whether a solid of these cells is accurate."""
    sides = [side / max(size) / count for side, count in zip(size, cells, strict=True)]
    return max(sides) <= (SLENDER_PATCH if max(cells) == PATCH else SLENDER) * (1 + 1e-9) * min(sides)


def nearest_fit(size: Sequence[float], cells: Sequence[int], fits: Fits, multiple: int = 1) -> tuple[int, ...] | None:
    """Cells that fit, not many more or fewer than the given ones and nearly cubic; None where MOST along the longest side are not enough.

    multiple: of how many they are multiples.
    """

    def away(found: Sequence[int]) -> float:
        sides = [side / max(size) / count for side, count in zip(size, found, strict=True)]
        return sum(abs(math.log(new / old)) for new, old in zip(found, cells, strict=True)) + 1.5 * math.log(max(sides) / min(sides))

    candidates = [found for most in range(multiple, MOST + 1, multiple) if fits(size, found := cells_of(most, None, size, multiple))]
    return min(candidates, key=away, default=None)
