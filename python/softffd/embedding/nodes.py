"""The nodes of a solid: the points of the material at which its patches have their mass and their strain.

A patch has 4 x 4 x 4 nodes, at the points of Gauss-Lobatto quadrature along each axis,

    0,  (1 - 1 / sqrt(5)) / 2,  (1 + 1 / sqrt(5)) / 2,  1      with the weights 1/12, 5/12, 5/12, 1/12,

which is exact for polynomials of degree 5. Patches side by side share the nodes of their common face, so that a lattice of n = 3 e + 1
control points along an axis has n nodes there. A node and the control point of the same index belong together, but are at different
places.
"""

import math
from collections.abc import Sequence

import numpy as np

from softffd.embedding.basis import weights
from softffd.lattice import Counts

PLACES = np.array([0.0, (1 - 1 / math.sqrt(5)) / 2, (1 + 1 / math.sqrt(5)) / 2, 1.0])
"""Places of the nodes along an axis of a patch"""
WEIGHTS = np.array([1.0, 5.0, 5.0, 1.0]) / 12
"""Weights of the quadrature at these places"""


def axis_nodes(n: int) -> np.ndarray:
    """Returns the places (n,) of the nodes of an axis of n = 3 e + 1, from 0 to 1."""
    patches = np.arange(n // 3)[:, None]
    return np.append((patches + PLACES[:3]).ravel(), n // 3) / (n // 3)


def axis_shares(n: int) -> np.ndarray:
    """Returns the fraction of an axis that belongs to each node (n,): the sum of the quadrature weights of the patches around it."""
    shares = np.zeros(n)
    for patch in range(n // 3):
        shares[3 * patch : 3 * patch + 4] += WEIGHTS / (n // 3)
    return shares


def rest_nodes(counts: Counts, origin: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Returns the nodes at rest in a box at `origin` with sides `size` [m], as a grid (nx, ny, nz, 3) [m]."""
    axes = np.meshgrid(*(axis_nodes(count) for count in counts), indexing="ij")
    return np.asarray(origin) + np.asarray(size) * np.stack(axes, axis=-1)


def node_positions(positions: np.ndarray) -> np.ndarray:
    """Returns the positions (..., nx, ny, nz, 3) [m] of the nodes for control points at `positions`, of the same shape."""
    return along_axes(positions, [weights(axis_nodes(n), n, "patches") for n in positions.shape[-4:-1]])


def along_axes(grid: np.ndarray, matrices: Sequence[np.ndarray]) -> np.ndarray:
    """Returns the product of a grid (..., nx, ny, nz, c) with a matrix (m, n) along each of its axes."""
    for axis, matrix in enumerate(matrices):
        grid = np.moveaxis(np.moveaxis(grid, axis - 4, -1) @ matrix.T, -1, axis - 4)
    return grid


def volume_shares(counts: Counts) -> np.ndarray:
    """Returns the fraction of the box that belongs to each node, (nx, ny, nz)."""
    x, y, z = (axis_shares(count) for count in counts)
    return x[:, None, None] * y[:, None] * z
