"""Basis functions: the weights of the control points of an axis at a place on it.

At rest the n control points of an axis stand at equal distances, c_i = i / (n - 1). For weights W_i(t) with

    sum of W_i = 1,     W_i >= 0,     sum of W_i c_i = t        at every place t from 0 to 1

the lattice at rest leaves the object as it is, and the deformed object stays in the convex hull of the control points.

"bezier": the Bernstein polynomials of degree n - 1, Xia & Wang 2009, eq. (2), for which all three conditions hold. Every control point
moves the whole object.

"bspline": uniform cubic B-splines N_i(s) with clamped ends, knots 0, 0, 0, 0, 1, 2, .., L, L, L, L with L = n - 3. A control point moves
only what is within two cells of it, or three near the ends. But B-splines do not reproduce places:

    X(s) = sum of N_i(s) c_i     is (s + 1) / (n - 1) in the middle, and three times as steep as that at the ends.

Therefore a place t takes the weights at the parameter s with X(s) = t. X increases everywhere. X and the deformation are continuous up to
the second derivative. With four control points or fewer there is one span with X(s) = s, and the B-splines are the Bernstein polynomials.

"patches", the basis of a solid: e Bezier volumes of degree 3 side by side, n = 3 e + 1. Each volume has four control points along the
axis, the last of which is the first of the next volume. The control points stand at equal distances, so all three conditions hold. The
deformation is continuous at a joint between two volumes, but its slope is not.
"""

from math import comb

import numpy as np

NEWTON_STEPS = 6
"""Newton steps for X(s) = t; five reach rounding for every n."""


def weights(t: np.ndarray, n: int, basis: str = "bezier") -> np.ndarray:
    """Returns the weights of the `n` control points of an axis at each place `t`, shape (m, n).

    t: (m,) coordinate along the axis of the box, 0 to 1; places slightly outside are evaluated with the same formulas.
    n: control points on the axis, at least 1 (a lattice has 2 to 32), of "patches" 3 e + 1. basis: "bezier", "bspline" or "patches".
    """
    first, values = local_weights(t, n, basis)
    if values.shape[1] == n:
        return values
    dense = np.zeros((len(values), n))
    np.put_along_axis(dense, first[:, None] + np.arange(values.shape[1]), values, axis=1)
    return dense


def local_weights(t: np.ndarray, n: int, basis: str = "bezier") -> tuple[np.ndarray, np.ndarray]:
    """Returns the weights without the zeros: the first control point that counts, (m,), and the weights from there on, (m, support)."""
    t = np.asarray(t, dtype=float).reshape(-1)
    if _one_span(n, basis):
        return np.zeros(t.size, dtype=np.int64), _bernstein(t, n)
    s = parameter(t, n, basis)
    if basis == "patches":
        patch = np.clip(np.floor(s), 0, n // 3 - 1)
        return 3 * patch.astype(np.int64), _bernstein(s - patch, 4)
    return bsplines(s, n)[:2]


def parameter(t: np.ndarray, n: int, basis: str) -> np.ndarray:
    """Returns the parameter s of each place, (m,): X(s) = t, in spans 0 .. n - 3 of B-splines, in patches 0 .. e, and t itself with one
    span.

    At least three cells from the ends s is known. Nearer, Newton's method starts from the same formula for s: on the side from which the
    curvature of X makes the method approach the solution without passing it.
    """
    t = np.asarray(t, dtype=float).reshape(-1)
    if _one_span(n, basis):
        return t
    if basis == "patches":
        return t * (n // 3)
    wanted = t * (n - 1)
    s = np.clip(wanted - 1, 0, n - 3)
    bent = np.flatnonzero(np.minimum(wanted, n - 1 - wanted) < 3)
    found = s[bent]
    for _ in range(NEWTON_STEPS):
        first, values, slope = bsplines(found, n)
        found += (wanted[bent] - (first + values @ np.arange(4.0))) / slope
    s[bent] = found
    return s


def bsplines(s: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Computes uniform cubic B-splines with clamped ends at the parameters `s` (m,), for n > 4 control points.

    Returns the index of the first that is not zero (m,), the four from there on (m, 4), and (n - 1) dX/ds (m,). The recurrence is that of
    Cox (1972) and de Boor (1972), whose terms are all positive.
    """
    spans = n - 3
    first = np.clip(np.floor(s), 0, spans - 1)
    behind = [s - np.maximum(first + 1 - p, 0) for p in range(4)]
    ahead = [np.minimum(first + p, spans) - s for p in range(4)]
    values = [np.ones_like(s)]
    for degree in (1, 2, 3):
        parts = [values[r] / (ahead[r + 1] + behind[degree - r]) for r in range(degree)]
        rising = [behind[degree - r] * parts[r] for r in range(degree)]
        falling = [ahead[r + 1] * parts[r] for r in range(degree)]
        values = [falling[0], *(rising[r - 1] + falling[r] for r in range(1, degree)), rising[-1]]
    return first.astype(np.int64), np.stack(values, axis=1), 3 * (parts[0] + parts[1] + parts[2])


def _one_span(n: int, basis: str) -> bool:
    return basis == "bezier" or n <= 4


def _bernstein(t: np.ndarray, n: int) -> np.ndarray:
    """Returns B_i(t) = (n-1)! / (i! (n-1-i)!) t^i (1-t)^(n-1-i), shape (m, n).

    Each value is a product of numbers of one sign, so it is accurate to a few units in its last place at any degree.
    """
    rising, falling = _powers(t, n), _powers(1.0 - t, n)[::-1]
    binomials = np.array([comb(n - 1, i) for i in range(n)], dtype=float)
    return (binomials[:, None] * rising * falling).T


def _powers(t: np.ndarray, n: int) -> np.ndarray:
    """Returns the rows t^0 .. t^(n-1), shape (n, m)."""
    powers = np.ones((n, t.size))
    for i in range(1, n):
        np.multiply(powers[i - 1], t, out=powers[i])
    return powers
