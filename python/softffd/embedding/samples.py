"""Samples of the object's surface that obstacles meet: the mesh's vertices, or, of many, those that the others follow closely.

If no sample is behind a plane, a vertex v that is left out lies behind the plane, whatever the deformation, by at most e_v times the
height of the lattice above the plane,

    e_v = 1/2 |W_v - sum alpha_s W_s|_1        for any alpha_s >= 0 that sum to 1,

where W are the weights of all control points: the point with a combination of the samples' weights is not behind the plane, and the
entries of the difference sum to 0. Samples are chosen farthest first (Gonzalez 1985) by the distance |W_v - W_s|_2, a measure of how far
deformation can separate them. alpha is the nearest combination of samples near a vertex. The library finds both
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
"""Most samples of a mesh that has more vertices"""


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a surface.

    places: (S, 3) m at rest, in the order of the vertices. vertices: number of places of all vertices. behind: fraction of the lattice's
    height by which any other vertex can be behind a plane at most.
    """

    places: Array
    vertices: int
    behind: float


def surface_samples(mesh: Mesh, box: LatticeBox, penetration: float) -> Samples:
    """Returns all places of vertices that faces use; if these are more than MOST, so many of them that no vertex is behind a plane by
    more than `penetration`, but MOST at most.

    penetration: fraction of the lattice's height; 0: all places, however many.
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
    """Returns the weights (3, n, V) of the control points of x, y and z at places (V, 3) [m]; their products are the weights of all
    points.

    n: the most control points of an axis; axes with fewer are filled up with zeros.
    """
    found = np.zeros((3, max(box.points), len(places)))
    for axis, (t, n) in enumerate(zip(lattice_coordinates(places, box.origin, box.size).T, box.points, strict=True)):
        found[axis, :n] = weights(t, n, box.basis).T
    return found


def farthest_first(axes: Array, first: int, count: int) -> Indices:
    """Returns indices (count,) of vertices, each the farthest from all before it, in weights (3, n, V); ties by index."""
    axes, order = np.ascontiguousarray(axes), np.empty(count, dtype=np.int64)
    find = library_function("softffd_farthest_first", None, c_int, c_longlong, c_void_p, c_longlong, c_longlong, c_void_p)
    find(*axes.shape[1:], axes.ctypes.data, first, count, order.ctypes.data)
    return order


def most_behind(axes: Array, samples: Indices, allowed: float = np.inf) -> float:
    """Returns the largest e_v found among vertices of weights (3, n, V) that are not samples (indices), or the first above `allowed`."""
    axes, samples = np.ascontiguousarray(axes), np.ascontiguousarray(samples)
    find = library_function("softffd_most_behind", c_double, c_int, c_longlong, c_void_p, c_longlong, c_void_p, c_double)
    return float(find(*axes.shape[1:], axes.ctypes.data, len(samples), samples.ctypes.data, allowed))
