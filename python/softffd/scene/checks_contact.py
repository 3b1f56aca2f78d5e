"""The checks of contact of the surface: a mesh that has one, a method that knows it."""

from collections.abc import Iterator

from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, toml_text
from softffd.scene.sections import SOLIDS

MEETING = ("auto", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "backward_euler")
"""Methods that may be asked for beside contact of the surface"""


def contact_check(draft: Draft) -> Iterator[Fault]:
    """The problems of a draft's contact with its mesh and method."""
    contact = draft.scene.contact
    if not draft.sound("contact", "of"):
        return
    if contact.of == "lattice":
        yield from _solids_of_lattice(draft)
        if "penetration" in contact.model_fields_set and draft.sound("contact", "penetration"):
            text = f'wanted it beside of = "surface" only, got {contact.penetration:g} with of = "lattice"'
            yield Fault(("contact", "penetration"), text)
        return
    if draft.scene.mesh is None and draft.sound("mesh"):
        yield Fault(("contact", "of"), '"surface" needs a mesh, but the scene has no [mesh]; take "lattice" instead')
    if draft.scene.obstacles:
        yield from _method(draft)


def _solids_of_lattice(draft: Draft) -> Iterator[Fault]:
    for section in SOLIDS:
        if getattr(draft.scene, section):
            text = f'"lattice" knows planes alone, but the scene has a [[{section}]]; take "surface", which needs a [mesh]'
            yield Fault(("contact", "of"), text)


def _method(draft: Draft) -> Iterator[Fault]:
    method = draft.scene.solver.method
    if method == "backward_euler" and draft.scene.solids and draft.sound("solver", "method"):
        wanted = '"auto", "leapfrog", "bm4", "rkn12", "dop853" or "ros34pw2"'
        text = f"wanted {wanted} beside a sphere, cylinder or box, got {toml_text(method)}"
        yield Fault(("solver", "method"), text)
    if method not in MEETING and draft.sound("solver", "method"):
        wanted = " or ".join([", ".join(f'"{each}"' for each in MEETING[:-1]), f'"{MEETING[-1]}"'])
        text = f'wanted {wanted} beside contact.of = "surface", which it does not know, got {toml_text(method)}'
        yield Fault(("solver", "method"), text)
