"""Parts of a mass by weights along the axes of a lattice. Each weight is one polynomial from one cut of the axis to the next: Bernstein
polynomials, which have no cut within, B-splines, or hat functions between nodes.

Triangles are cut at the cuts of all three axes, so that the integrands of mass.py are smooth on a piece. A sample counts for the points
near it. For a solid it also counts for the points below, whose integrals up to the sample's height are their integrals over the whole
axis: such a column is added at its top, and summed downwards at the end.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from softffd.embedding.basis import bsplines, local_weights, parameter, weights
from softffd.embedding.deform import lattice_coordinates
from softffd.embedding.quadrature import add_integral, sufficient_degrees
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import area_vectors, cut_triangles

Local = tuple[np.ndarray, np.ndarray]
"""At places (m,): the first point that counts (m,), and the weights, or integrals, of this point and those behind it (m, few)."""

EXACT_DEGREE, END_DEGREE = 10, 27
"""Degrees of quadrature for pieces of B-splines: in the middle, where all integrands are polynomials in the place, and in spans that
touch an end, where the parameter is not linear in the place; measured, see the tests."""

_BLOCK = 1 << 21
"""Numbers held at a time: 16 MB."""


@dataclass(frozen=True, eq=False)
class Axis:
    """Weights of the points along an axis, with places and cuts from 0 to 1, both ends included.

    weights: at places. integrals: from 0 to each place, of the weights that count there. whole: (n,), integrals over the whole axis.
    """

    cuts: np.ndarray
    weights: Callable[[np.ndarray], Local]
    integrals: Callable[[np.ndarray], Local]
    whole: np.ndarray


Axes = Sequence[Axis]
Degrees = Callable[[np.ndarray], np.ndarray]
"""A function that returns sufficient degrees of quadrature (P,) for pieces (P, 3, 3) in box coordinates."""


def control_axis(n: int, basis: str) -> Axis:
    """Returns the axis of `n` control points of "bezier" or "bspline"."""
    if basis == "bezier" or n <= 4:
        return Axis(np.array([0.0, 1.0]), lambda t: local_weights(t, n), lambda t: _bernstein_integrals(t, n), np.full(n, 1 / n))
    spans = _span_integrals(n)
    before = np.vstack([np.zeros(n), np.cumsum(spans, axis=0)])

    def integrals(t: np.ndarray) -> Local:
        s = parameter(t, n, basis)
        first = bsplines(s, n)[0]
        return first, before[first[:, None], first[:, None] + np.arange(4)] + _from_knot(s, first, n)

    return Axis(knots(n), lambda t: local_weights(t, n, basis), integrals, spans.sum(axis=0))


def control_degrees(counts: Sequence[int], basis: str, *, solid: bool) -> Degrees:
    """Returns the function for the degrees of quadrature of the weights of control points. For Bernstein polynomials it is the degree of
    their product. B-splines are, along every axis, cubics of the place in cells or flatter; pieces near the ends count as if all of them
    needed END_DEGREE."""
    cells = np.array(counts) - 1.0

    def degrees(pieces: np.ndarray) -> np.ndarray:
        low, high = pieces.min(axis=1), pieces.max(axis=1)
        if basis == "bezier":
            return sufficient_degrees((high - low) @ cells, sum(counts) - 3 + solid)
        bent = np.zeros(len(pieces), dtype=bool)
        for axis, n in enumerate(counts):
            if n > 4:
                begin, end = knots(n)[[2, -3]] + [-1e-9, 1e-9]
                bent |= (high - low > 1e-6)[:, axis] & ((low[:, axis] < begin) | (high[:, axis] > end))
        reach = 3 * (high - low) @ cells
        return np.where(bent, sufficient_degrees(reach, END_DEGREE), sufficient_degrees(reach, EXACT_DEGREE))

    return degrees


def knots(n: int) -> np.ndarray:
    """Returns the places, 0 to 1 with both ends, where one span of B-splines with `n` > 4 control points ends and the next begins."""
    first, values, _ = bsplines(np.arange(n - 2.0), n)
    return (first + values @ np.arange(4.0)) / (n - 1)


def sample_shares(axes: Axes, coordinates: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Returns the sum of m_s W_i(u_s) W_j(v_s) W_k(w_s) over samples (m, 3) in box coordinates, shape (nx, ny, nz)."""
    return _summed([axis.weights(t) for axis, t in zip(axes, coordinates.T, strict=True)], masses, _counts(axes))


def vertex_shares(axes: Axes, coordinates: np.ndarray) -> np.ndarray:
    """Returns the sum (nx, ny, nz) of the weights at places (m, 3) in box coordinates, each of which has a mass of 1."""
    blocks = (coordinates[block] for block in _blocks(len(coordinates), _numbers_a_sample(axes)))
    return sum((sample_shares(axes, block, np.ones(len(block))) for block in blocks), np.zeros(_counts(axes)))


def triangle_shares(axes: Axes, mesh: Mesh, origin: ArrayLike, size: ArrayLike, degrees: Degrees, *, solid: bool) -> np.ndarray:
    """Returns the parts (nx, ny, nz) of the surface of a mesh in the box `origin`, `size` (3,) [m], or of the solid inside it."""
    total = np.zeros(_counts(axes))
    corners = np.concatenate([lattice_coordinates(mesh.vertices, origin, size), mesh.vertices], axis=1)[mesh.faces]
    shares = _shares_below if solid else sample_shares
    for block in _blocks(len(corners), 9 * sum(len(axis.cuts) for axis in axes)):
        pieces = _cut_at_all(axes, corners[block])
        normals = area_vectors(pieces[..., 3:]) / 2
        areas, pieces = normals[:, 2] if solid else np.linalg.norm(normals, axis=1), pieces[..., :3]
        add_integral(
            total, pieces, areas, degrees(pieces), lambda places, masses: shares(axes, places, masses), _BLOCK // _numbers_a_sample(axes)
        )
    return total


def _counts(axes: Axes) -> tuple[int, ...]:
    return tuple(len(axis.whole) for axis in axes)


def _numbers_a_sample(axes: Axes) -> int:
    """Returns how many numbers are held at a time for a sample."""
    nx, ny, _ = (len(axis.whole) if len(axis.cuts) == 2 else 4 for axis in axes)
    return nx * ny


def _blocks(count: int, each: int) -> Iterator[slice]:
    """Returns slices of `count` things, `each` numbers a thing, that fit the memory set aside."""
    step = max(1, _BLOCK // each)
    return (slice(start, start + step) for start in range(0, count, step))


def _cut_at_all(axes: Axes, corners: np.ndarray) -> np.ndarray:
    """Cuts triangles (F, 3, c), whose corners begin with their three box coordinates, into pieces (P, 3, c) that lie between two cuts of
    every axis."""
    for number, axis in enumerate(axes):
        for place in axis.cuts[1:-1]:
            corners = cut_triangles(corners, corners[:, :, number] - place)
    return corners


def _shares_below(axes: Axes, coordinates: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Returns the sum of m_s W_i(u_s) W_j(v_s) I_k(w_s), where I_k is the integral of W_k from 0 to w."""
    counts = _counts(axes)
    u, v = (axis.weights(t) for axis, t in zip(axes[:2], coordinates.T[:2], strict=True))
    first, integrals = axes[2].integrals(coordinates[:, 2])
    total = _summed([u, v, (first, integrals)], masses, counts)
    if len(axes[2].cuts) == 2:
        return total
    below = _summed([u, v, (first, np.ones((len(first), 1)))], masses, counts)
    passed = np.cumsum(below[:, :, ::-1], axis=2)[:, :, ::-1] - below
    return total + passed * axes[2].whole


def _summed(local: Sequence[Local], masses: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Returns the sum over samples of masses (m,) times the product of the values along each axis. Unlike a matrix product, the sum has
    the same bits on every processor."""
    (i, u), (j, v), (k, w) = local
    if (u.shape[1], v.shape[1], w.shape[1]) == tuple(counts):  # every point counts everywhere
        plane = ((u.T * masses)[:, None] * v.T).reshape(-1, len(masses))
        return np.stack([(plane * along).sum(axis=1) for along in w.T], axis=1).reshape(counts)
    total = np.zeros(int(np.prod(counts)))
    corner = (i * counts[1] + j) * counts[2] + k
    for a, b, c in product(*(range(part.shape[1]) for part in (u, v, w))):
        place = corner + ((a * counts[1] + b) * counts[2] + c)
        total += np.bincount(place, masses * u[:, a] * v[:, b] * w[:, c], minlength=total.size)
    return total.reshape(counts)


def _bernstein_integrals(t: np.ndarray, n: int) -> Local:
    """Returns I_i(t) of mass.py."""
    return np.zeros(len(t), dtype=np.int64), np.cumsum(weights(t, n + 1)[:, :0:-1], axis=1)[:, ::-1] / n


def _span_integrals(n: int) -> np.ndarray:
    """Returns the integrals of the weights (n,) over each span, (n - 3, n)."""
    spans = np.arange(n - 3)
    dense = np.zeros((n - 3, n))
    np.put_along_axis(dense, spans[:, None] + np.arange(4), _from_knot(spans + 1.0, spans, n), axis=1)
    return dense


def _from_knot(s: np.ndarray, first: np.ndarray, n: int) -> np.ndarray:
    """Returns integrals of the four weights of span `first` (m,) from its lower knot to the parameter `s` (m,), shape (m, 4).

    N dX/ds is of degree 5 in s, for which three Gauss points are exact.
    """
    total = np.zeros((len(s), 4))
    for point, share in zip(*np.polynomial.legendre.leggauss(3), strict=True):
        _, values, slope = bsplines(first + (s - first) * (point + 1) / 2, n)
        total += ((s - first) * share / 2 * slope / (n - 1))[:, None] * values
    return total
