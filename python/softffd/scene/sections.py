"""The sections of a scene file, key by key: default, unit, range and meaning. SI units."""

import math
import re
import unicodedata
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    WithJsonSchema,
)

from softffd.names import IDENTIFIER
from softffd.obstacles import SolidShape
from softffd.scene.quantity import (
    Number,
    PositiveVector,
    Switch,
    Vector,
    key,
    list_of,
    list_schema,
    quantity,
    refusal,
)
from softffd.scene.selection import Selection
from softffd.spelling import nearest_of


class Section(BaseModel):
    """A table of the scene file: immutable, and closed to unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


def _printable(text: str) -> str:
    if not text.isprintable():
        raise refusal("text without control characters")
    return text


def _identifier(name: str) -> str:
    if re.fullmatch(IDENTIFIER, name):
        return name
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    nearest = re.sub("[^A-Za-z0-9_]+", "_", plain).strip("_")
    nearest = f"_{nearest}" if nearest[:1].isdigit() else nearest
    raise refusal("a name of letters A-Z a-z, digits and underscores, no digit first", nearest=nearest)


def _direction(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    if not 1e-100 < max(map(abs, vector)) < 1e100:
        raise refusal("a vector of length > 0 (in double precision: 1e-100 to 1e100)")
    return vector


def _file_name(value: Any) -> Path:
    if isinstance(value, Path):
        return value
    if not isinstance(value, str) or not value.strip() or not value.isprintable():
        raise refusal("the name of a mesh file in quotes")
    return Path(value)


FileName = Annotated[Path, BeforeValidator(_file_name), WithJsonSchema({"type": "string", "minLength": 1})]
Text = Annotated[str, Strict(), AfterValidator(_printable)]
Name = Annotated[
    str,
    Strict(),
    AfterValidator(_identifier),
    WithJsonSchema({"type": "string", "pattern": f"^{IDENTIFIER}$"}),
]
Direction = Annotated[Vector, AfterValidator(_direction)]
Count = Annotated[int, Strict(), Field(ge=2, le=32)]
Cells = Annotated[int, Strict(), Field(ge=1, le=31)]
Threads = Annotated[int, Strict(), Field(ge=1, le=64)]
Counts = Annotated[
    tuple[Count, Count, Count],
    list_of(3, "3 whole numbers [nx, ny, nz]"),
    list_schema(3, type="integer", minimum=2, maximum=32),
]


if TYPE_CHECKING:
    PointsInput = tuple[int, int, int]  # what either form becomes
else:
    PointsInput = Annotated[
        Annotated[Counts, Tag("<list>")] | Annotated[Literal["cubic"], Tag("<word>")],
        Discriminator(lambda value: "<word>" if isinstance(value, str) else "<list>"),
    ]
NAME = "a name for the FMU's variables: letters, digits, underscores"
Motion = Literal["fixed", "input"]


PLANE_POSE = {"point": "xyz", "normal": "xyz", "velocity": "xyz", "angular_velocity": "xyz"}
SPHERE_POSE = {"point": "xyz", "velocity": "xyz", "angular_velocity": "xyz"}
BOX_POSE = {"point": "xyz", "rotation": "xyz", "velocity": "xyz", "angular_velocity": "xyz"}
PIN_POSE = {"position": "xyz", "orientation": "wxyz", "velocity": "xyz", "angular_velocity": "xyz"}
"""Components of the vectors that say where a plane, a sphere, a box or a pin is and how it moves"""


def _pose_words(pose: dict[str, str]) -> list[str]:
    """Names of the vectors, each followed by its components."""
    return [word for vector, components in pose.items() for word in (vector, *(f"{vector}.{each}" for each in components))]


def _chosen_of(pose: dict[str, str]) -> BeforeValidator:
    words = _pose_words(pose)
    wanted = f'a list of {", ".join(pose)} or their components, such as "{words[3]}"'

    def check(value: Any) -> Any:
        if not isinstance(value, list | tuple) or not value:
            raise refusal(wanted)
        if unknown := [each for each in value if each not in words]:
            raise refusal(wanted, nearest=nearest_of(str(unknown[0]), words))
        return value

    return BeforeValidator(check)


def _chosen_schema(pose: dict[str, str]) -> WithJsonSchema:
    return WithJsonSchema({"type": "array", "items": {"enum": _pose_words(pose)}, "minItems": 1})


PlaneInputs = Annotated[tuple[str, ...], _chosen_of(PLANE_POSE), _chosen_schema(PLANE_POSE)]
SphereInputs = Annotated[tuple[str, ...], _chosen_of(SPHERE_POSE), _chosen_schema(SPHERE_POSE)]
BoxInputs = Annotated[tuple[str, ...], _chosen_of(BOX_POSE), _chosen_schema(BOX_POSE)]
PinInputs = Annotated[tuple[str, ...], _chosen_of(PIN_POSE), _chosen_schema(PIN_POSE)]


def _components(pose: dict[str, str], chosen: tuple[str, ...]) -> list[str]:
    """All components that are chosen, by themselves or with their vector, in the pose's order."""
    return [f"{vector}.{each}" for vector in pose for each in pose[vector] if {vector, f"{vector}.{each}"} & set(chosen)]


class Lattice(Section):
    """The volume around the object and its springs (Xia & Wang 2009, section 1)."""

    points: PointsInput = quantity(
        (4, 4, 4), "1", 'control points per axis [nx, ny, nz], 2..32 each; "cubic", or left out: as `cells` or `spacing` has them'
    )
    cells: Cells | None = quantity(
        None,
        "1",
        "cells along the longest side of the box, 1..31, in place of `points`: along the others as many as make them nearly cubic",
    )
    spacing: Number | None = quantity(None, "m", "side of the cells, in place of `points`: as nearly as the box allows", gt=0)
    origin: Vector | None = quantity(None, "m", "lower corner of the box; default: that of the mesh's box grown by `margin`, or [0, 0, 0]")
    size: PositiveVector | None = quantity(
        None, "m", "edges of the box, > 0; default: those of the mesh's box grown by `margin`, or [1, 1, 1]"
    )
    margin: Number = quantity(0.0, "1", "share of the mesh's box added on every side", ge=0)
    springs: Literal["distinct", "paper"] = key(
        "distinct",
        '"distinct" (468 springs for 4x4x4) or "paper" (504: those on the edges of the box doubled)',
    )
    basis: Literal["bezier", "bspline"] = key(
        "bezier",
        '"bezier": every control point moves the whole object; "bspline": uniform cubic, clamped, only what is near, for finer lattices',
    )


class MeshFile(Section):
    """The embedded object."""

    file: FileName = key(
        ..., "a mesh file: OBJ, STL, PLY, GLB, glTF, OFF, COLLADA (.dae) or 3MF, relative to the scene file", examples=["car.obj"]
    )
    scale: Number = quantity(1.0, "1", "metres per unit of length of the file", gt=0)
    up: Literal["x", "y", "z"] = key("z", "axis of the file that becomes +z")


class Mass(Section):
    """The object's mass and how it is spread over the control points."""

    total: Number | None = quantity(None, "kg", "total mass; absent together with `density`: 1", gt=0)
    density: Number | None = quantity(
        None,
        "kg/m3",
        "density, in place of `total`: times the volume of the mesh, which must be closed, or of the box where there is no mesh",
        gt=0,
    )
    distribution: Literal["uniform", "box", "vertices", "surface", "volume"] = key(
        "uniform",
        '"uniform": equal points; "box": even through the box, each cell gives an eighth to each of its corners; "vertices", "surface", '
        '"volume": as it is spread over the mesh; default beside `material.youngs_modulus`: "volume" with a closed mesh, else "box"',
    )
    uniform_share: Number = quantity(
        0.1,
        "1",
        'part of the total spread evenly over the points, so that none is nearly massless; 0 for "box"',
        ge=0,
        le=1,
    )
    inertia: Literal["lumped", "matched"] = key(
        "lumped",
        '"lumped": masses that follow the weights, whose moment of inertia is too large, about twice at 4 control points per axis, as '
        '`softffd build` tells; "matched": the inertia of the object, at steps two to five times shorter, where bodies roll or tip',
    )


class Stiffness(Section):
    """Stiffness by kind of spring."""

    edge: Number = quantity(..., "N/m", "stiffness of the edge springs", ge=0, examples=[1e3])
    face: Number = quantity(..., "N/m", "stiffness of the face diagonals", ge=0, examples=[1e3])
    body: Number = quantity(..., "N/m", "stiffness of the body diagonals", ge=0, examples=[1e3])


def _stiffness_form(value: Any) -> str | None:
    if isinstance(value, dict | Stiffness):
        return "<table>"
    return "<number>" if isinstance(value, int | float) and not isinstance(value, bool) else None


def _for_all_springs(value: float | Stiffness) -> Stiffness:
    return value if isinstance(value, Stiffness) else Stiffness(edge=value, face=value, body=value)


if TYPE_CHECKING:
    StiffnessInput = Stiffness  # what either form becomes
else:
    StiffnessInput = Annotated[
        Annotated[Number, Field(ge=0), Tag("<number>")] | Annotated[Stiffness, Tag("<table>")],
        Discriminator(
            _stiffness_form,
            custom_error_type="wanted",
            custom_error_message="a number or a table { edge = , face = , body = }",
        ),
        AfterValidator(_for_all_springs),
    ]


class Material(Section):
    """Springs and damping (Xia & Wang 2009, eq. (3) and (6)): a stiffness for each spring, or the modulus of a solid."""

    stiffness: StiffnessInput | None = quantity(
        None,
        "N/m",
        "spring stiffness, >= 0: one number for all springs, or { edge = , face = , body = }; absent together with `youngs_modulus`: 1e3",
    )
    youngs_modulus: Number | None = quantity(
        None,
        "Pa",
        "Young's modulus, in place of `stiffness`: springs of an isotropic solid of Poisson's ratio 1/4, the only one that springs can "
        "have, whatever the lattice; edges and face diagonals alone have springs",
        gt=0,
    )
    damping: Number = quantity(
        0.01,
        "N.s/m",
        "viscous damping of each control point, d_i of eq. (3): drag of the surroundings, which brakes free flight; default beside "
        "`youngs_modulus`: 0",
        ge=0,
    )
    internal_damping: Number = quantity(
        0.0,
        "s",
        "a dashpot along each spring, its stiffness times this time: damps deformation and leaves rigid motion alone; a mode of frequency "
        "omega has the damping ratio omega / 2 times it; 0: absent",
        ge=0,
    )
    volume_stiffness: Number = quantity(
        0.0,
        "Pa",
        "keeps crushed cells from folding: resists where a cell's corner has lost half its volume, a good first value is "
        "3 times stiffness by edge of a cell, or youngs_modulus; 0: absent",
        ge=0,
    )


class Region(Section):
    """A local override; of several on one point or spring the last one wins."""

    points: Selection = key(..., "the control points of the region: a selection", examples=["z-"])
    stiffness: Number | None = quantity(None, "N/m", "stiffness of springs with both ends in the region", ge=0)
    youngs_modulus: Number | None = quantity(
        None, "Pa", "Young's modulus of the cells with all eight corners in the region, where the material has one", gt=0
    )
    mass: Number | None = quantity(None, "kg", "mass of each control point of the region", gt=0)
    density: Number | None = quantity(
        None, "kg/m3", 'density of the cells with all eight corners in the region, where the distribution is "box"; `mass` wins', gt=0
    )
    damping: Number | None = quantity(None, "N.s/m", "damping of each control point of the region", ge=0)
    internal_damping: Number | None = quantity(
        None, "s", "internal damping of what has its stiffness from the region: springs with both ends in it, or, of a modulus, cells", ge=0
    )


class Environment(Section):
    """What acts everywhere."""

    gravity: Vector | None = quantity(None, "m/s2", "gravity; absent: none, and no variable for it")


class Contact(Section):
    """What of the object the obstacles meet."""

    of: Literal["surface", "lattice"] = key(
        "lattice",
        '"surface": the vertices of the mesh, the default where there is one; "lattice": the control points, in whose hull the object '
        'stays, the default without a mesh and with the method "central_difference", which does not know the other',
    )
    penetration: Number = quantity(
        1e-3,
        "1",
        "of a mesh with more than 5,000 vertices so many are taken, 5,000 at most, that no other can be behind a plane by more than this "
        "share of the lattice's height; `softffd build` says what is certain; 0: all are taken",
        ge=0,
        le=1,
    )


class Plane(Section):
    """An obstacle: the half-space behind the plane is solid."""

    name: Name = key(..., NAME, examples=["ground"])
    point: Vector = quantity((0.0, 0.0, 0.0), "m", "a point of the plane")
    normal: Direction = quantity((0.0, 0.0, 1.0), "1", "points out of the solid; any length > 0")
    velocity: Vector = quantity((0.0, 0.0, 0.0), "m/s", "velocity of the obstacle at `point`")
    angular_velocity: Vector = quantity((0.0, 0.0, 0.0), "rad/s", "angular velocity about `point`")
    friction: Number = quantity(0.4, "1", "Coulomb's coefficient of friction", ge=0)
    motion: Motion = key("fixed", '"fixed", or "input": the FMU has inputs for what `inputs` names')
    inputs: PlaneInputs = key(
        ("point", "velocity"),
        'what of `point`, `normal`, `velocity`, `angular_velocity` are inputs, or single components: "point.z"; '
        "the rest are parameters, which hold at every communication point",
    )

    def input_components(self) -> list[str]:
        """What is an input of pose and motion: "point.z", ..."""
        return _components(PLANE_POSE, self.inputs) if self.motion == "input" else []


class Rotation(Section):
    """A rotation about an axis, right-handed."""

    axis: Direction = key(..., "the axis, of any length > 0", examples=[[0.0, 1.0, 0.0]])
    degrees: Number = key(..., "the angle in degrees", examples=[0.0])

    def vector(self) -> tuple[float, float, float]:
        """Along the axis, as long as the angle [rad]."""
        x, y, z = self.axis
        scale = math.radians(self.degrees) / math.hypot(x, y, z)
        return x * scale, y * scale, z * scale


def _rotation_table(value: Any) -> Any:
    """Whatever may be a table of axis and degrees; radians are told in degrees."""
    wanted = "{ axis = [x, y, z], degrees = }"
    if not isinstance(value, dict | Rotation):
        raise refusal(f"a table {wanted}")
    if isinstance(value, dict) and "degrees" not in value and isinstance(angle := value.get("radians"), int | float):
        raise refusal(wanted, nearest=f"degrees = {math.degrees(angle):.10g}")
    return value


RotationTable = Annotated[Rotation, BeforeValidator(_rotation_table)]


class Solid(Section):
    """An obstacle with an inside: what it has in common with others. Its variables have the names of a plane's."""

    name: Name = key(..., NAME, examples=["ball"])
    point: Vector = quantity((0.0, 0.0, 0.0), "m", "its centre")
    velocity: Vector = quantity((0.0, 0.0, 0.0), "m/s", "velocity of its centre")
    angular_velocity: Vector = quantity((0.0, 0.0, 0.0), "rad/s", "angular velocity about its centre")
    friction: Number = quantity(0.4, "1", "Coulomb's coefficient of friction", ge=0)
    motion: Motion = key("fixed", '"fixed", or "input": the FMU has inputs for what `inputs` names')


class Round(Solid):
    """A solid of revolution."""

    radius: Number = quantity(..., "m", "its radius", gt=0, examples=[0.5])
    inputs: PlaneInputs = key(
        ("point", "velocity"),
        "what of `point`, `normal`, `velocity`, `angular_velocity` are inputs, or single components; "
        "the rest are parameters, which hold at every communication point",
    )

    def input_components(self) -> list[str]:
        """What is an input of pose and motion: "point.z", ..."""
        return _components(PLANE_POSE, self.inputs) if self.motion == "input" else []


class Sphere(Round):
    """An obstacle: a solid sphere about `point`; needs contact.of = "surface"."""

    inputs: SphereInputs = key(
        ("point", "velocity"),
        "what of `point`, `velocity`, `angular_velocity` are inputs, or single components; "
        "the rest are parameters, which hold at every communication point",
    )

    @property
    def normal(self) -> tuple[float, float, float]:
        """Of no meaning: a sphere looks alike from all sides."""
        return (0.0, 0.0, 1.0)

    @property
    def length(self) -> float:
        """None [m]."""
        return 0.0

    def shape(self) -> SolidShape:
        """What there is to see."""
        return SolidShape(self.name, "sphere", (2 * self.radius,) * 3)


class Cylinder(Round):
    """An obstacle: a solid cylinder with flat ends about `point`; needs contact.of = "surface"."""

    length: Number = quantity(..., "m", "from end to end", gt=0, examples=[1.0])
    normal: Direction = quantity((0.0, 0.0, 1.0), "1", "its axis; any length > 0")

    def shape(self) -> SolidShape:
        """What there is to see."""
        return SolidShape(self.name, "cylinder", (2 * self.radius, 2 * self.radius, self.length))


class Box(Solid):
    """An obstacle: a solid box about `point`; needs contact.of = "surface"."""

    size: PositiveVector = quantity(..., "m", "its edges, > 0", examples=[[1.0, 1.0, 1.0]])
    rotation: RotationTable | None = key(
        None, "turned about `point`, { axis = [0, 1, 0], degrees = 35 }; absent: edges along the axes of the world"
    )
    inputs: BoxInputs = key(
        ("point", "velocity"),
        "what of `point`, `rotation`, `velocity`, `angular_velocity` are inputs, or single components; "
        "the rest are parameters, which hold at every communication point",
    )

    def shape(self) -> SolidShape:
        """What there is to see."""
        return SolidShape(self.name, "box", self.size)

    def rotation_vector(self) -> tuple[float, float, float]:
        """Along the axis, as long as the angle [rad]."""
        return self.rotation.vector() if self.rotation else (0.0, 0.0, 0.0)

    def input_components(self) -> list[str]:
        """What is an input of pose and motion: "rotation.z", ..."""
        return _components(BOX_POSE, self.inputs) if self.motion == "input" else []


class Pin(Section):
    """Control points on a rigid frame, whose axes at rest are the world's."""

    name: Name = key(..., NAME, examples=["base"])
    points: Selection = key(..., "the pinned control points: a selection of at least one", examples=["z-"])
    origin: Vector | None = quantity(
        None, "m", "origin of the frame at rest: what its position and velocity are those of, and its torque is about; default: the "
        "centroid of the points"
    )  # fmt: skip
    motion: Motion = key("fixed", '"fixed", or "input": the FMU has inputs for what `inputs` names')
    inputs: PinInputs = key(
        ("position", "velocity"),
        'what of `position`, `orientation`, `velocity`, `angular_velocity` of the frame are inputs, or single components: "position.z"; '
        "the rest are parameters, which hold at every communication point",
    )

    def input_components(self) -> list[str]:
        """What is an input of pose and motion: "position.z", ..."""
        return _components(PIN_POSE, self.inputs) if self.motion == "input" else []


class Load(Section):
    """A total force shared equally by its points; an input of the FMU."""

    name: Name = key(..., NAME, examples=["push"])
    points: Selection = key(..., "the loaded control points: a selection of at least one", examples=["x+"])


class Inputs(Section):
    """Inputs besides those of planes, pins and loads."""

    forces: Selection = key("none", "control points with a force input each: a selection")


class Initial(Section):
    """The state at the start: x0 = origin + stretch (X - origin) + offset, X the rest position, turned by the rotation."""

    stretch: Vector = quantity((1.0, 1.0, 1.0), "1", "factor per axis on the rest shape")
    offset: Vector = quantity((0.0, 0.0, 0.0), "m", "displacement of the whole object")
    rotation: RotationTable | None = key(
        None,
        "the whole object turned about the centre of its box, { axis = [0, 1, 0], degrees = 35 }, with the points that pins hold; "
        "velocities stay those of the world frame; absent: not turned, and no parameter for it",
    )
    velocity: Vector = quantity((0.0, 0.0, 0.0), "m/s", "velocity of the whole object, world frame")
    angular_velocity: Vector = quantity((0.0, 0.0, 0.0), "rad/s", "angular velocity about the box's centre, world frame")

    def rotation_vector(self) -> tuple[float, float, float]:
        """Along the axis, as long as the angle [rad]."""
        return self.rotation.vector() if self.rotation else (0.0, 0.0, 0.0)


class Probe(Section):
    """A point of the object followed through the deformation: Q(u, v, w) of Xia & Wang 2009, eq. (1)."""

    name: Name = key(..., NAME, examples=["nose"])
    at: Vector = quantity(..., "m", "a place in the rest shape, inside the box", examples=[[0.5, 0.5, 0.5]])


class Outputs(Section):
    """What the FMU computes for others; what is not asked for does not exist."""

    positions: Selection = key("all", "control points whose positions are outputs: a selection")
    velocities: Selection = key("none", "control points whose velocities are outputs: a selection")
    reactions: Switch = key(True, "force and torque on each plane and each pin, centre of pressure on each plane")
    energy: Switch = key(False, "kinetic, elastic, gravity and dissipated energy, work")
    solver: Switch = key(False, "steps, error estimate, stable step, folded cells")


class Solver(Section):
    """How the equations of motion are integrated."""

    method: Literal["auto", "central_difference", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "backward_euler"] = key(
        "auto", '"auto": chosen per communication step; "central_difference": as published'
    )
    tolerance: Number = quantity(1e-4, "m", "error at the end of the run for a box of 1 m, scaled by its largest side", gt=0)
    step: Number = quantity(0.0, "s", "internal step; 0: chosen by stability and tolerance", ge=0)
    most_work: Number = key(
        5e6,
        "work that one call may do, in evaluations of the forces of 64 control points: a million is about a second of one core",
        gt=0,
    )
    threads: Threads = key(
        1, "1 to 64 threads that share the work on the springs' forces, each for 512 control points at least; results have the same bits"
    )
    error_estimate: Switch = key(False, "a second run beside this one estimates its error; costs 80 to 160 % more")


class Experiment(Section):
    """The default experiment of the FMU."""

    stop_time: Number = quantity(1.0, "s", "end of the simulation", gt=0)
    communication_step: Number = quantity(0.01, "s", "time between two exchanges of inputs and outputs", gt=0)


class Fmu(Section):
    """How the FMU shows itself to other tools."""

    names: Literal["structured", "plain"] = key(
        "structured",
        'names of variables at control points: "structured" is position[0,1,2].x; "plain" is position_0_1_2.x, for tools that split '
        "names at commas or know no brackets; runs and CSV files take either form",
    )
