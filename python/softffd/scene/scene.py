"""The scene: one TOML file that says what the soft object is, what acts on it and what is wanted of it."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import PrivateAttr

from softffd.errors import MeshError, SceneError
from softffd.lattice import rest_grid, to_flat
from softffd.scene import sections as sections
from softffd.scene.checks import cross_check
from softffd.scene.document import find_scene, read_document, shipped_scenes, shown
from softffd.scene.draft import Draft, read_draft
from softffd.scene.faults import Fault, in_file_order
from softffd.scene.quantity import key
from softffd.scene.selection import Selection, flat_indices
from softffd.scene.template import template

if TYPE_CHECKING:
    from softffd.mesh.mesh import Mesh

__all__ = ["Scene", "load_scene", "scene_from", "schema", "shipped_scenes", "template"]


class Scene(sections.Section):
    """A complete, valid scene, made by `load_scene` or `scene_from`; its attributes are the keys of the file.

    Nothing is left open: `lattice.origin` and `.size` are filled, and one of `mass.total` and `.density`.
    """

    title: sections.Text = key("Soft object", "what the scene shows, in one line: the FMU's description")
    lattice: sections.Lattice = key(sections.Lattice(), "the volume around the object and its springs")
    mesh: sections.MeshFile | None = key(None, "the embedded object; absent: the box alone")
    mass: sections.Mass = key(sections.Mass(), "mass and how it is spread")
    material: sections.Material = key(sections.Material(), "stiffness and damping")
    region: tuple[sections.Region, ...] = key((), "local overrides; later ones win")
    environment: sections.Environment = key(sections.Environment(), "what acts everywhere")
    plane: tuple[sections.Plane, ...] = key((), "obstacles: half-spaces")
    pin: tuple[sections.Pin, ...] = key((), "control points attached to rigid frames")
    load: tuple[sections.Load, ...] = key((), "forces shared by several control points")
    inputs: sections.Inputs = key(sections.Inputs(), "inputs besides those of planes, pins and loads")
    initial: sections.Initial = key(sections.Initial(), "the state at the start")
    probe: tuple[sections.Probe, ...] = key((), "points followed through the deformation")
    outputs: sections.Outputs = key(sections.Outputs(), "what the FMU computes for others")
    solver: sections.Solver = key(sections.Solver(), "how the motion is integrated")
    experiment: sections.Experiment = key(sections.Experiment(), "the FMU's default experiment")

    _path: Path = PrivateAttr()
    _mesh: "Mesh | None" = PrivateAttr(None)

    @property
    def path(self) -> Path:
        """The scene's file, absolute."""
        return self._path

    @property
    def name(self) -> str:
        """The file's stem: the FMU's modelName."""
        return self._path.stem

    @property
    def loaded_mesh(self) -> "Mesh | None":
        """The mesh as it was read when the scene was loaded [m]; None without [mesh]."""
        return self._mesh

    @property
    def default_inputs(self) -> Path | None:
        """The CSV beside the scene file that holds its default inputs over time; None where there is none."""
        beside = self._path.with_suffix(".csv")
        return beside if beside.is_file() else None

    def select(self, selection: Selection) -> np.ndarray:
        """Flat indices p = i + nx (j + ny k), (m,) int64. Raises ValueError outside the lattice."""
        return flat_indices(selection, self.lattice.points)

    def rest_positions(self) -> np.ndarray:
        """The control points at rest in flat order, (n, 3) [m]."""
        return to_flat(rest_grid(self.lattice.points, self.lattice.origin, self.lattice.size))


def load_scene(path_or_name: str | Path) -> Scene:
    """The scene of a TOML file, or the shipped scene of that name. Raises SceneError with all problems."""
    path = find_scene(path_or_name)
    return scene_from(read_document(path), path=path)


def scene_from(document: dict[str, Any], *, path: str | Path = "scene.toml") -> Scene:
    """The scene of a parsed TOML file (for sweeps that change a value and try again).

    `path` is where the file might stand: its stem becomes the scene's name, its folder holds a mesh file.
    Raises SceneError with all problems.
    """
    path = Path(path).absolute()
    draft = read_draft(document, Scene)
    _settle(draft, path.parent)
    faults = draft.faults + cross_check(draft)
    if faults:
        raise SceneError(shown(path), [str(fault) for fault in in_file_order(faults, document)])
    draft.scene._path, draft.scene._mesh = path, draft.mesh
    return draft.scene


def schema() -> dict[str, Any]:
    """The JSON schema of the scene file, for editors that complete and check TOML."""
    head = {"$schema": "http://json-schema.org/draft-07/schema#"}
    about = {
        "title": "softffd scene",
        "description": "A soft object, what acts on it and what is wanted of it.",
    }
    return head | _without_null(Scene.model_json_schema()) | about


def _settle(draft: Draft, folder: Path) -> None:
    """Loads the mesh and fills in what the file leaves open: the box, and the default of the total mass."""
    scene, changes = draft.scene, {}
    if scene.mesh is not None and draft.sound("mesh"):
        changes["mesh"] = _filled(scene.mesh, file=folder / scene.mesh.file)
        draft.mesh = _load_mesh(draft, changes["mesh"])
    origin, size = _box(scene.lattice, draft.mesh)
    changes["lattice"] = _filled(scene.lattice, origin=origin, size=size)
    if scene.mass.density is None:
        changes["mass"] = _filled(scene.mass, total=1.0 if scene.mass.total is None else scene.mass.total)
    draft.scene = scene.model_copy(update=changes)


def _filled(section: sections.Section, **values: Any) -> sections.Section:
    """A copy with other values; `model_fields_set` still names the keys that the file gave."""
    return type(section).model_construct(section.model_fields_set, **(dict(section) | values))


def _load_mesh(draft: Draft, source: sections.MeshFile) -> "Mesh | None":
    from softffd.mesh.mesh import load_mesh  # only scenes with a mesh pay for the import

    try:
        return load_mesh(source.file, scale=source.scale, up=source.up)
    except MeshError as error:
        draft.note(Fault(("mesh", "file"), " ".join(str(error).split())))
        return None


def _box(lattice: sections.Lattice, mesh: "Mesh | None") -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Origin and size [m]: as given, else those of the mesh's box grown by the margin, else the unit box."""
    lower, upper = np.array([[0.0] * 3, [1.0] * 3]) if mesh is None else mesh.bounds
    grown = lattice.margin * (upper - lower) if mesh is not None else np.zeros(3)
    origin = lattice.origin or tuple((lower - grown).tolist())
    return origin, lattice.size or tuple((upper - lower + 2 * grown).tolist())


def _without_null(node: Any) -> Any:
    """A schema without `null`, which TOML does not have: an absent key is simply not there."""
    if isinstance(node, list):
        return [_without_null(entry) for entry in node]
    if not isinstance(node, dict):
        return node
    rest = {name: _without_null(value) for name, value in node.items() if value is not None}
    arms = [arm for arm in rest.pop("anyOf", []) if arm != {"type": "null"}]
    return rest | (arms[0] if len(arms) == 1 else {"anyOf": arms} if arms else {})
