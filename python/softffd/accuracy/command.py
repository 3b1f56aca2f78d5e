"""`softffd accuracy`: measures scenes one after the other and keeps files after each."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from softffd.accuracy.files import keep
from softffd.accuracy.kept import conditions
from softffd.accuracy.measure import REPEATS, Anchors, Interrupted, measure
from softffd.accuracy.page import time_words
from softffd.accuracy.picture import front_picture
from softffd.accuracy.records import CHOSEN, LEVELS, MISSED, Records, level_words
from softffd.accuracy.report import factor_words
from softffd.errors import FmuError
from softffd.run.drive import positive
from softffd.run.progress import Note, silent
from softffd.scene.scene import load_scene

STANDARD = (
    "free_vibration", "stiff_pull", "stiff_layer", "sliding_drop", "light_corner", "spin", "stiff_bounce", "light_bounce",
)  # fmt: skip
"""The standard set, S1 .. S8: soft, undamped; stiff and slow; one stiff layer; contact with friction; a nearly massless point; rotation;
impact of a stiff body, and of a nearly massless point."""


def report_accuracy(
    scenes: Sequence[str],
    folder: Path,
    *,
    step: float | None = None,
    anchors: Anchors | None = None,
    typed: str = "softffd accuracy",
    quick: bool = False,
    note: Note = silent,
    say: Note = print,
) -> list[Records]:
    """Measures scenes (names or files; the standard set if there are none) and keeps CSV, JSON, pictures and page in `folder` after each.

    Options as in `measure`; typed: the command, for the files; say: told what has come out, a few lines per scene. Raises SceneError for
    an unknown scene and FmuError for an unusable step before anything is run; FmuError in the end if a scene could not be measured, with
    its message; KeyboardInterrupt on Ctrl-C once what is done is kept.
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
            records = interrupt.records
        except FmuError as error:
            refused[scene.name] = str(error)
            say(f"{scene.name}: {scene.title}\n  not measured: {error}")
            keep(folder, measured, refused | missing, about, pictures)
            continue
        if records.good():
            measured.append(records)
            pictures[scene.name] = front_picture(records)
        else:
            missing = {scene.name: "interrupted"} | missing
        keep(folder, measured, refused | missing, about, pictures)
        if not records.complete:
            unfinished = dict.fromkeys([scene.name, *missing])
            raise KeyboardInterrupt(f"what is done is kept in {folder}; not complete: {', '.join(unfinished)}")
        for line in _outcome(records):
            say(line)
    if refused:
        raise FmuError("\n".join(["scenes that could not be measured:", *(f"  {name}: {why}" for name, why in refused.items())]))
    return measured


def _about(scenes: Sequence[str], *, step: float | None, anchors: Anchors | None, typed: str, quick: bool) -> dict[str, Any]:
    """Date, command line, machine, versions and settings, for the files."""
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
