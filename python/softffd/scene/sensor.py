"""The section of sensors: patches of the object's surface whose contact forces are outputs."""

from typing import Annotated, Any

from pydantic import AfterValidator, Field, Strict, Tag

from softffd.scene.section import NAME, Name, Section, Text, Vector, key, list_of, list_schema, one_of, refusal

MOST = 64  # taxels along a side
Corners = Annotated[tuple[Vector, Vector], list_of(2, "2 corners [[x, y, z], [x, y, z]]")]
Side = Annotated[int, Strict(), Field(ge=1, le=MOST)]
Sides = Annotated[tuple[Side, Side], list_of(2, "2 whole numbers [n, m]"), list_schema(2, type="integer", minimum=1, maximum=MOST)]


def _in_order(corners: tuple[Any, Any]) -> tuple[Any, Any]:
    lower, upper = corners
    if any(low > high for low, high in zip(lower, upper, strict=True)):
        raise refusal("[lower corner, upper corner], of which the second is nowhere below the first")
    return corners


class Cuboid(Section):
    """A box with edges along the axes, in the rest shape."""

    box: Annotated[Corners, AfterValidator(_in_order)] = key(..., "its lower and its upper corner [m]", examples=[[[0.0] * 3, [1.0] * 3]])


On = Annotated[
    Annotated[Text, Tag("<word>")] | Annotated[Cuboid, Tag("<box>")],
    one_of(
        {"<word>": str, "<box>": dict | Cuboid},
        'a face such as "z-", the name of a group of the mesh, or { box = [[x, y, z], [x, y, z]] }',
    ),
]


class Sensor(Section):
    """Contact forces and pressures on a patch of the object: outputs, of all obstacles together, means over the communication step."""

    name: Name = key(..., NAME, examples=["foot"])
    on: On = key(
        ...,
        'the patch: "z-" and its like is what faces that side of the box, of the mesh where that touches, else of the control points; the '
        "name of a group or object of the mesh; { box = [[x, y, z], [x, y, z]] } is what lies in a box of the rest shape [m]",
        examples=["z-"],
    )

    taxels: Sides | None = key(
        None, "a grid of n x m cells over the patch, 1..64 each, along the axes that it lies along, in their order; absent: none"
    )

    @property
    def where(self) -> str | tuple[Any, Any]:
        """What `on` says, of a box its corners."""
        return self.on if isinstance(self.on, str) else self.on.box
