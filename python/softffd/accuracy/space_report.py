"""`softffd accuracy --space`: measures scenes over lattices and tolerances and writes files: table, document, picture, page."""

import html
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from softffd.accuracy.kept import conditions, csv_text, keep_files
from softffd.accuracy.page import NONE, image, page, paragraph, row, section, small, table, time_words
from softffd.accuracy.picture import setting_words, space_picture
from softffd.accuracy.records import CLAIM, Record, Records, level_words
from softffd.accuracy.space import KINDS, Measured, judge_all, measure_space
from softffd.files import json_text
from softffd.run.drive import positive
from softffd.run.progress import Note, silent
from softffd.scene.scene import load_scene

LEVELS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)  # errors, relative to the largest change, whose cost is reported
INTRODUCTION = """<p>The scene ran on finer and finer lattices, at its tolerance, a tenth and a hundredth of it. A time is the CPU time of
the loop over the communication steps. An error is the largest difference from the answer of the continuum, to which the lattices tend, over
all outputs of a kind and all communication points, divided by the largest change of that kind. Scenes whose answers agree within their
uncertainties are measured against the one that is known best.</p>"""


def report_space(
    scenes: Sequence[str], folder: Path, *, step: float | None = None, quick: bool = False, note: Note = silent, say: Note = print
) -> list[Measured]:
    """Measures scenes (names or files) and writes accuracy.csv, accuracy.json, accuracy.png and report.html to `folder` after each.

    Options as in `measure_space`. say: called with the results. Raises SceneError for an unknown scene or one that belongs to its
    lattice, and FmuError for an unusable step, if fewer than two lattices can be run, and if nothing moves.
    """
    if step is not None:
        positive("communication step", step, None)
    about = conditions(["softffd accuracy --space", *scenes, f"--step {step:g}" if step else "", "--quick" * quick])
    measured: list[Measured] = []
    for scene in [load_scene(name) for name in scenes]:
        measured.append(measure_space(scene, step=step, quick=quick, note=note))
        judge_all(measured)
        rows = [_row(each, run) for each in measured for run in each.records.runs]
        picture = space_picture([each.records for each in measured])
        files: dict[str, bytes | str] = {
            "accuracy.csv": csv_text(tuple(rows[0]), rows),
            "accuracy.json": json_text(about | {"scenes": [_document(each) for each in measured]}),
            "accuracy.png": picture,
            "report.html": page("Error against run time over lattices", about, [INTRODUCTION, image(picture)], map(_section, measured)),
        }
        keep_files(folder, files)
    for each in measured:
        for line in [f"{each.records.scene}: {each.records.title}", *(f"  {words}" for words in [*_continua(each), *_costs(each.records)])]:
            say(line)
    return measured


def _row(measured: Measured, run: Record) -> dict[str, Any]:
    errors = _errors(measured, run)
    points = dict(zip(("points_x", "points_y", "points_z"), run.lattice, strict=True))
    return {
        "scene": measured.records.scene, **points, "method": run.setting.method, "tolerance": run.setting.tolerance,
        "cpu_time_s": None if run.failure else run.cpu_time, "internal_steps": run.steps,
        **{f"error_{kind}": errors.get(kind) for kind in KINDS}, "failure": run.failure,
    }  # fmt: skip


def _errors(measured: Measured, run: Record) -> dict[str, float]:
    return {} if run.errors is None else dict(zip(measured.own, map(float, run.errors), strict=True))


def _document(measured: Measured) -> dict[str, Any]:
    kinds = measured.own.items()
    return {
        "scene": measured.records.scene, "title": measured.records.title,
        "continuum": {kind: {"order": each.order, "uncertainty": each.uncertainty, "largest_change": each.change} for kind, each in kinds},
        "errors_against": measured.against, "apart": measured.apart,
        "runs": [_row(measured, run) for run in measured.records.runs],
    }  # fmt: skip


def _continua(measured: Measured) -> Iterator[str]:
    """Yields what the lattices show of the continuum: a line for each kind of outputs, and one for each scene with the same outputs."""
    for kind, each in measured.own.items():
        order = f"order {each.order:.2g}" if each.order == each.order else "no order, the finest lattice is taken"
        yield f"{kind}: {order}; the continuum's answer is known within {each.uncertainty:.1e} of the largest change"
    for name, kinds in measured.apart.items():
        differences = ", ".join(f"{each:.1e} ({kind})" for kind, each in kinds.items())
        taken = "; errors are told against that" * (name == measured.against)
        yield f"the continuum's answer differs from that of {name} by {differences}{taken}"


def _costs(records: Records) -> Iterator[str]:
    for level in LEVELS:
        run = records.recommended(level)
        yield f"error {level_words(level)}: {_told(run) if run else 'not reached'}"


def _told(run: Record) -> str:
    return f"{run.name} points, {setting_words(run)}, {time_words(run.cpu_time)}"


def _section(measured: Measured) -> str:
    records = measured.records
    doubt = f"Errors below {CLAIM * records.reference.uncertainty:.1e} are not told apart from that of the extrapolation."
    return section(
        records.title,
        paragraph(". ".join(_continua(measured)) + ".", "soft"),
        paragraph(doubt, "soft"),
        "<h3>Lattice and tolerance for an error</h3>",
        table(["error", "lattice and tolerance", "time", "lines of the scene"], _choices(records)),
        "<h3>All runs</h3>",
        table(["points", "setting", "time", *(f"error of {kind}" for kind in measured.own), "internal steps"], _run_rows(measured)),
        name=records.scene,
    )


def _choices(records: Records) -> Iterator[str]:
    for level in LEVELS:
        run = records.recommended(level)
        told = [_told(run), time_words(run.cpu_time), f"<pre>{html.escape(run.toml, quote=False)}</pre>"] if run else [NONE] * 3
        yield row(level_words(level), told)


def _run_rows(measured: Measured) -> Iterator[str]:
    for run in measured.records.runs:
        if run.failure:
            yield row(run.name, [setting_words(run) + small(run.failure), *[NONE] * (len(measured.own) + 2)])
        else:
            errors = (f"{error:.1e}" for error in _errors(measured, run).values())
            yield row(run.name, [setting_words(run), time_words(run.cpu_time), *errors, str(run.steps)])
