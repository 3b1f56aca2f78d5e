"""The numbers of a scene file: strict, finite types, and fields that carry their unit and range.

Strict: TOML has types, so `"1.0"` or `true` is not a number here.
Finite: TOML knows `nan` and `inf`, physics does not.
"""

from typing import Annotated, Any

from pydantic import AllowInfNan, BeforeValidator, Field, Strict, WithJsonSchema
from pydantic_core import PydanticCustomError

SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def refusal(wanted: str, *, nearest: str | None = None) -> PydanticCustomError:
    """The error that a validator raises; it will read `PATH: wanted {wanted}, got ...`."""
    return PydanticCustomError("wanted", "{wanted}", {"wanted": wanted, "nearest": nearest})


def list_of(length: int, wanted: str) -> BeforeValidator:
    """A validator that lets a list of `length` entries pass."""

    def check(value: Any) -> Any:
        if isinstance(value, list | tuple) and len(value) == length:
            return value
        raise refusal(wanted)

    return BeforeValidator(check)


def list_schema(length: int, **entry: Any) -> WithJsonSchema:
    """The JSON schema of a list of `length` equal entries (draft 7, which editors know)."""
    return WithJsonSchema({"type": "array", "items": entry, "minItems": length, "maxItems": length})


def key(default: Any, description: str, **options: Any) -> Any:
    """A pydantic field for a key of the file; `default` is `...` for one that must be given."""
    return Field(default, description=description, **options)


def quantity(default: Any, unit: str, description: str, **options: Any) -> Any:
    """A key for a number with its unit ("1" for none) and bounds (gt, ge, lt, le), shown in its description.

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
