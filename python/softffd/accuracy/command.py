"""`softffd accuracy`: measures scenes one after the other and writes files after each: table, document, page, pictures."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softffd.accuracy.kept import conditions, csv_text, keep_files
from softffd.accuracy.measure import REPEATS, Anchors, measure
from softffd.accuracy.page import time_words
from softffd.accuracy.picture import front_picture
from softffd.accuracy.records import CHOSEN, LEVELS, MISSED, Record, Records, level_words
from softffd.accuracy.report import factor_words, report_page
from softffd.errors import FmuError, Interrupted
from softffd.files import finite, json_text
from softffd.run.drive import positive
from softffd.run.progress import Note, silent
from softffd.scene.scene import load_scene

STANDARD = (
    "free_vibration", "stiff_pull", "stiff_layer", "sliding_drop", "light_corner", "spin", "stiff_bounce", "light_bounce",
)  # fmt: skip
"""The standard set, S1 .. S8: soft, undamped; stiff and slow; one stiff layer; contact with friction; a nearly massless point; rotation;
impact of a stiff body, and of a nearly massless point."""
COLUMNS = (
    "scene", "method", "origin", "step_s", "tolerance", "communication_step_s", "cpu_time_s", "repeats", "error", "error_claimed",
    "internal_steps", "rejected_steps", "failure",
)  # fmt: skip


def report_accuracy(
    scenes: Sequence[str], folder: Path, *, step: float | None = None, anchors: Anchors | None = None, typed: str = "softffd accuracy",
    quick: bool = False, note: Note = silent, say: Note = print,
) -> list[Records]:  # fmt: skip
    """Measures scenes (names or files; the standard set if there are none), and writes CSV, JSON, pictures and page to `folder` after
    each.

    Options as in `measure`. typed: the command, for the files. say: called with the results, a few lines per scene. Raises SceneError for
    an unknown scene and FmuError for an unusable step before anything is run. If a scene could not be measured, raises FmuError with its
    message in the end. On Ctrl-C, writes what is done and raises KeyboardInterrupt.
    """
    if step is not None:
        positive("communication step", step, None)
    loaded = [load_scene(name) for name in scenes or STANDARD]
    about = _about(scenes, step=step, anchors=anchors, typed=typed, quick=quick)
    measured: list[Records] = []
    refused: dict[str, str] = {}
    pictures: dict[str, bytes] = {}
    for number, scene in enumerate(loaded):
        missing = {each.name: "interrupted" for each in loaded[number + 1 :]}
        try:
            records = measure(scene, step=step, anchors=anchors, quick=quick, note=note)
        except Interrupted as interrupt:
            records = interrupt.result
        except FmuError as error:
            refused[scene.name] = str(error)
            say(f"{scene.name}: {scene.title}\n  not measured: {error}")
            _keep(folder, measured, refused | missing, about, pictures)
            continue
        if records.good():
            measured.append(records)
            pictures[scene.name] = front_picture(records)
        else:
            missing = {scene.name: "interrupted"} | missing
        _keep(folder, measured, refused | missing, about, pictures)
        if not records.complete:
            unfinished = dict.fromkeys([scene.name, *missing])
            raise KeyboardInterrupt(f"what is done is kept in {folder}; not complete: {', '.join(unfinished)}")
        for line in _outcome(records):
            say(line)
    if refused:
        raise FmuError("\n".join(["scenes that could not be measured:", *(f"  {name}: {why}" for name, why in refused.items())]))
    return measured


def _about(scenes: Sequence[str], *, step: float | None, anchors: Anchors | None, typed: str, quick: bool) -> dict[str, Any]:
    options = [f"--step {step:g}" if step else "", "--quick" * quick]
    settings = {"communication_step_s": step, "scipy": anchors is not None, "quick": quick, "repeats": REPEATS}
    return conditions([typed, *scenes, *options], *(["scipy"] if anchors else [])) | {"settings": settings}


def _outcome(records: Records) -> list[str]:
    lines = [f"{records.scene}: {records.title}", f"  reference: {records.reference}"]
    for level in LEVELS:
        best, chosen = records.best(level), records.cheapest(CHOSEN, level)
        words = [f"{run.name} {time_words(run.cpu_time)}" for run in (chosen, best) if run] or ["not reached"]
        if factor := factor_words(records.factor(chosen or best, level)):
            words.append(f"{factor} times as fast as the published scheme")
        lines.append(f"  error {level_words(level)}: {', '.join(words)}")
    for name in records.names("softffd"):
        run = records.worst_of_tolerance(name)
        if run and run.error > MISSED * run.setting.tolerance:
            lines.append(f"  {name} misses its tolerance: error {run.error:.1e} at {run.setting.tolerance:.1e}")
    return lines


# ---- files ----


def _keep(
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
    failed, setting = run.failure is not None, run.setting
    cells = (
        records.scene, setting.method, run.origin, setting.step or None, setting.tolerance or None, records.communication_step,
        None if failed else run.cpu_time, run.repeats, None if failed else run.error, None if failed else finite(records.claimed(run)),
        run.steps, run.rejected, run.failure,
    )  # fmt: skip
    return dict(zip(COLUMNS, cells, strict=True))


def _scene(records: Records) -> dict[str, Any]:
    reference, recommended = records.reference, records.recommended(records.tolerance)
    worst = {name: run for name in records.names("softffd") if (run := records.worst_of_tolerance(name))}
    errors = ([] if run.errors is None else [float(f"{error:.3e}") for error in run.errors] for run in records.runs)
    told = {
        "method": reference.method, "compared_with": reference.check, "confirmed": reference.confirmed,
        "uncertainty": reference.uncertainty,
    }  # fmt: skip
    over = {name: {"largest": run.error / run.setting.tolerance, "tolerance": run.setting.tolerance} for name, run in worst.items()}
    return {
        "scene": records.scene, "title": records.title, "complete": records.complete, "control_points": records.points,
        "stop_time_s": records.stop_time, "communication_step_s": records.communication_step, "reference": told,
        "left_out": records.left_out, "levels": {level_words(level): _level(records, level) for level in LEVELS},
        "error_over_tolerance": over, "recommended": recommended and _row(records, recommended), "times_s": records.times.tolist(),
        "runs": [_row(records, run) | {"errors": each or None} for run, each in zip(records.runs, errors, strict=True)],
    }  # fmt: skip


def _level(records: Records, level: float) -> dict[str, Any]:
    """Returns the times to reach an error, the factors over the published scheme (a bound if it never gets there), and auto's time over
    the best's."""
    best, chosen = records.best(level), records.cheapest(CHOSEN, level)
    reached = {name: run.cpu_time for name in records.names() if (run := records.cheapest(name, level))}
    factors = {name: records.factor(run, level) for name, run in (("best", best), ("auto", chosen))}
    told = {f"{name}_over_published": pair and {"factor": pair[0], "is_lower_bound": pair[1]} for name, pair in factors.items()}
    return {"cpu_time_s": reached, "best": best and best.name, **told, "auto_over_best": records.ratio(level)}
