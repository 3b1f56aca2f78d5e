"""The sections of a scene file, key by key: default, unit, range and meaning. SI units."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Strict, Tag, WithJsonSchema

from softffd.scene import section
from softffd.scene.cells import PATCH
from softffd.scene.section import NAME, Name, Number, PositiveVector, RotationTable, Section, Switch, Vector, key, quantity, refusal
from softffd.scene.selection import Selection


def _file_name(value: Any) -> Path:
    if isinstance(value, Path):
        return value
    if not isinstance(value, str) or not value.strip() or not value.isprintable():
        raise refusal("the name of a mesh file in quotes")
    return Path(value)


FileName = Annotated[Path, BeforeValidator(_file_name), WithJsonSchema({"type": "string", "minLength": 1})]
Count = Annotated[int, Strict(), Field(ge=2, le=32)]
Cells = Annotated[int, Strict(), Field(ge=1, le=31)]
Threads = Annotated[int, Strict(), Field(ge=1, le=64)]
Counts = Annotated[
    tuple[Count, Count, Count],
    section.list_of(3, "3 whole numbers [nx, ny, nz]"),
    section.list_schema(3, type="integer", minimum=2, maximum=32),
]


if TYPE_CHECKING:
    PointsInput = tuple[int, int, int]  # what either form becomes
else:
    PointsInput = Annotated[
        Annotated[Counts, Tag("<list>")] | Annotated[Literal["cubic"], Tag("<word>")],
        Discriminator(lambda value: "<word>" if isinstance(value, str) else "<list>"),
    ]


class Lattice(Section):
    """The volume around the object and its springs (Xia & Wang 2009, section 1), or the patches of a solid."""

    points: PointsInput = quantity(
        (4, 4, 4), "1",
        "number of control points per axis, [nx, ny, nz], each from 2 to 32. For a solid each is 4, 7, .. or 31: three cells per patch. "
        'With "cubic", or without `points`, the numbers are computed from `cells` or `spacing` if one of these is given',
    )  # fmt: skip
    cells: Cells | None = quantity(
        None, "1",
        "number of cells along the longest side of the box, 1 to 31, in place of `points`. The other sides get nearly cubic cells, and "
        "each side of a solid gets whole patches",
    )  # fmt: skip
    spacing: Number | None = quantity(None, "m", "approximate edge of the cells, in place of `points`", gt=0)
    origin: Vector | None = quantity(None, "m", "lower corner of the box; default: that of the mesh enlarged by `margin`, or [0, 0, 0]")
    size: PositiveVector | None = quantity(
        None, "m", "edges of the box, > 0; default: those of the mesh enlarged by `margin`, or [1, 1, 1]"
    )
    margin: Number = quantity(0.0, "1", "fraction of the size of the mesh that the box adds on every side", ge=0)
    springs: Literal["distinct", "paper"] = key(
        "distinct",
        'with "distinct" each spring exists once (468 for 4x4x4). With "paper" the springs on the edges of the box exist twice (504). A '
        "solid has no springs",
    )
    basis: Literal["bezier", "bspline", "patches"] = key(
        "bezier",
        'with "bezier" each control point moves the whole object. With "bspline" (uniform cubic, clamped) it moves only its surroundings, '
        'which suits fine lattices. A solid has "patches": Bezier volumes of 3 x 3 x 3 cells side by side',
    )


class MeshFile(Section):
    """The embedded object."""

    file: FileName = key(
        ..., "a mesh file: OBJ, STL, PLY, GLB, glTF, OFF, COLLADA (.dae) or 3MF, relative to the scene file", examples=["car.obj"]
    )
    scale: Number = quantity(1.0, "1", "metres per unit of length of the file", gt=0)
    up: Literal["x", "y", "z"] = key("z", "axis of the file that becomes +z")


class Mass(Section):
    """The mass of the object and its distribution over the control points."""

    total: Number | None = quantity(None, "kg", "total mass; default without `density`: 1", gt=0)
    density: Number | None = quantity(
        None, "kg/m3",
        "density, in place of `total`; the volume is that of the mesh, which must be closed, or of the box without a mesh", gt=0,
    )  # fmt: skip
    distribution: Literal["uniform", "box", "vertices", "surface", "volume"] = key(
        "uniform",
        'with "uniform" all points have equal masses. With "box" the box has uniform density: each cell gives an eighth of its mass to '
        'each corner. With "vertices", "surface" or "volume" the mass is spread evenly over that part of the mesh. The default beside '
        '`material.youngs_modulus` is "volume" with a closed mesh, and "box" otherwise. A solid cannot have "uniform"',
    )
    uniform_share: Number = quantity(
        0.1, "1",
        "this fraction of the mass is shared equally by all points, so that no point is nearly massless. It must be 0 with \"box\", which "
        "is its default there. A solid does not have this key",
        ge=0, le=1,
    )  # fmt: skip
    inertia: Literal["lumped", "matched"] = key(
        "lumped",
        'with "lumped" the masses follow the weights of the points. Their moment of inertia is too large, about twice at 4 control points '
        'per axis; `softffd build` reports the factor. With "matched" the masses have the inertia of the object, for bodies that roll or '
        "tip, and steps are shorter. A solid has the inertia of the object already, if masses at its nodes can have it",
    )


class Stiffness(Section):
    """Stiffness by kind of spring."""

    edge: Number = quantity(..., "N/m", "stiffness of the edge springs", ge=0, examples=[1e3])
    face: Number = quantity(..., "N/m", "stiffness of the face diagonals", ge=0, examples=[1e3])
    body: Number = quantity(..., "N/m", "stiffness of the body diagonals", ge=0, examples=[1e3])


def _for_all_springs(value: float | Stiffness) -> Stiffness:
    return value if isinstance(value, Stiffness) else Stiffness(edge=value, face=value, body=value)


if TYPE_CHECKING:
    StiffnessInput = Stiffness  # what either form becomes
else:
    StiffnessInput = Annotated[
        Annotated[Number, Field(ge=0), Tag("<number>")] | Annotated[Stiffness, Tag("<table>")],
        section.one_of({"<number>": int | float, "<table>": dict | Stiffness}, "a number or a table { edge = , face = , body = }"),
        AfterValidator(_for_all_springs),
    ]


class Material(Section):
    """The body is made of springs with a stiffness or a modulus (Xia & Wang 2009, eq. (3) and (6)), or it is a solid of finite elements.
    The elastic body always fills the whole box, also if the mesh fills little of the box: a hollow object has the stiffness of a block."""

    model: Literal["springs", "solid"] = key(
        "springs",
        '"springs": those of the paper; "solid": finite elements of a neo-Hookean solid, with `youngs_modulus` and `poissons_ratio`',
    )
    stiffness: StiffnessInput | None = quantity(
        None, "N/m",
        "spring stiffness, >= 0: one number for all springs, or { edge = , face = , body = }. The default without `youngs_modulus` is "
        "1e3. A solid does not have this key",
    )  # fmt: skip
    youngs_modulus: Number | None = quantity(
        None, "Pa",
        "Young's modulus at small strain. It must be given for a solid. For springs it replaces `stiffness`: the springs, on edges and "
        "face diagonals only, then behave as an isotropic body of Poisson's ratio 1/4 on any lattice", gt=0,
    )  # fmt: skip
    poissons_ratio: Number | None = quantity(
        None, "1",
        "Poisson's ratio of a solid; the default is 0.45. A ratio nearer to 1/2 makes steps shorter. Springs do not have this key",
        ge=0, le=0.495,
    )  # fmt: skip
    density: Number | None = quantity(None, "kg/m3", "density of a solid, the same as `mass.density`. Springs do not have this key", gt=0)
    damping: Number = quantity(
        0.01, "N.s/m",
        "nodal viscous drag: damping coefficient of each control point, d_i of eq. (3). It also brakes rigid motion. The default beside "
        "`youngs_modulus` is 0", ge=0,
    )  # fmt: skip
    internal_damping: Number = quantity(
        0.0, "s",
        "Kelvin-Voigt damping: the stiffness is multiplied by this time, which gives each spring a dashpot. It damps deformation but not "
        "rigid motion. A mode of angular frequency omega gets the damping ratio omega / 2 times this time. With 0 there is none",
        ge=0,
    )  # fmt: skip
    volume_stiffness: Number = quantity(
        0.0, "Pa",
        "prevents crushed cells from inverting; it acts once a corner of a cell has lost half its volume. Begin with 3 times the stiffness "
        "divided by the edge of a cell, or with `youngs_modulus`. 0 switches it off. A solid does not have this key", ge=0,
    )  # fmt: skip

    @property
    def multiple(self) -> int:
        """The number of cells along each axis is a multiple of this number."""
        return PATCH if self.model == "solid" else 1


class Region(Section):
    """A local override. Where regions overlap, the last one wins. In a region of a solid only `mass` and `damping` can be given."""

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
        None, "s", "internal damping of springs with both ends in the region; with a modulus, of cells with all corners in it", ge=0
    )


class Environment(Section):
    """What acts everywhere."""

    gravity: Vector | None = quantity(None, "m/s2", "gravitational acceleration; absent: no gravity, and no variable for it")


class Contact(Section):
    """The points of the object that obstacles act on."""

    of: Literal["surface", "lattice"] = key(
        "lattice",
        'with "surface" obstacles act on the vertices of the mesh; this is the default with a mesh. With "lattice" they act on the control '
        "points, whose convex hull contains the object, or on the nodes of a solid. This is the default without a mesh, and with the "
        'method "central_difference", which has no contact of the surface',
    )
    penetration: Number = quantity(
        1e-3, "1",
        "if a mesh has more than 5,000 vertices, at most 5,000 are tested for contact. This is the penetration that is aimed at for the "
        "others, as a fraction of the lattice's height; `softffd build` reports the real bound. With 0 all vertices are tested", ge=0, le=1,
    )  # fmt: skip


class Load(Section):
    """A total force, an input of the FMU. Control points share it equally, nodes of a solid by their volume, as a traction on a face."""

    name: Name = key(..., NAME, examples=["push"])
    points: Selection = key(..., "the loaded control points: a selection of at least one", examples=["x+"])


class Inputs(Section):
    """Inputs besides those of planes, pins and loads."""

    forces: Selection = key("none", "control points with a force input each: a selection")


class Initial(Section):
    """The state at the start: x0 = origin + stretch (X - origin) + offset, X the rest position, then the rotation."""

    stretch: Vector = quantity((1.0, 1.0, 1.0), "1", "factor per axis on the rest shape, and on where free pins are")
    offset: Vector = quantity((0.0, 0.0, 0.0), "m", "displacement of the whole object, and of free pins with it; other pins stay")
    rotation: RotationTable | None = key(
        None,
        "rotation of the whole object about the centre of its box, { axis = [0, 1, 0], degrees = 35 }, with the points that pins hold; "
        "velocities stay in the world frame; absent: no rotation, and no parameter for it",
    )
    velocity: Vector = quantity((0.0, 0.0, 0.0), "m/s", "velocity of the whole object, or of its centre if it spins, world frame")
    angular_velocity: Vector = quantity((0.0, 0.0, 0.0), "rad/s", "angular velocity about the centre, world frame")
    spin_about: Literal["box", "mass"] = key(
        "box",
        'reference point of `velocity` and `angular_velocity`: "box": the centre of the box; "mass": the centre of mass',
    )

    def rotation_vector(self) -> tuple[float, float, float]:
        """Returns the rotation vector: along the axis, with the angle [rad] as its length."""
        return self.rotation.vector() if self.rotation else (0.0, 0.0, 0.0)


class Solver(Section):
    """How the equations of motion are integrated."""

    method: Literal["auto", "central_difference", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "backward_euler", "sdirk2"] = key(
        "auto", '"auto": chosen per communication step; "central_difference": as published'
    )
    tolerance: Number = quantity(
        1e-4, "1",
        "error allowed in each coordinate of any control point, or node of a solid, at the end of the run, relative to the largest side of "
        "the box", gt=0,
    )  # fmt: skip
    step: Number = quantity(0.0, "s", "internal step; 0: chosen by stability and tolerance", ge=0)
    most_work: Number = key(
        5e6,
        "limit of the work of one call, in evaluations of the forces of 64 control points: a million takes about a second on one core",
        gt=0,
    )
    threads: Threads = key(
        1, "number of threads for the spring forces, 1 to 64. Each thread needs at least 512 control points. The results have the same bits"
    )
    error_estimate: Switch = key(False, "estimates the error by a second run beside this one; takes 80 to 400 % more time")


class Experiment(Section):
    """The default experiment of the FMU."""

    stop_time: Number = quantity(1.0, "s", "end of the simulation", gt=0)
    communication_step: Number = quantity(0.01, "s", "time between two exchanges of inputs and outputs", gt=0)


class Fmu(Section):
    """The interface of the FMU to other tools."""

    names: Literal["structured", "flat"] = key(
        "structured",
        'names of variables: "structured" is position[0,1,2].x and plane.ground.point.z; "flat" is position_0_1_2_x and '
        "plane_ground_point_z, for tools that take letters, digits and underscores only; runs and CSV files take either form",
    )
