"""The numbers of a run that are worth a curve: reactions of planes and pins, energies, and the lattice's height."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from softffd.names import OBSTACLES, Part, parts_of, variable_name, vector_names

if TYPE_CHECKING:
    from softffd.run.result import Result

ENERGIES = ("kinetic", "elastic", "gravity", "dissipated", "work")


def reactions(result: Result) -> dict[Part, np.ndarray]:
    """Forces of the object on its obstacles and fixtures, (T, 3) [N] each; a part as text is "plane.ground" or "pin.base"."""
    parts = [*parts_of(result.outputs, *OBSTACLES), *parts_of(result.outputs, "pin")]
    recorded = {part: vector_names("plane_reaction" if part.is_obstacle else "pin_reaction", part) for part in parts}
    whole = {part: names for part, names in recorded.items() if all(name in result.outputs for name in names)}
    return {part: np.stack([result.outputs[name] for name in names], axis=1) for part, names in whole.items()}


def energies(result: Result) -> dict[str, np.ndarray]:
    """The recorded energies: "kinetic", "elastic", ... -> (T,) [J]."""
    names = {kind: variable_name(f"energy_{kind}") for kind in ENERGIES}
    return {kind: result.outputs[name] for kind, name in names.items() if name in result.outputs}


def heights(result: Result, up: np.ndarray) -> dict[str, np.ndarray]:
    """The lattice's highest and lowest place along `up` (3,): words -> (T,) [m]."""
    along = result.positions @ np.asarray(up)
    return {"highest point": along.max(axis=(1, 2, 3)), "lowest point": along.min(axis=(1, 2, 3))}
