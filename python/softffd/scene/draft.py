"""From a TOML document to a first `Scene`, whatever is wrong with it.

A user wants to hear of all problems at once, but a cross check ("is this selection inside the lattice?")
needs values that hold. So a faulty value is noted and taken out, in favour of its default (of an example, if
the key must be given). The rest is a complete scene, on which the cross checks run; each asks `sound(...)`
first whether the values that it reads are the user's own.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from softffd.errors import SceneError
from softffd.scene.faults import Fault, KeyPath, faults_of, field_at

if TYPE_CHECKING:
    from softffd.mesh.mesh import Mesh


@dataclass
class Draft:
    """A complete scene, what is known to be wrong in its file, and its mesh where that was read."""

    scene: Any
    faults: list[Fault] = field(default_factory=list)
    mesh: "Mesh | None" = None

    def sound(self, *path: str | int) -> bool:
        """Whether neither the value at `path` nor a part of it nor a table around it is at fault."""
        return not any(_overlap(fault.path, path) for fault in self.faults)

    def note(self, fault: Fault) -> None:
        """Adds a fault; from now on the value at its path counts as not sound."""
        self.faults.append(fault)


def read_draft(document: dict, model: type[BaseModel], where: str = "scene") -> Draft:
    """The draft of `model` from a parsed TOML file, called `where`. SceneError for a fault without a place from which to take it out."""
    document = unshared(document)
    draft = Draft(None)
    while draft.scene is None:
        try:
            draft.scene = model.model_validate(document)
        except ValidationError as error:
            new, before = faults_of(error, model), unshared(document)
            for fault in new:
                _take_out(document, fault, model)
            if document == before:
                raise SceneError(where, [str(fault) for fault in dict.fromkeys([*draft.faults, *new])]) from None
            draft.faults += [fault for fault in new if draft.sound(*fault.path)]
    return draft


def unshared(value: Any) -> Any:
    """A copy in which no two places hold the same table, so that one can be mended without the other.

    numpy's numbers become Python's, sections the tables of the keys that were given, and keys words, as TOML has no other.
    """
    value = value.tolist() if isinstance(value, np.generic | np.ndarray) else value
    if isinstance(value, BaseModel):
        value = {key: getattr(value, key) for key in value.model_fields_set}
    if isinstance(value, Mapping):
        return {str(key): unshared(entry) for key, entry in value.items()}
    return [unshared(entry) for entry in value] if isinstance(value, list | tuple) else value


def _overlap(one: KeyPath, other: KeyPath) -> bool:
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]


def _take_out(document: dict, fault: Fault, model: type[BaseModel]) -> None:
    """Puts the default, or an example, in the place of the smallest key around the fault.

    A misspelt key stands in for the one that was meant where that must be given.
    """
    if not fault.path:
        return
    table, key, length = _key_around(document, fault.path)
    if isinstance(table, list):
        table[key] = {}
        return
    value = table.pop(key, None)
    if fault.meant and _required(model, fault.meant):
        table.setdefault(fault.meant[-1], value)
    elif (field := _required(model, fault.path[:length])) and field.examples:
        table[key] = field.examples[0]


def _required(model: type[BaseModel], path: KeyPath) -> FieldInfo | None:
    field = field_at(model, path)
    return field if field and field.is_required() else None


def _key_around(document: dict, path: KeyPath) -> tuple[dict | list, Any, int]:
    """The table, the key in it (of a list of tables: the position), and the path's length up to it."""
    node: Any = document
    place: tuple[dict | list, Any, int] = (document, path[0], 1)
    for length, part in enumerate(path, start=1):
        if isinstance(node, dict) or (length == 2 and isinstance(node, list)):
            place = (node, part, length)
        inside = part in node if isinstance(node, dict) else isinstance(node, list) and isinstance(part, int) and part < len(node)
        if not inside:
            break
        node = node[part]
    return place
