"""Samples of the object's surface that obstacles meet: the mesh's vertices, or, of many, those that the others follow closely.

A vertex v that is left out lies, whatever the deformation, behind a plane by at most e_v times the height of the lattice above it if no
sample is behind it,

    e_v = 1/2 |W_v - sum alpha_s W_s|_1        for any alpha_s >= 0 that sum to 1,

W being the weights of all control points: those of a combination of samples are not behind the plane, and the entries of the difference
sum to 0. Samples are chosen farthest first by the distance |W_v - W_s|_2, which is what deformation can separate, and alpha is the nearest
combination of samples near a vertex, by pairwise Frank-Wolfe steps (Lacoste-Julien & Jaggi 2015). Any alpha gives a bound: all vertices
take a few steps with samples found block by block, and those whose e_v may be the largest are compared with the samples nearest to them.

The farthest vertex (Gonzalez 1985) is looked for in blocks of vertices near each other at rest, each with a middle, a radius about it, and
how far its farthest vertex is from all that are chosen. A newly chosen vertex p is nearer than those only to vertices of blocks with

    |W_p - W_middle| < radius + farthest of the block,

the others are left alone: the choice is what a search through all vertices finds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from softffd.embedding.basis import weights
from softffd.embedding.deform import lattice_coordinates
from softffd.lattice import LatticeBox
from softffd.mesh.mesh import Mesh

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

MOST = 5000
"""Samples of a mesh that has more vertices"""
NEAREST, AROUND, BLOCK = 16, 64, 16
"""Samples that a vertex is compared with, of so many around a block of so many vertices at most"""
FEW_ROUNDS, ROUNDS, ENOUGH = 20, 400, 1e-9
"""Steps towards the nearest combination: of all vertices, and at most of those that go on; what more could gain that ends them"""
_AT_ONCE, _GO_ON = 1 << 19, 256
"""Numbers held at a time: 4 MB; vertices that go on together"""

WIDE_BLOCK = 64
"""Vertices of a block, at most: of 16 to 128 the quickest on meshes of 10,000 to 160,000 vertices"""
ROUNDING = 1e-7
"""What a distance may be off where squares of weights, which are 1 at most, cancel"""


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a surface.

    places: (S, 3) m at rest, in the order of the vertices. vertices: how many places they have. behind: by how much of the lattice's height
    any other vertex can be behind a plane.
    """

    places: Array
    vertices: int
    behind: float


def surface_samples(mesh: Mesh, box: LatticeBox, penetration: float) -> Samples:
    """All places of vertices that faces use; of more than MOST so many that none is behind by more than `penetration`, MOST at most.

    penetration: share of the lattice's height; 0: all, however many.
    """
    used = mesh.vertices[np.unique(mesh.faces)]
    places = used[np.sort(np.unique(used, axis=0, return_index=True)[1])]
    if len(places) <= MOST or penetration == 0:
        return Samples(places, len(places), 0.0)
    axes = axis_weights(places, box)
    order = farthest_first(axes, int(places[:, 2].argmin()), MOST)
    few, many, behind = 0, MOST, most_behind(axes, order)
    while behind <= penetration and many - few > MOST // 20:
        middle = (few + many) // 2
        if (found := most_behind(axes, order[:middle])) <= penetration:
            many, behind = middle, found
        else:
            few = middle
    return Samples(places[np.sort(order[:many])], len(places), behind)


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
    blocks = neighbours(axes, WIDE_BLOCK)
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


def most_behind(axes: Array, samples: Indices) -> float:
    """The largest e_v found of the vertices of weights (3, n, V) that are not among the samples (indices)."""
    left, near = _samples_around(axes, samples)
    if not len(left):
        return 0.0
    step = max(1, _AT_ONCE // max(2 * axes.shape[1] ** 3, NEAREST**2))
    parts = [slice(start, start + step) for start in range(0, len(left), step)]
    rough = np.concatenate([_behind(axes, near[part], left[part], FEW_ROUNDS) for part in parts])
    order, most = np.argsort(-rough), 0.0
    for start in range(0, len(order), _GO_ON):
        part = order[start : start + _GO_ON]
        if rough[part[0]] <= most:
            break
        nearest = _nearest(axes, samples, left[part], NEAREST)
        most = max(most, np.minimum(rough[part], _behind(axes, nearest, left[part], ROUNDS)).max())
    return float(most)


def _samples_around(axes: Array, samples: Indices) -> tuple[Indices, Indices]:
    """The vertices (m,) that are no samples, some twice, and the samples nearest to each in weights, (m, NEAREST) or all.

    Blocks are of samples too: those of the others alone would be wide where most vertices are samples.
    """
    blocks = neighbours(axes, BLOCK)
    squares, near = products(axes, axes), []
    step = max(1, _AT_ONCE // len(samples))
    for block in (blocks[start : start + step] for start in range(0, len(blocks), step)):
        around = _nearest(axes, samples, block[:, 0], AROUND)
        theirs = axes[:, :, around].transpose(2, 0, 1, 3)
        mine = axes[:, :, block].transpose(2, 0, 1, 3)
        chosen = _least(squares[around][:, None] - 2 * (mine.swapaxes(2, 3) @ theirs).prod(axis=1), NEAREST)
        near.append(np.take_along_axis(around[:, None], chosen, axis=2).reshape(-1, chosen.shape[2]))
    left = ~np.isin(blocks.ravel(), samples)
    return blocks.ravel()[left], np.concatenate(near)[left]


def _nearest(axes: Array, samples: Indices, vertices: Indices, count: int) -> Indices:
    """The samples nearest to vertices (m,) in weights, (m, count) or all."""
    theirs = axes[:, :, samples]
    near, *others = axes[:, :, vertices].swapaxes(1, 2) @ theirs
    for each in (*others, -2.0):
        near *= each
    near += products(theirs, theirs)
    return samples[_least(near, count)]


def _least(values: Array, count: int) -> Indices:
    """Where the least `count` of the last axis are, or all."""
    count = min(count, values.shape[-1])
    return np.argpartition(values, count - 1, axis=-1)[..., :count]


def _behind(axes: Array, near: Indices, vertices: Indices, rounds: int) -> Array:
    """e_v (m,) of some vertices (m,) by the samples near them, (m, s)."""
    mine, theirs = axes[:, :, vertices].transpose(0, 2, 1), axes.transpose(0, 2, 1)[:, near]
    gram = (theirs @ theirs.swapaxes(2, 3)).prod(axis=0)
    aim = (theirs @ mine[..., None])[..., 0].prod(axis=0)
    x, y, z = theirs
    planes = (y[..., None] * z[:, :, None]).reshape(*near.shape, -1)
    combined = np.einsum("vsi,vsp->vip", _nearest_combination(gram, aim, rounds)[..., None] * x, planes)
    own = np.einsum("vi,vj,vk->vijk", *mine).reshape(combined.shape)
    return 0.5 * np.abs(own - combined).sum(axis=(1, 2))


def _nearest_combination(gram: Array, aim: Array, rounds: int) -> Array:
    """Shares (m, s) >= 0 that sum to 1 and nearly minimise 1/2 alpha . gram alpha - aim . alpha, for gram (m, s, s) and aim (m, s)."""
    count = aim.shape[1]
    begin = np.arange(0, aim.size, count)
    first = begin + (0.5 * np.einsum("vss->vs", gram) - aim).argmin(axis=1)
    shares, closed = np.zeros(aim.size), np.full(aim.size, -np.inf)  # closed: -inf where there is nothing to take away
    shares[first], closed[first] = 1.0, 0.0
    rows = gram.reshape(-1, count)
    slope = rows[first] - aim
    for _ in range(rounds):
        to, away = begin + slope.argmin(axis=1), begin + (slope + closed.reshape(slope.shape)).argmax(axis=1)
        gain = slope.take(away) - slope.take(to)
        if gain.max() < ENOUGH:
            break
        turn, back = rows.take(to, axis=0), rows.take(away, axis=0)
        bend = turn.take(to) + back.take(away) - 2 * turn.take(away)
        length = np.minimum(shares[away], np.divide(gain, bend, out=np.ones_like(gain), where=bend > 0))
        shares[to] += length
        shares[away] -= length
        closed[to], closed[away] = 0.0, np.where(shares[away] > 0, 0.0, -np.inf)
        turn -= back
        turn *= length[:, None]
        slope += turn
    return shares.reshape(aim.shape)
