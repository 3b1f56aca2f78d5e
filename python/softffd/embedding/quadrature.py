"""Quadrature over triangles: rules of any degree, and the degree that is enough for a small triangle."""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

Integrand = Callable[[np.ndarray, np.ndarray], np.ndarray]


def sufficient_degrees(reach: np.ndarray, exact: int) -> np.ndarray:
    """Returns the degree of quadrature per triangle (F,): `exact`, or less if the triangle is so small that less is exact to rounding.

    reach: (F,), S = sum over axes of (degree of the polynomial along the axis) x (extent of the triangle, in units of the interval where
    the polynomial is a Bernstein polynomial). Products of Bernstein polynomials grow, away from that interval in the complex plane, no
    faster than exp(2 N d), with N their degree and d the distance. So the best ellipse bounds the error of q Gauss points by
    (e S / 4 q)^(2q); one point more pays for the bound's factor (Trefethen 2008, "Is Gauss quadrature better than Clenshaw-Curtis?",
    theorem 4.5).
    """
    degrees = np.full(len(reach), exact)
    for points in range(exact // 2, 0, -1):
        enough = np.e * reach < 4 * points * 1e-17 ** (1 / (2 * points))
        degrees[enough] = np.minimum(exact, 2 * points + 1)
    return degrees


def add_integral(total: np.ndarray, corners: np.ndarray, areas: np.ndarray, degrees: np.ndarray, each: Integrand, at_once: int) -> None:
    """Adds to `total` (nx, ny, nz) the sum over triangles (F, 3, 3) of area (F,) times the mean of the integrand, by rules of degrees
    (F,).

    each: returns the sum over samples (m, 3) of masses (m,), (nx, ny, nz). at_once: number of samples of one call of `each`.
    """
    for degree in np.unique(degrees):
        rule, chosen = triangle_rule(int(degree)), np.flatnonzero(degrees == degree)
        step = max(1, at_once // len(rule.share))
        for some in (chosen[start : start + step] for start in range(0, len(chosen), step)):
            samples = np.einsum("sc,fcx->fsx", rule.corner_weights, corners[some]).reshape(-1, 3)
            total += each(samples, np.outer(areas[some], rule.share).reshape(-1))


class TriangleRule(NamedTuple):
    """A quadrature. corner_weights (s, 3): barycentric coordinates of the samples. share (s,): their fractions of the area."""

    corner_weights: np.ndarray
    share: np.ndarray


@lru_cache(maxsize=128)
def triangle_rule(degree: int) -> TriangleRule:
    """Returns a quadrature over a triangle that is exact for polynomials up to the total `degree`.

    It is a conical product: the unit square (a, b) is mapped to the triangle by the barycentric coordinates (1-a)(1-b), a, (1-a) b, with
    Jacobian 1-a. So Gauss-Legendre needs the degree + 1 along a and the degree along b.
    """
    a, along_a = _gauss(degree + 1)
    b, along_b = _gauss(degree)
    a, b = (axis.reshape(-1) for axis in np.meshgrid(a, b, indexing="ij"))
    share = 2 * (1 - a) * np.outer(along_a, along_b).reshape(-1)
    return TriangleRule(np.stack([(1 - a) * (1 - b), a, (1 - a) * b], axis=1), share)


def _gauss(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns Gauss-Legendre points and weights on 0 to 1, exact up to `degree`."""
    points, along = np.polynomial.legendre.leggauss(degree // 2 + 1)
    return (points + 1) / 2, along / 2
