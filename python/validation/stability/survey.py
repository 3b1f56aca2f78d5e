"""A survey of stiff and extreme scenes: its panels and cases, and their results."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from softffd.errors import SoftffdError
from softffd.run.progress import Note
from softffd.spelling import did_you_mean, nearest_of
from validation.guard import Lost, guarded
from validation.stability import rebound
from validation.stability.cases import CASES, run_named
from validation.stability.cell import HANG, Cell, Judged, Panel
from validation.stability.drive import Drive
from validation.stability.map import SCENES, Border, borders, document, run_cells
from validation.stability.verdict import Outcome, outcome_of

LEAVES_CONTACT = ("bm4", "rkn12", "dop853", "ros34pw2")  # methods that pass communication steps with contact to another method

RATIOS = [10.0 ** (n / 2) for n in range(-4, 7)]
"""Internal damping times in the map of damping, in units of 1 / omega, 0.01 to 1000. The map of vibration shows zero internal damping."""

DAMPED = 1e3  # stiffness of the box in the map of damping [N/m]
LEAVES_DAMPING = ("bm4", "rkn12", "central_difference")  # methods that pass bodies with internal damping to another method

CHOSEN = "auto"
MAP, EVERY_CASE = "map", "cases"  # names of the map and of all cases, accepted beside names of cases

QUICK_PANELS = (*(Panel(scene, CHOSEN) for scene in SCENES if scene != "rebound"), Panel("vibration", "leapfrog", True))

QUICK_PATIENCE = 10.0  # longest time of a case in a quick survey [s]


@dataclass
class Survey:
    """The panels and cases to run, and the results so far."""

    panels: list[Panel]
    stiffnesses: list[float]  # N/m
    steps: list[float]  # communication steps [s]
    names: list[str]  # of cases
    most_patience: float = math.inf  # longest time of a case [s]
    borders: list[Border] = field(default_factory=list)
    cells: dict[Cell, Judged] = field(default_factory=dict)
    outcomes: dict[str, Outcome] = field(default_factory=dict)

    @property
    def missing(self) -> list[str]:
        """Panels and cases without results"""
        left = [str(panel) for panel in self.panels if any(cell not in self.cells for cell in self.cells_of(panel))]
        return left + [name for name in self.names if name not in self.outcomes]

    def stiffnesses_of(self, panel: Panel) -> list[float]:
        """Returns the stiffnesses of a panel [N/m]."""
        if panel.scene == "damping":
            return [DAMPED]
        return list(rebound.STIFFNESSES) if panel.scene == "rebound" else self.stiffnesses

    def across(self, panel: Panel) -> list[float]:
        """Returns the horizontal values of a panel's picture: stiffnesses [N/m], or ratios of internal damping."""
        return RATIOS if panel.scene == "damping" else self.stiffnesses_of(panel)

    def steps_of(self, panel: Panel) -> list[float]:
        """Returns the communication steps of a panel [s]: all for auto, and for other methods every second one if there are many."""
        if panel.scene == "rebound":
            return list(rebound.STEPS)
        return self.steps if panel.method == CHOSEN or len(self.steps) < 6 else self.steps[::2]

    def cells_of(self, panel: Panel) -> list[Cell]:
        """Returns the cells of a panel in the order of running, soft ones first."""
        ratios = RATIOS if panel.scene == "damping" else [0.0]
        return [
            Cell(panel, stiffness, step, ratio)
            for stiffness in self.stiffnesses_of(panel) for ratio in ratios for step in self.steps_of(panel)
        ]  # fmt: skip

    def wrong(self) -> list[str]:
        """Returns a line for each cell or case that ended with fmi2OK and a wrong answer, or in a crash."""
        cells = [
            f"map, {cell.panel}, {_place(cell)}: {judged.why}"
            for cell, judged in self.cells.items() if judged.kind == "WRONG"
        ]  # fmt: skip
        return cells + [f"{name}: {_why(outcome)}" for name, outcome in self.outcomes.items() if outcome.verdict == "WRONG"]


def _place(cell: Cell) -> str:
    damping = f"tau omega = {cell.ratio:.3g}, " if cell.ratio else ""
    return f"k = {cell.stiffness:g} N/m, {damping}H = {cell.step:.3g} s"


def _why(outcome: Outcome) -> str:
    broken = "; ".join(str(check) for check in outcome.checks if check.verdict == "WRONG")
    return broken or outcome.words


def planned(only: Sequence[str] = (), *, quick: bool = False) -> Survey:
    """Returns the survey of everything, or of named parts: "map", "cases", or a part of a case's name.

    Raises SoftffdError if a name matches nothing."""
    chosen = {name for name, case in CASES.items() if not quick or case.quick}
    with_map = True
    if only:
        chosen = {name for name in CASES for part in only if part == EVERY_CASE or part.lower() in name.lower()}
        with_map = MAP in only
        for part in only:
            if part not in (MAP, EVERY_CASE) and not any(part.lower() in name.lower() for name in CASES):
                nearest = did_you_mean(nearest_of(part, [MAP, EVERY_CASE, *CASES]))
                raise SoftffdError(f"--only {part}: wanted {MAP!r}, {EVERY_CASE!r} or a part of a case's name{nearest}")
    names = [name for name in CASES if name in chosen]
    if not with_map:
        return Survey([], [], [], names)
    if quick:
        return Survey(list(QUICK_PANELS), [1e-3, 1e3, 1e6, 1e9], [1e-5, 1e-3, 1e-1], names, QUICK_PATIENCE)
    return Survey(_panels(), [10.0**n for n in range(-3, 13)], [10 ** (n / 2) for n in range(-10, 1)], names)


def _panels() -> list[Panel]:
    """Returns panels for every method of the FMU. With given steps auto is left out, because auto is then leapfrog."""
    with Drive(document("vibration")) as drive:
        methods = list(drive.simulation.variables["solver.method"].items or {})
    vibration = [Panel("vibration", method) for method in methods]
    given = [Panel("vibration", method, True) for method in methods if method != CHOSEN]
    damping = [Panel("damping", method) for method in methods if method not in LEAVES_DAMPING]
    rotation = [Panel("rotation", method) for method in methods]
    contact = [Panel("contact", method) for method in methods if method not in LEAVES_CONTACT]
    return [*vibration, *given, *damping, *rotation, *contact, Panel("rebound", CHOSEN)]


def run(survey: Survey, note: Note, processes: int = 1) -> Iterator[str]:
    """Runs the survey on several processes; yields a line of news after each part that is worth saving. note: receives the progress."""
    if survey.panels:
        note("the border of the explicit scheme")
        survey.borders = borders(survey.stiffnesses)
        yield _border_news(survey.borders)
    cells = [cell for panel in survey.panels for cell in survey.cells_of(panel)]
    left = {panel: len(survey.cells_of(panel)) for panel in survey.panels}
    for cell, result in guarded(run_cells, cells, lambda cell: HANG, processes):
        survey.cells[cell] = _judged(result)
        note(f"map, {cell.panel}: {_place(cell)}")
        left[cell.panel] -= 1
        if left[cell.panel] == 0:
            yield _panel_news(survey, cell.panel)
    patience = {name: min(CASES[name].patience, survey.most_patience) for name in survey.names}
    for name, result in guarded(run_named, survey.names, patience.__getitem__, processes):
        outcome = survey.outcomes[name] = outcome_of(result, patience[name])
        note(f"{len(survey.outcomes)} of {len(survey.names)} cases")
        yield f"{name}: {outcome.verdict}{f', {outcome.worst}' if outcome.worst else ''}"


def _judged(result: Judged | Lost) -> Judged:
    if isinstance(result, Judged):
        return result
    if result.how == "hang":
        return Judged("slow", why=result.words, run_time=HANG)
    return Judged("WRONG", why=f"{result.how}: {result.words}")


def _border_news(found: Sequence[Border]) -> str:
    ratios = [border.raw / border.theory for border in found]
    return f"border of the explicit scheme: {min(ratios):.4f} to {max(ratios):.4f} of 2 / omega"


def _panel_news(survey: Survey, panel: Panel) -> str:
    kinds = [survey.cells[cell].kind for cell in survey.cells_of(panel)]
    counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    return f"map, {panel}: {counts}"
