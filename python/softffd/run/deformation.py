"""How far a lattice is deformed: the one meaning of the largest deformation in numbers, pictures and words."""

import numpy as np


def deformation(positions: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """The largest distance (T,) [m] of a control point from the rest shape, moved and turned to fit best.

    positions: (T, nx, ny, nz, 3) [m]. rest: (nx, ny, nz, 3) [m]. The best fit is that of the least squares (Kabsch 1976), no mirror image.
    """
    moved, at_rest = positions.reshape(len(positions), -1, 3), rest.reshape(-1, 3)
    moved, at_rest = moved - moved.mean(axis=1, keepdims=True), at_rest - at_rest.mean(axis=0)
    u, _, vt = np.linalg.svd(np.einsum("na,tnb->tab", at_rest, moved))
    u[:, :, -1] *= np.where(np.linalg.det(u @ vt) < 0, -1.0, 1.0)[:, None]
    return np.linalg.norm(moved - at_rest @ (u @ vt), axis=2).max(axis=1)
