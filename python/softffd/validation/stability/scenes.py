"""The scenes of the cases, as documents: a box and what acts on it."""

from __future__ import annotations

import math
from typing import Any

GRAVITY = 9.81
DOWN = {"gravity": [0.0, 0.0, -GRAVITY]}
Z, X = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
ORIGIN = (0.0, 0.0, 0.0)


def box(
    stiffness: float = 1e3, damping: float = 0.0, *, points: tuple[int, int, int] = (4, 4, 4), method: str = "auto", **sections: Any
) -> dict[str, Any]:
    """A box of 1 m and 1 kg with springs of one stiffness [N/m] and a damping of each control point [N s/m]; other sections as given."""
    document: dict[str, Any] = {
        "lattice": {"points": list(points)},
        "material": {"stiffness": stiffness, "damping": damping},
        "solver": {"method": method},
    }
    for name, section in sections.items():
        document[name] = document.get(name, {}) | section if isinstance(section, dict) else section
    return document


def plane(name: str = "ground", *, point=ORIGIN, normal=Z, friction: float = 0.0, velocity=ORIGIN, **motion: Any) -> dict[str, Any]:
    """An obstacle. motion: `motion` and `inputs` of a plane that inputs move."""
    return {
        "name": name, "point": list(point), "normal": list(normal), "friction": friction, "velocity": list(velocity), **motion,
    }  # fmt: skip


def tilted(degrees: float) -> dict[str, Any]:
    """Gravity of a world in which the plane z = 0 is an incline."""
    angle = math.radians(degrees)
    return {"gravity": [GRAVITY * math.sin(angle), 0.0, -GRAVITY * math.cos(angle)]}
