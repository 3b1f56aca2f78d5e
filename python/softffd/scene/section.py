"""The parts of the sections of a scene file: their base class, keys with unit and range, and types of keys that several sections have.

Numbers are strict: TOML has types, so `"1.0"` or `true` is no number here. They are finite: TOML knows `nan` and `inf`, physics does not.
"""

import math
import re
import unicodedata
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Self

from pydantic import AfterValidator, AllowInfNan, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Strict, WithJsonSchema
from pydantic_core import PydanticCustomError

from softffd.names import IDENTIFIER

SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def refusal(wanted: str, *, nearest: str | None = None) -> PydanticCustomError:
    """Returns the error that a validator raises; the message reads `PATH: wanted {wanted}, got ...`."""
    return PydanticCustomError("wanted", "{wanted}", {"wanted": wanted, "nearest": nearest})


def holding(test: Callable[[Any], bool], wanted: str, *, before: bool = False) -> AfterValidator | BeforeValidator:
    """Returns a validator that accepts values that pass `test`. before: the validator sees the values as the file has them."""

    def check(value: Any) -> Any:
        if not test(value):
            raise refusal(wanted)
        return value

    return (BeforeValidator if before else AfterValidator)(check)


def list_of(length: int, wanted: str) -> AfterValidator | BeforeValidator:
    """Returns a validator that accepts a list of `length` entries."""
    return holding(lambda value: isinstance(value, list | tuple) and len(value) == length, wanted, before=True)


def list_schema(length: int, **entry: Any) -> WithJsonSchema:
    """Returns the JSON schema of a list of `length` entries of one kind (draft 7, which editors know)."""
    return WithJsonSchema({"type": "array", "items": entry, "minItems": length, "maxItems": length})


def one_of(forms: Mapping[str, Any], wanted: str) -> Discriminator:
    """Returns the discriminator of the forms of a key. forms: Python types of each form by its tag (`<...>`, never a key of the file)."""

    def tag_of(value: Any) -> str | None:
        return next((tag for tag, types in forms.items() if isinstance(value, types) and not isinstance(value, bool)), None)

    return Discriminator(tag_of, custom_error_type="wanted", custom_error_message=wanted)


def key(default: Any, description: str, **options: Any) -> Any:
    """Returns a pydantic field for a key of the file; `default` is `...` for a key that must be given."""
    return Field(default, description=description, **options)


def quantity(default: Any, unit: str, description: str, **options: Any) -> Any:
    """Returns a field for a number with its unit ("1" for none) and bounds (gt, ge, lt, le), both shown in the description.

    The bounds of a list belong to the type of its entries and are named in `description`.
    """
    bounds = ", ".join(f"{sign} {options[bound]:g}" for bound, sign in SIGNS.items() if bound in options)
    facts = "; ".join(part for part in ("" if unit == "1" else unit, bounds) if part)
    text = f"{description} [{facts}]" if facts else description
    return key(default, text, json_schema_extra={"unit": unit}, **options)


Number = Annotated[float, Strict(), AllowInfNan(False)]
Positive = Annotated[Number, Field(gt=0)]
Switch = Annotated[bool, Strict()]
_three = list_of(3, "3 numbers [x, y, z]")
Vector = Annotated[tuple[Number, Number, Number], _three, list_schema(3, type="number")]
PositiveVector = Annotated[tuple[Positive, Positive, Positive], _three, list_schema(3, type="number", exclusiveMinimum=0)]


class Section(BaseModel):
    """A table of the scene file: immutable, and closed to unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    def filled(self, **values: Any) -> Self:
        """Returns a copy with other values; `model_fields_set` still names the keys that the file gave."""
        return self.model_construct(self.model_fields_set, **(dict(self) | values))


def _identifier(name: str) -> str:
    if re.fullmatch(IDENTIFIER, name):
        return name
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    nearest = re.sub("[^A-Za-z0-9_]+", "_", plain).strip("_")
    nearest = f"_{nearest}" if nearest[:1].isdigit() else nearest
    raise refusal("a name of letters A-Z a-z, digits and underscores, no digit first", nearest=nearest)


Text = Annotated[str, Strict(), holding(str.isprintable, "text without control characters")]
Name = Annotated[str, Strict(), AfterValidator(_identifier), WithJsonSchema({"type": "string", "pattern": f"^{IDENTIFIER}$"})]
_LONG = "a vector of length > 0 (in double precision: 1e-100 to 1e100)"
Direction = Annotated[Vector, holding(lambda vector: 1e-100 < max(map(abs, vector)) < 1e100, _LONG)]
NAME = "a name for the FMU's variables: letters, digits, underscores"


class Rotation(Section):
    """A rotation about an axis, right-handed."""

    axis: Direction = key(..., "the axis, of any length > 0", examples=[[0.0, 1.0, 0.0]])
    degrees: Number = key(..., "the angle in degrees", examples=[0.0])

    def vector(self) -> tuple[float, float, float]:
        """Returns the rotation vector: along the axis, with the angle [rad] as its length."""
        x, y, z = self.axis
        scale = math.radians(self.degrees) / math.hypot(x, y, z)
        return x * scale, y * scale, z * scale


def _rotation_table(value: Any) -> Any:
    """Passes a table on that may hold axis and degrees; for one in radians the error proposes the degrees."""
    wanted = "{ axis = [x, y, z], degrees = }"
    if not isinstance(value, dict | Rotation):
        raise refusal(f"a table {wanted}")
    if isinstance(value, dict) and "degrees" not in value and isinstance(angle := value.get("radians"), int | float):
        raise refusal(wanted, nearest=f"degrees = {math.degrees(angle):.10g}")
    return value


RotationTable = Annotated[Rotation, BeforeValidator(_rotation_table)]
