"""Names of an Integer variable's values, which stand in its description: "Time integration method: 1 auto, 2 central_difference".

FMI 2.0 has enumerations for this, which many masters can't set.
"""

from __future__ import annotations

import re

_LIST = re.compile(r"[^:]*: (\d+ \w+(?:, \d+ \w+)*)")


def list_of_values(values: dict[str, int]) -> str:
    """The list of values by name, as descriptions and messages have it."""
    return ", ".join(f"{value} {name}" for name, value in values.items())


def listed_values(description: str) -> dict[str, int] | None:
    """The values by name from a description that ends in their list; None where it has none."""
    found = _LIST.fullmatch(description)
    return {name: int(value) for value, name in (pair.split() for pair in found[1].split(", "))} if found else None
