"""The sections of rigid parts, which inputs may move or which may have a mass: planes, solids and pins. SI units."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, WithJsonSchema

from softffd.names import Part
from softffd.obstacles import SolidShape
from softffd.scene.section import NAME, Direction, Name, Number, PositiveVector, RotationTable, Section, Vector, key, quantity, refusal
from softffd.scene.selection import Selection
from softffd.spelling import nearest_of

Motion = Literal["fixed", "input"]
FreeMotion = Literal["fixed", "input", "free"]

PLANE_POSE = {"point": "xyz", "normal": "xyz", "velocity": "xyz", "angular_velocity": "xyz"}
SPHERE_POSE = {"point": "xyz", "velocity": "xyz", "angular_velocity": "xyz"}
BOX_POSE = {"point": "xyz", "rotation": "xyz", "velocity": "xyz", "angular_velocity": "xyz"}
PIN_POSE = {"position": "xyz", "orientation": "wxyz", "velocity": "xyz", "angular_velocity": "xyz"}
"""Vectors of the pose and motion of a plane, a sphere, a box and a pin, with their components."""


def _pose_words(pose: dict[str, str]) -> list[str]:
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


def _inputs(pose: dict[str, str], *, of: str = "", example: str = "") -> Any:
    vectors = ", ".join(f"`{vector}`" for vector in pose)
    what = f"the vectors of {vectors}{of} that are inputs, or single components{example}"
    return key((next(iter(pose)), "velocity"), f"{what}. The others are parameters, which hold at every communication point")


def _motion(*, free: bool = False) -> Any:
    """Returns the key `motion`. free: whether the part may be a free body with its own mass."""
    body = (
        '. With "free" the part is a rigid body with its own mass, moved by gravity, by the object and by its inputs `force` and `torque`'
    )
    return key("fixed", f'with "input" the components that `inputs` names are inputs of the FMU{body if free else ""}')


def _inertia(default: str) -> Any:
    limits = "Each must be positive, and none may exceed the sum of the other two. A body with `guide` has none"
    return quantity(None, "kg m2", f"moments of inertia of a free body about {default}. {limits}")


def _guide() -> Any:
    return quantity(None, "1", "axis in the world, of any length > 0: a free body that has it moves along it only and does not turn")


class Rigid(Section):
    """A rigid part that inputs may move."""

    POSE: ClassVar[dict[str, str]] = PLANE_POSE

    if TYPE_CHECKING:  # every subclass declares these as keys of its own
        name: Any
        motion: Any
        inputs: Any

    @property
    def part(self) -> Part:
        """Kind and name of the part, with which the names of its variables begin."""
        return Part(type(self).__name__.lower(), self.name)

    def input_components(self) -> list[str]:
        """Returns the components of pose and motion that are inputs, alone or with their vector, in the order of POSE: "point.z", ..."""
        chosen = set(self.inputs) if self.motion == "input" else set()
        return [f"{vector}.{each}" for vector in self.POSE for each in self.POSE[vector] if {vector, f"{vector}.{each}"} & chosen]


class Plane(Rigid):
    """An obstacle: the half-space behind the plane is solid."""

    name: Name = key(..., NAME, examples=["ground"])
    point: Vector = quantity((0.0, 0.0, 0.0), "m", "a point of the plane")
    normal: Direction = quantity((0.0, 0.0, 1.0), "1", "points out of the solid; any length > 0")
    velocity: Vector = quantity((0.0, 0.0, 0.0), "m/s", "velocity of the obstacle at `point`")
    angular_velocity: Vector = quantity((0.0, 0.0, 0.0), "rad/s", "angular velocity about `point`")
    friction: Number = quantity(0.4, "1", "Coulomb's coefficient of friction", ge=0)
    motion: Motion = _motion()
    inputs: PlaneInputs = _inputs(PLANE_POSE, example=': "point.z"')


class Solid(Rigid):
    """A solid obstacle: the keys that all kinds have."""

    name: Name = key(..., NAME, examples=["ball"])
    point: Vector = quantity((0.0, 0.0, 0.0), "m", "its centre")
    velocity: Vector = quantity((0.0, 0.0, 0.0), "m/s", "velocity of its centre")
    angular_velocity: Vector = quantity((0.0, 0.0, 0.0), "rad/s", "angular velocity about its centre")
    friction: Number = quantity(0.4, "1", "Coulomb's coefficient of friction", ge=0)
    motion: FreeMotion = _motion(free=True)
    mass: Number | None = quantity(None, "kg", "mass of a free body, which has it or `density`", gt=0)
    density: Number | None = quantity(None, "kg/m3", "density of a free body, in place of `mass`", gt=0)
    inertia: PositiveVector | None = _inertia(
        "its own axes through its centre (a box: its edges; a cylinder: the third is `normal`; a sphere: the world's). By default "
        "they are those of the homogeneous solid"
    )
    guide: Direction | None = _guide()

    def own_mass(self) -> float:
        """Returns the mass of a free body, given or computed from the density [kg]."""
        return self.mass if self.mass is not None else (self.density or 0.0) * self.shape().volume

    def own_inertia(self) -> tuple[float, float, float]:
        """Returns the moments of inertia of a free body, given or those of the homogeneous solid [kg m2]."""
        return self.inertia or self.shape().inertia(self.own_mass())

    def shape(self) -> SolidShape:
        """Returns the form of the obstacle for pictures and mass."""
        raise NotImplementedError


class Round(Solid):
    """A solid of revolution."""

    radius: Number = quantity(..., "m", "its radius", gt=0, examples=[0.5])
    inputs: PlaneInputs = _inputs(PLANE_POSE)


class Sphere(Round):
    """An obstacle: a solid sphere about `point`; needs contact.of = "surface"."""

    POSE = SPHERE_POSE

    inputs: SphereInputs = _inputs(SPHERE_POSE)

    normal: ClassVar[tuple[float, float, float]] = (0.0, 0.0, 1.0)  # without meaning: a sphere has no axis
    length: ClassVar[float] = 0.0

    def shape(self) -> SolidShape:
        return SolidShape(self.name, "sphere", (2 * self.radius,) * 3)


class Cylinder(Round):
    """An obstacle: a solid cylinder with flat ends about `point`; needs contact.of = "surface"."""

    length: Number = quantity(..., "m", "from end to end", gt=0, examples=[1.0])
    normal: Direction = quantity((0.0, 0.0, 1.0), "1", "its axis; any length > 0")

    def shape(self) -> SolidShape:
        return SolidShape(self.name, "cylinder", (2 * self.radius, 2 * self.radius, self.length))


class Box(Solid):
    """An obstacle: a solid box about `point`; needs contact.of = "surface"."""

    POSE = BOX_POSE

    size: PositiveVector = quantity(..., "m", "its edges, > 0", examples=[[1.0, 1.0, 1.0]])
    rotation: RotationTable | None = key(
        None, "rotation about `point`, { axis = [0, 1, 0], degrees = 35 }; absent: edges along the axes of the world"
    )
    inputs: BoxInputs = _inputs(BOX_POSE)

    def shape(self) -> SolidShape:
        return SolidShape(self.name, "box", self.size)

    def rotation_vector(self) -> tuple[float, float, float]:
        """Returns the rotation vector: along the axis, with the angle [rad] as its length."""
        return self.rotation.vector() if self.rotation else (0.0, 0.0, 0.0)


class Pin(Rigid):
    """A rigid frame that holds control points, or the nodes of a solid with the same indices. At rest its axes are those of the world."""

    POSE = PIN_POSE

    name: Name = key(..., NAME, examples=["base"])
    points: Selection = key(..., "the pinned control points: a selection of at least one", examples=["z-"])
    origin: Vector | None = quantity(
        None, "m", "origin of the frame at rest: the reference point of its position, velocity and torque. The default is the centroid of "
        "the points, or of the nodes of a solid"
    )  # fmt: skip
    motion: FreeMotion = _motion(free=True)
    mass: Number | None = quantity(None, "kg", "mass of a free body, which must be given; the mass of the points is added to it", gt=0)
    inertia: PositiveVector | None = _inertia("the axes of the frame through `origin`, which is the centre of mass. They must be given")
    guide: Direction | None = _guide()
    inputs: PinInputs = _inputs(PIN_POSE, of=" of the frame", example=': "position.z"')
