"""A scene while it is read: each key is checked by itself, then the mesh is loaded and open keys are filled in.

This is the first of two passes. The second one, `checks`, checks relations between keys, and asks `sound(...)` which keys it may rely on.
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
"""Methods that support contact of the surface."""
STIFFNESS = 1e3  # default of springs, if a scene gives neither stiffness nor modulus [N/m]
POISSONS_RATIO = 0.45  # default of a solid
Triple = tuple[float, float, float]


@dataclass
class Draft:
    """The sound keys of a document with the filled-in values, the faults of the other keys, and the mesh if it could be read.

    A faulty key is left out; if it is a required key, its example takes its place.
    """

    keys: SceneKeys
    faults: list[Fault]
    mesh: Mesh | None = None

    def sound(self, *path: str | int) -> bool:
        """True if there is no fault at `path`, in a part of the value at `path`, or in a table around it."""
        return not any(all(map(eq, place, path)) for fault in self.faults for place in (fault.path, fault.meant) if place)

    @property
    def box_is_given(self) -> bool:
        """True if both `origin` and `size` of the lattice are given."""
        return {"origin", "size"} <= self.keys.lattice.model_fields_set

    @property
    def box(self) -> tuple[Triple, Triple] | None:
        """Origin and size [m]; None if one of their keys is faulty, or the mesh that they follow could not be read."""
        lattice = self.keys.lattice
        known = all(self.sound("lattice", key) for key in ("origin", "size", "margin")) and (self.sound("mesh") or self.box_is_given)
        return (lattice.origin, lattice.size) if known and lattice.origin and lattice.size else None

    @property
    def counts(self) -> tuple[int, int, int] | None:
        """Control points per axis; None if one of their keys is faulty, or the box is unknown and the numbers follow from it."""
        lattice = self.keys.lattice
        known = all(self.sound("lattice", key) for key in ("points", "cells", "spacing")) and not isinstance(lattice.points, str)
        follows = lattice.cells is not None or lattice.spacing is not None
        return lattice.points if known and (not follows or (self.box and self.sound("material", "model"))) else None

    @property
    def multiple(self) -> int:
        """The number of cells along each axis is a multiple of this number."""
        return self.keys.material.multiple


def read_draft(document: Mapping[Any, Any], folder: Path) -> Draft:
    """Returns the draft of a document of tables or section instances, of which only the given keys count. folder: of the mesh file."""
    given = plain(document)
    try:
        draft = Draft(SceneKeys.model_validate(given), [])
    except ValidationError as error:
        draft = Draft(SceneKeys(), faults_of(error, SceneKeys))
        draft.keys = SceneKeys.model_validate(_sound_part(given, draft))
    with np.errstate(over="ignore", invalid="ignore"):  # the checks refuse huge boxes
        _fill_in(draft, folder)
    return draft


def plain(value: Any) -> Any:
    """Returns a copy of a document: numpy values become Python's, sections become tables of their given keys, keys text."""
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
    """Loads the mesh and fills in what the file leaves open: the box, the control points, and defaults that depend on other keys."""
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
    from softffd.mesh.files import load_mesh  # imported only for scenes with a mesh

    try:
        draft.mesh = load_mesh(source.file, scale=source.scale, up=source.up)
    except MeshError as error:
        draft.faults.append(Fault(("mesh", "file"), " ".join(str(error).split())))


def _lattice(lattice: Lattice, mesh: Mesh | None, material: Material) -> Lattice:
    """Fills in the box (as given, else that of the mesh enlarged by the margin, else the unit box), the control points that `cells` or
    `spacing` ask for if `points` gives no numbers, and the basis of a solid."""
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
    """Fills in a stiffness if neither stiffness nor modulus is given, zero drag beside a modulus, and Poisson's ratio of a solid."""
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
        mass = mass.filled(uniform_share=0.0)  # no point of a box of uniform density is nearly massless
    return mass


def _contact(keys: SceneKeys) -> Contact:
    if "of" in keys.contact.model_fields_set or keys.mesh is None or keys.solver.method not in MEETING:
        return keys.contact
    return keys.contact.filled(of="surface")
