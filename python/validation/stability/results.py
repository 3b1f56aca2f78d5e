"""Runs a survey and writes its files: a table, a document with all checks, and pictures of the map.

A picture has a small chart per method, with stiffness to the right, communication step upwards, and a colour for each class of cells.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from softffd.accuracy.kept import conditions, csv_text, keep_files
from softffd.errors import SoftffdError
from softffd.files import json_text
from softffd.run.progress import Note, silent
from softffd.show.figure import INK, SOFT, new_figure, png_of
from validation.stability.cases import CASES
from validation.stability.cell import CLASSES, Cell, Judged, Panel, omega
from validation.stability.survey import Survey, planned, run
from validation.stability.verdict import Outcome

COLUMNS = (
    "part", "name", "method", "given_step", "stiffness_n_per_m", "tau_omega", "communication_step_s", "verdict", "measured", "limit",
    "error_stated_m", "communication_steps", "internal_steps", "run_time_s", "words",
)  # fmt: skip

TITLES = {
    ("vibration", False): "Vibration: the step follows the tolerance",
    ("vibration", True): "Vibration: the internal step is given, solver.step = H",
    ("damping", False): "Internal damping of a box of 1000 N/m: the step follows the tolerance",
    ("rotation", False): "Rotation: the step follows the tolerance",
    ("contact", False): "Contact with friction: the step follows the tolerance",
    ("rebound", False): "Rebound: a box falls by 0.2 m and is thrown off",
}


def pictures(survey: Survey) -> dict[str, bytes]:
    """Returns PNGs by file stem, one for each kind of panel that has results."""
    found = {}
    for (scene, given), title in TITLES.items():
        panels = [panel for panel in survey.panels if (panel.scene, panel.given) == (scene, given)]
        if any(cell.panel in panels for cell in survey.cells):
            found[f"map_{scene}{'_given_step' * given}"] = map_picture(survey, panels, title)
    return found


def keep(folder: Path, survey: Survey, about: Mapping[str, Any]) -> None:
    """Writes stability.csv, stability.json and the pictures of the map into `folder`."""
    drawn = pictures(survey)
    rows = [_cell_row(cell, judged) for cell, judged in survey.cells.items()]
    rows += [_case_row(name, outcome) for name, outcome in survey.outcomes.items()]
    files: dict[str, bytes | str] = {"stability.csv": csv_text(COLUMNS, rows), "stability.json": json_text(_document(survey, about))}
    keep_files(folder, files | {f"{name}.png": png for name, png in drawn.items()})


def _cell_row(cell: Cell, judged: Judged) -> dict[str, Any]:
    return {
        "part": "map",
        "name": cell.panel.scene,
        "method": cell.panel.method,
        "given_step": int(cell.panel.given),
        "stiffness_n_per_m": cell.stiffness,
        "tau_omega": cell.ratio,
        "communication_step_s": cell.step,
        "verdict": judged.kind,
        "measured": "" if math.isnan(judged.error) else judged.error,
        "error_stated_m": "" if math.isnan(judged.stated) else judged.stated,
        "communication_steps": judged.steps,
        "internal_steps": judged.internal_steps,
        "run_time_s": judged.run_time,
        "words": judged.why,
    }


def _case_row(name: str, outcome: Outcome) -> dict[str, Any]:
    worst = outcome.worst
    return {
        "part": "case",
        "name": name,
        "verdict": outcome.verdict,
        "measured": "" if worst is None else worst.measured,
        "limit": "" if worst is None else worst.limit,
        "run_time_s": outcome.run_time,
        "words": outcome.words,
    }


def _document(survey: Survey, about: Mapping[str, Any]) -> dict[str, Any]:
    return {
        **about,
        "missing": survey.missing,
        "wrong": survey.wrong(),
        "borders": [asdict(border) for border in survey.borders],
        "map": [_cell_row(cell, judged) for cell, judged in survey.cells.items()],
        "cases": [_case(name, outcome) for name, outcome in survey.outcomes.items()],
    }


def _case(name: str, outcome: Outcome) -> dict[str, Any]:
    case = CASES[name]
    checks = [{**asdict(check), "verdict": check.verdict} for check in outcome.checks]
    return {
        "name": name, "what": case.what, "oracle": case.oracle, "verdict": outcome.verdict, "run_time_s": outcome.run_time,
        "words": outcome.words, "checks": checks,
    }  # fmt: skip


COLOURS = {
    "accurate": "#3a9a6e", "bounded": "#b9dfa8", "divided": "#8fc6e8", "unstated": "#f2c14e", "slow": "#c9ced6", "refused": "#7d8794",
    "WRONG": "#c8102e",
}  # fmt: skip
WORDS = {
    "accurate": "accurate",
    "bounded": "bounded, error stated",
    "divided": "given step divided, with a warning",
    "unstated": "given step too long, error not stated",
    "slow": "given up for its time",
    "refused": "refused",
    "WRONG": "WRONG",
}
EMPTY = "#ffffff"
PER_ROW = 4


def map_picture(survey: Survey, panels: Sequence[Panel], title: str) -> bytes:
    """Returns a PNG of these panels. Panels over the stiffness of the map's box show the line H = 2 / omega and the raw scheme's border."""
    rows = math.ceil(len(panels) / PER_ROW)
    height = 1.3 + 2.85 * rows
    figure = new_figure(13.0, height, dpi=110)
    figure.text(0.02, 1 - 0.3 / height, title, fontsize=15, fontweight="bold", color=INK, va="center")
    for place, panel in enumerate(panels):
        row, column = divmod(place, PER_ROW)
        box = (0.06 + 0.238 * column, 1 - (0.85 + 2.85 * row + 2.05) / height, 0.205, 2.05 / height)
        _chart(figure.add_axes(box), survey, panel, first=column == 0)
    present = {survey.cells[cell].kind for panel in panels for cell in survey.cells_of(panel) if cell in survey.cells}
    handles = [Patch(color=COLOURS[kind], label=WORDS[kind]) for kind in CLASSES if kind in present]
    lines = figure.axes[0].get_lines() if figure.axes else []
    figure.legend(handles=[*handles, *lines], loc="lower left", bbox_to_anchor=(0.015, 0.0), ncol=6, frameon=False, fontsize=9,
                  columnspacing=1.2, handlelength=1.4)  # fmt: skip
    return png_of(figure)


def _chart(axes: Any, survey: Survey, panel: Panel, *, first: bool) -> None:
    steps, across = survey.steps_of(panel), survey.across(panel)
    k, h = np.log10(across), np.log10(steps)
    numbers = np.full((len(h), len(k)), -1)
    for cell in survey.cells_of(panel):
        if cell in survey.cells:
            place = steps.index(cell.step), across.index(cell.ratio or cell.stiffness)
            numbers[place] = CLASSES.index(survey.cells[cell].kind)
    colours = ListedColormap([EMPTY, *(COLOURS[kind] for kind in CLASSES)])
    norm = BoundaryNorm(np.arange(-1.5, len(CLASSES)), len(CLASSES) + 1)
    axes.pcolormesh(_edges(k), _edges(h), numbers, cmap=colours, norm=norm, edgecolors="white", linewidth=0.5)
    axes.set_xlim(_edges(k)[[0, -1]])
    axes.set_ylim(_edges(h)[[0, -1]])
    if panel.scene not in ("rebound", "damping"):
        _border(axes, survey)
    axes.set_title(panel.method, fontsize=10.5, color=INK, loc="left")
    _label(axes.xaxis, k, 3)
    _label(axes.yaxis, h, 1)
    axes.tick_params(labelsize=8, length=2, colors=SOFT)
    axes.set_xlabel("internal damping, tau omega" if panel.scene == "damping" else "stiffness, N/m", fontsize=8.5, color=SOFT, labelpad=1)
    if first:
        axes.set_ylabel("communication step, s", fontsize=8.5, color=SOFT)
    axes.spines[:].set_visible(False)


def _border(axes: Any, survey: Survey) -> None:
    """Draws the stability limit of the explicit scheme for the box of 2 x 2 x 2 points."""
    line = np.array(axes.get_xlim())
    axes.plot(line, [math.log10(2 / omega(10.0**value)) for value in line], color=INK, linewidth=1.4, label="H = 2 / omega")
    axes.plot(np.log10([border.stiffness for border in survey.borders]), np.log10([border.raw for border in survey.borders]), "o",
              color="white", markeredgecolor=INK, markersize=3.4, label="border of the raw explicit scheme, measured")  # fmt: skip


def _edges(centres: np.ndarray) -> np.ndarray:
    """Returns the borders (n + 1,) of cells with these centres (n,)."""
    middle = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])


def _label(axis: Any, values: np.ndarray, every: int) -> None:
    ticks = np.arange(math.ceil(values[0] - 1e-9), values[-1] + 1e-9, every)
    axis.set_ticks(ticks, [f"$10^{{{tick:.0f}}}$" for tick in ticks])


SHOWN = 20  # wrong answers that are listed on stderr


def report_stability(
    folder: Path, *, only: Sequence[str] = (), quick: bool = False, processes: int = 1, note: Note = silent, say: Note = print
) -> Survey:
    """Runs the map and the cases, or those that `only` names, and writes CSV, JSON and pictures to `folder`.

    quick: some cases and a coarse map, within half a minute. processes: number of cells and cases at a time. note: receives the progress.
    say: receives the results. Raises SoftffdError if processes < 1, for an unknown name before anything is run, and at the end if an answer
    is wrong. Raises KeyboardInterrupt on Ctrl-C after the finished results are written.
    """
    survey = planned(only, quick=quick)
    about = _about(only, quick)
    try:
        for place, news in enumerate(run(survey, note, processes)):
            say(news)
            if place < len(survey.panels):
                keep(folder, survey, about)
    except KeyboardInterrupt:
        keep(folder, survey, about)
        raise KeyboardInterrupt(f"what is done is kept in {folder}; {len(survey.missing)} parts are missing") from None
    keep(folder, survey, about)
    if wrong := survey.wrong():
        more = [f"  and {len(wrong) - SHOWN} more in {folder}"] if len(wrong) > SHOWN else []
        raise SoftffdError("\n".join([f"{len(wrong)} wrong answers given as right:", *(f"  {line}" for line in wrong[:SHOWN]), *more]))
    return survey


def _about(only: Sequence[str], quick: bool) -> dict[str, Any]:
    named = ["--only", *(f"'{name}'" for name in only)] if only else []
    options = ["--quick" * quick, *named]
    return conditions(["python3 python/run.py stability", *options])
