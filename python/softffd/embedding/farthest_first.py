"""Vertices farthest from each other first, by the distance |W_v - W_w|_2 of their weights (Gonzalez 1985).

Vertices near each other at rest are kept in blocks, each with a middle, a radius about it, and how far its farthest vertex is from all that
are chosen. A newly chosen vertex p is nearer than those only to vertices of blocks with

    |W_p - W_middle| < radius + farthest of the block,

the others are left alone: the choice is what a search through all vertices finds.
"""

import numpy as np
from numpy.typing import NDArray

from softffd.embedding.basis import weights
from softffd.embedding.deform import lattice_coordinates
from softffd.lattice import LatticeBox

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

BLOCK = 64
"""Vertices of a block, at most: of 16 to 128 the quickest on meshes of 10,000 to 160,000 vertices"""
ROUNDING = 1e-7
"""What a distance may be off where squares of weights, which are 1 at most, cancel"""


def axis_weights(places: Array, box: LatticeBox) -> Array:
    """Weights (3, n, V) of the control points of x, y and z at places (V, 3) [m], whose products are those of all.

    n: the most control points that an axis has; axes with fewer have zeros behind.
    """
    found = np.zeros((3, max(box.points), len(places)))
    for axis, (t, n) in enumerate(zip(lattice_coordinates(places, box.origin, box.size).T, box.points, strict=True)):
        found[axis, :n] = weights(t, n, box.basis).T
    return found


def farthest_first(axes: Array, first: int, count: int) -> Indices:
    """Indices (count,) of vertices, each the farthest from all before it, in weights (3, n, V); ties by index."""
    blocks = neighbours(axes, BLOCK)
    squares = products(axes, axes)
    members, own = np.ascontiguousarray(axes[:, :, blocks].transpose(2, 0, 1, 3)), squares[blocks]
    middles = np.ascontiguousarray(members[..., 0].transpose(1, 0, 2))
    radius = _lengths(own + own[:, :1] - 2 * products(members, members[..., :1])).max(axis=1)
    distance, reach = np.full(blocks.shape, np.inf), np.full(len(blocks), np.inf)
    farthest, order = distance.max(axis=1), np.full(count, first)
    for n in range(1, count):
        last, square = axes[:, :, order[n - 1], None], squares[order[n - 1]]
        x, y, z = (middles @ last)[..., 0]
        near = np.flatnonzero(own[:, 0] + square - 2 * x * y * z < reach)
        nearest = np.minimum(distance[near], own[near] + square - 2 * products(members[near], last))
        distance[near], farthest[near] = nearest, nearest.max(axis=1)
        reach[near] = (_lengths(farthest[near]) + radius[near] + ROUNDING) ** 2
        most = np.flatnonzero(farthest == farthest.max())
        order[n] = blocks[most][distance[most] == farthest[most[0]]].min()
    return order


def neighbours(axes: Array, most: int) -> Indices:
    """All vertices of weights (3, n, V) in blocks (b, s) of some near each other at rest, the middle one first, s <= most.

    Where a block lacks one, it has another twice.
    """
    cells = np.arange(axes.shape[1]) @ axes
    whole, sizes = np.arange(axes.shape[2])[None], np.array([axes.shape[2]])
    while whole.shape[1] > most:
        whole, sizes = _halved(whole, sizes, cells)
    off = cells[:, whole] - cells[:, whole].mean(axis=2, keepdims=True)
    return np.take_along_axis(whole, (off**2).sum(axis=0).argsort(axis=1, kind="stable"), axis=1)


def _halved(blocks: Indices, sizes: Indices, cells: Array) -> tuple[Indices, Indices]:
    """Blocks (b, s), of which so many (b,) count, cut in the middle of their longest side in cells (3, V) of the lattice.

    Vertices above the middle follow those below. What does not count repeats the block from its first vertex on.
    """
    longest = np.ptp(cells[:, blocks], axis=2).argmax(axis=0)
    along = cells[longest[:, None], blocks]
    along[np.arange(blocks.shape[1]) >= sizes[:, None]] = np.inf
    order = np.take_along_axis(blocks, along.argsort(axis=1, kind="stable"), axis=1)
    parts = np.stack([sizes // 2, sizes - sizes // 2], axis=1)
    places = np.arange(parts.max()) % parts[..., None] + np.stack([np.zeros_like(sizes), sizes // 2], axis=1)[..., None]
    return np.take_along_axis(order[:, None], places, axis=2).reshape(-1, places.shape[2]), parts.reshape(-1)


def products(some: Array, others: Array) -> Array:
    """W_v . W_w from weights (.., 3, n, s) of either, (.., s); the same bits on every processor, which matrix products are not."""
    found = (some * others).sum(axis=-2)
    return found[..., 0, :] * found[..., 1, :] * found[..., 2, :]


def _lengths(squares: Array) -> Array:
    return np.sqrt(np.maximum(squares, 0.0))
