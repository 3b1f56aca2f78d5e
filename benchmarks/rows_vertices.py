"""Deforming vertices from Python, including checks, against a plain loop over the nonzero weights."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from measured import Pair, require_alike, row

import softffd

ORIGIN, SIZE = np.array([-1.0, 2.0, 0.5]), np.array([2.0, 0.7, 1.3])


def compared(plain: Callable[..., np.ndarray], side: int, basis: str, count: int, *, of_base: int | None = None) -> Pair:
    """Returns the pair for random vertices in a box with random control points. The plain loop deforms the first `of_base` vertices."""
    rng = np.random.default_rng(0)
    rest, control = ORIGIN + SIZE * rng.random((count, 3)), rng.random((side, side, side, 3))
    few = rest[: of_base or count]

    def own(vertices: np.ndarray) -> np.ndarray:
        return softffd.deform(vertices, control, origin=ORIGIN, size=SIZE, basis=basis)

    require_alike("vertices", own(few[:1000]), plain(few[:1000], ORIGIN, SIZE, control), 1e-12)
    return Pair(lambda: own(rest), lambda: plain(few, ORIGIN, SIZE, control), per=count, per_base=len(few))


@row("vertices", "a vertex of a million, 4^3, Bezier", "numba, a loop over 64 weights", goal=0.5)
def bezier() -> Iterator[Pair]:
    from plain_vertices import bernstein, loop_with

    yield compared(loop_with(bernstein), 4, "bezier", 1_000_000)


@row("vertices", "a vertex of a million, 12^3, B-splines", "numba, a loop over 64 weights", goal=0.5)
def bsplines() -> Iterator[Pair]:
    from plain_vertices import bspline, loop_with

    yield compared(loop_with(bspline), 12, "bspline", 1_000_000, of_base=100_000)


@row("vertices", "35,000 vertices, 24^3, Bezier", "numba, a loop over 13,824 weights", seconds=1.0)
def large() -> Iterator[Pair]:
    from plain_vertices import bezier_of_all

    pair = compared(bezier_of_all, 24, "bezier", 35_000, of_base=1000)
    yield Pair(pair.own, pair.base, per=1, per_base=1000 / 35_000)
