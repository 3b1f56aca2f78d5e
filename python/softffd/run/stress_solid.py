"""Deformation gradient and stress of a solid at the centres of its cells.

Inside a patch the deformation is a polynomial, and so is F. With J = det F and C = dJ/dF the material has the stress of Piola and Kirchhoff

    P = mu F + (mu (J - 2) + lambda pi - lambda (J0 - J)^2 / J0) C,    mu = E / 2 (1 + nu),  lambda = E nu / (1 + nu) (1 - 2 nu),

neo-Hookean (Smith, de Goes & Kim 2018, without the logarithm), and the Cauchy stress P F^T / J = mu F F^T / J + (..) 1. pi is J - 1
projected onto the trilinear functions of the patch, in the sum over its nodes (nodes.py), without which it would lock where nu is near 1/2
(Maday & Patera 1989). The last term is there where J < J0 = 0.3: it keeps the material from turning inside out.
"""

from collections.abc import Sequence

import numpy as np

from softffd.embedding.basis import weights
from softffd.embedding.nodes import PLACES, WEIGHTS, along_axes

CENTRES = np.array([1.0, 3.0, 5.0]) / 6
"""Of the cells along an axis of a patch"""
FOLDING = 0.3
"""J0"""


def patch_gradients(positions: np.ndarray, size: Sequence[float]) -> np.ndarray:
    """F at the centres of the cells (..., nx - 1, ny - 1, nz - 1, 3, 3).

    positions: of the control points (..., nx, ny, nz, 3) [m]; size: of the box at rest (3,) [m].
    """
    return _gradients(positions, size, CENTRES)


def solid_stress(positions: np.ndarray, size: Sequence[float], modulus: float, ratio: float) -> np.ndarray:
    """Cauchy stress (..., nx - 1, ny - 1, nz - 1, 3, 3) [Pa] of a solid of Young's modulus [Pa] and Poisson's ratio there; NaN where it is
    inverted. positions and size as above."""
    mu, lame = modulus / (2 * (1 + ratio)), modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
    gradient = patch_gradients(positions, size)
    change = np.linalg.det(gradient)
    at_nodes = np.linalg.det(_gradients(positions, size, PLACES))[..., None] - 1
    projected = along_axes(at_nodes, [_blocks(_projection(), n // 3) for n in positions.shape[-4:-1]])[..., 0]
    pressure = mu * (change - 2) + lame * projected - lame * np.maximum(FOLDING - change, 0) ** 2 / FOLDING
    stretched = gradient @ np.swapaxes(gradient, -1, -2)
    whole = np.where(change > 0, change, np.nan)[..., None, None]
    return np.asarray(mu * stretched / whole + np.where(change > 0, pressure, np.nan)[..., None, None] * np.eye(3))


def _gradients(positions: np.ndarray, size: Sequence[float], places: np.ndarray) -> np.ndarray:
    """F at these places (m,) of every patch along each axis, (..., m nx / 3, .., 3, 3); where patches meet, as each of them has it."""
    counts = positions.shape[-4:-1]
    values = [_patches(weights(places, 4), n) for n in counts]
    slopes = [_patches(_slopes(places), n) * (n // 3 / side) for n, side in zip(counts, size, strict=True)]
    columns = [along_axes(positions, [*values[:axis], slopes[axis], *values[axis + 1 :]]) for axis in range(3)]
    return np.stack(columns, axis=-1)


def _slopes(places: np.ndarray) -> np.ndarray:
    """Derivatives of the four weights of a patch of length 1, (m, 4)."""
    lower = weights(places, 3)
    return 3 * (np.pad(lower, [(0, 0), (1, 0)]) - np.pad(lower, [(0, 0), (0, 1)]))


def _projection() -> np.ndarray:
    """The linear function nearest to values at an axis' nodes, at the centres, (3, 4)."""
    at, nodes = 2 * CENTRES - 1, 2 * PLACES - 1
    return WEIGHTS * (1 + np.outer(at, nodes) / (WEIGHTS @ nodes**2))


def _patches(rows: np.ndarray, n: int) -> np.ndarray:
    """What rows (m, 4) of a patch are along an axis of n control points, patch by patch, (m n / 3, n)."""
    found = np.zeros((n // 3, len(rows), n))
    for patch in range(n // 3):
        found[patch, :, 3 * patch : 3 * patch + 4] = rows
    return found.reshape(-1, n)


def _blocks(rows: np.ndarray, patches: int) -> np.ndarray:
    """The same for values that each patch has of its own."""
    return np.kron(np.eye(patches), rows)
