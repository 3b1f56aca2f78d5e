"""Shares of the mass for a volume of B-splines, whose weights differ from one span of knots to the next (mass_pieces.py).

On a piece the integrands are polynomials in the place where all three spans are far from the ends, of degree 10 at most; in a span next to
an end, where the parameter bends, they are smooth, and the degree END_DEGREE leaves rounding.
"""

from collections.abc import Sequence

import numpy as np

from softffd.embedding import mass_pieces
from softffd.embedding.basis import bsplines, local_weights, parameter, weights
from softffd.embedding.quadrature import sufficient_degrees

EXACT_DEGREE, END_DEGREE = 10, 27
"""Degrees of quadrature for pieces in the middle, and in spans that touch an end: measured, see the tests."""


def sample_shares(coordinates: np.ndarray, masses: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Sum of m_s W_i(u_s) W_j(v_s) W_k(w_s) over samples (m, 3) in box coordinates, shape (nx, ny, nz)."""
    return mass_pieces.sample_shares([_axis(n) for n in counts], coordinates, masses)


def triangle_shares(corners: np.ndarray, size: np.ndarray, counts: Sequence[int], *, solid: bool) -> np.ndarray:
    """Shares (nx, ny, nz) of a surface of triangles, corners (F, 3, 3) in box coordinates, or of the solid inside it.

    size: sides (3,) [m] of the box.
    """
    axes = [_axis(n) for n in counts]
    return mass_pieces.triangle_shares(axes, corners, size, lambda pieces: _degrees(pieces, counts), solid=solid)


def _axis(n: int) -> mass_pieces.Axis:
    return mass_pieces.Axis(knots(n), lambda t: local_weights(t, n, "bspline"), lambda t: _integrals(t, n), _whole_integrals(n))


def knots(n: int) -> np.ndarray:
    """Places, 0 to 1, where one span of an axis with `n` control points ends and the next begins, both ends included."""
    if n <= 4:
        return np.array([0.0, 1.0])
    first, values, _ = bsplines(np.arange(n - 2.0), n)
    return (first + values @ np.arange(4.0)) / (n - 1)


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
