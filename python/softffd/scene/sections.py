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
        'control points per axis [nx, ny, nz], 2..32 each, of a solid 4, 7, .., 31, three cells for each patch; "cubic", or absent beside '
        "`cells` or `spacing`: computed from these",
    )  # fmt: skip
    cells: Cells | None = quantity(
        None, "1",
        "cells along the longest side of the box, 1..31, in place of `points`; the other sides get nearly cubic cells, a solid whole "
        "patches",
    )  # fmt: skip
    spacing: Number | None = quantity(None, "m", "approximate edge of the cells, in place of `points`", gt=0)
    origin: Vector | None = quantity(None, "m", "lower corner of the box; default: that of the mesh enlarged by `margin`, or [0, 0, 0]")
    size: PositiveVector | None = quantity(
        None, "m", "edges of the box, > 0; default: those of the mesh enlarged by `margin`, or [1, 1, 1]"
    )
    margin: Number = quantity(0.0, "1", "fraction of the size of the mesh that the box adds on every side", ge=0)
    springs: Literal["distinct", "paper"] = key(
        "distinct", '"distinct": each spring once (468 for 4x4x4); "paper": springs on the edges of the box twice (504); a solid has none'
    )
    basis: Literal["bezier", "bspline", "patches"] = key(
        "bezier",
        '"bezier": each control point moves the whole object; "bspline": uniform cubic, clamped: only its surroundings, for fine lattices; '
        '"patches", that of a solid: Bezier volumes of 3 x 3 x 3 cells side by side',
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
        '"uniform": equal masses; "box": uniform density in the box, each cell gives an eighth of its mass to each corner; "vertices", '
        '"surface", "volume": uniform over those of the mesh; default beside `material.youngs_modulus`: "volume" with a closed mesh, '
        'else "box"; a solid is never "uniform"',
    )
    uniform_share: Number = quantity(
        0.1, "1",
        'fraction of the mass that is distributed equally over the points, so that none is nearly massless; 0 for "box"; none of a solid',
        ge=0, le=1,
    )  # fmt: skip
    inertia: Literal["lumped", "matched"] = key(
        "lumped",
        '"lumped": masses by the weights; their moment of inertia is too large, about twice at 4 control points per axis '
        '(`softffd build` reports it); "matched": the inertia of the object, for bodies that roll or tip; steps are two to five times '
        "shorter; a solid has it by itself, where masses at its nodes can",
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
    """Springs and damping (Xia & Wang 2009, eq. (3) and (6)): a stiffness for each spring, or a modulus; or a solid of finite elements.
    The elastic body is the whole box of the lattice, also where a mesh fills little of it: a hollow one has the stiffness of a block."""

    model: Literal["springs", "solid"] = key(
        "springs",
        '"springs": those of the paper; "solid": finite elements of a neo-Hookean solid, with `youngs_modulus` and `poissons_ratio`',
    )
    stiffness: StiffnessInput | None = quantity(
        None, "N/m",
        "spring stiffness, >= 0: one number for all springs, or { edge = , face = , body = }; default without `youngs_modulus`: 1e3; "
        "none of a solid",
    )  # fmt: skip
    youngs_modulus: Number | None = quantity(
        None, "Pa",
        "Young's modulus at small strain; must be given for a solid. Of springs in place of `stiffness`: they model an isotropic body of "
        "Poisson's ratio 1/4, the only ratio that springs allow, on any lattice; only edges and face diagonals have springs", gt=0,
    )  # fmt: skip
    poissons_ratio: Number | None = quantity(
        None, "1",
        "Poisson's ratio of a solid, 0..0.495; default 0.45; the nearer to 1/2, the shorter the steps; none of springs", ge=0, le=0.495,
    )  # fmt: skip
    density: Number | None = quantity(None, "kg/m3", "density of a solid, the same as `mass.density`; none of springs", gt=0)
    damping: Number = quantity(
        0.01, "N.s/m",
        "nodal viscous drag: damping coefficient of each control point, d_i of eq. (3); it also brakes rigid motion; default beside "
        "`youngs_modulus`: 0", ge=0,
    )  # fmt: skip
    internal_damping: Number = quantity(
        0.0, "s",
        "stiffness-proportional (Kelvin-Voigt) damping: the stiffness times this time, of springs a dashpot along each; "
        "damps deformation, not rigid motion; a mode of angular frequency omega has the damping ratio omega / 2 times this time; 0: absent",
        ge=0,
    )  # fmt: skip
    volume_stiffness: Number = quantity(
        0.0, "Pa",
        "prevents the inversion of crushed cells: acts where a corner of a cell has lost half its volume; a first value is 3 times the "
        "stiffness divided by the edge of a cell, or youngs_modulus; 0: absent; none of a solid", ge=0,
    )  # fmt: skip

    @property
    def multiple(self) -> int:
        """The number of cells along each axis is a multiple of this number."""
        return PATCH if self.model == "solid" else 1


class Region(Section):
    """A local override; where regions overlap, the last one wins. Those of a solid have `mass` and `damping` alone."""

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
        '"surface": the vertices of the mesh, default with a mesh; "lattice": the control points, whose convex hull contains the object, '
        'or the nodes of a solid, which lie on its surface; default without a mesh and with the method "central_difference", which has no '
        "contact of the surface",
    )
    penetration: Number = quantity(
        1e-3, "1",
        "of a mesh with more than 5,000 vertices, up to 5,000 are tested for contact; the others may penetrate a plane by this fraction "
        "of the height of the lattice; `softffd build` reports the bound that holds; 0: all vertices are tested", ge=0, le=1,
    )  # fmt: skip


class Load(Section):
    """A total force shared equally by its points, or by nodes of a solid as their parts of the volume are, which makes a traction on a
    face; an input of the FMU."""

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
        "error allowed in any control point, or node of a solid, at the end of the run, relative to the largest side of the box", gt=0,
    )  # fmt: skip
    step: Number = quantity(0.0, "s", "internal step; 0: chosen by stability and tolerance", ge=0)
    most_work: Number = key(
        5e6,
        "limit of the work of one call, in evaluations of the forces of 64 control points: a million takes about a second on one core",
        gt=0,
    )
    threads: Threads = key(1, "threads for the spring forces, 1..64, each for at least 512 control points; results are bitwise the same")
    error_estimate: Switch = key(False, "estimates the error by a second run beside this one; takes 80 to 160 % more time")


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
