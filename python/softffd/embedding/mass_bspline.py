"""Shares of the mass for a volume of B-splines, whose weights differ from one span of knots to the next.

Triangles are cut at the knots of all three axes. On a piece the integrands of mass.py are polynomials in the place where
all three spans are far from the ends, of degree 10 at most; in a span next to an end, where the parameter bends, they
are smooth, and the degree END_DEGREE leaves rounding. A sample counts for the 64 control points near it, and for a solid for
those below, whose integrals up to the sample's height are their integrals over the whole axis: such a column is booked at its top
and summed downwards at the end.
"""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from softffd.embedding.basis import bsplines, local_weights, parameter, weights
from softffd.embedding.quadrature import add_integral, sufficient_degrees
from softffd.mesh.normals import area_vectors

EXACT_DEGREE, END_DEGREE = 10, 27
"""Degrees of quadrature for pieces in the middle, and in spans that touch an end: measured, see the tests."""

_BLOCK = 1 << 21
"""Numbers held at a time: 16 MB."""


def sample_shares(coordinates: np.ndarray, masses: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Sum of m_s W_i(u_s) W_j(v_s) W_k(w_s) over samples (m, 3) in box coordinates, shape (nx, ny, nz)."""
    local = [local_weights(t, n, "bspline") for t, n in zip(coordinates.T, counts, strict=True)]
    return _summed(local, masses, counts)


def triangle_shares(corners: np.ndarray, size: np.ndarray, counts: Sequence[int], *, solid: bool) -> np.ndarray:
    """Shares (nx, ny, nz) of a surface of triangles, corners (F, 3, 3) in box coordinates, or of the solid inside it.

    size: sides (3,) [m] of the box.
    """
    total = np.zeros(counts)
    each = _shares_below if solid else sample_shares
    for block in _blocks(len(corners), 9 * sum(counts)):
        pieces = _cut_at_knots(corners[block], counts)
        normals = area_vectors(pieces * size) / 2
        areas = normals[:, 2] if solid else np.linalg.norm(normals, axis=1)
        add_integral(total, pieces, areas, _degrees(pieces, counts), each, _BLOCK // 20)
    return total


def knots(n: int) -> np.ndarray:
    """Places, 0 to 1, where one span of an axis with `n` control points ends and the next begins, both ends included."""
    if n <= 4:
        return np.array([0.0, 1.0])
    first, values, _ = bsplines(np.arange(n - 2.0), n)
    return (first + values @ np.arange(4.0)) / (n - 1)


def _cut_at_knots(corners: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """The triangles in pieces (P, 3, 3) that each lie in one span of every axis."""
    for axis, n in enumerate(counts):
        for place in knots(n)[1:-1]:
            height = corners[:, :, axis] - place
            crossing = (height.min(axis=1) < 0) & (height.max(axis=1) > 0)
            if crossing.any():
                corners = np.concatenate([corners[~crossing], _cut(corners[crossing], height[crossing])])
    return corners


def _cut(corners: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Triangles (F, 3, 3) cut at height (F, 3) zero: the corner that is alone on its side, and two for the other side."""
    above = height > 0
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (height < 0).argmax(axis=1))
    order = (alone[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(corners, order[:, :, None], axis=1).transpose(1, 0, 2)
    at, bt, ct = np.take_along_axis(height, order, axis=1).T[:, :, None]
    ab, ac = (b * at - a * bt) / (at - bt), (c * at - a * ct) / (at - ct)
    return np.concatenate([np.stack(piece, axis=1) for piece in ((a, ab, ac), (ab, b, c), (ab, c, ac))])


def _degrees(pieces: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Degree of quadrature per piece: along every axis the weights are cubics of the place in cells, or flatter."""
    low, high = pieces.min(axis=1), pieces.max(axis=1)
    bent = np.zeros(len(pieces), dtype=bool)
    for axis, n in enumerate(counts):
        if n > 4:
            begin, end = knots(n)[[2, -3]] + [-1e-9, 1e-9]
            bent |= (high - low > 1e-6)[:, axis] & ((low[:, axis] < begin) | (high[:, axis] > end))
    reach = 3 * (high - low) @ (np.array(counts) - 1.0)
    return np.where(bent, sufficient_degrees(reach, END_DEGREE), sufficient_degrees(reach, EXACT_DEGREE))


def _shares_below(coordinates: np.ndarray, masses: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Sum of m_s W_i(u_s) W_j(v_s) I_k(w_s), I_k being the integral of W_k from 0 to w."""
    u, v = (local_weights(t, n, "bspline") for t, n in zip(coordinates.T[:2], counts[:2], strict=True))
    first, integrals = _integrals(coordinates[:, 2], counts[2])
    total = _summed([u, v, (first, integrals)], masses, counts)
    below = _summed([u, v, (first, np.ones((len(first), 1)))], masses, counts)
    passed = np.cumsum(below[:, :, ::-1], axis=2)[:, :, ::-1] - below
    return total + passed * _whole_integrals(counts[2])


def _integrals(t: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Integrals from 0 to each place (m,) of the weights that count there: the first of them (m,), and they (m, support)."""
    if n <= 4:
        higher = weights(t, n + 1)
        return np.zeros(len(t), dtype=np.int64), np.cumsum(higher[:, :0:-1], axis=1)[:, ::-1] / n
    s = parameter(t, n, "bspline")
    first = bsplines(s, n)[0]
    before = np.vstack([np.zeros(n), np.cumsum(_span_integrals(n), axis=0)])
    return first, before[first[:, None], first[:, None] + np.arange(4)] + _from_knot(s, first, n)


def _whole_integrals(n: int) -> np.ndarray:
    return np.full(n, 1 / n) if n <= 4 else _span_integrals(n).sum(axis=0)


def _span_integrals(n: int) -> np.ndarray:
    """Integrals of the weights (n,) over each span, (n - 3, n)."""
    spans = np.arange(n - 3)
    dense = np.zeros((n - 3, n))
    np.put_along_axis(dense, spans[:, None] + np.arange(4), _from_knot(spans + 1.0, spans, n), axis=1)
    return dense


def _from_knot(s: np.ndarray, first: np.ndarray, n: int) -> np.ndarray:
    """Integrals of the four weights of span `first` (m,) from its lower knot to the parameter `s` (m,), shape (m, 4).

    N dX/ds is of degree 5 in s, for which three points after Gauss are exact.
    """
    total = np.zeros((len(s), 4))
    for point, share in zip(*np.polynomial.legendre.leggauss(3), strict=True):
        _, values, slope = bsplines(first + (s - first) * (point + 1) / 2, n)
        total += ((s - first) * share / 2 * slope / (n - 1))[:, None] * values
    return total


def _summed(local: Sequence[tuple[np.ndarray, np.ndarray]], masses: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Sum over samples of masses (m,) times the product of what counts along each axis: first (m,), values (m, few)."""
    (i, u), (j, v), (k, w) = local
    total = np.zeros(int(np.prod(counts)))
    corner = (i * counts[1] + j) * counts[2] + k
    for a, b, c in product(*(range(part.shape[1]) for part in (u, v, w))):
        place = corner + ((a * counts[1] + b) * counts[2] + c)
        total += np.bincount(place, masses * u[:, a] * v[:, b] * w[:, c], minlength=total.size)
    return total.reshape(counts)


def _blocks(count: int, each: int) -> Iterator[slice]:
    """Slices of `count` things, `each` numbers a thing, that fit the memory set aside."""
    step = max(1, _BLOCK // each)
    return (slice(start, start + step) for start in range(0, count, step))
