"""What a scene uses: an internal step of it against one of springs alone."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from boxes import STEP, box
from measured import Pair, row

from softffd import Simulation

GROUP = "parts of a scene"
INTERVAL = 0.1
"""The communication step [s]: a thousand internal ones, whose number hides its own cost."""

GRAVITY = {"environment": {"gravity": [0.0, 0.0, -9.81]}}
AT_REST = {"initial": {"stretch": [1.0, 1.0, 1.0]}}


def ground(height: float) -> dict[str, Any]:
    """A plane, with its reaction and torque as outputs."""
    plane = {"name": "ground", "point": [0.0, 0.0, height], "normal": [0.0, 0.0, 1.0], "friction": 0.4}
    return {"plane": [plane], "outputs": {"reactions": True}}


def part(name: str, *, goal: float | None = None, **sections: Any) -> None:
    """A row for a scene with these sections besides."""

    @row(GROUP, name, "a step of springs alone", goal=goal)
    def with_part() -> Iterator[Pair]:
        with Simulation(box(**sections)) as own, Simulation(box()) as bare:
            yield Pair(lambda: lap(own), lambda: lap(bare), per=round(INTERVAL / STEP))


def lap(simulation: Simulation) -> float:
    """Processor time [s] of the second communication step of a run, so that every repetition does the same."""
    simulation.restart()
    simulation.step(INTERVAL)
    began = time.process_time()
    simulation.step(INTERVAL)
    return time.process_time() - began


part("damping", material={"damping": 0.01})
part("internal damping", material={"internal_damping": 1e-4})
part("gravity", **GRAVITY)
part("a load", load=[{"name": "push", "points": "x+"}])
part("64 force inputs", inputs={"forces": "all"})
part("energy outputs", outputs={"energy": True})
part("a plane out of reach", **ground(-9.0))
part("16 points resting on a plane", goal=1.4, **GRAVITY, **AT_REST, **ground(0.0))
part("volume stiffness, body in shape", material={"volume_stiffness": 9e3})
too_soft_to_unfold = {"volume_stiffness": 1e-6}
part("volume stiffness, all corners folded", material=too_soft_to_unfold, initial={"stretch": [1.02, 1.0, -1.0]})
part("a pinned face", pin=[{"name": "base", "points": "z-"}], outputs={"reactions": True})
