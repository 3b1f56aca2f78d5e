"""The moments of a run that are worth a picture."""

import numpy as np

from softffd.run.findings import reactions


def telling_moments(result):
    """Start, first contact, largest deformation and end, in the order of time: {frame: words}.

    A first contact that is hardly apart from another of them is left out.
    """
    found = {0: "start", len(result.time) - 1: "end"}
    found.setdefault(largest_deformation(result), "largest deformation")
    contact = first_contact(result)
    if contact is not None and min(abs(contact - frame) for frame in found) > 0.02 * len(result.time):
        found[contact] = "first contact"
    return dict(sorted(found.items()))


def first_contact(result):
    """The first frame in which an obstacle reports a reaction, or None."""
    forces = [force for part, force in reactions(result).items() if part.is_obstacle]
    touching = np.flatnonzero(np.any([force.any(axis=1) for force in forces], axis=0)) if forces else []
    return int(touching[0]) if len(touching) else None


def largest_deformation(result):
    """The frame with the largest deformation."""
    return int(result.deformation().argmax())
