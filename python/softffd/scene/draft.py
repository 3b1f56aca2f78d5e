"""A scene while it is read: its keys, each looked at by itself, then its mesh and what the keys leave open.

This is the first of two passes; `checks` looks at what holds between the keys that are sound, and asks `sound(...)` for those of others.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from operator import eq
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from softffd.errors import MeshError
from softffd.mesh.mesh import Mesh
from softffd.scene.cells import MOST, cells_of
from softffd.scene.faults import Fault, KeyPath, faults_of, table_in
from softffd.scene.keys import SceneKeys
from softffd.scene.sections import Contact, Lattice, Mass, Material, MeshFile, Stiffness

MEETING = ("auto", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "backward_euler", "sdirk2")
"""Methods that may be asked for beside contact of the surface"""
STIFFNESS = 1e3  # of springs where a scene says neither stiffness nor modulus [N/m]
POISSONS_RATIO = 0.45  # of a solid where a scene does not say
Triple = tuple[float, float, float]


@dataclass
class Draft:
    """The sound keys of a document with what was filled in, what is wrong with the others, and the mesh where that was read.

    A key at fault is left out; where one must be given stands an example.
    """

    keys: SceneKeys
    faults: list[Fault]
    mesh: Mesh | None = None

    def sound(self, *path: str | int) -> bool:
        """Whether neither the value at `path` nor a part of it nor a table around it is at fault."""
        return not any(all(map(eq, place, path)) for fault in self.faults for place in (fault.path, fault.meant) if place)

    @property
    def box_is_given(self) -> bool:
        """By both of its keys."""
        return {"origin", "size"} <= self.keys.lattice.model_fields_set

    @property
    def box(self) -> tuple[Triple, Triple] | None:
        """Origin and size [m] where they are those that are meant: their keys hold, and the mesh that they follow was read."""
        lattice = self.keys.lattice
        known = all(self.sound("lattice", key) for key in ("origin", "size", "margin")) and (self.sound("mesh") or self.box_is_given)
        return (lattice.origin, lattice.size) if known and lattice.origin and lattice.size else None

    @property
    def counts(self) -> tuple[int, int, int] | None:
        """Control points per axis, where their keys hold and so does the box, if they follow it."""
        lattice = self.keys.lattice
        known = all(self.sound("lattice", key) for key in ("points", "cells", "spacing")) and not isinstance(lattice.points, str)
        follows = lattice.cells is not None or lattice.spacing is not None
        return lattice.points if known and (not follows or (self.box and self.sound("material", "model"))) else None

    @property
    def multiple(self) -> int:
        """Of how many cells the body has multiples along each axis."""
        return self.keys.material.multiple


def read_draft(document: Mapping[Any, Any], folder: Path) -> Draft:
    """The draft of a document, whose sections may be tables or instances, of which only what was given counts. folder: of the mesh file."""
    given = plain(document)
    try:
        draft = Draft(SceneKeys.model_validate(given), [])
    except ValidationError as error:
        draft = Draft(SceneKeys(), faults_of(error, SceneKeys))
        draft.keys = SceneKeys.model_validate(_sound_part(given, draft))
    with np.errstate(over="ignore", invalid="ignore"):  # huge boxes are refused in words
        _fill_in(draft, folder)
    return draft


def plain(value: Any) -> Any:
    """A copy of a document in which numpy's numbers are Python's, sections the tables of the keys that were given, and keys words."""
    value = value.tolist() if isinstance(value, np.generic | np.ndarray) else value
    if isinstance(value, BaseModel):
        value = {key: getattr(value, key) for key in value.model_fields_set}
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    return [plain(entry) for entry in value] if isinstance(value, Iterable) and not isinstance(value, str | bytes) else value


def _sound_part(document: dict[str, Any], draft: Draft) -> dict[str, Any]:
    wrong = {fault.path for fault in draft.faults}

    def part_of(section: type[BaseModel], table: Any, path: KeyPath) -> dict[str, Any]:
        examples = {key: field.examples[0] for key, field in section.model_fields.items() if field.is_required() and field.examples}
        given = table if isinstance(table, dict) else {}
        return examples | {key: value for key, value in given.items() if draft.sound(*path, key)}

    part: dict[str, Any] = {}
    for name in document.keys() & SceneKeys.model_fields.keys():
        section, value = table_in(SceneKeys.model_fields[name].annotation), document[name]
        if (name,) in wrong:
            continue
        if section and isinstance(value, list):
            value = [part_of(section, table, (name, position)) for position, table in enumerate(value)]
        elif section and value is not None:
            value = part_of(section, value, (name,))
        part[name] = value
    return part


def _fill_in(draft: Draft, folder: Path) -> None:
    """Loads the mesh and fills in what the file leaves open: box, control points, and defaults that depend on other keys."""
    keys = draft.keys
    found: dict[str, Any] = {}
    if keys.mesh is not None and draft.sound("mesh"):
        found["mesh"] = keys.mesh.filled(file=folder / keys.mesh.file)
        _read_mesh(draft, found["mesh"])
    found["lattice"] = _lattice(keys.lattice, draft.mesh, keys.material)
    found["material"] = _material(keys.material)
    found["mass"] = _mass(keys.mass, draft.mesh, keys.material)
    found["contact"] = _contact(keys)
    draft.keys = keys.model_copy(update=found)


def _read_mesh(draft: Draft, source: MeshFile) -> None:
    from softffd.mesh.files import load_mesh  # only scenes with a mesh pay for the import

    try:
        draft.mesh = load_mesh(source.file, scale=source.scale, up=source.up)
    except MeshError as error:
        draft.faults.append(Fault(("mesh", "file"), " ".join(str(error).split())))


def _lattice(lattice: Lattice, mesh: Mesh | None, material: Material) -> Lattice:
    """The box as given, else that of the mesh grown by the margin, else the unit box; control points as `cells` or `spacing` ask for
    where `points` does not say how many there are; the patches of a solid."""
    multiple = material.multiple
    if material.model == "solid" and "basis" not in lattice.model_fields_set:
        lattice = lattice.filled(basis="patches")
    lower, upper = np.array([[0.0] * 3, [1.0] * 3]) if mesh is None else mesh.bounds
    grown = lattice.margin * (upper - lower) if mesh is not None else np.zeros(3)
    origin = lattice.origin or tuple((lower - grown).tolist())
    size = lattice.size or tuple((upper - lower + 2 * grown).tolist())
    boxed = lattice.filled(origin=origin, size=size)
    if (lattice.cells is None and lattice.spacing is None) or ("points" in lattice.model_fields_set and str(lattice.points) != "cubic"):
        return boxed
    counts = tuple(min(count, MOST // multiple * multiple) + 1 for count in cells_of(lattice.cells, lattice.spacing, size, multiple))
    return Lattice.model_construct(lattice.model_fields_set - {"points"}, **(dict(boxed) | {"points": counts}))


def _material(material: Material) -> Material:
    """A stiffness of all springs where neither that nor a modulus is given; no drag beside a modulus; a solid's Poisson's ratio."""
    if material.model == "solid" and material.poissons_ratio is None:
        material = material.filled(poissons_ratio=POISSONS_RATIO)
    if material.youngs_modulus is not None:
        return material if "damping" in material.model_fields_set else material.filled(damping=0.0)
    if material.stiffness or material.model == "solid":
        return material
    return material.filled(stiffness=Stiffness(edge=STIFFNESS, face=STIFFNESS, body=STIFFNESS))


def _mass(mass: Mass, mesh: Mesh | None, material: Material) -> Mass:
    if mass.density is None and mass.total is None:
        of_solid = material.model == "solid" and material.density is not None
        mass = mass.filled(density=material.density) if of_solid else mass.filled(total=1.0)
    if (material.model == "solid" or material.youngs_modulus is not None) and "distribution" not in mass.model_fields_set:
        mass = mass.filled(distribution="volume" if mesh is not None and mesh.closed else "box")
    if mass.distribution == "box" and "uniform_share" not in mass.model_fields_set:
        mass = mass.filled(uniform_share=0.0)  # no point of it is nearly massless
    return mass


def _contact(keys: SceneKeys) -> Contact:
    if "of" in keys.contact.model_fields_set or keys.mesh is None or keys.solver.method not in MEETING:
        return keys.contact
    return keys.contact.filled(of="surface")
