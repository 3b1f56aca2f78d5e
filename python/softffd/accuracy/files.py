"""The files that a measurement is kept in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softffd.accuracy.kept import csv_text, finite, json_text, keep_files
from softffd.accuracy.records import CHOSEN, LEVELS, Record, Records, level_words
from softffd.accuracy.report import report_page

COLUMNS = (
    "scene", "method", "origin", "step_s", "tolerance", "communication_step_s", "cpu_time_s", "repeats", "error", "error_claimed",
    "internal_steps", "rejected_steps", "failure",
)  # fmt: skip


def keep(
    folder: Path, measured: Sequence[Records], missing: Mapping[str, str], about: Mapping[str, Any], pictures: Mapping[str, bytes]
) -> None:
    """Writes accuracy.csv, accuracy.json, report.html and a SCENE.png of each scene into `folder`. pictures: PNGs by scene."""
    scenes = [_scene(records) for records in measured]
    files: dict[str, bytes | str] = {
        "accuracy.csv": csv_text(COLUMNS, (_row(records, run) for records in measured for run in records.runs)),
        "accuracy.json": json_text({**about, "error_levels": LEVELS, "scenes": scenes, "scenes_not_measured": dict(missing)}),
        "report.html": report_page(measured, missing, about, pictures),
    }
    keep_files(folder, files | {f"{records.scene}.png": pictures[records.scene] for records in measured})


def _row(records: Records, run: Record) -> dict[str, Any]:
    failed = run.failure is not None
    return {
        "scene": records.scene,
        "method": run.setting.method,
        "origin": run.origin,
        "step_s": run.setting.step or None,
        "tolerance": run.setting.tolerance or None,
        "communication_step_s": records.communication_step,
        "cpu_time_s": None if failed else run.cpu_time,
        "repeats": run.repeats,
        "error": None if failed else run.error,
        "error_claimed": None if failed else finite(records.claimed(run)),
        "internal_steps": run.steps,
        "rejected_steps": run.rejected,
        "failure": run.failure,
    }


def _scene(records: Records) -> dict[str, Any]:
    reference, recommended = records.reference, records.recommended(records.tolerance)
    worst = {name: run for name in records.names("softffd") if (run := records.worst_of_tolerance(name))}
    errors = ([] if run.errors is None else [float(f"{error:.3e}") for error in run.errors] for run in records.runs)
    return {
        "scene": records.scene,
        "title": records.title,
        "complete": records.complete,
        "control_points": records.points,
        "stop_time_s": records.stop_time,
        "communication_step_s": records.communication_step,
        "reference": {
            "method": reference.method,
            "compared_with": reference.check,
            "confirmed": reference.confirmed,
            "uncertainty": reference.uncertainty,
        },
        "left_out": records.left_out,
        "levels": {level_words(level): _level(records, level) for level in LEVELS},
        "error_over_tolerance": {
            name: {"largest": run.error / run.setting.tolerance, "tolerance": run.setting.tolerance} for name, run in worst.items()
        },
        "recommended": recommended and _row(records, recommended),
        "times_s": records.times.tolist(),
        "runs": [_row(records, run) | {"errors": each or None} for run, each in zip(records.runs, errors, strict=True)],
    }


def _level(records: Records, level: float) -> dict[str, Any]:
    """Times to reach an error, factors over the published scheme (a bound where it never gets there), and auto's time over the best's."""
    best, chosen = records.best(level), records.cheapest(CHOSEN, level)
    reached = {name: run.cpu_time for name in records.names() if (run := records.cheapest(name, level))}
    factors = {name: records.factor(run, level) for name, run in (("best", best), ("auto", chosen))}
    told = {f"{name}_over_published": pair and {"factor": pair[0], "is_lower_bound": pair[1]} for name, pair in factors.items()}
    return {"cpu_time_s": reached, "best": best and best.name, **told, "auto_over_best": records.ratio(level)}
