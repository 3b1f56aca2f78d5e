"""Free-form deformation: the object follows the control points through the volume that they span.

A point X of the object has the coordinates (u, v, w) = (X - origin) / size in the lattice's box. They never
change; the control points p_ijk move, and the object's point moves to Q(u, v, w), Xia & Wang 2009, eq. (1):

    Q(u, v, w) = sum over i, j, k of  p_ijk W_i(u) W_j(v) W_k(w)

with the Bernstein polynomials for W, or B-splines (basis.py). While the control points stand on their regular
grid, Q(u, v, w) = X. Inside the box the weights are not negative and sum to one, so Q lies in the convex hull of
the control points: where no control point is behind a plane, nothing of the object is. Outside the box that is
lost and the polynomials grow fast, so a point outside is an error here, not an extrapolation.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np

from softffd.embedding.basis import local_weights, support, weights
from softffd.errors import MeshError
from softffd.lattice import to_flat
from softffd.mesh.mesh import Mesh
from softffd.spelling import did_you_mean, nearest_of

BASES = ("bezier", "bspline")

OUTSIDE_ALLOWED = 1e-6
"""How far outside the box a point may lie, as a share of the side: room for a box typed with six digits."""

_KEPT, _BLOCK = 1 << 22, 1 << 19
"""Weights that an embedding keeps, if no more (32 MB); numbers worked on at a time otherwise (4 MB)."""

_FEW = 8
"""Up to so many times are deformed axis by axis; for more, products of weights that all of them share cost less."""


def deform(mesh: Mesh | np.ndarray, positions: np.ndarray, *, origin=None, size=None, basis="bezier") -> np.ndarray:
    """Return the deformed vertices of `mesh`: Q of eq. (1) at every vertex, m.

    mesh: a Mesh, or its vertices (V, 3) m, in the rest configuration.
    positions: control points (nx, ny, nz, 3) m, positions[i, j, k] = p_ijk; or (T, nx, ny, nz, 3), T instants.
    origin, size: lower corner and sides (3,) m of the lattice's box at rest; default the vertices' bounding box.
    basis: "bezier" or "bspline", as the scene's lattice.basis. For a run's own lattice `Result.deformed` knows all three.
    Returns (V, 3), or (T, V, 3); the last bits of a vertex depend on how many are deformed together.
    Raises MeshError where a vertex lies outside the box, ValueError for arguments of no such form.
    """
    vertices = mesh.vertices if isinstance(mesh, Mesh) else np.asarray(mesh, dtype=float)
    positions = np.asarray(positions, dtype=float)
    if positions.ndim not in (4, 5):
        raise ValueError(f"positions: wanted the shape (nx, ny, nz, 3) or (T, nx, ny, nz, 3), got {positions.shape}")
    origin = vertices.min(axis=0) if origin is None else origin
    size = vertices.max(axis=0) - origin if size is None else size
    return Embedding(vertices, origin, size, positions.shape[-4:-1], basis).deform(positions)


class Embedding:
    """An object's points in a lattice: made once, then deformed as often as the control points move."""

    def __init__(self, vertices: np.ndarray, origin, size, counts, basis="bezier"):
        """Place `vertices` (V, 3) m in a lattice: box at `origin` (3,) m, sides `size` (3,) m, counts (nx, ny, nz), `basis`.

        Raises MeshError where a vertex lies outside the box by more than OUTSIDE_ALLOWED of its side.
        """
        self.counts, self.basis = _checked_counts(counts), _checked_basis(basis)
        self.coordinates = lattice_coordinates(vertices, origin, size)
        points = int(np.prod(self.counts))
        small = points * len(self.coordinates) <= _KEPT
        self._kept = self._products(slice(None)) if small else None
        few = np.prod([support(n, basis) for n in self.counts]) <= points / 2
        self._near = self._local() if few and not small else None

    def deform(self, positions: np.ndarray) -> np.ndarray:
        """Return the vertices (V, 3) m for control points (nx, ny, nz, 3) m, or (T, V, 3) for (T, nx, ny, nz, 3)."""
        positions = np.asarray(positions, dtype=float)
        if positions.shape[-4:] != (*self.counts, 3) or positions.ndim > 5:
            raise ValueError(f"positions: wanted the shape {(*self.counts, 3)}, or one axis of time before, got {positions.shape}")
        frames = positions.reshape(-1, *self.counts, 3)
        if self._near is not None:
            moved = np.stack([self._moved_by_few(frame, self._near) for frame in frames])
            return moved[0] if positions.ndim == 4 else moved
        control = to_flat(frames).swapaxes(1, 2).reshape(3 * len(frames), -1)
        moved = np.empty((len(frames), len(self.coordinates), 3))
        summed = self._kept is None and len(frames) <= _FEW
        for part in self._parts(len(frames), summed):
            if summed:
                sums = self._summed(control, part)
            else:
                sums = control @ (self._products(part) if self._kept is None else self._kept[:, part])
            moved[:, part] = sums.reshape(len(frames), 3, -1).transpose(0, 2, 1)
        return moved[0] if positions.ndim == 4 else moved

    def _local(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Per axis the first control point that counts at each vertex (V,), and the weights from there on (V, support)."""
        axes = zip(self.coordinates.T, self.counts, strict=True)
        return [local_weights(t, n, self.basis) for t, n in axes]

    def _moved_by_few(self, frame: np.ndarray, near: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
        """Vertices (V, 3) for control points (nx, ny, nz, 3): 64 of these count at a vertex, whatever their number."""
        (i, u), (j, v), (k, w) = near
        moved = np.zeros_like(self.coordinates)
        for a, b, c in product(*(range(part.shape[1]) for part in (u, v, w))):
            moved += (u[:, a] * v[:, b] * w[:, c])[:, None] * frame[i + a, j + b, k + c]
        return moved

    def _parts(self, frames: int, summed: bool) -> Iterator[slice]:
        """Slices of the vertices, so short that a block's weights and results fit the memory set aside."""
        points = 3 * frames * int(np.prod(self.counts[:2])) if summed else int(np.prod(self.counts)) + 3 * frames
        step = max(1, _BLOCK // points)
        return (slice(start, start + step) for start in range(0, len(self.coordinates), step))

    def _summed(self, control: np.ndarray, part: slice) -> np.ndarray:
        """The rows of `control`, (rows, n) in flat order, at the vertices of `part`, (rows, vertices): one axis of the lattice after the
        other. At one time this takes a tenth of what the products of all three take, which many times share."""
        u, v, w = (weights(t, n, self.basis).T for t, n in zip(self.coordinates[part].T, self.counts, strict=True))
        nx, ny, nz = self.counts
        layers = control.reshape(-1, nz, ny * nx).swapaxes(1, 2).reshape(-1, nz) @ w
        lines = np.einsum("rjiv,iv->rjv", layers.reshape(-1, ny, nx, w.shape[1]), u)
        return np.einsum("rjv,jv->rv", lines, v)

    def _products(self, part: slice) -> np.ndarray:
        """W_i(u) W_j(v) W_k(w) at the vertices of `part`, shape (n, vertices), control points in flat order."""
        u, v, w = (weights(t, n, self.basis).T for t, n in zip(self.coordinates[part].T, self.counts, strict=True))
        product = w[:, None, None] * v[None, :, None] * u[None, None, :]
        return product.reshape(-1, product.shape[-1])


def lattice_coordinates(points: np.ndarray, origin, size) -> np.ndarray:
    """Return (u, v, w) = (points - origin) / size, shape (m, 3), of `points` (m, 3) m.

    Raises MeshError where a point lies outside the box by more than OUTSIDE_ALLOWED of its side.
    """
    points = np.asarray(points, dtype=float)
    origin, size = np.asarray(origin, dtype=float), np.asarray(size, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points: wanted the shape (m, 3), got {points.shape}")
    if origin.shape != (3,) or size.shape != (3,) or not np.isfinite([origin, size]).all():
        raise ValueError(f"lattice box: wanted three finite numbers each, got origin {origin} and size {size}")
    if not (size > 0).all():
        raise MeshError(f"lattice.size: wanted three sides > 0 m, got {_triple(size)}")
    coordinates = (points - origin) / size
    _require_inside(coordinates, points, origin, size)
    return coordinates


def _require_inside(coordinates: np.ndarray, points: np.ndarray, origin: np.ndarray, size: np.ndarray) -> None:
    outside = ~((coordinates >= -OUTSIDE_ALLOWED) & (coordinates <= 1 + OUTSIDE_ALLOWED)).all(axis=1)
    if not outside.any():
        return
    low, high = points.min(axis=0), points.max(axis=0)
    raise MeshError(
        f"lattice.origin, lattice.size: {outside.sum()} of the mesh's {len(points)} points lie outside the lattice's "
        f"box, which spans {_triple(origin)} to {_triple(origin + size)} m, while the mesh spans {_triple(low)} to "
        f"{_triple(high)} m. Wanted a box that holds the whole mesh: leave both keys out to take the mesh's own "
        f"bounding box (lattice.margin enlarges it), or use origin = {_triple(low)} and size = {_triple(high - low)}."
    )


def _checked_counts(counts) -> tuple[int, int, int]:
    counts = tuple(int(n) for n in counts)
    if len(counts) != 3 or not all(2 <= n <= 32 for n in counts):
        raise ValueError(f"lattice.points: wanted three counts of 2 to 32, got {counts}")
    return counts


def _checked_basis(basis) -> str:
    if basis not in BASES:
        wanted = " or ".join(f'"{each}"' for each in BASES)
        raise ValueError(f"basis: wanted {wanted}, got {basis!r}{did_you_mean(nearest_of(str(basis), BASES))}")
    return basis


def _triple(values: np.ndarray) -> str:
    return "[" + ", ".join(f"{value:.7g}" for value in values) + "]"
