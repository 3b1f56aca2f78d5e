"""Deformation of the lattice, strain and stress of its cells, computed from control points and the material, springs or a solid.

For springs, the deformation gradient F at the centre of a cell is that of the mean of its four edges along each axis. Under F the springs
of a cell store the energy

    W = sum of k (|F l| - |l|)^2 / (2 V),    l a spring at rest, V the cell's volume.

Each spring is shared equally by the cells around it; if the scene gives a modulus, a cell counts the stiffness that it gives a spring
itself. The Cauchy stress is dW/dF F^T / det F: the sum of k (1 - |l| / |d|) d d^T / (V det F), d = F l.

Inside a patch of a solid the deformation is a polynomial, and so is F. With J = det F and C = dJ/dF the material has the first
Piola-Kirchhoff stress

    P = mu F + (mu (J - 2) + lambda pi - lambda (J0 - J)^2 / J0) C,    mu = E / 2 (1 + nu),  lambda = E nu / (1 + nu) (1 - 2 nu),

neo-Hookean (Smith, de Goes & Kim 2018, without the logarithm), and the Cauchy stress P F^T / J = mu F F^T / J + (..) 1. pi is J - 1
projected onto the trilinear functions of the patch, in the sum over its nodes (nodes.py); without the projection the material would lock
where nu is near 1/2 (Maday & Patera 1989). The last term of P applies only where J < J0 = 0.3; it keeps the material from inverting.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from softffd.embedding.basis import weights
from softffd.embedding.nodes import PLACES, WEIGHTS, along_axes
from softffd.lattice import LatticeBox
from softffd.scene.springs import WAYS, cell_stiffness

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

CENTRES = np.array([1.0, 3.0, 5.0]) / 6  # centres of the cells along an axis of a patch
FOLDING = 0.3  # J0


def deformation(positions: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Returns the largest distance (T,) [m] of a control point from the rest shape, which is moved and rotated to fit best.

    positions: (T, nx, ny, nz, 3) [m]. rest: (nx, ny, nz, 3) [m]. The best fit is that of least squares (Kabsch 1976), without a mirror
        image.
    """
    moved, at_rest, turns = best_fit(positions, rest)
    return np.linalg.norm(moved - at_rest @ turns, axis=2).max(axis=1)


def best_fit(positions: np.ndarray, rest: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns points (T, n, 3) and points at rest (n, 3), each about their mean [m], and turns (T, 3, 3) by which points ~ rest @ turn."""
    moved, at_rest = positions.reshape(len(positions), -1, 3), rest.reshape(-1, 3)
    moved, at_rest = moved - moved.mean(axis=1, keepdims=True), at_rest - at_rest.mean(axis=0)
    u, _, vt = np.linalg.svd(np.einsum("na,tnb->tab", at_rest, moved))
    u[:, :, -1] *= np.where(np.linalg.det(u @ vt) < 0, -1.0, 1.0)[:, None]
    return moved, at_rest, u @ vt


def lattice_gradients(positions: np.ndarray, lattice: LatticeBox) -> np.ndarray:
    """Returns F at the centres of the cells (..., nx - 1, ny - 1, nz - 1, 3, 3), of springs or a solid.

    positions: of the control points (..., nx, ny, nz, 3) [m]."""
    return patch_gradients(positions, lattice.size) if lattice.basis == "patches" else gradients(positions, _sides(lattice))


def lattice_stress(positions: np.ndarray, lattice: LatticeBox, scene: Scene, parameters: Mapping[str, float]) -> np.ndarray:
    """Returns the Cauchy stress (..., 3, 3) [Pa] of the scene's material at the centres of the cells; NaN in inverted cells.
    parameters: values of the run, where they differ from the scene's."""
    if lattice.basis == "patches":
        modulus, ratio = (float(parameters.get(key, getattr(scene.material, key))) for key in ("youngs_modulus", "poissons_ratio"))
        return solid_stress(positions, lattice.size, modulus, ratio)
    return cauchy_stress(lattice_gradients(positions, lattice), cell_stiffness(scene, parameters), _sides(lattice))


def _sides(lattice: LatticeBox) -> np.ndarray:
    return np.array(lattice.size) / (np.array(lattice.points) - 1)


def gradients(positions: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Returns F at the centres of the cells (..., nx - 1, ny - 1, nz - 1, 3, 3) of springs.

    positions: of the control points (..., nx, ny, nz, 3) [m]; sides: of a cell at rest (3,) [m].
    """
    columns = []
    for axis in range(3):
        found = np.diff(positions, axis=axis - 4) / sides[axis]
        for other in {0, 1, 2} - {axis}:
            layers = np.moveaxis(found, other - 4, 0)
            found = np.moveaxis((layers[:-1] + layers[1:]) / 2, 0, other - 4)
        columns.append(found)
    return np.stack(columns, axis=-1)


def green_strain(gradient: np.ndarray) -> np.ndarray:
    """Returns the Green-Lagrange strain (F^T F - 1) / 2."""
    return (np.swapaxes(gradient, -1, -2) @ gradient - np.eye(3)) / 2


def cauchy_stress(gradient: np.ndarray, stiffness: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Returns the stress (..., 3, 3) [Pa] of cells with gradients (..., 3, 3) and springs (..., 13) [N/m] along WAYS; NaN in inverted
    ones."""
    total = np.zeros_like(gradient)
    for number, way in enumerate(WAYS):
        rest = np.array(way) * sides
        now = gradient @ rest
        length = np.linalg.norm(now, axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            pull = stiffness[..., number] * (1 - np.linalg.norm(rest) / length)
        total += pull[..., None, None] * now[..., :, None] * now[..., None, :]
    change = np.linalg.det(gradient)
    return total / np.where(change > 0, change * np.prod(sides), np.nan)[..., None, None]


# ---- solids ----


def solid_stress(positions: np.ndarray, size: Sequence[float], modulus: float, ratio: float) -> np.ndarray:
    """Returns the Cauchy stress (..., nx - 1, ny - 1, nz - 1, 3, 3) [Pa] at the centres of a solid's cells, from Young's modulus [Pa]
    and Poisson's ratio; NaN in inverted cells. positions, size: as for `patch_gradients`."""
    mu, lame = modulus / (2 * (1 + ratio)), modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
    gradient = patch_gradients(positions, size)
    change = np.linalg.det(gradient)
    at_nodes = np.linalg.det(patch_gradients(positions, size, PLACES))[..., None] - 1
    projected = along_axes(at_nodes, [np.kron(np.eye(n // 3), _projection()) for n in positions.shape[-4:-1]])[..., 0]
    pressure = mu * (change - 2) + lame * projected - lame * np.maximum(FOLDING - change, 0) ** 2 / FOLDING
    stretched = gradient @ np.swapaxes(gradient, -1, -2)
    whole = np.where(change > 0, change, np.nan)[..., None, None]
    return np.asarray(mu * stretched / whole + np.where(change > 0, pressure, np.nan)[..., None, None] * np.eye(3))


def patch_gradients(positions: np.ndarray, size: Sequence[float], places: np.ndarray = CENTRES) -> np.ndarray:
    """Returns F at these places (m,) of every patch along each axis, (..., m nx / 3, .., 3, 3), by default at the centres of the cells
    (..., nx - 1, ny - 1, nz - 1, 3, 3); where patches meet, each patch has its own value.

    positions: of the control points (..., nx, ny, nz, 3) [m]; size: of the box at rest (3,) [m].
    """
    counts = positions.shape[-4:-1]
    values = [_patches(weights(places, 4), n) for n in counts]
    slopes = [_patches(_slopes(places), n) * (n // 3 / side) for n, side in zip(counts, size, strict=True)]
    columns = [along_axes(positions, [*values[:axis], slopes[axis], *values[axis + 1 :]]) for axis in range(3)]
    return np.stack(columns, axis=-1)


def _slopes(places: np.ndarray) -> np.ndarray:
    """Returns the derivatives of the four weights of a patch of length 1, (m, 4)."""
    lower = weights(places, 3)
    return 3 * (np.pad(lower, [(0, 0), (1, 0)]) - np.pad(lower, [(0, 0), (0, 1)]))


def _projection() -> np.ndarray:
    """Returns the matrix (3, 4) from values at an axis' nodes to the nearest linear function at the centres."""
    at, nodes = 2 * CENTRES - 1, 2 * PLACES - 1
    return WEIGHTS * (1 + np.outer(at, nodes) / (WEIGHTS @ nodes**2))


def _patches(rows: np.ndarray, n: int) -> np.ndarray:
    """Returns the matrix (m n / 3, n) of an axis of n control points that applies rows (m, 4) of a patch patch by patch."""
    found = np.zeros((n // 3, len(rows), n))
    for patch in range(n // 3):
        found[patch, :, 3 * patch : 3 * patch + 4] = rows
    return found.reshape(-1, n)
