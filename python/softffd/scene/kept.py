"""How results and systems keep a scene: its keys, the path of its file, and a fingerprint of its mesh."""

from __future__ import annotations

import hashlib
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softffd.errors import SceneError
from softffd.lattice import LatticeBox
from softffd.mesh.mesh import Mesh
from softffd.scene.document import SHIPPED

if TYPE_CHECKING:
    from softffd.scene.scene import Scene


@dataclass(frozen=True)
class KeptScene:
    """The stored data of a scene, from which `found` restores the scene."""

    path: Any
    keys: dict[str, Any]
    mesh: str | None  # fingerprint of the mesh that was read

    @classmethod
    def of(cls, scene: Scene) -> KeptScene:
        return cls(scene.path, scene.keys_given(), _fingerprint(scene.loaded_mesh) if scene.loaded_mesh else None)

    def found(self, lattice: LatticeBox | None, folder: Path, given: Path | None = None) -> tuple[Scene | None, str]:
        """Returns the scene and "", or None and the reason: the mesh is missing or has changed, or the lattice differs from the run's.

        folder: of the file that keeps the scene. given: the file of the mesh, if the caller knows it.
        """
        from softffd.scene.scene import scene_from  # imports pydantic

        keys = dict(self.keys)
        if (named := keys.get("mesh")) and isinstance(named, dict):
            file = given or _mesh_file(str(named.get("file", "")), folder)
            if file is None:
                why = f"its mesh, {named.get('file')}, is not beside it nor below its folder"
                return None, f"{why}: copy it there, or name it: --mesh FILE, load(..., mesh=FILE)"
            keys["mesh"] = {**named, "file": str(file.absolute())}
        try:
            scene = scene_from(keys, path=str(self.path))
        except (SceneError, OSError, ValueError) as error:
            return None, error.problems[0] if isinstance(error, SceneError) else str(error)
        if lattice and scene.lattice_box.points != lattice.points:
            return None, f"its scene has a lattice of {scene.lattice_box.points}, the run one of {lattice.points}"
        if scene.loaded_mesh and _fingerprint(scene.loaded_mesh) != self.mesh:
            return None, f"{scene.mesh.file if scene.mesh else ''} is another mesh than at the time of the run"
        return scene, ""


def _mesh_file(name: str, folder: Path) -> Path | None:
    """Returns the mesh file beside the file that names it, else at its former place if that lies below the folder of the naming file,
    below the working directory or in the package; else None. Any other place is not accessed, not even to test if the file exists."""
    beside = folder / (re.split(r"[\\/]", name)[-1] or "-")
    if beside.is_file():
        return beside
    was = Path(os.path.normpath(folder / name))
    return was if any(was.is_relative_to(place) for place in (folder, Path.cwd(), SHIPPED)) else None


def _fingerprint(mesh: Mesh) -> str:
    return hashlib.sha256(mesh.vertices.astype("<f8").tobytes() + mesh.faces.astype("<i8").tobytes()).hexdigest()
