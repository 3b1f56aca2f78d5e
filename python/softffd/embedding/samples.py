"""Samples of the object's surface that obstacles meet: the mesh's vertices, or, of many, those that the others follow closely.

A vertex v that is left out lies, whatever the deformation, behind a plane by at most e_v times the height of the lattice above it if no
sample is behind it,

    e_v = 1/2 |W_v - sum alpha_s W_s|_1        for any alpha_s >= 0 that sum to 1,

W being the weights of all control points: those of a combination of samples are not behind the plane, and the entries of the difference
sum to 0. Samples are chosen farthest first (Gonzalez 1985) by the distance |W_v - W_s|_2, which is what deformation can separate, and alpha
is the nearest combination of samples near a vertex. The library finds both
(fmu_src/core/embedding/samples.hpp).
"""

from ctypes import c_double, c_int, c_longlong, c_void_p
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from softffd.embedding.basis import weights
from softffd.embedding.deform import lattice_coordinates
from softffd.installed import library_function
from softffd.lattice import LatticeBox
from softffd.mesh.mesh import Mesh

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

MOST = 5000
"""Samples of a mesh that has more vertices"""


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
    used = mesh.vertices[np.bincount(mesh.faces.ravel()).nonzero()]
    places = used[np.sort(np.unique(used, axis=0, return_index=True)[1])]
    if len(places) <= MOST or penetration == 0:
        return Samples(places, len(places), 0.0)
    axes = axis_weights(places, box)
    order = farthest_first(axes, int(places[:, 2].argmin()), MOST)
    few, many, behind = 0, MOST, most_behind(axes, order)
    while behind <= penetration and many - few > MOST // 20:
        middle = (few + many) // 2
        if (found := most_behind(axes, order[:middle], penetration)) <= penetration:
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
    axes, order = np.ascontiguousarray(axes), np.empty(count, dtype=np.int64)
    find = library_function("softffd_farthest_first", None, c_int, c_longlong, c_void_p, c_longlong, c_longlong, c_void_p)
    find(*axes.shape[1:], axes.ctypes.data, first, count, order.ctypes.data)
    return order


def most_behind(axes: Array, samples: Indices, allowed: float = np.inf) -> float:
    """The largest e_v found of the vertices of weights (3, n, V) that are not among the samples (indices), or the first above `allowed`."""
    axes, samples = np.ascontiguousarray(axes), np.ascontiguousarray(samples)
    find = library_function("softffd_most_behind", c_double, c_int, c_longlong, c_void_p, c_longlong, c_void_p, c_double)
    return float(find(*axes.shape[1:], axes.ctypes.data, len(samples), samples.ctypes.data, allowed))
