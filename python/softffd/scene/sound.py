"""Whether the box and the control points of a draft are those that are meant, so that checks may go by them."""

from softffd.scene.draft import Draft
from softffd.scene.sections import Lattice


def box_is_sound(draft: Draft) -> bool:
    """Its own keys hold, and the mesh that it follows was read."""
    own = all(draft.sound("lattice", key) for key in ("origin", "size", "margin"))
    return own and (draft.sound("mesh") or box_is_given(draft.scene.lattice))


def box_is_given(lattice: Lattice) -> bool:
    """By both of its keys."""
    return {"origin", "size"} <= lattice.model_fields_set


def counts_are_sound(draft: Draft) -> bool:
    """The keys that say how many control points there are hold, and so does the box where they follow it."""
    own = all(draft.sound("lattice", key) for key in ("points", "cells", "spacing"))
    lattice = draft.scene.lattice
    return own and (box_is_sound(draft) or (lattice.cells is None and lattice.spacing is None))
