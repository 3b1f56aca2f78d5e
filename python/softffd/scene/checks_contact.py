"""The checks of contact of the surface: a mesh that has one, a method that knows it."""

from collections.abc import Iterator

from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, toml_text

MEETING = ("auto", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "backward_euler")
"""Methods that may be asked for beside contact of the surface"""


def contact_check(draft: Draft) -> Iterator[Fault]:
    """The problems of a draft's contact with its mesh and method."""
    contact = draft.scene.contact
    if not draft.sound("contact", "of"):
        return
    if contact.of == "lattice":
        if "penetration" in contact.model_fields_set and draft.sound("contact", "penetration"):
            text = f'wanted it beside of = "surface" only, got {contact.penetration:g} with of = "lattice"'
            yield Fault(("contact", "penetration"), text)
        return
    if draft.scene.mesh is None and draft.sound("mesh"):
        yield Fault(("contact", "of"), '"surface" needs a mesh, but the scene has no [mesh]; take "lattice" instead')
    if draft.scene.plane:
        yield from _method(draft)


def _method(draft: Draft) -> Iterator[Fault]:
    method = draft.scene.solver.method
    if method not in MEETING and draft.sound("solver", "method"):
        wanted = " or ".join([", ".join(f'"{each}"' for each in MEETING[:-1]), f'"{MEETING[-1]}"'])
        text = f'wanted {wanted} beside contact.of = "surface", which it does not know, got {toml_text(method)}'
        yield Fault(("solver", "method"), text)
