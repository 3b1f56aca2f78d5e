"""All keys of a scene file, section by section, before anything is filled in or checked across sections; their JSON schema."""

from typing import Any

from softffd.scene import observed, rigid, sections
from softffd.scene.section import Section, Text, key

SOLIDS = ("sphere", "cylinder", "box")
OBSTACLES = ("plane", *SOLIDS)  # sections of obstacles, in the order of the library


class SceneKeys(Section):
    """The keys of a scene file, each sound by itself."""

    title: Text = key("Soft object", "what the scene shows, in one line: the FMU's description")
    lattice: sections.Lattice = key(sections.Lattice(), "the volume around the object and its springs or patches")
    mesh: sections.MeshFile | None = key(None, "the embedded object; absent: the box alone")
    mass: sections.Mass = key(sections.Mass(), "mass and its distribution")
    material: sections.Material = key(sections.Material(), "springs or solid, stiffness and damping")
    region: tuple[sections.Region, ...] = key((), "local overrides; later ones win")
    environment: sections.Environment = key(sections.Environment(), "gravity")
    contact: sections.Contact = key(sections.Contact(), "the points of the object that obstacles act on")
    plane: tuple[rigid.Plane, ...] = key((), "obstacles: half-spaces")
    sphere: tuple[rigid.Sphere, ...] = key((), "obstacles: solid spheres")
    cylinder: tuple[rigid.Cylinder, ...] = key((), "obstacles: solid cylinders")
    box: tuple[rigid.Box, ...] = key((), "obstacles: solid boxes")
    pin: tuple[rigid.Pin, ...] = key((), "control points attached to rigid frames")
    load: tuple[sections.Load, ...] = key((), "forces shared by several control points")
    inputs: sections.Inputs = key(sections.Inputs(), "inputs besides those of planes, pins and loads")
    initial: sections.Initial = key(sections.Initial(), "the state at the start")
    probe: tuple[observed.Probe, ...] = key((), "points followed through the deformation")
    sensor: tuple[observed.Sensor, ...] = key((), "patches of the surface whose contact forces are outputs")
    outputs: observed.Outputs = key(observed.Outputs(), "outputs of the FMU")
    solver: sections.Solver = key(sections.Solver(), "time integration")
    experiment: sections.Experiment = key(sections.Experiment(), "the FMU's default experiment")
    fmu: sections.Fmu = key(sections.Fmu(), "interface of the FMU to other tools")

    @property
    def solids(self) -> tuple[rigid.Sphere | rigid.Cylinder | rigid.Box, ...]:
        """The obstacles with an inside (all but planes), in the order of the library."""
        return (*self.sphere, *self.cylinder, *self.box)

    @property
    def obstacles(self) -> tuple[rigid.Plane | rigid.Sphere | rigid.Cylinder | rigid.Box, ...]:
        """All obstacles, in the order of the library."""
        return (*self.plane, *self.solids)


def schema() -> dict[str, Any]:
    """Returns the JSON schema of the scene file, for editors that complete and check TOML."""
    head = {"$schema": "http://json-schema.org/draft-07/schema#"}
    about = {"title": "softffd scene", "description": "A soft object, what acts on it and what is wanted of it."}
    return head | _without_null(SceneKeys.model_json_schema()) | about


def _without_null(node: Any) -> Any:
    """Returns a schema without `null`, which TOML does not have: an absent key is simply missing."""
    if isinstance(node, list):
        return [_without_null(entry) for entry in node]
    if not isinstance(node, dict):
        return node
    rest = {name: _without_null(value) for name, value in node.items() if value is not None}
    arms = [arm for arm in rest.pop("anyOf", []) if arm != {"type": "null"}]
    return rest | (arms[0] if len(arms) == 1 else {"anyOf": arms} if arms else {})
