"""From the keys that a document gives to a scene in which nothing is open: mesh read, box and mass filled in, all checked."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from softffd.errors import MeshError, SceneError
from softffd.scene.cells import MOST, cells_of
from softffd.scene.checks import cross_check
from softffd.scene.checks_contact import MEETING
from softffd.scene.draft import Draft, read_draft, unshared
from softffd.scene.faults import Fault, in_file_order, toml_text
from softffd.scene.keys import SceneKeys
from softffd.scene.section import Section
from softffd.scene.sections import Contact, Lattice, Mass, Material, MeshFile, Stiffness

if TYPE_CHECKING:
    from softffd.mesh.mesh import Mesh

AnySection = TypeVar("AnySection", bound=Section)

STIFFNESS = 1e3
"""Of springs where a scene says neither stiffness nor modulus [N/m]."""


def settled(document: Any, *, folder: Path, where: str) -> Draft:
    """The draft of a document, complete and without faults; sections may be tables or instances, of which only what was given counts.

    folder: holds the mesh file. where: what the scene is called in messages. Raises SceneError with all problems.
    """
    if not isinstance(document, Mapping):
        raise SceneError(where, [f"wanted a table of sections, got {toml_text(document)}"])
    draft = read_draft(dict(document), SceneKeys, where)
    _settle(draft, folder)
    if faults := draft.faults + cross_check(draft):
        raise SceneError(where, [str(fault) for fault in in_file_order(faults, unshared(document))])
    return draft


def _settle(draft: Draft, folder: Path) -> None:
    """Loads the mesh and fills in what the file leaves open: box, control points, and defaults that depend on other keys."""
    scene, changes = draft.scene, {}
    if scene.mesh is not None and draft.sound("mesh"):
        changes["mesh"] = _filled(scene.mesh, file=folder / scene.mesh.file)
        draft.mesh = _load_mesh(draft, changes["mesh"])
    origin, size = _box(scene.lattice, draft.mesh)
    changes["lattice"] = _filled(_counted(scene.lattice, size, draft), origin=origin, size=size)
    changes["material"] = _material(scene.material)
    changes["mass"] = _mass(scene.mass, draft, of_modulus=scene.material.youngs_modulus is not None)
    changes["contact"] = _contact(scene)
    draft.scene = scene.model_copy(update=changes)


def _counted(lattice: Lattice, size: tuple[float, ...], draft: Draft) -> Lattice:
    """The lattice with the control points that `cells` or `spacing` ask for, where `points` does not say how many there are."""
    following = lattice.cells is not None or lattice.spacing is not None
    cubic = lattice.points == "cubic"
    if cubic and not following and draft.sound("lattice", "cells") and draft.sound("lattice", "spacing"):
        draft.note(Fault(("lattice", "points"), 'wanted cells or spacing beside "cubic", got neither'))
    if not cubic and ("points" in lattice.model_fields_set or not following):
        return lattice
    counts = tuple(min(count, MOST) + 1 for count in cells_of(lattice, size)) if following else (4, 4, 4)
    given = lattice.model_fields_set - {"points"}
    return Lattice.model_construct(given, **(dict(lattice) | {"points": counts}))


def _material(material: Material) -> Material:
    """A stiffness of all springs where neither that nor a modulus is given; no drag beside a modulus."""
    if material.youngs_modulus is not None:
        return material if "damping" in material.model_fields_set else _filled(material, damping=0.0)
    usual = Stiffness(edge=STIFFNESS, face=STIFFNESS, body=STIFFNESS)
    return _filled(material, stiffness=material.stiffness or usual)


def _mass(mass: Mass, draft: Draft, *, of_modulus: bool) -> Mass:
    """The total, and how it is spread."""
    values: dict[str, Any] = {}
    if mass.density is None and mass.total is None:
        values["total"] = 1.0
    if of_modulus and "distribution" not in mass.model_fields_set:
        values["distribution"] = "volume" if draft.mesh is not None and draft.mesh.closed else "box"
    if values.get("distribution", mass.distribution) == "box" and "uniform_share" not in mass.model_fields_set:
        values["uniform_share"] = 0.0  # no point of it is nearly massless
    return _filled(mass, **values)


def _contact(scene: SceneKeys) -> Contact:
    """Of the surface, where there is one that the method knows."""
    if "of" in scene.contact.model_fields_set or scene.mesh is None or scene.solver.method not in MEETING:
        return scene.contact
    return _filled(scene.contact, of="surface")


def _filled(section: AnySection, **values: Any) -> AnySection:
    """A copy with other values; `model_fields_set` still names the keys that the file gave."""
    return type(section).model_construct(section.model_fields_set, **(dict(section) | values))


def _load_mesh(draft: Draft, source: MeshFile) -> "Mesh | None":
    from softffd.mesh.files import load_mesh  # only scenes with a mesh pay for the import

    try:
        return load_mesh(source.file, scale=source.scale, up=source.up)
    except MeshError as error:
        draft.note(Fault(("mesh", "file"), " ".join(str(error).split())))
        return None


def _box(lattice: Lattice, mesh: "Mesh | None") -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Origin and size [m]: as given, else those of the mesh's box grown by the margin, else the unit box."""
    lower, upper = np.array([[0.0] * 3, [1.0] * 3]) if mesh is None else mesh.bounds
    grown = lattice.margin * (upper - lower) if mesh is not None else np.zeros(3)
    origin = lattice.origin or tuple((lower - grown).tolist())
    return origin, lattice.size or tuple((upper - lower + 2 * grown).tolist())
