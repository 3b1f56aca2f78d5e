"""What sections of a scene file are made of: their base, and types of keys that several of them have."""

import math
import re
import unicodedata
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Strict, WithJsonSchema

from softffd.names import IDENTIFIER
from softffd.scene.quantity import Number, Vector, key, refusal


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


Text = Annotated[str, Strict(), AfterValidator(_printable)]
Name = Annotated[
    str,
    Strict(),
    AfterValidator(_identifier),
    WithJsonSchema({"type": "string", "pattern": f"^{IDENTIFIER}$"}),
]
Direction = Annotated[Vector, AfterValidator(_direction)]
NAME = "a name for the FMU's variables: letters, digits, underscores"


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
