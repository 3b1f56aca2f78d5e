"""How wide contact is in cells of the lattice: of a narrow patch, the lattice decides force and size."""

from __future__ import annotations

from typing import Any

import numpy as np

from softffd.names import Part
from softffd.run.findings import reactions
from softffd.run.result import Result
from softffd.show.stage import stage_of
from softffd.show.touch import touch_of

ENOUGH = 3.0
"""Cells across a patch from which on its force is that of the material within some per cent."""


def contact_widths(result: Result) -> dict[Part, float]:
    """The width of contact with each obstacle that the body presses on, when the force is largest, in cells: the lesser of the two extents
    of the touched places at rest. Without obstacles, reactions or positions that were recorded, none."""
    forces = {part.name: (part, np.linalg.norm(force, axis=1)) for part, force in reactions(result).items() if part.is_obstacle}
    if result.lattice is None or not result.has_positions or not any(force.any() for _, force in forces.values()):
        return {}
    stage = stage_of(result, mesh=result.loaded_mesh)
    touch, cells = touch_of(result, stage), stage.size / (np.array(stage.counts) - 1)
    widths: dict[Part, float] = {}
    for obstacle in (*stage.planes, *stage.solids):
        part, force = forces.get(obstacle.name, (None, np.zeros(1)))
        for frame in (int(force.argmax()), int(force.argmax()) - 1):  # what was touched in the step may be left at its end
            touched = touch.touched(frame, obstacle) if force.any() and frame >= 0 else np.empty((0, 3))
            if len(touched):
                widths[part] = float(np.sort(np.ptp(touched / cells, axis=0))[1])
                break
    return widths


def narrow_contact(result: Result) -> dict[str, Any]:
    """Entries for the summary: the widths by obstacle, and of those that are too narrow a line to read."""
    widths = contact_widths(result)
    narrow = {part.name: width for part, width in widths.items() if width < ENOUGH - 1e-6}
    entries: dict[str, Any] = {f"{part}.contact_cells": width for part, width in widths.items()}
    if not narrow:
        return entries | {"findings": []}
    listed = ", ".join(f"{name}: {f'{width:.2g}' if width >= 0.01 else 'a point or a line'}" for name, width in narrow.items())
    line = (
        f"contact is narrower than {ENOUGH:g} cells ({listed}): force and size of the patch are the lattice's there, not the material's; "
        "finer cells show how much (docs/methods.md: How fine for contact)"
    )
    return entries | {"findings": [line]}
