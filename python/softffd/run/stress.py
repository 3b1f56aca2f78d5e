"""Deformation of the lattice, strain and stress of its cells: what an engineer looks at, from control points and springs or a solid.

Those of a solid are in stress_solid.py. Of springs, the deformation gradient F at the centre of a cell is that of the mean of its four
edges along each axis. Its springs, each shared equally by the cells around it, or of a modulus with what this cell gives it, store under F
the energy

    W = sum of k (|F l| - |l|)^2 / (2 V),    l a spring at rest, V the cell's volume,

and the Cauchy stress is dW/dF F^T / det F: the sum of k (1 - |l| / |d|) d d^T / (V det F), d = F l.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from softffd.lattice import LatticeBox
from softffd.run.stress_solid import patch_gradients, solid_stress
from softffd.scene.springs import WAYS, cell_stiffness

if TYPE_CHECKING:
    from softffd.scene.scene import Scene


def deformation(positions: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """The largest distance (T,) [m] of a control point from the rest shape, moved and turned to fit best.

    positions: (T, nx, ny, nz, 3) [m]. rest: (nx, ny, nz, 3) [m]. The best fit is that of the least squares (Kabsch 1976), no mirror image.
    """
    moved, at_rest, turns = best_fit(positions, rest)
    return np.linalg.norm(moved - at_rest @ turns, axis=2).max(axis=1)


def best_fit(positions: np.ndarray, rest: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The points (T, n, 3) and those at rest (n, 3), each about their mean [m], and the turns (T, 3, 3) by which points ~ rest @ turn."""
    moved, at_rest = positions.reshape(len(positions), -1, 3), rest.reshape(-1, 3)
    moved, at_rest = moved - moved.mean(axis=1, keepdims=True), at_rest - at_rest.mean(axis=0)
    u, _, vt = np.linalg.svd(np.einsum("na,tnb->tab", at_rest, moved))
    u[:, :, -1] *= np.where(np.linalg.det(u @ vt) < 0, -1.0, 1.0)[:, None]
    return moved, at_rest, u @ vt


def lattice_gradients(positions: np.ndarray, lattice: LatticeBox) -> np.ndarray:
    """F at the centres of the cells (..., nx - 1, ny - 1, nz - 1, 3, 3), of springs or a solid.

    positions: of the control points (..., nx, ny, nz, 3) [m]."""
    return patch_gradients(positions, lattice.size) if lattice.basis == "patches" else gradients(positions, _sides(lattice))


def lattice_stress(positions: np.ndarray, lattice: LatticeBox, scene: Scene, parameters: Mapping[str, float]) -> np.ndarray:
    """Cauchy stress (..., 3, 3) [Pa] there, of the scene's material; parameters: of the run, where they differ. NaN in inverted cells."""
    if lattice.basis == "patches":
        modulus, ratio = (float(parameters.get(key, getattr(scene.material, key))) for key in ("youngs_modulus", "poissons_ratio"))
        return solid_stress(positions, lattice.size, modulus, ratio)
    return cauchy_stress(lattice_gradients(positions, lattice), cell_stiffness(scene, parameters), _sides(lattice))


def _sides(lattice: LatticeBox) -> np.ndarray:
    return np.array(lattice.size) / (np.array(lattice.points) - 1)


def gradients(positions: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """F at the centres of the cells (..., nx - 1, ny - 1, nz - 1, 3, 3) of springs.

    positions: (..., nx, ny, nz, 3) [m]; sides: of a cell at rest (3,) [m].
    """
    columns = []
    for axis in range(3):
        found = np.diff(positions, axis=axis - 4) / sides[axis]
        for other in {0, 1, 2} - {axis}:
            found = (_but(found, other, last=True) + _but(found, other, last=False)) / 2
        columns.append(found)
    return np.stack(columns, axis=-1)


def _but(grid: np.ndarray, axis: int, *, last: bool) -> np.ndarray:
    """A grid (..., nx, ny, nz, c) without the last or the first layer along an axis."""
    return np.moveaxis(np.moveaxis(grid, axis - 4, 0)[slice(None, -1) if last else slice(1, None)], 0, axis - 4)


def green_strain(gradient: np.ndarray) -> np.ndarray:
    """(F^T F - 1) / 2."""
    return (np.swapaxes(gradient, -1, -2) @ gradient - np.eye(3)) / 2


def cauchy_stress(gradient: np.ndarray, stiffness: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Stress (..., 3, 3) [Pa] of cells with gradients (..., 3, 3) and springs (..., 13) [N/m] along WAYS; NaN in folded cells."""
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
