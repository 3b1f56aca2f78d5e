"""How far a box sinks that rests on a plane, by the linear theory in numpy."""

from __future__ import annotations

import numpy as np

from softffd.validation.stability.drive import Drive


def static_sag(drive: Drive, *, held: bool = False) -> float:
    """Static sag of the centre for a gravity of 1 m/s2 and a stiffness of 1 N/m, of a box whose springs are all alike [m].

    held: the lower face cannot widen; it is free to otherwise.
    """
    a, b = drive.body.pairs.T
    along = drive.rest[b] - drive.rest[a]
    along /= np.linalg.norm(along, axis=1)[:, None]
    rows = np.zeros((len(a), 3 * len(drive.rest)))
    for axis in range(3):
        rows[np.arange(len(a)), 3 * a + axis] -= along[:, axis]
        rows[np.arange(len(a)), 3 * b + axis] += along[:, axis]
    weight = np.tile([0.0, 0.0, -1.0], (len(drive.rest), 1)) * drive.mass[:, None]
    free = np.repeat(drive.rest[:, 2] > 0, 3) | ((np.arange(rows.shape[1]) % 3 != 2) & (not held))
    moved = np.zeros(rows.shape[1])
    moved[free] = np.linalg.lstsq((rows.T @ rows)[np.ix_(free, free)], weight.ravel()[free], rcond=1e-10)[0]
    return float(-drive.mass @ moved.reshape(-1, 3)[:, 2] / drive.mass.sum())
