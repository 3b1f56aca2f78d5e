"""Bernstein polynomials: how much each control point of an axis counts at a place on it."""

from math import comb

import numpy as np


def weights(t: np.ndarray, n: int) -> np.ndarray:
    """Return the `n` Bernstein polynomials of degree n - 1 at each `t`, shape (m, n).

    t: (m,) coordinate along the axis of the box, 0 to 1; slightly outside is evaluated as it stands.
    n: control points on the axis, at least 1 (a lattice has 2 to 32).

    B_i(t) = (n-1)! / (i! (n-1-i)!) t^i (1-t)^(n-1-i). Each is a product of numbers of one sign, so it is
    accurate to a few units in its last place at any degree. Source: Xia & Wang 2009, eq. (2).
    """
    t = np.asarray(t, dtype=float).reshape(-1)
    rising, falling = _powers(t, n), _powers(1.0 - t, n)[::-1]
    binomials = np.array([comb(n - 1, i) for i in range(n)], dtype=float)
    return (binomials[:, None] * rising * falling).T


def _powers(t: np.ndarray, n: int) -> np.ndarray:
    """Rows t^0 .. t^(n-1), shape (n, m)."""
    powers = np.ones((n, t.size))
    for i in range(1, n):
        np.multiply(powers[i - 1], t, out=powers[i])
    return powers
