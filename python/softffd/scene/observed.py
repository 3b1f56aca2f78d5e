"""The sections for observed quantities: probes, sensors (patches of the surface of the object) and outputs. SI units."""

from typing import Annotated, Any

from pydantic import Field, Strict, Tag

from softffd.scene.section import NAME, Name, Section, Switch, Text, Vector, holding, key, list_of, list_schema, one_of, quantity
from softffd.scene.selection import Selection

MOST = 64  # largest number of taxels along a side
Corners = Annotated[tuple[Vector, Vector], list_of(2, "2 corners [[x, y, z], [x, y, z]]")]
Side = Annotated[int, Strict(), Field(ge=1, le=MOST)]
Sides = Annotated[tuple[Side, Side], list_of(2, "2 whole numbers [n, m]"), list_schema(2, type="integer", minimum=1, maximum=MOST)]


def _in_order(corners: tuple[Any, Any]) -> bool:
    return all(low <= high for low, high in zip(*corners, strict=True))


class Cuboid(Section):
    """A box with edges along the axes, in the rest shape."""

    box: Annotated[Corners, holding(_in_order, "[lower corner, upper corner], of which the second is nowhere below the first")] = key(
        ..., "its lower and its upper corner [m]", examples=[[[0.0] * 3, [1.0] * 3]]
    )


On = Annotated[
    Annotated[Text, Tag("<word>")] | Annotated[Cuboid, Tag("<box>")],
    one_of(
        {"<word>": str, "<box>": dict | Cuboid},
        'a face such as "z-", the name of a group of the mesh, or { box = [[x, y, z], [x, y, z]] }',
    ),
]


class Sensor(Section):
    """Measures the contact force and pressure of all obstacles on a patch. The outputs are means over the communication step."""

    name: Name = key(..., NAME, examples=["foot"])
    on: On = key(
        ...,
        'the patch. "z-" means the part of the mesh that faces that side of the box (control points, if obstacles touch these). The patch '
        "can also be a group or object of the mesh, by its name, or everything in a box of the rest shape, "
        "{ box = [[x, y, z], [x, y, z]] } [m]",
        examples=["z-"],
    )

    taxels: Sides | None = key(
        None, "divides the patch into n x m cells, 1 to 64 each, along the two axes in which it extends, in their order; absent: none"
    )

    @property
    def where(self) -> str | tuple[Any, Any]:
        """The value of `on`; for a box, its two corners."""
        return self.on if isinstance(self.on, str) else self.on.box


class Probe(Section):
    """A point of the object followed through the deformation: Q(u, v, w) of Xia & Wang 2009, eq. (1)."""

    name: Name = key(..., NAME, examples=["nose"])
    at: Vector = quantity(..., "m", "position in the rest shape, inside the box", examples=[[0.5, 0.5, 0.5]])
    stress: Switch = key(False, "outputs of the Cauchy stress of a solid there: xx, yy, zz, xy, xz and yz [Pa]")
    von_mises: Switch = key(False, "an output of von Mises' equivalent stress of a solid there [Pa]")
    stretch: Switch = key(False, "an output of the largest principal stretch of a solid there")
    velocity: Switch = key(False, "outputs of its velocity [m/s]")
    acceleration: Switch = key(False, "outputs of its acceleration, mean of the communication step [m/s2]")
    maximum: Switch = key(
        False,
        "adds the largest magnitude, over all internal steps of the communication step, of each of `velocity`, `acceleration` and "
        "`von_mises` that is switched on",
    )


class Outputs(Section):
    """The outputs of the FMU; what is not selected does not exist."""

    positions: Selection = key("all", "control points whose positions are outputs: a selection")
    velocities: Selection = key("none", "control points whose velocities are outputs: a selection")
    reactions: Switch = key(True, "force and torque on each obstacle and each pin, centre of pressure on each obstacle")
    energy: Switch = key(False, "kinetic, elastic, gravity and dissipated energy, work")
    solver: Switch = key(False, "steps, rejected steps, contacts, stable step, inverted cells")
