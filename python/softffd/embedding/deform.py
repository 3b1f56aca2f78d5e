"""Free-form deformation: the object follows the control points through the volume that they span.

A point X of the object has the coordinates (u, v, w) = (X - origin) / size in the lattice's box. The coordinates never change; the
control points p_ijk move, and the object's point moves to Q(u, v, w), Xia & Wang 2009, eq. (1):

    Q(u, v, w) = sum over i, j, k of  p_ijk W_i(u) W_j(v) W_k(w)

where the W are Bernstein polynomials, B-splines, or patches of polynomials (basis.py). While the control points stand on their regular
grid, Q(u, v, w) = X. Inside the box the weights are not negative and sum to one, so Q lies in the convex hull of the control points: if
no control point is behind a plane, no point of the object is. Outside the box this property is lost and the polynomials grow fast, so a
point outside is an error here, not an extrapolation.
"""

from collections.abc import Iterator, Sequence
from ctypes import c_int, c_longlong, c_void_p
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softffd.errors import MeshError
from softffd.installed import library_function
from softffd.lattice import bounding_box
from softffd.spelling import did_you_mean, nearest_of

Array = NDArray[np.float64]
Points = NDArray[np.float32] | NDArray[np.float64]

BASES = ("bezier", "bspline", "patches")
"""The bases; the index of each is its number in the library and on the interactive page"""

OUTSIDE_ALLOWED = 1e-6
"""How far outside the box a point may lie, as a fraction of the side: room for a box typed with six digits."""

DEFORM = (*[c_void_p] * 3, c_int, c_longlong, c_void_p, c_longlong, c_void_p, c_longlong, c_void_p)
"""Types of the arguments of the library's function for the deformation (fmu_src/core/embedding/deform.hpp)."""

_BLOCK = 1 << 27
"""Multiplications in one call of the library: some 20 ms, after which Ctrl-C takes effect."""


class Surface(Protocol):
    """An object with vertices, (V, 3) m, such as a Mesh."""

    @property
    def vertices(self) -> Array: ...


def deform(
    mesh: Surface | ArrayLike,
    positions: ArrayLike,
    *,
    origin: ArrayLike | None = None,
    size: ArrayLike | None = None,
    basis: str = "bezier",
) -> Array:
    """Returns the deformed vertices of `mesh`: Q of eq. (1) at every vertex, m.

    mesh: a Mesh, or its vertices (V, 3) m, in the rest configuration.
    positions: control points (nx, ny, nz, 3) m, positions[i, j, k] = p_ijk; or (T, nx, ny, nz, 3) for T instants.
    origin, size: lower corner and sides (3,) m of the lattice's box at rest; by default of the vertices' bounding box.
    basis: "bezier", "bspline" or "patches", as the scene's lattice.basis. For the lattice of a run, `Result.deformed` knows origin, size
        and basis.
    Returns (V, 3), or (T, V, 3). The bits of a vertex do not depend on the other vertices, nor on how many instants are deformed with it.
    Raises MeshError if a vertex lies outside the box, and ValueError for arguments of another form.
    """
    given: Any = mesh
    vertices = _points(getattr(given, "vertices", given))
    positions = np.asarray(positions, dtype=float)
    if positions.ndim not in (4, 5):
        raise ValueError(f"positions: wanted the shape (nx, ny, nz, 3) or (T, nx, ny, nz, 3), got {positions.shape}")
    if (origin is None or size is None) and not len(vertices):
        raise ValueError("origin, size: wanted both where there are no vertices, got none")
    if origin is None or size is None:
        low, high = bounding_box(vertices)
        origin = low if origin is None else origin
        size = high - np.asarray(origin) if size is None else size
    return Embedding(vertices, origin, size, positions.shape[-4:-1], basis).deform(positions)


class Embedding:
    """The points of an object in a lattice: checked once, then deformed as often as the control points move."""

    def __init__(self, vertices: ArrayLike, origin: ArrayLike, size: ArrayLike, counts: Sequence[int], basis: str = "bezier"):
        """Places `vertices` (V, 3) m in a lattice: box at `origin` (3,) m, sides `size` (3,) m, counts (nx, ny, nz), `basis`.

        Raises MeshError if a vertex lies outside the box by more than OUTSIDE_ALLOWED of the box's side.
        """
        self.counts, self.basis = _checked_counts(counts), _checked_basis(basis, counts)
        self.vertices, self.origin, self.size = _in_box(vertices, origin, size)

    def deform(self, positions: ArrayLike) -> Array:
        """Returns the vertices (V, 3) m for control points (nx, ny, nz, 3) m, or (T, V, 3) for (T, nx, ny, nz, 3)."""
        positions = np.asarray(positions, dtype=float)
        if positions.shape[-4:] != (*self.counts, 3) or positions.ndim > 5:
            raise ValueError(f"positions: wanted the shape {(*self.counts, 3)}, or one axis of time before, got {positions.shape}")
        frames = positions.reshape(-1, *self.counts, 3)
        fill = max(0, 4 - self.counts[2])  # the library needs four along z at least
        control = np.ascontiguousarray(np.pad(frames, [(0, 0)] * 3 + [(0, fill), (0, 0)]) if fill else frames)
        moved = np.empty((len(frames), len(self.vertices), 3))
        counts, basis = np.array(self.counts, dtype=np.int32), BASES.index(self.basis)
        for part in self._parts(len(frames)):
            rest = np.ascontiguousarray(self.vertices[part], dtype=float)
            library_function("softffd_deform", None, *DEFORM)(
                self.origin.ctypes.data, self.size.ctypes.data, counts.ctypes.data, basis, len(frames), control.ctypes.data,
                len(rest), rest.ctypes.data, len(self.vertices), moved.ctypes.data + part.start * rest.itemsize * 3,
            )  # fmt: skip
        return moved[0] if positions.ndim == 4 else moved

    def _parts(self, frames: int) -> Iterator[slice]:
        """Returns slices of the vertices, each so short that its deformation takes little memory and time."""
        work = 3 * max(1, frames) * int(np.prod([n if self.basis == "bezier" else min(n, 4) for n in self.counts]))
        step = 32 * max(1, min(_BLOCK // work, 1 << 16) // 32)
        return (slice(start, min(start + step, len(self.vertices))) for start in range(0, len(self.vertices), step))


def lattice_coordinates(points: ArrayLike, origin: ArrayLike, size: ArrayLike) -> Array:
    """Returns (u, v, w) = (points - origin) / size, shape (m, 3), of `points` (m, 3) m.

    Raises MeshError if a point lies outside the box by more than OUTSIDE_ALLOWED of the box's side.
    """
    inside, low, sides = _in_box(points, origin, size)
    return (inside - low) / sides


def _in_box(given: ArrayLike, origin: ArrayLike, size: ArrayLike) -> tuple[Points, Array, Array]:
    """Checks the points and the box, and returns them as arrays."""
    points, corner, sides = _points(given), np.array(origin, dtype=float), np.array(size, dtype=float)
    if corner.shape != (3,) or sides.shape != (3,) or not np.isfinite([corner, sides]).all():
        raise ValueError(f"lattice box: wanted three finite numbers each, got origin {corner} and size {sides}")
    if not (sides > 0).all():
        raise MeshError(f"lattice.size: wanted three sides > 0 m, got {_triple(sides)}")
    if found := outside(points, corner, sides):
        low, high = bounding_box(points)
        wanted = (
            "a box that holds the whole mesh: leave both keys out to take the mesh's own bounding box (lattice.margin enlarges it), or use "
            f"origin = {_triple(low)} and size = {_triple(high - low)}"
        )
        raise MeshError(f"lattice.origin, lattice.size: {found}. Wanted {wanted if np.isfinite(points).all() else 'finite coordinates'}.")
    return points, corner, sides


def outside(given: ArrayLike, origin: ArrayLike, size: ArrayLike) -> str:
    """Returns in words how many points (m, 3) m are not finite or lie outside the box, and the first of them; "" if all lie inside."""
    points, corner, sides = _points(given), np.asarray(origin), np.asarray(size)
    if not len(points) or all(_inside((end - corner) / sides) for end in bounding_box(points)):
        return ""
    finite = np.isfinite(points).all(axis=1)
    wrong = ~_inside((points - corner) / sides) if finite.all() else ~finite
    first = int(wrong.argmax())
    box = f"lie outside the lattice's box, which spans {_triple(corner)} to {_triple(corner + sides)} m"
    which = f"number {first} (from 0), {_triple(points[first])} m"
    return f"{wrong.sum()} of the {len(points)} points {box if finite.all() else 'are not finite'}; the first is {which}"


def _points(given: ArrayLike) -> Points:
    """Returns points (m, 3) as floating-point numbers of single or double precision."""
    points = np.asarray(given)
    if points.dtype not in (np.float32, np.float64):
        points = points.astype(float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points: wanted the shape (m, 3), got {points.shape}")
    return points


def _inside(coordinates: Array) -> Any:
    """Returns which points with these coordinates (.., 3) are in the box."""
    return ((coordinates >= -OUTSIDE_ALLOWED) & (coordinates <= 1 + OUTSIDE_ALLOWED)).all(axis=-1)


def _checked_counts(counts: Sequence[int]) -> tuple[int, int, int]:
    if len(counts) != 3 or not all(2 <= n <= 32 for n in counts):
        raise ValueError(f"lattice.points: wanted three counts of 2 to 32, got {tuple(counts)}")
    x, y, z = map(int, counts)
    return x, y, z


def _checked_basis(basis: str, counts: Sequence[int]) -> str:
    if basis not in BASES:
        *others, last = (f'"{each}"' for each in BASES)
        wanted = f"{', '.join(others)} or {last}"
        raise ValueError(f"basis: wanted {wanted}, got {basis!r}{did_you_mean(nearest_of(str(basis), BASES))}")
    if basis == "patches" and any(n % 3 != 1 for n in counts):
        raise ValueError(f'lattice.points: wanted 4, 7, 10, .. or 31 along each axis of "patches", got {tuple(counts)}')
    return basis


def _triple(values: Array) -> str:
    return "[" + ", ".join(f"{value:.7g}" for value in values) + "]"
