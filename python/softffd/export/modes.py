"""A run as rigid motion and a few shapes, for formats that have morph targets in the place of moving vertices.

Every vertex is a fixed combination of control points, so shapes (n, 3) of the control points are shapes of any mesh. At a row they are at

    p = mean + turn (rest - mean of rest + base + sum of weight_k shape_k),    k <= 8,  0 <= weight_k <= 1

with the turn that fits best. In a window of consecutive rows, base, shapes and weights are the principal components of what remains.
(Blender takes no weights outside of 0 .. 1.) Inside the box the combinations are convex, so that no vertex has a larger error than the
worst control point. Nine rows have eight components without an error: windows that are short enough reach any tolerance.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from softffd.run.stress import best_fit

MOST = 8
"""Number of morph targets that every viewer blends at a time"""


@dataclass(frozen=True, eq=False)
class Window:
    """Rows first .. last; the last row is the next window's first. `shapes` (1 + K, n, 3) [m], K <= 8: the base, then the K shapes;
    `weights` (last - first + 1, K) of the K shapes, 0 .. 1."""

    first: int
    last: int
    shapes: np.ndarray
    weights: np.ndarray


@dataclass(frozen=True, eq=False)
class Motion:
    """`means` (R, 3) [m] and `turns` (R, 3, 3) of the motion x -> mean + x @ turn about `centre` (3,) [m], the mean at rest; `windows`."""

    centre: np.ndarray
    means: np.ndarray
    turns: np.ndarray
    windows: tuple[Window, ...]


def motion_of(positions: np.ndarray, rest: np.ndarray, error: float) -> Motion:
    """Returns the motion of control points (R, n, 3), at rest (n, 3), in few windows with errors up to `error` [m] at all points, rows."""
    moved, at_rest, turns = best_fit(positions, rest)
    left = (moved @ turns.transpose(0, 2, 1) - at_rest).reshape(len(positions), -1)
    return Motion(rest.mean(axis=0), positions.mean(axis=1), turns, tuple(_windows(left, error)))


def _windows(left: np.ndarray, error: float) -> Iterator[Window]:
    """Yields windows, each as long as it can be: the length is doubled, then bisected."""
    products, first, end = left @ left.T, 0, len(left) - 1
    while True:
        reached, over, step = min(first + MOST, end), end + 1, MOST  # a window up to `reached` is good, up to `over` it is not
        window, _ = _fitted(left, products, first, reached, error)
        while over - reached > 1:
            tried = min(reached + step, end) if over > end else (reached + over) // 2
            longer, is_good = _fitted(left, products, first, tried, error)
            window, reached, over, step = (longer, tried, over, 2 * step) if is_good else (window, reached, tried, step)
        yield window
        if reached == end:
            return
        first = reached


def _fitted(left: np.ndarray, products: np.ndarray, first: int, last: int, error: float) -> tuple[Window, bool]:
    """Returns the window with the fewest shapes below the error, with MOST where these are not enough; and whether it is below."""
    part = slice(first, last + 1)
    inner = products[part, part]
    inner = inner - inner.mean(axis=0) - inner.mean(axis=1, keepdims=True) + inner.mean()
    vectors = np.linalg.eigh(inner)[1][:, ::-1][:, :MOST]
    base = left[part].mean(axis=0)
    rest = left[part] - base
    shapes, count = vectors.T @ rest, 0
    while not (is_good := np.linalg.norm(rest.reshape(len(rest), -1, 3), axis=2).max() <= error) and count < len(shapes):
        rest -= vectors[:, count, None] * shapes[count]
        count += 1
    weights = vectors[:, :count]
    low, span = weights.min(axis=0), np.maximum(np.ptp(weights, axis=0), 1e-12)
    every = np.concatenate([(base + low @ shapes[:count])[None], span[:, None] * shapes[:count]])
    return Window(first, last, every.reshape(1 + count, -1, 3), ((weights - low) / span).clip(0, 1)), bool(is_good)
