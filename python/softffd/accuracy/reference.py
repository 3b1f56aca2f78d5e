"""The reference of a scene: a run much more accurate than those that it judges, and a second run that shows how accurate it is.

Without obstacles two methods of different kind are run as tightly as possible. The largest difference between the two is the uncertainty
of the reference. A fixed-step method takes part with steps h and h / 2 and Richardson's extrapolation of the two.
With obstacles only leapfrog resolves contact at every step: one method is run at two very fine steps, and the reference is unconfirmed.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from softffd.accuracy.rig import Rig, Run, Setting
from softffd.errors import FmuError
from softffd.run.progress import Note, silent

TIGHT = (1e-13, 1e-12, 1e-11)  # tolerances tried for the adaptive methods, relative to the box; the first that the method meets counts
ORDERS = {"bm4": 4, "leapfrog": 2}  # fixed-step methods by preference, and their order of accuracy
ADAPTIVE = ("dop853", "rkn12")
CONFIRMED = 1e-7  # a larger difference, relative to the box, confirms nothing: errors of 1e-6 could not be resolved
AGREED = 1e-12  # a difference, relative to the box, below which refining further would compare rounding
NEARLY_AGREED = 1e-9  # below this a difference that refining hardly changes is the reference's own error
PATIENCE, QUICK_PATIENCE = 15.0, 1.0  # approximate CPU time [s] of the longest run
FAILURES = 6  # steps that may fail before the method is given up


@dataclass(frozen=True, eq=False)
class Reference:
    """Positions that runs are compared with."""

    positions: np.ndarray  # (T, n, 3) m at the communication points
    uncertainty: float  # largest difference from the second run, relative to the box's largest side
    method: str  # how it was computed, in words
    check: str  # what it was compared with, in words
    independent: bool  # whether the second run is by an independent method

    @property
    def confirmed(self) -> bool:
        """True if an independent method gives the same result, to the digits that are judged by the reference."""
        return self.independent and self.uncertainty <= CONFIRMED

    def errors(self, positions: np.ndarray, side: float) -> np.ndarray:
        """Returns the largest distance of a control point from the reference at each communication point, relative to the side [m]:
        (T,)."""
        return np.linalg.norm(positions - self.positions, axis=2).max(axis=1) / side

    def __str__(self) -> str:
        difference = f"{self.uncertainty:.1e} of the largest side"
        if self.confirmed:
            return f"{self.method}, confirmed by {self.check} within {difference}"
        alone = "" if self.independent else "no independent method; "
        return f"{self.method}, unconfirmed: {alone}{self.check} differs by {difference}"


NO_REFERENCE = Reference(np.empty((0, 0, 3)), math.inf, "none", "nothing", False)  # until one is found


@dataclass(frozen=True, eq=False)
class _Candidate:
    positions: np.ndarray
    words: str


def find_reference(rig: Rig, *, quick: bool = False, note: Note = silent) -> Reference:
    """Returns the best reference that the FMU's methods allow. Raises FmuError if no method can run the scene at all."""
    patience = QUICK_PATIENCE if quick else PATIENCE
    if rig.contact or rig.free:
        return _by_fine_steps(rig, "leapfrog", patience, note)
    best = _tight_runs(rig, patience, note)
    if len(best) >= 2:
        return _compared(best[0], [best[1]], rig, independent=True)
    methods = [method for method in ORDERS if method in rig.methods and not (method == "bm4" and rig.dashpots)]  # dop853 replaces bm4 there
    if best:
        return _compared(best[0], _extrapolations(rig, methods[0], patience, note), rig, independent=True)
    if len(methods) >= 2:
        *_, finest = _extrapolations(rig, methods[0], patience, note)
        return _compared(finest, _extrapolations(rig, methods[1], patience, note), rig, independent=True)
    return _by_fine_steps(rig, methods[0], patience, note)


def _tight_runs(rig: Rig, patience: float, note: Note) -> list[_Candidate]:
    """Runs each applicable adaptive method at the tightest tolerance that it can meet."""
    found = []
    for method in ADAPTIVE:
        if method not in rig.methods or (method == "rkn12" and rig.damped):
            continue
        for tolerance in TIGHT:
            note(f"reference: {method} at {tolerance:g}")
            try:
                run = rig.run(Setting(method, tolerance=tolerance), most=patience)
            except FmuError:
                continue
            found.append(_Candidate(run.positions, f"{method} at tolerance {tolerance:g}"))
            break
    return found


def _extrapolations(rig: Rig, method: str, patience: float, note: Note) -> Iterator[_Candidate]:
    """Yields Richardson's extrapolation of runs with steps h and h / 2, for finer and finer h until patience ends."""
    weight, previous = 2.0 ** ORDERS[method], None
    for run, step in _refined(rig, method, patience, note):
        if previous is not None:
            extrapolated = run.positions + (run.positions - previous) / (weight - 1)
            yield _Candidate(extrapolated, f"{method} at {2 * step:.2g} s and half of it, extrapolated")
        previous = run.positions


def _by_fine_steps(rig: Rig, method: str, patience: float, note: Note) -> Reference:
    """Runs one method at the finest step that patience allows, and compares that run with one at twice the step."""
    *_, (check, coarse), (fine, step) = _refined(rig, method, patience, note)
    other = _Candidate(check.positions, f"{method} at {coarse:.2g} s")
    return _compared(_Candidate(fine.positions, f"{method} at {step:.2g} s"), [other], rig, independent=False)


def _refined(rig: Rig, method: str, patience: float, note: Note) -> Iterator[tuple[Run, float]]:
    """Yields runs with the step halved each time, from the stable step on, at least two, until a run has taken half of the patience.

    A run whose step the FMU has shortened to that of the run before is skipped. Raises FmuError if no two runs can be made.
    """
    steps, done, failures, taken = max(1, math.ceil(rig.communication_step / rig.stable_step)), 0, 0, 0
    elapsed = 0.0
    while elapsed < patience / 2 or done < 2:
        step = rig.communication_step / steps
        steps *= 2
        note(f"reference: {method} at {step:.2g} s")
        try:
            run = rig.run(Setting(method, step=step))
        except FmuError:
            failures += 1
            if done >= 2:
                return
            if failures == FAILURES:
                raise
            continue
        if run.steps == taken:
            continue
        yield run, step
        elapsed, done, taken = run.cpu_time, done + 1, run.steps


def _compared(best: _Candidate, others: Iterable[_Candidate], rig: Rig, *, independent: bool) -> Reference:
    """Returns the reference `best` with its smallest difference from the others, which come by growing fineness."""
    uncertainty, check = np.inf, ""
    for other in others:
        difference = float(np.linalg.norm(best.positions - other.positions, axis=2).max()) / rig.side
        at_floor = difference < AGREED or (difference < NEARLY_AGREED and difference > uncertainty / 4)
        if difference < uncertainty:
            uncertainty, check = difference, other.words
        if at_floor:
            break
    return Reference(best.positions, uncertainty, best.words, check, independent)
