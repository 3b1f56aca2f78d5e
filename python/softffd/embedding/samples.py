"""Samples of the object's surface that obstacles meet: the mesh's vertices, or, of many, those that the others follow closely.

A vertex v that is left out lies, whatever the deformation, behind a plane by at most e_v times the height of the lattice above it if no
sample is behind it,

    e_v = 1/2 |W_v - sum alpha_s W_s|_1        for any alpha_s >= 0 that sum to 1,

W being the weights of all control points: those of a combination of samples are not behind the plane, and the entries of the difference
sum to 0. Samples are chosen farthest first by the distance |W_v - W_s|_2, which is what deformation can separate, and alpha is the nearest
combination of the samples nearest to a vertex, by pairwise Frank-Wolfe steps (Lacoste-Julien & Jaggi 2015).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softffd.embedding.basis import weights
from softffd.embedding.deform import lattice_coordinates
from softffd.lattice import LatticeBox
from softffd.mesh.mesh import Mesh

MOST = 5000
"""Samples of a mesh that has more vertices"""
NEAREST, ROUNDS, ENOUGH = 16, 400, 1e-9
"""Samples that a vertex is compared with; steps towards their nearest combination at most, and what more could gain that ends them"""
_BLOCK = 1 << 21
"""Numbers held at a time: 16 MB"""

Axes = Sequence[np.ndarray]
"""Weights of the control points of x, y and z (n, V) at the vertices, whose products are those of all"""


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a surface.

    places: (S, 3) m at rest, in the order of the vertices. vertices: how many places they have. behind: by how much of the lattice's height
    any other vertex can be behind a plane.
    """

    places: np.ndarray
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
    at = lattice_coordinates(places, box.origin, box.size)
    axes = [np.ascontiguousarray(weights(t, n, box.basis).T) for t, n in zip(at.T, box.points, strict=True)]
    order = farthest_first(axes, int(places[:, 2].argmin()), MOST)
    few, many, behind = 0, MOST, most_behind(axes, order)
    while behind <= penetration and many - few > MOST // 20:
        middle = (few + many) // 2
        if (found := most_behind(axes, order[:middle])) <= penetration:
            many, behind = middle, found
        else:
            few = middle
    return Samples(places[np.sort(order[:many])], len(places), behind)


def farthest_first(axes: Axes, first: int, count: int) -> np.ndarray:
    """Indices (count,) of vertices, each the farthest from all before it, in weights; ties by index."""
    squares = _products(axes, axes)
    order, distance = np.empty(count, np.int64), np.full(len(squares), np.inf)
    order[0] = first
    for n in range(1, count):
        last = order[n - 1]
        near = _products(axes, [along[:, last, None] for along in axes])
        np.minimum(distance, squares + squares[last] - 2 * near, out=distance)
        order[n] = distance.argmax()
    return order


def most_behind(axes: Axes, samples: np.ndarray) -> float:
    """The largest e_v of the vertices that are not among the samples (indices)."""
    left = np.setdiff1d(np.arange(axes[0].shape[1]), samples)
    points = math.prod(len(along) for along in axes)
    step = max(1, _BLOCK // max(len(samples), 2 * points, NEAREST**2))
    blocks = (left[start : start + step] for start in range(0, len(left), step))
    return max((float(_behind(axes, samples, block).max()) for block in blocks), default=0.0)


def _products(some: Axes, others: Axes) -> np.ndarray:
    """W_v . W_w, the same bits on every processor, which matrix products are not."""
    x, y, z = ((a * b).sum(axis=0) for a, b in zip(some, others, strict=True))
    return x * y * z


def _behind(axes: Axes, samples: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """e_v of some vertices, (m,)."""
    near = math.prod(along[:, vertices].T @ along[:, samples] for along in axes)
    distance = _products(axes, axes)[samples] - 2 * near
    count = min(NEAREST, len(samples))
    chosen = samples[np.argpartition(distance, count - 1, axis=1)[:, :count]]
    mine, theirs = [along[:, vertices].T for along in axes], [along[:, chosen].transpose(1, 2, 0) for along in axes]
    gram = math.prod(each @ each.transpose(0, 2, 1) for each in theirs)
    aim = math.prod(np.einsum("vi,vsi->vs", own, each) for own, each in zip(mine, theirs, strict=True))
    x, y, z = theirs
    combined = np.einsum("vsi,vsj,vsk->vijk", _nearest_combination(gram, aim)[..., None] * x, y, z, optimize=True)
    return 0.5 * np.abs(np.einsum("vi,vj,vk->vijk", *mine) - combined).sum(axis=(1, 2, 3))


def _nearest_combination(gram: np.ndarray, aim: np.ndarray) -> np.ndarray:
    """Shares (m, s) >= 0 that sum to 1 and minimise 1/2 alpha . gram alpha - aim . alpha, for gram (m, s, s) and aim (m, s)."""
    rows = np.arange(len(aim))
    shares = np.zeros_like(aim)
    first = (0.5 * np.einsum("vss->vs", gram) - aim).argmin(axis=1)
    shares[rows, first] = 1.0
    slope = gram[rows, first] - aim
    for _ in range(ROUNDS):
        to, away = slope.argmin(axis=1), np.where(shares > 0, slope, -np.inf).argmax(axis=1)
        gain = slope[rows, away] - slope[rows, to]
        if gain.max() < ENOUGH:
            break
        bend = gram[rows, to, to] + gram[rows, away, away] - 2 * gram[rows, to, away]
        length = np.minimum(shares[rows, away], np.divide(gain, bend, out=np.ones_like(gain), where=bend > 0))
        shares[rows, to] += length
        shares[rows, away] -= length
        slope += length[:, None] * (gram[rows, to] - gram[rows, away])
    return shares
