"""The files that a measurement is kept in; each appears whole or not at all."""

from __future__ import annotations

import csv
import json
import math
import os
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from io import StringIO
from pathlib import Path
from typing import Any

from softffd.files import write_bytes
from softffd.validation.accuracy.records import CHOSEN, LEVELS, Record, Records, level_words
from softffd.validation.accuracy.report import report_page

COLUMNS = (
    "scene", "method", "origin", "step_s", "tolerance", "communication_step_s", "cpu_time_s", "repeats", "error", "error_claimed",
    "internal_steps", "rejected_steps", "failure",
)  # fmt: skip

Pictures = Mapping[str, Sequence[bytes]]
"""PNGs by scene: error against run time, error against simulated time"""


def keep(folder: Path, measured: Sequence[Records], missing: Mapping[str, str], about: Mapping[str, Any], pictures: Pictures) -> None:
    """Writes accuracy.csv, accuracy.json, report.html and a SCENE.png of each scene into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    for records in measured:
        write_bytes(folder / f"{records.scene}.png", pictures[records.scene][0])
    write_bytes(folder / "accuracy.csv", _csv(measured).encode())
    write_bytes(folder / "accuracy.json", (json.dumps(_document(measured, missing, about), indent=1, allow_nan=False) + "\n").encode())
    write_bytes(folder / "report.html", report_page(measured, missing, about, pictures).encode())


def _csv(measured: Sequence[Records]) -> str:
    stream = StringIO()
    writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for records in measured:
        for run in records.runs:
            writer.writerow({name: "" if value is None else value for name, value in _row(records, run).items()})
    return stream.getvalue()


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
        "error_claimed": None if failed else _finite(records.claimed(run)),
        "internal_steps": run.steps,
        "rejected_steps": run.rejected,
        "failure": run.failure,
    }


def _document(measured: Sequence[Records], missing: Mapping[str, str], about: Mapping[str, Any]) -> dict[str, Any]:
    return {**about, "error_levels": LEVELS, "scenes": [_scene(records) for records in measured], "scenes_not_measured": dict(missing)}


def _scene(records: Records) -> dict[str, Any]:
    reference = records.reference
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
            "uncertainty": _finite(reference.uncertainty),
        },
        "left_out": records.left_out,
        "levels": {level_words(level): _level(records, level) for level in LEVELS},
        "error_over_tolerance": {name: _worst(run) for name in records.names("softffd") if (run := records.worst_of_tolerance(name))},
        "recommended": _told(records.recommended(records.tolerance)),
        "times_s": records.times.tolist(),
        "runs": [_row(records, run) | {"errors": _rounded(run)} for run in records.runs],
    }


def _level(records: Records, level: float) -> dict[str, Any]:
    """Times to reach an error, factors over the published scheme (a bound where it never gets there), and auto's time over the best's."""
    best, chosen = records.best(level), records.cheapest(CHOSEN, level)
    reached = {name: run.cpu_time for name in records.names() if (run := records.cheapest(name, level))}
    factors = {name: records.factor(run, level) for name, run in (("best", best), ("auto", chosen))}
    told = {f"{name}_over_published": pair and {"factor": pair[0], "is_lower_bound": pair[1]} for name, pair in factors.items()}
    return {"cpu_time_s": reached, "best": best and best.name, **told, "auto_over_best": records.ratio(level)}


def _told(run: Record | None) -> dict[str, Any] | None:
    if run is None:
        return None
    return {
        "method": run.setting.method,
        "step_s": run.setting.step or None,
        "tolerance": run.setting.tolerance or None,
        "cpu_time_s": run.cpu_time,
    }


def _worst(run: Record) -> dict[str, float]:
    return {"largest": run.error / run.setting.tolerance, "tolerance": run.setting.tolerance}


def _rounded(run: Record) -> list[float] | None:
    return None if run.errors is None else [float(f"{error:.3e}") for error in run.errors]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def machine() -> dict[str, Any]:
    """What the times belong to: processor, cores, system."""
    return {"processor": _processor(), "cores": os.cpu_count(), "system": platform.platform(terse=True)}


def _processor() -> str:
    table = Path("/proc/cpuinfo")
    lines = table.read_text().splitlines() if table.is_file() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def versions(*, scipy: bool) -> dict[str, str]:
    """Of softffd, Python and the packages whose speed or results count."""
    found = {"Python": platform.python_version()}
    for name in ("softffd", "numpy", "fmpy", *(["scipy"] if scipy else [])):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "?"
    return found
