"""A cell of the map: its setting, the communication steps of its run, and its verdict."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from validation.stability.drive import Drive

RADIANS = 400.0  # phase of the highest mode that a run covers if the communication step is short

PATIENCE, HANG = 1.0, 4.0
"""A cell makes no further communication step after the first time [s]. It is abandoned if a single step takes longer than the second."""

STATED = 10.0  # an error up to this multiple of the component's estimate counts as stated
GAIN = 1e-2  # relative energy gain above which a motion is WRONG, whatever error is stated

CLASSES = ("accurate", "bounded", "divided", "unstated", "slow", "refused", "WRONG")
"""bounded: the component's estimate states the error. divided: accurate or bounded after the component has divided a given step. unstated:
with a given step, to which no tolerance applies, the motion is bounded but the error exceeds ten times the estimate; with a step of the
component's choice such a cell is WRONG. slow: no answer within the time. refused: fmi2Discard or fmi2Error. WRONG: fmi2OK all the same."""


@dataclass(frozen=True)
class Panel:
    """One map: a scene with a method. The component chooses the internal steps, or the steps are given."""

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
    ratio: float = 0.0  # internal damping time times the highest frequency: twice the damping ratio of that mode


@dataclass(frozen=True)
class Judged:
    """The result of a cell."""

    kind: str  # one of CLASSES
    error: float = math.nan
    """vibration, rebound: of a position [m]; rotation: of energy or angular momentum, contact: of the friction impulse, both relative"""
    stated: float = math.nan  # the component's own estimate [m]
    steps: int = 0  # communication steps made
    internal_steps: int = 0
    run_time: float = 0.0  # s
    why: str = ""


def omega(stiffness: float) -> float:
    """Returns the highest frequency of the box [rad/s]. stiffness: [N/m]."""
    return 8 * math.sqrt(stiffness)


def settings(panel: Panel, stiffness: float, step: float) -> dict[str, Any]:
    """Returns the start values for a stiffness [N/m] and a communication step [s]."""
    springs = {f"stiffness.{kind}": stiffness for kind in ("edge", "face", "body")}
    return springs | {"solver.method": panel.method, "solver.step": step if panel.given else 0.0}


class Trial:
    """The run of a cell: makes the communication steps and the verdict."""

    def __init__(self, drive: Drive, cell: Cell, began: float):
        """began: clock time [s] from which the patience is counted."""
        self.drive, self.cell, self.began = drive, cell, began
        self.patience = PATIENCE
        self.wanted = min(max(math.ceil(RADIANS / (omega(cell.stiffness) * cell.step)), 4), 200)
        self.done = 0
        drive.body.stiffness[:] = cell.stiffness

    def start(self, **more: float) -> None:
        """Restarts the drive with the settings of the cell. more: start values besides those of the map."""
        cell = self.cell
        damping = {"internal_damping": cell.ratio / omega(cell.stiffness)} if cell.ratio else {}
        self.drive.restart(settings(cell.panel, cell.stiffness, cell.step) | damping | more, self.wanted * cell.step)

    def steps(self) -> Iterator[None]:
        """Makes communication steps, at least one, until the wanted number is done or the time is over, and yields after each."""
        while self.done < self.wanted and (self.done == 0 or clock.perf_counter() - self.began < self.patience):
            self.drive.step(self.cell.step)
            self.done += 1
            yield

    @property
    def stated(self) -> float:
        """Error estimate of the component [m]"""
        return self.drive.value("solver.error_estimate")

    def judged(self, kind: str, error: float, why: str = "") -> Judged:
        """Returns the verdict at the present state."""
        divided = "above the stability bound" in self.drive.warned and kind in ("accurate", "bounded")
        internal, elapsed = int(self.drive.value("solver.steps")), clock.perf_counter() - self.began
        return Judged("divided" if divided else kind, error, self.stated, self.done, internal, elapsed, why)
