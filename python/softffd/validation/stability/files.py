"""The files that a survey is kept in."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from softffd.validation.kept import csv_text, json_text, keep_files
from softffd.validation.stability.cases import CASES
from softffd.validation.stability.cell import Cell, Judged
from softffd.validation.stability.picture import map_picture
from softffd.validation.stability.report import report_page
from softffd.validation.stability.survey import Survey
from softffd.validation.stability.verdict import Outcome

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
    """PNGs by file stem, one for each kind of panel that has results."""
    found = {}
    for (scene, given), title in TITLES.items():
        panels = [panel for panel in survey.panels if (panel.scene, panel.given) == (scene, given)]
        if any(cell.panel in panels for cell in survey.cells):
            found[f"map_{scene}{'_given_step' * given}"] = map_picture(survey, panels, title)
    return found


def keep(folder: Path, survey: Survey, about: Mapping[str, Any]) -> None:
    """Writes stability.csv, stability.json, report.html and the pictures of the map into `folder`."""
    drawn = pictures(survey)
    rows = [_cell_row(cell, judged) for cell, judged in survey.cells.items()]
    rows += [_case_row(name, outcome) for name, outcome in survey.outcomes.items()]
    files: dict[str, bytes | str] = {
        "stability.csv": csv_text(COLUMNS, rows),
        "stability.json": json_text(_document(survey, about)),
        "report.html": report_page(survey, about, drawn),
    }
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
