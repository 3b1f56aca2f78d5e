"""The baseline of deforming vertices: a loop over the weights of each vertex, as a user would write it for numba."""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np


@numba.njit
def bernstein(t: float, _n: int, weights: np.ndarray) -> int:
    """Computes the four Bernstein weights at a place t and returns the index of the first control point with a weight."""
    u = 1 - t
    weights[0], weights[1], weights[2], weights[3] = u * u * u, 3 * t * u * u, 3 * t * t * u, t * t * t
    return 0


@numba.njit
def bspline(t: float, n: int, weights: np.ndarray) -> int:
    """Computes the four weights of uniform cubic B-splines for n > 4 and returns the index of the first control point with a weight."""
    wanted = t * (n - 1)
    s = min(max(wanted - 1, 0.0), n - 3.0)
    for _ in range(7 if min(wanted, n - 1 - wanted) < 3 else 1):
        first, slope = min(int(s), n - 4), 0.0
        weights[0] = 1.0
        for degree in range(1, 4):
            rising, slope = 0.0, 0.0
            for r in range(degree):
                ahead, behind = min(first + r + 1, n - 3) - s, s - max(first + 1 - degree + r, 0)
                part = weights[r] / (ahead + behind)
                weights[r] = rising + ahead * part
                rising = behind * part
                slope += degree * part
            weights[degree] = rising
        s += (wanted - (first + weights[1] + 2 * weights[2] + 3 * weights[3])) / slope
    return first


def loop_with(weights_at: Callable[[float, int, np.ndarray], int]) -> Callable[..., np.ndarray]:
    """Returns a compiled loop over vertices and their 64 weights."""

    @numba.njit
    def loop(rest: np.ndarray, origin: np.ndarray, size: np.ndarray, control: np.ndarray) -> np.ndarray:
        moved, u, v, w = np.empty_like(rest), np.empty(4), np.empty(4), np.empty(4)
        for m in range(len(rest)):
            a = weights_at((rest[m, 0] - origin[0]) / size[0], control.shape[0], u)
            b = weights_at((rest[m, 1] - origin[1]) / size[1], control.shape[1], v)
            c = weights_at((rest[m, 2] - origin[2]) / size[2], control.shape[2], w)
            x = y = z = 0.0
            for i in range(4):
                for j in range(4):
                    for k in range(4):
                        weight = u[i] * v[j] * w[k]
                        x += weight * control[a + i, b + j, c + k, 0]
                        y += weight * control[a + i, b + j, c + k, 1]
                        z += weight * control[a + i, b + j, c + k, 2]
            moved[m, 0], moved[m, 1], moved[m, 2] = x, y, z
        return moved

    return loop


@numba.njit
def bezier_of_all(rest: np.ndarray, origin: np.ndarray, size: np.ndarray, control: np.ndarray) -> np.ndarray:
    """Returns the vertices moved by a Bezier volume of any size, in which every control point has a weight."""
    n = control.shape[0]
    binomials = np.ones(n)
    for i in range(1, n):
        binomials[i] = binomials[i - 1] * (n - i) / i
    moved, weights = np.zeros_like(rest), np.empty((3, n))
    for m in range(len(rest)):
        for a in range(3):
            t = (rest[m, a] - origin[a]) / size[a]
            for i in range(n):
                weights[a, i] = binomials[i] * t**i * (1 - t) ** (n - 1 - i)
        for i in range(n):
            for j in range(n):
                for k in range(n):
                    weight = weights[0, i] * weights[1, j] * weights[2, k]
                    for a in range(3):
                        moved[m, a] += weight * control[i, j, k, a]
    return moved
