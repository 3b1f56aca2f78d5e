"""`softffd stability`: runs a survey and keeps files after each part of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from softffd.errors import SoftffdError
from softffd.run.progress import Note, silent
from softffd.run.times import positive
from softffd.validation.conditions import conditions
from softffd.validation.stability.files import keep
from softffd.validation.stability.survey import Survey, planned, run

SHOWN = 20
"""Wrong answers that are told one by one on stderr."""


def report_stability(
    folder: Path,
    *,
    only: Sequence[str] = (),
    quick: bool = False,
    slowness: float = 1.0,
    processes: int = 1,
    note: Note = silent,
    say: Note = print,
) -> Survey:
    """Runs the map and the cases, or those that `only` names, and keeps CSV, JSON, pictures and page in `folder`.

    quick: some cases and a coarse map, within half a minute. slowness: each case may take so many times longer than usual, for builds with
    sanitizers. processes: cells and cases at a time, SoftffdError if none. note: told what is done; say: told what has come out.
    Raises SoftffdError for an unknown name before anything is run, and in the end if an answer is wrong; KeyboardInterrupt on Ctrl-C once
    what is done is kept.
    """
    positive("slowness", slowness, None)
    survey = planned(only, quick=quick, slowness=slowness)
    about = _about(only, quick, slowness)
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


def _about(only: Sequence[str], quick: bool, slowness: float) -> dict[str, Any]:
    named = ["--only", *(f"'{name}'" for name in only)] if only else []
    options = ["--quick" * quick, f"--slowness {slowness:g}" * (slowness != 1), *named]
    return conditions(["softffd stability", *options])
