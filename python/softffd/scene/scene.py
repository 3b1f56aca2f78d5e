"""The scene: one TOML file that describes the soft object, what acts on it, and the wanted outputs."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import PrivateAttr, ValidationInfo, model_validator

from softffd.embedding.nodes import rest_nodes
from softffd.errors import SceneError, SoftffdError
from softffd.lattice import LatticeBox, to_flat
from softffd.mesh.mesh import Mesh
from softffd.rotation import quaternion, turned
from softffd.scene.checks import cross_check
from softffd.scene.document import find_scene, read_document, shown
from softffd.scene.draft import Draft, plain, read_draft
from softffd.scene.faults import in_file_order, toml_text
from softffd.scene.keys import OBSTACLES, SceneKeys
from softffd.scene.rigid import Pin
from softffd.scene.selection import Selection, flat_indices
from softffd.spelling import did_you_mean, is_unicode, nearest_of

NAMELESS = Path("scene.toml")  # assumed path of a scene without a file


class Scene(SceneKeys):
    """A complete, valid scene that can run; its attributes are the keys of the file. Every way to create a Scene checks the whole scene.

    `load_scene` reads a file; `Scene(material={"stiffness": 2e3}, ...)` and `Scene.model_validate(document)` take the content of a file;
    `replace` and `model_copy(update=...)` return a changed scene. All of them raise SceneError with all problems.
    No key is left open: `lattice.origin`, `lattice.size` and one of `mass.total` and `mass.density` are filled in. Filled-in values do not
    count as given: a changed scene fills them in anew. Two scenes are equal if their keys, files and meshes are equal.
    """

    if TYPE_CHECKING:

        def __init__(self, **keys: Any) -> None: ...  # each section is a table or an instance

    _path: Path = PrivateAttr()
    _mesh: Mesh | None = PrivateAttr(None)

    @model_validator(mode="wrap")
    @classmethod
    def _whole(cls, data: Any, handler: Callable[[Any], Scene], info: ValidationInfo) -> Scene:
        """Validates a document, whose file is the `path` of the validation context."""
        if isinstance(data, Scene):
            return data
        path = Path((info.context or {}).get("path", NAMELESS)).absolute()
        draft = _checked(data, path)
        scene = handler({name: getattr(draft.keys, name) for name in draft.keys.model_fields_set})
        scene._path, scene._mesh = path, draft.mesh
        return scene

    def __repr__(self) -> str:
        box, kinds = self.lattice_box, (*OBSTACLES, "pin", "load", "probe", "sensor")
        counts, sides = (" × ".join(f"{n:.4g}" for n in triple) for triple in (box.points, box.size))
        mesh = f", mesh {self.mesh.file.name}" if self.mesh else ""
        parts = [f"{kind} {', '.join(part.name for part in found)}" for kind in kinds if (found := getattr(self, kind))]
        lines = [
            f"Scene {self.name}: {self.title}",
            f"{counts} control points ({box.basis}) in a box of {sides} m{mesh}",
            *(["; ".join(parts)] if parts else []),
            f"method {self.solver.method}, tolerance {self.solver.tolerance:g}, {self.experiment.stop_time:g} s in communication steps of "
            f"{self.experiment.communication_step:g} s",
        ]
        return "\n  ".join(lines)

    __str__ = __repr__

    def replace(self, changes: Mapping[str, Any]) -> Scene:
        """Returns a scene with other values: scene.replace({"material.stiffness": 2e3, "plane.plate.friction": 0.1}).

        A list entry is named by its name or its number from 0: plane.plate or plane[0]. The value None removes a key, so that its default
        applies. Raises SceneError with all problems.
        """
        document, problems = _changed(self.keys_given(), changes)
        if problems:
            raise SceneError(_called(self._path), problems)
        return scene_from(document, path=self._path)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Scene:
        """Returns a copy with the sections of `update`, checked like any scene. Raises SceneError with all problems."""
        if not update:
            return super().model_copy(deep=deep)
        return scene_from({**self._given(), **update}, path=self._path)

    def keys_given(self) -> dict[str, Any]:
        """Returns the given keys as a file would hold them; a mesh file has the path under which it was found."""
        return plain(self._given())

    def _given(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in self.model_fields_set}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self.__dict__ == other.__dict__ and self._path == other._path and _same_mesh(self._mesh, other._mesh)

    @property
    def path(self) -> Path:
        """Absolute path of the scene file."""
        return self._path

    @property
    def name(self) -> str:
        """Stem of the file name, which is the modelName of the FMU; "scene" without a file."""
        return self._path.stem

    @property
    def lattice_box(self) -> LatticeBox:
        """Control points per axis, box at rest and basis of the lattice."""
        lattice = self.lattice
        assert lattice.origin is not None and lattice.size is not None  # filled in
        return LatticeBox(lattice.points, lattice.origin, lattice.size, "patches" if self.is_solid else lattice.basis)

    @property
    def loaded_mesh(self) -> Mesh | None:
        """The mesh as read when the scene was loaded, vertices in m; None without [mesh]."""
        return self._mesh

    @property
    def default_inputs(self) -> Path | None:
        """The CSV file beside the scene file that holds the default inputs over time; None if there is none."""
        beside = self._path.with_suffix(".csv")
        return beside if beside.is_file() else None

    def select(self, selection: Selection) -> np.ndarray:
        """Returns the flat indices of a selection, (m,) int64. Raises ValueError if the selection leaves the lattice."""
        return flat_indices(selection, self.lattice.points)

    def pin_origin(self, pin: Pin) -> tuple[float, float, float]:
        """Returns the origin of the frame of a pin at rest [m]."""
        x, y, z = pin.origin or map(float, self.mass_positions()[self.select(pin.points)].mean(axis=0))
        return x, y, z

    def pin_start(self, pin: Pin) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Returns origin [m] and orientation (w, x, y, z) of the frame of a pin at the start: as at rest, or rotated with the body."""
        turn, origin = np.array(self.initial.rotation_vector()), self.pin_origin(pin)
        if not turn.any():
            return origin, (1.0, 0.0, 0.0, 0.0)
        centre = np.array(self.lattice_box.origin) + np.array(self.lattice_box.size) / 2
        at = centre + turned(np.array(origin) - centre, turn)
        return tuple(at.tolist()), tuple(quaternion(turn).tolist())

    def rest_positions(self) -> np.ndarray:
        """Returns the control points at rest in flat order, (n, 3) [m]."""
        return to_flat(self.lattice_box.rest())

    @property
    def is_solid(self) -> bool:
        """True if the body consists of finite elements, not of springs."""
        return self.material.model == "solid"

    def mass_positions(self) -> np.ndarray:
        """Returns the points with mass, which pins hold, at rest in flat order, (n, 3) [m]: control points, or the nodes of a solid."""
        if not self.is_solid:
            return self.rest_positions()
        box = self.lattice_box
        return to_flat(rest_nodes(box.points, np.array(box.origin), np.array(box.size)))


def load_scene(path_or_name: str | Path) -> Scene:
    """Returns the scene of a TOML file, or the shipped scene of that name. Raises SceneError with all problems."""
    path = find_scene(path_or_name)
    return scene_from(read_document(path), path=path)


def scene_of(given: Any, who: str, wanted: str = "a Scene, or the path or name of one") -> Scene:
    """Returns a given scene, or the scene of the path of a TOML file or of the name of a shipped scene.

    Raises SoftffdError, with a message that begins with `who`, for other types, and SceneError for a faulty scene."""
    if isinstance(given, Scene):
        return given
    if isinstance(given, str | Path):
        return load_scene(given)
    raise SoftffdError(f"{who}: wanted {wanted}, got {given!r:.70}")


def scene_from(document: Mapping[str, Any], *, path: str | Path = NAMELESS) -> Scene:
    """Returns the scene of a parsed TOML file.

    `path` is the assumed path of the file: its stem becomes the name of the scene, and its folder is the one of a relative mesh file.
    Raises SceneError with all problems.
    """
    return Scene.model_validate(document, context={"path": path})


def _checked(document: Any, path: Path) -> Draft:
    """Returns the complete, faultless draft of a document. Raises SceneError with all problems."""
    if not is_unicode(path.stem):  # the FMU's name
        raise SceneError(_called(path), [f"wanted a file name in UTF-8, got {os.fsencode(path.name)!r}"])
    if not isinstance(document, Mapping):
        raise SceneError(_called(path), [f"wanted a table of sections, got {toml_text(document)}"])
    try:
        draft = read_draft(document, path.parent)
        problems = [str(fault) for fault in in_file_order(draft.faults + cross_check(draft), document)]
    except RecursionError:
        problems = ["not a scene that can be read: nested too deeply"]
    if problems:
        raise SceneError(_called(path), problems)
    return draft


def _called(path: Path) -> str:
    """Returns the name of a scene in messages: its file as a user would name it, or "scene" without a file."""
    return shown(path) if path.name != NAMELESS.name or path.is_file() else NAMELESS.stem


def _same_mesh(one: Mesh | None, other: Mesh | None) -> bool:
    if one is None or other is None or one is other:
        return one is other
    return np.array_equal(one.vertices, other.vertices) and np.array_equal(one.faces, other.faces)


# ---- changes by dotted keys: `material.stiffness`, `plane.plate.friction`, `region[0].mass` ----


def _changed(document: dict[str, Any], changes: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Changes values of a document in place; returns the document and the problems with the keys. The values are not checked.

    document: tables and lists of tables, not shared with other owners. A key names tables from the outside in, and a list entry by its
    `name` or its number from 0: plane.plate.friction or plane[0].friction. The value None removes a key: its default applies.
    """
    problems = [problem for key, value in changes.items() if (problem := _change(document, str(key), value))]
    return document, problems


def _change(document: dict[str, Any], key: str, value: Any) -> str | None:
    words = re.split(r"[.\[\]]+", key.removesuffix("]"))
    node: Any = document
    for depth, word in enumerate(words):
        place: Any = _position(node, word) if isinstance(node, list) else word
        if place is None:
            return f"{key}: {_unknown_entry(node, '.'.join(words[:depth]), word)}"
        if depth < len(words) - 1:
            node = _below(node, place)
        elif value is not None:
            node[place] = value
        elif isinstance(node, list) or place in node:
            del node[place]
    return None


def _position(entries: list[Any], word: str) -> int | None:
    """Returns the position of the list entry with a number or name; None if there is none."""
    if word.isdecimal():
        return int(word) if int(word) < len(entries) else None
    return next((n for n, entry in enumerate(entries) if isinstance(entry, dict) and entry.get("name") == word), None)


def _below(node: Any, place: Any) -> Any:
    """Returns the table or list at a place. If there is none, inserts an empty table, which the checks of the scene then refuse."""
    below = node.get(place) if isinstance(node, dict) else node[place]
    if not isinstance(below, dict) and not (isinstance(below, list) and all(isinstance(entry, dict) for entry in below)):
        below = node[place] = {}
    return below


def _unknown_entry(entries: list[Any], where: str, word: str) -> str:
    names = [str(entry["name"]) for entry in entries if isinstance(entry, dict) and "name" in entry]
    numbers = f"a number below {len(entries)}" if entries else "an entry, of which there is none"
    wanted = " or ".join([*(["the name of one (" + ", ".join(names) + ")"] if names else []), numbers])
    return f"wanted {wanted} in {where}, got {toml_text(word)}{did_you_mean(nearest_of(word, names))}"
