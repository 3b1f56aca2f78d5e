"""What deforming a vertex costs: processor time against a plain loop over its 64 weights, compiled by numba, in the same run.

    pip install numba                                # for this alone
    python benchmarks/vertices_cost.py

A million vertices in a Bezier volume of 4 x 4 x 4 and in B-splines of 12 x 12 x 12 control points, from Python, checks of the vertices
included; 35,000 in a Bezier volume of 24 x 24 x 24. The loop computes the weights of a vertex as basis.py does, then sums 64 products. One
thread. Smallest of several times; the ratios are what to read.

Predicted for 4 x 4 x 4: 252 multiplications and additions, four points at once, two of each a clock: 32 clocks, 10 ns; the weights 5 ns,
the checks 3 ns. Axes contracted one after the other in 24 x 24 x 24: 41,000 of each, 35,000 times: 0.1 s.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numba
import numpy as np

import softffd

VERTICES, REPEATS = 1_000_000, 7
ORIGIN, SIZE = np.array([-1.0, 2.0, 0.5]), np.array([2.0, 0.7, 1.3])


@numba.njit
def bernstein(t: float, _n: int, weights: np.ndarray) -> int:
    """The four weights at a place; returns the first control point that counts."""
    u = 1 - t
    weights[0], weights[1], weights[2], weights[3] = u * u * u, 3 * t * u * u, 3 * t * t * u, t * t * t
    return 0


@numba.njit
def bspline(t: float, n: int, weights: np.ndarray) -> int:
    """The same of uniform cubic B-splines for n > 4."""
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
    """The loop over vertices and their 64 weights."""

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


def main() -> None:
    """Prints the table."""
    rng = np.random.default_rng(0)
    rest = ORIGIN + SIZE * rng.random((VERTICES, 3))
    print("                               numba     deform    ratio  largest difference")
    for side, basis, weights_at in ((4, "bezier", bernstein), (12, "bspline", bspline)):
        control = rng.random((side, side, side, 3))
        loop = loop_with(weights_at)
        base, expected = smallest(loop, rest, ORIGIN, SIZE, control)
        own, moved = smallest(softffd.deform, rest, control, origin=ORIGIN, size=SIZE, basis=basis)
        ns = 1e9 / VERTICES
        print(
            f"{side:2}^3 {basis:8}         {base * ns:10.1f} ns {own * ns:7.1f} ns {own / base:6.2f}   {abs(moved - expected).max():.1e} m"
        )
    own, _ = smallest(softffd.deform, rest[:35_000], rng.random((24, 24, 24, 3)), origin=ORIGIN, size=SIZE)
    print(f"24^3 bezier, 35,000 vertices           {own:7.2f} s")


def smallest(function: Callable[..., np.ndarray], *arguments: object, **named: object) -> tuple[float, np.ndarray]:
    """The smallest of several processor times [s], and what the function returns."""
    times = []
    result = function(*arguments, **named)
    for _ in range(REPEATS):
        began = time.process_time()
        result = function(*arguments, **named)
        times.append(time.process_time() - began)
    return min(times), result


if __name__ == "__main__":
    main()
