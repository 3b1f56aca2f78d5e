"""Measurements of one scene, and their evaluation: the front, times to reach an error, factors, the recommended setting."""

import math
from dataclasses import dataclass, field

import numpy as np

from softffd.accuracy.reference import NO_REFERENCE, Reference
from softffd.accuracy.rig import Setting

LEVELS = (1e-2, 1e-4, 1e-6, 1e-8)  # errors, relative to the box's largest side, whose cost is reported
PUBLISHED, CHOSEN = "central_difference", "auto"  # the published scheme, and the method that chooses by itself
WITHIN = 1.5  # `auto` is recommended where it takes at most this many times the best method's time
ALIKE = 1.1  # times that differ by less are taken as equal
MISSED = 10.0  # an error above this many tolerances misses the tolerance
CLAIM = 3.0  # errors are claimed down to this many uncertainties of the reference only


def level_words(level: float) -> str:
    """Returns the error in words, "1e-4" rather than "1e-04"."""
    return f"{level:.0e}".replace("e-0", "e-")


ERROR_FLOOR = 1e-10  # a method's sweep ends below this error, relative to the box


@dataclass(frozen=True, eq=False)
class Record:
    """One run: its setting, its time, and its error or the reason why there is none."""

    setting: Setting
    origin: str = "softffd"  # "softffd": through the FMU; "scipy": an outside anchor
    cpu_time: float = math.nan  # s
    repeats: int = 0
    steps: int | None = None
    rejected: int | None = None
    errors: np.ndarray | None = field(default=None, repr=False)
    """(T,) largest distance of a control point from the reference at each communication point, relative to the box's largest side. If
    lattices are compared: the largest error of each kind of output, relative to the largest change of that kind"""
    failure: str | None = None
    lattice: tuple[int, ...] = ()  # control points along each axis, if lattices are compared and not methods

    @property
    def name(self) -> str:
        """The method, with its origin if it is no softffd method: "leapfrog", "SciPy DOP853"; or the lattice: "7 x 4 x 4"."""
        if self.lattice:
            return " x ".join(map(str, self.lattice))
        return self.setting.method if self.origin == "softffd" else f"SciPy {self.setting.method}"

    @property
    def toml(self) -> str:
        """The lines of a scene file that set the solver, or lattice and tolerance, as in this run."""
        if self.lattice:
            return f"[lattice]\npoints = {list(self.lattice)}\n[solver]\ntolerance = {self.setting.tolerance:.3g}"
        kind = "step" if self.setting.step else "tolerance"
        return f'[solver]\nmethod = "{self.setting.method}"\n{kind} = {getattr(self.setting, kind):.3g}'

    @property
    def error(self) -> float:
        """Largest of `errors`; NaN for a failed run."""
        return math.nan if self.errors is None else float(self.errors.max())


@dataclass(eq=False)
class Records:
    """All runs of one scene, in the order in which they were made."""

    scene: str
    title: str
    communication_step: float
    stop_time: float
    times: np.ndarray  # (T,) s, communication points
    points: int
    tolerance: float  # the scene's own
    reference: Reference = NO_REFERENCE
    runs: list[Record] = field(default_factory=list)
    left_out: dict[str, str] = field(default_factory=dict)  # methods that were not run, and why
    complete: bool = False  # not interrupted

    def names(self, origin: str | None = None) -> list[str]:
        """Returns the methods that were run, in order of appearance."""
        return list(dict.fromkeys(run.name for run in self.runs if origin in (None, run.origin)))

    def good(self, name: str | None = None) -> list[Record]:
        """Returns the runs of a method, or all of the FMU's runs, that did not fail."""
        chosen = (run for run in self.runs if (run.name == name if name else run.origin == "softffd"))
        return [run for run in chosen if run.failure is None]

    @property
    def floor(self) -> float:
        """The error below which nothing more is to be learnt, so that a method's sweep ends there."""
        return max(ERROR_FLOOR, CLAIM * self.reference.uncertainty)

    def claimed(self, run: Record) -> float:
        """Returns the run's error, or three times the reference's uncertainty if that is larger."""
        return max(run.error, CLAIM * self.reference.uncertainty)

    def cheapest(self, name: str, level: float) -> Record | None:
        """Returns the run of a method with the smallest time among those whose error is at most `level`."""
        reached = [run for run in self.good(name) if self.claimed(run) <= level]
        return min(reached, key=lambda run: run.cpu_time, default=None)

    def best(self, level: float) -> Record | None:
        """Returns the cheapest run that reaches `level`, of all the FMU's methods but `auto`."""
        found = [self.cheapest(name, level) for name in self.names("softffd") if name != CHOSEN]
        return min((run for run in found if run), key=lambda run: run.cpu_time, default=None)

    def factor(self, run: Record | None, level: float) -> tuple[float, bool] | None:
        """Returns how many times less time than the published scheme a run that reaches `level` takes, and if this is only a lower bound.

        It is a bound if no run of the published scheme reaches the level: then the longest run of that scheme counts.
        """
        published = self.good(PUBLISHED)
        if run is None or not published:
            return None
        reached = self.cheapest(PUBLISHED, level)
        time = reached.cpu_time if reached else max(each.cpu_time for each in published)
        return time / run.cpu_time, reached is None

    def ratio(self, level: float) -> float | None:
        """Returns the time of `auto` over that of the best other method at an error; None if one of them does not reach it."""
        chosen, best = self.cheapest(CHOSEN, level), self.best(level)
        return chosen.cpu_time / best.cpu_time if chosen and best else None

    def front(self) -> list[Record]:
        """Returns the FMU's runs that no other run beats in both time and error, by growing time."""
        found: list[Record] = []
        for run in sorted(self.good(), key=lambda run: (run.cpu_time, run.error)):
            if not found or max(self.claimed(run), ERROR_FLOOR) < self.claimed(found[-1]):
                found.append(run)
        return found

    def recommended(self, level: float) -> Record | None:
        """Returns a run of `auto` if that is within 1.5 of the best method's time, else a run of the best method.

        Among the runs that reach the level and cost hardly more than the cheapest of them, it is the most accurate one.
        """
        chosen, best = self.cheapest(CHOSEN, level), self.best(level)
        if chosen is None or (best is not None and chosen.cpu_time > WITHIN * best.cpu_time):
            chosen = best
        if chosen is None:
            return None
        equal = [run for run in self.good(chosen.name) if self.claimed(run) <= level and run.cpu_time <= ALIKE * chosen.cpu_time]
        return min(equal, key=lambda run: (run.error, abs(math.log((run.setting.tolerance or level) / level))))

    def worst_of_tolerance(self, name: str) -> Record | None:
        """Returns a method's run with the largest error per tolerance. Runs without a tolerance, and errors too small for the reference,
        are left out."""
        runs = [run for run in self.good(name) if run.setting.tolerance and run.error >= CLAIM * self.reference.uncertainty]
        return max(runs, key=lambda run: run.error / run.setting.tolerance, default=None)
