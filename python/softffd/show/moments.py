"""The moments of a run that are worth a picture."""

import numpy as np

from softffd.run.history import reactions


def telling_moments(result, stage):
    """Start, first contact, largest deformation and end, in the order of time: {frame: words}.

    A first contact that is hardly apart from another of them is left out.
    """
    found = {0: "start", len(stage.time) - 1: "end"}
    found.setdefault(largest_deformation(stage), "largest deformation")
    contact = first_contact(result)
    if contact is not None and min(abs(contact - frame) for frame in found) > 0.02 * len(stage.time):
        found[contact] = "first contact"
    return dict(sorted(found.items()))


def first_contact(result):
    """The first frame in which a plane reports a reaction, or None."""
    forces = [force for part, force in reactions(result).items() if part.kind == "plane"]
    touching = np.flatnonzero(np.any([force.any(axis=1) for force in forces], axis=0)) if forces else []
    return int(touching[0]) if len(touching) else None


def largest_deformation(stage):
    """The frame with the largest deformation."""
    return int(deformation(stage).argmax())


def deformation(stage):
    """Root mean square distance (T,) [m] of the control points from the rest shape, moved and turned to fit best.

    The best rotation is that of the singular value decomposition (Kabsch 1976); only its singular values are needed.
    """
    rest = stage.rest.reshape(-1, 3)
    moved = stage.positions.reshape(len(stage.time), -1, 3)
    rest, moved = rest - rest.mean(axis=0), moved - moved.mean(axis=1, keepdims=True)
    turned = np.einsum("na,tnb->tab", rest, moved)
    singular = np.linalg.svd(turned, compute_uv=False)
    singular[:, 2] *= np.where(np.linalg.det(turned) < 0, -1.0, 1.0)
    squares = (rest**2).sum() + (moved**2).sum(axis=(1, 2)) - 2 * singular.sum(axis=1)
    return np.sqrt(squares.clip(0) / len(rest))
