"""A run as rigid motion and a few shapes: what formats hold that have morph targets in the place of moving vertices.

Every vertex is a fixed combination of control points, so that shapes of these, (n, 3) each, are shapes of any mesh. At a row the points are

    p = mean + turn (rest - mean of rest + sum of weight_k shape_k),    k <= 8

with the turn that fits best, and for some rows one after the other, a window, the shapes and weights of a singular value decomposition of
what is left. Inside the box the combinations are convex, so that no vertex is farther off than the worst control point. Eight rows have
eight shapes without an error: windows that are short enough reach any tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from softffd.run.stress import best_fit

MOST = 8
"""Morph targets that every viewer blends at a time"""


@dataclass(frozen=True, eq=False)
class Window:
    """Rows first .. last, of which the last is the next window's first: `shapes` (K, n, 3) [m], K <= 8, and `weights` (last - first + 1,
    K), the largest of each shape 1."""

    first: int
    last: int
    shapes: np.ndarray
    weights: np.ndarray


@dataclass(frozen=True, eq=False)
class Motion:
    """`means` (R, 3) [m] and `turns` (R, 3, 3), by which x -> mean + x @ turn, about `centre` (3,) [m], the mean at rest; the windows."""

    centre: np.ndarray
    means: np.ndarray
    turns: np.ndarray
    windows: tuple[Window, ...]


def motion_of(positions: np.ndarray, rest: np.ndarray, error: float) -> Motion:
    """The motion of control points (R, n, 3), at rest (n, 3), in as few windows as stay below an error [m] at every point and row."""
    moved, at_rest, turns = best_fit(positions, rest)
    left = (moved @ turns.transpose(0, 2, 1) - at_rest).reshape(len(positions), -1)
    return Motion(rest.mean(axis=0), positions.mean(axis=1), turns, tuple(_windows(left, error)))


def _windows(left: np.ndarray, error: float) -> Iterator[Window]:
    products, first, end = left @ left.T, 0, len(left) - 1
    while True:
        reached, over = min(first + MOST - 1, end), end + 1  # a window to `reached` is good, one to `over` is not
        step = MOST
        while reached < end and over - reached > 1:
            tried = min(reached + step, end) if over > end else (reached + over) // 2
            good = _found(left, products, first, tried, error) is not None
            reached, over, step = (tried, over, 2 * step) if good else (reached, tried, step)
        window = _found(left, products, first, reached, error) or _found(left, products, first, reached, np.inf)
        assert window
        yield window
        if reached == end:
            return
        first = reached


def _found(left: np.ndarray, products: np.ndarray, first: int, last: int, error: float) -> Window | None:
    """The window with the fewest shapes below the error; None where MOST are not enough."""
    part = slice(first, last + 1)
    vectors = np.linalg.eigh(products[part, part])[1][:, ::-1][:, :MOST]
    shapes = vectors.T @ left[part]
    rest = left[part].copy()
    for count in range(vectors.shape[1] + 1):
        if np.linalg.norm(rest.reshape(len(rest), -1, 3), axis=2).max() <= error or (error == np.inf and count == vectors.shape[1]):
            scale = np.abs(vectors[:, :count]).max(axis=0)
            return Window(first, last, (scale[:, None] * shapes[:count]).reshape(count, left.shape[1] // 3, 3), vectors[:, :count] / scale)
        if count < vectors.shape[1]:
            rest -= vectors[:, count, None] * shapes[count]
    return None
