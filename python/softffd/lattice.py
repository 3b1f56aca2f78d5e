"""The lattice: its box, its grid at rest, and the one order of its control points.

A control point p_ijk (Xia & Wang 2009, eq. (1)) is the i-th along x, the j-th along y and the k-th along z, each counted from 0. Where
points are numbered, p_ijk has the flat index

    p = i + nx (j + ny k)        i runs fastest, then j, then k

    z (k)                    9---10---11
    |    y (j)              /|  /    /|
    |   /                  6---7----8 |        the indices of a 3 x 2 x 2 lattice
    |  /                   | 3 | 4  | 5
    | /                    |/  |    |/
    +------ x (i)          0---1----2

and every list, record, block of variables and file goes in this order. Arrays have one of two forms, whose memory layouts differ: flat
arrays follow p, grids follow numpy's habit, in which the last index runs fastest. `to_grid` and `to_flat` convert between the two; a bare
reshape does not.

    flat   (..., n, c)              row p
    grid   (..., nx, ny, nz, c)     entry [i, j, k]

At rest the points stand at equal distances in the box: X_ijk = origin + size (i / (nx - 1), j / (ny - 1), k / (nz - 1)).
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

Counts = Sequence[int]  # control points along x, y and z
Point = tuple[int, int, int]  # indices (i, j, k) of a control point


@dataclass(frozen=True)
class LatticeBox:
    """The data of a lattice that embeddings and pictures need."""

    points: tuple[int, int, int]  # control points per axis
    origin: tuple[float, float, float]  # lower corner of the box at rest [m]
    size: tuple[float, float, float]  # sides of the box at rest [m]
    basis: str  # "bezier", "bspline" or "patches"

    def rest(self) -> np.ndarray:
        """Returns the control points at rest as a grid, (nx, ny, nz, 3) [m]."""
        return rest_grid(self.points, self.origin, self.size)


def bounding_box(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the lower and upper corner (c,) of points (m, c), m > 0. The columns are taken one by one, since numpy takes twenty times
    as long along short rows."""
    return np.array([column.min() for column in points.T]), np.array([column.max() for column in points.T])


def rest_grid(counts: Counts, origin: Sequence[float] | np.ndarray, size: Sequence[float] | np.ndarray) -> np.ndarray:
    """Returns the control points at rest, (nx, ny, nz, 3) [m]."""
    axes = np.meshgrid(*(np.linspace(0.0, 1.0, count) for count in counts), indexing="ij")
    return np.asarray(origin) + np.asarray(size) * np.stack(axes, axis=-1)


def index_grid(counts: Counts) -> np.ndarray:
    """Returns the flat index of every control point, (nx, ny, nz) int64."""
    return np.arange(math.prod(counts), dtype=np.int64).reshape(counts, order="F")


def point_at(index: int, counts: Counts) -> Point:
    """Returns the indices (i, j, k) of the control point with the flat index p = `index`."""
    nx, ny, _ = counts
    return index % nx, index // nx % ny, index // nx // ny


def all_points(counts: Counts) -> Iterator[Point]:
    """Returns an iterator over (i, j, k) of every control point, in flat order."""
    nx, ny, nz = counts
    return ((i, j, k) for k, j, i in product(range(nz), range(ny), range(nx)))


def cells_within(points: np.ndarray, counts: Counts) -> np.ndarray:
    """Returns which cells have all eight corners among these points (m,), flat indices: (nx - 1, ny - 1, nz - 1) bool, each cell at the
    indices of its lower corner."""
    found = np.isin(index_grid(counts), points)
    for axis in range(3):
        low, high = (np.take(found, range(first, found.shape[axis] - 1 + first), axis=axis) for first in (0, 1))
        found = low & high
    return found


def shared_by_corners(cells: np.ndarray) -> np.ndarray:
    """Distributes values of cells to the control points, (nx, ny, nz): each cell gives an eighth of its value to each corner."""
    points = np.zeros([count + 1 for count in cells.shape])
    for i, j, k in product((0, 1), repeat=3):
        nx, ny, nz = cells.shape
        points[i : i + nx, j : j + ny, k : k + nz] += cells / 8
    return points


def to_grid(flat: np.ndarray, counts: Counts) -> np.ndarray:
    """Returns a flat array (..., n, c) as a grid (..., nx, ny, nz, c): a view."""
    nx, ny, nz = counts
    return flat.reshape(*flat.shape[:-2], nz, ny, nx, flat.shape[-1]).swapaxes(-4, -2)


def to_flat(grid: np.ndarray) -> np.ndarray:
    """Returns a grid (..., nx, ny, nz, c) as a flat array (..., n, c)."""
    return grid.swapaxes(-4, -2).reshape(*grid.shape[:-4], -1, grid.shape[-1])
