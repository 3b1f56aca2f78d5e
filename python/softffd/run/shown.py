"""What a result says of itself: a few lines in a console, and in a notebook its picture and its page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from softffd.names import listed

if TYPE_CHECKING:
    from softffd.run.result import Result


def in_words(result: Result) -> str:
    """Title and time, positions with the largest deformation, names of outputs, inputs and parameters, the first warning."""
    span = f"{result.time[0]:.6g} to {result.time[-1]:.6g} s" if len(result.time) else "no time"
    lines = [
        f"Result of {result.title}: {span} in {len(result.time)} rows",
        f"positions {result.positions.shape} m, {_deformed(result)}",
        *(f"{what}: {listed(names)}" for what in ("outputs", "inputs", "parameters") if (names := getattr(result, what))),
    ]
    if warnings := result.summary.get("warnings"):
        lines.append(f"{len(warnings)} warning{'s, the first' if len(warnings) > 1 else ', the first'}: {warnings[0]}")
    if result.sceneless:
        lines.append(f"without its scene: {result.sceneless}")
    return "\n  ".join(lines)


def _deformed(result: Result) -> str:
    if not result.has_positions:
        return "not all recorded"
    depths = result.deformation()
    row = int(np.argmax(depths))
    return f"largest deformation {depths[row]:.4g} m at {result.time[row]:.4g} s"
