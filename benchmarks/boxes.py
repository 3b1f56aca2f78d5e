"""The measured scenes: boxes of springs with a side of one metre and a sixty-fourth of a kilogram per point."""

from __future__ import annotations

from typing import Any

from softffd.scene.scene import Scene, scene_from

STEP = 1e-4
"""Internal step [s]"""


def box(side: int = 4, method: str = "leapfrog", **sections: Any) -> Scene:
    """Returns a vibrating box of side x side x side points with springs alone, and further sections as given."""
    parts: dict[str, Any] = {
        "lattice": {"points": [side] * 3, "basis": "bspline" if side > 4 else "bezier"},
        "mass": {"total": side**3 / 64},
        "material": {"stiffness": 1e3, "damping": 0.0},
        "initial": {"stretch": [1.02, 1.0, 1.0]},
        "outputs": {"reactions": False, "positions": "all" if side <= 8 else "none"},
        "solver": {"method": method, "step": STEP},
    }
    for name, section in sections.items():
        parts[name] = parts.get(name, {}) | section if isinstance(section, dict) else section
    return scene_from(parts)
