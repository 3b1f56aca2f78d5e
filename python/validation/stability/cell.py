"""A cell of the map on its way: what it is, its communication steps, and its verdict."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from validation.stability.drive import Drive

RADIANS = 400.0  # the highest mode is followed for so long where the communication step is short

PATIENCE, HANG = 1.0, 4.0
"""No further communication step after this time [s]; a cell is given up when a single one takes longer than the second."""

STATED = 10.0  # an error up to so many times the stated estimate is a stated one
GAIN = 1e-2  # relative gain of energy from which on a motion is WRONG, whatever is stated

CLASSES = ("accurate", "bounded", "divided", "unstated", "slow", "refused", "WRONG")
"""bounded: an error that the component's estimate tells. divided: accurate or bounded after the component has divided a given step.
unstated: with a given step, to which no tolerance applies, bounded but with an error beyond ten times the estimate; with a step of the
component's choice that is WRONG. slow: no answer within the time. refused: fmi2Discard or fmi2Error. WRONG: fmi2OK all the same."""


@dataclass(frozen=True)
class Panel:
    """One map: a scene with a method, whose steps are chosen by the component or given."""

    scene: str
    method: str
    given: bool = False  # solver.step = the communication step

    def __str__(self) -> str:
        return f"{self.scene}, {self.method}{', solver.step = H' * self.given}"


@dataclass(frozen=True)
class Cell:
    """One setting of a panel."""

    panel: Panel
    stiffness: float  # N/m
    step: float  # communication step [s]
    ratio: float = 0.0  # time of the dashpots times the highest frequency: twice its damping ratio


@dataclass(frozen=True)
class Judged:
    """What came of a cell."""

    kind: str  # one of CLASSES
    error: float = math.nan
    """vibration, rebound: of a position [m]; rotation, contact: relative, of energy or angular momentum, and of the friction impulse"""
    stated: float = math.nan  # the component's own estimate [m]
    steps: int = 0  # communication steps made
    internal_steps: int = 0
    run_time: float = 0.0  # s
    why: str = ""


def omega(stiffness: float) -> float:
    """Highest frequency of the box [rad/s]."""
    return 8 * math.sqrt(stiffness)


def settings(panel: Panel, stiffness: float, step: float) -> dict[str, Any]:
    """Start values for a stiffness [N/m] and a communication step [s]."""
    springs = {f"stiffness.{kind}": stiffness for kind in ("edge", "face", "body")}
    return springs | {"solver.method": panel.method, "solver.step": step if panel.given else 0.0}


class Trial:
    """A cell on its way: its communication steps, and the verdict."""

    def __init__(self, drive: Drive, cell: Cell, began: float):
        """began: by the clock [s], from which on the patience counts."""
        self.drive, self.cell, self.began = drive, cell, began
        self.patience = PATIENCE
        self.wanted = min(max(math.ceil(RADIANS / (omega(cell.stiffness) * cell.step)), 4), 200)
        self.done = 0
        drive.body.stiffness[:] = cell.stiffness

    def start(self, **more: float) -> None:
        """more: start values besides those of the map."""
        cell = self.cell
        damping = {"internal_damping": cell.ratio / omega(cell.stiffness)} if cell.ratio else {}
        self.drive.restart(settings(cell.panel, cell.stiffness, cell.step) | damping | more, self.wanted * cell.step)

    def steps(self) -> Iterator[None]:
        """After each communication step, until there are enough of them or the time is over; at least one."""
        while self.done < self.wanted and (self.done == 0 or clock.perf_counter() - self.began < self.patience):
            self.drive.step(self.cell.step)
            self.done += 1
            yield

    @property
    def stated(self) -> float:
        """The component's own estimate of the error [m]."""
        return self.drive.value("solver.error_estimate")

    def judged(self, kind: str, error: float, why: str = "") -> Judged:
        """The verdict now."""
        divided = "above the stability bound" in self.drive.warned and kind in ("accurate", "bounded")
        internal, elapsed = int(self.drive.value("solver.steps")), clock.perf_counter() - self.began
        return Judged("divided" if divided else kind, error, self.stated, self.done, internal, elapsed, why)
