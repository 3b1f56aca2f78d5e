"""The cases of the table: what a case measures, the error that warnings of the component state, and the resulting verdict."""

from __future__ import annotations

import math
import re
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import SupportsFloat

import numpy as np

from validation.guard import Lost
from validation.stability.drive import Drive, Refused, StateTouched, Vector

VERDICTS = ("right", "bounded", "refused", "slow", "WRONG")
"""right: within every limit. bounded: outside a limit, but within the bound of that limit. refused: fmi2Discard or fmi2Error, with a
message. slow: no answer within the time of the case. WRONG: anything else, including a crash."""


@dataclass(frozen=True)
class Check:
    """One oracle: a measured value and its limit."""

    what: str
    measured: float
    limit: float
    bound: float | None = None  # of an answer that is inexact but harmless; None: there is no such answer

    @property
    def verdict(self) -> str:
        """ "right", "bounded" or "WRONG" """
        if self.measured <= self.limit:
            return "right"
        return "bounded" if self.bound is not None and self.measured <= self.bound else "WRONG"

    def __str__(self) -> str:
        return f"{self.what} {self.measured:.2g} (limit {self.limit:.2g})"


@dataclass
class Findings:
    """The checks and notes that a case collects while it runs."""

    checks: list[Check] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def check(self, what: str, measured: SupportsFloat, limit: float, *, bound: float | None = None) -> None:
        """Adds a check."""
        self.checks.append(Check(what, float(measured), limit, bound))

    def at_most(self, what: str, measured: SupportsFloat, limit: float, *, bound: float | None = None) -> None:
        """Adds a check that is repeated during the run, and keeps the worst value."""
        for place, check in enumerate(self.checks):
            if check.what == what:
                if not float(measured) <= check.measured:  # NaN is worst
                    self.checks[place] = Check(what, float(measured), limit, bound)
                return
        self.check(what, measured, limit, bound=bound)

    def sound(self, drive: Drive, planes: Sequence[tuple[Vector, Vector]] = ()) -> None:
        """Checks the bounds of every case: all numbers are finite, and no point that obstacles meet is behind a plane (point, normal)."""
        self.at_most("not finite", 0.0 if drive.finite() else math.inf, 0.0)
        for point, normal in planes:
            self.at_most("penetration / box", behind(drive, point, normal), 1e-12)


def behind(drive: Drive, point: Vector, normal: Vector) -> float:
    """Returns the largest depth of a control point, or a point of the surface, behind a plane, relative to the box."""
    length = math.sqrt(sum(part * part for part in normal))
    gaps = (drive.touching - point) @ np.array([part / length for part in normal])
    return max(0.0, -float(gaps.min())) / drive.side


Run = Callable[[Findings], None]


@dataclass(frozen=True)
class Case:
    """One row of the table."""

    name: str
    what: str
    oracle: str
    run: Run
    quick: bool = False
    refusal: str = ""  # pattern of the message of the required refusal; empty: an answer is wanted, and a refusal is second best
    patience: float = 60.0  # s


@dataclass(frozen=True)
class Outcome:
    """The result of a case."""

    verdict: str  # one of VERDICTS
    checks: tuple[Check, ...] = ()
    words: str = ""  # message of a refusal, or notes
    run_time: float = 0.0  # s

    @property
    def worst(self) -> Check | None:
        """The decisive check: the one nearest to its limit or furthest beyond"""
        return max(self.checks, key=_excess, default=None)


def _excess(check: Check) -> tuple[int, float]:
    order = ("right", "bounded", "WRONG").index(check.verdict)
    ratio = check.measured / check.limit if check.limit > 0 else -1.0 if check.measured == 0 else math.inf
    return order, math.inf if math.isnan(ratio) else ratio


def run_case(case: Case) -> Outcome:
    """Runs one case in this process and returns its outcome."""
    findings, began = Findings(), clock.perf_counter()
    try:
        case.run(findings)
    except Refused as refusal:
        expected = re.search(case.refusal, str(refusal)) is not None
        words = str(refusal) if expected else f"wanted a refusal that says {case.refusal!r}, got: {refusal}"
        return Outcome("refused" if expected else "WRONG", tuple(findings.checks), words, clock.perf_counter() - began)
    except StateTouched as fault:
        return Outcome("WRONG", tuple(findings.checks), str(fault), clock.perf_counter() - began)
    elapsed, notes = clock.perf_counter() - began, "; ".join(findings.notes)
    if case.refusal:
        return Outcome("WRONG", tuple(findings.checks), "wanted a refusal, got an answer", elapsed)
    verdicts = [check.verdict for check in findings.checks]
    worst = max(verdicts, key=VERDICTS.index)
    return Outcome(worst, tuple(findings.checks), notes, elapsed)


def outcome_of(result: Outcome | Lost, patience: float) -> Outcome:
    """Returns the outcome of a case that ran in another process. patience: run time [s] of a hang."""
    if isinstance(result, Outcome):
        return result
    if result.how == "hang":
        return Outcome("slow", words=result.words, run_time=patience)
    return Outcome("WRONG", words=f"{result.how}: {result.words}")


STATED = 5.0  # an error up to this multiple of the number in a warning counts as stated

NUMBER = r"([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)"
WRONG_BY = re.compile(rf"(?:wrong|off) by (?:up to |about |some )*{NUMBER}")
GAINED = re.compile(rf"has gained {NUMBER} J")
TURNS = re.compile(rf"omega = {NUMBER} rad/s in implicit steps .* omega h / 2 = {NUMBER} per radian")


def stated_length(text: str) -> float:
    """Returns the largest error [m] that a text states, or 0 if the text states none."""
    return max((float(number) for number in WRONG_BY.findall(text)), default=0.0)


def stated_error(warning: str, drive: Drive, duration: float) -> float:
    """Returns the position error [m] that follows from the number in a warning, or 0 if the warning has no number.

    A length is returned as it is. A gained energy is converted to a speed of the whole body, times the duration [s] of the run. A fraction
    of the rotation per radian is converted to an error of the angle, times the side of the box.
    """
    if WRONG_BY.search(warning):
        return stated_length(warning)
    if found := GAINED.search(warning):
        return math.sqrt(2 * max(0.0, float(found[1])) / drive.mass.sum()) * duration
    if found := TURNS.search(warning):
        angle = float(found[1]) * duration
        return float(found[2]) * angle**2 * drive.side
    return 0.0


def stated_errors(drive: Drive, duration: float) -> float:
    """Returns the largest position error [m] stated by the warnings so far."""
    return max((stated_error(text, drive, duration) for text in drive.simulation.warnings), default=0.0)
