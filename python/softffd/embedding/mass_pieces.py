"""Shares of the mass where the weights of an axis are one polynomial from one cut to the next: B-splines, or hat functions between nodes.

Triangles are cut at the cuts of all three axes, so that on a piece the integrands of mass.py are smooth. A sample counts for the points
near it, and for a solid for those below, whose integrals up to the sample's height are their integrals over the whole axis: such a column
is booked at its top and summed downwards at the end.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from softffd.embedding.quadrature import add_integral
from softffd.mesh.normals import area_vectors

Local = tuple[np.ndarray, np.ndarray]
"""At places (m,): the first point that counts (m,), and how much it and those behind it do (m, few)."""

_BLOCK = 1 << 21
"""Numbers held at a time: 16 MB."""


@dataclass(frozen=True, eq=False)
class Axis:
    """Weights of the points along an axis, places and cuts from 0 to 1, both ends included.

    weights: at places. integrals: of the weights that count there, from 0 to each place. whole: (n,), those over the whole axis.
    """

    cuts: np.ndarray
    weights: Callable[[np.ndarray], Local]
    integrals: Callable[[np.ndarray], Local]
    whole: np.ndarray


Axes = Sequence[Axis]
Degrees = Callable[[np.ndarray], np.ndarray]
"""Of quadrature that is enough for pieces (P, 3, 3) in box coordinates: (P,)."""


def sample_shares(axes: Axes, coordinates: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Sum of m_s W_i(u_s) W_j(v_s) W_k(w_s) over samples (m, 3) in box coordinates, shape (nx, ny, nz)."""
    return _summed([axis.weights(t) for axis, t in zip(axes, coordinates.T, strict=True)], masses, _counts(axes))


def triangle_shares(axes: Axes, corners: np.ndarray, size: np.ndarray, degrees: Degrees, *, solid: bool) -> np.ndarray:
    """Shares (nx, ny, nz) of a surface of triangles, corners (F, 3, 3) in box coordinates, or of the solid inside it.

    size: sides (3,) [m] of the box.
    """
    counts = _counts(axes)
    total = np.zeros(counts)
    shares = _shares_below if solid else sample_shares
    for block in _blocks(len(corners), 9 * sum(counts)):
        pieces = _cut_at_all(axes, corners[block])
        normals = area_vectors(pieces * size) / 2
        areas = normals[:, 2] if solid else np.linalg.norm(normals, axis=1)
        add_integral(total, pieces, areas, degrees(pieces), lambda places, masses, _: shares(axes, places, masses), _BLOCK // 20)
    return total


def _counts(axes: Axes) -> tuple[int, ...]:
    return tuple(len(axis.whole) for axis in axes)


def _cut_at_all(axes: Axes, corners: np.ndarray) -> np.ndarray:
    """The triangles in pieces (P, 3, 3) that each lie between two cuts of every axis."""
    for number, axis in enumerate(axes):
        for place in axis.cuts[1:-1]:
            height = corners[:, :, number] - place
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


def _shares_below(axes: Axes, coordinates: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Sum of m_s W_i(u_s) W_j(v_s) I_k(w_s), I_k being the integral of W_k from 0 to w."""
    counts = _counts(axes)
    u, v = (axis.weights(t) for axis, t in zip(axes[:2], coordinates.T[:2], strict=True))
    first, integrals = axes[2].integrals(coordinates[:, 2])
    total = _summed([u, v, (first, integrals)], masses, counts)
    below = _summed([u, v, (first, np.ones((len(first), 1)))], masses, counts)
    passed = np.cumsum(below[:, :, ::-1], axis=2)[:, :, ::-1] - below
    return total + passed * axes[2].whole


def _summed(local: Sequence[Local], masses: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Sum over samples of masses (m,) times the product of what counts along each axis."""
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
