"""Runs random scenes on several processes and writes the table of verdicts."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from softffd.accuracy.kept import conditions, csv_text, keep_files
from softffd.errors import SoftffdError
from softffd.files import json_text
from softffd.run.progress import Note, silent
from validation.guard import guarded
from validation.stability.drawn_runs import FAULTS, RUNGS, RUNS, VERDICTS, Job, Judged, judge, patience, run_jobs

COMMAND = "python3 python/run.py random"
TOGETHER = 4  # scenes that a process runs one after the other
SHOWN = 20  # faults that are listed on stderr

COLUMNS = (
    "seed", "verdict", "rough", "error_tolerances", "stated_tolerances", "tight_error_tolerances", "truth", "apart_tolerances", "last_rung",
    "methods", "asked_steps", "asked_s", "tight_steps", "tight_s", "rungs_s", "scene", "words",
)  # fmt: skip


@dataclass
class Lot:
    """The scenes of some seeds, and the verdicts so far."""

    seeds: list[int]
    judged: dict[int, Judged] = field(default_factory=dict)
    family: str = "lattice"  # family of the scenes

    @property
    def missing(self) -> list[int]:
        """Seeds without a verdict."""
        return [seed for seed in self.seeds if seed not in self.judged]

    def faults(self) -> list[Judged]:
        """Returns the faults, the worst first."""
        found = [judged for judged in self.judged.values() if judged.verdict in FAULTS]
        return sorted(found, key=lambda judged: -judged.error if judged.error == judged.error else -math.inf)

    def summary(self) -> str:
        """Returns a text with the numbers of verdicts and the fraction of silent failures among the scenes with a truth."""
        counts = Counter(judged.verdict for judged in self.judged.values())
        known = [judged for judged in self.judged.values() if judged.truth and not judged.rough]
        silent = sum(judged.verdict == "SILENT" for judged in known)
        words = ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])
        share = f"; of {len(known)} with a truth {silent / len(known):.1%} are silently wrong" if known else ""
        more = counts["SILENT"] - silent
        share += f", and {more} where the truth is known roughly" if more else ""
        return f"{len(self.judged)} scenes: {words}{share}"


def report_random(
    folder: Path, number: int, seed: int, *, family: str = "lattice", processes: int = 1, note: Note = silent, say: Note = print
) -> Lot:
    """Runs `number` scenes with the seeds from `seed` on and writes random.csv and random.json to `folder`.

    family: of the scenes, one of FAMILIES. processes: number of scenes at a time. note: receives the progress. say: receives each verdict
    except "right" and "no truth", and the summary. Raises SoftffdError at the end if there is a fault, and KeyboardInterrupt on Ctrl-C
    after the table of the finished scenes is written.
    """
    for name, value, least in (("number of scenes", number, 1), ("--seed", seed, 0)):
        if value < least:
            raise SoftffdError(f"{name} {value}: wanted at least {least}")
    lot, flag = Lot(list(range(seed, seed + number)), family=family), f" --family {family}" * (family != "lattice")
    about = conditions([f"{COMMAND} {number} --seed {seed}{flag}"])
    try:
        for judged in run(lot, processes):
            note(f"{len(lot.judged)} of {number} scenes")
            if judged.verdict not in ("right", "no truth"):
                say(line(judged))
    except KeyboardInterrupt:
        _keep(folder, lot, about)
        say(lot.summary())
        raise KeyboardInterrupt(f"what is done is kept in {folder}; {len(lot.missing)} scenes are missing") from None
    _keep(folder, lot, about)
    say(lot.summary())
    if faults := lot.faults():
        more = [f"  and {len(faults) - SHOWN} more in {folder}"] if len(faults) > SHOWN else []
        again = f"{COMMAND} 1 --seed SEED{flag}"
        head = f"{len(faults)} scenes are wrong without a word; {again} runs one again:"
        raise SoftffdError("\n".join([head, *(f"  {line(judged)}" for judged in faults[:SHOWN]), *more]))
    return lot


def run(lot: Lot, processes: int) -> Iterator[Judged]:
    """Runs the scenes, fills the lot, and yields each scene when it is judged."""
    jobs = [Job(seed, run, lot.family) for seed in lot.seeds for run in RUNS]
    runs: dict[int, list[Any]] = {seed: [] for seed in lot.seeds}
    for job, result in guarded(run_jobs, jobs, patience, processes, TOGETHER * len(RUNS)):
        runs[job.seed].append(result)
        if len(runs[job.seed]) == len(RUNS):
            judged = lot.judged[job.seed] = judge(job.scene, runs[job.seed])
            yield judged


def line(judged: Judged) -> str:
    """Returns a line of text about a scene and its verdict."""
    error = f" error {judged.error:.3g} tolerances," if judged.error == judged.error else ""
    stated = f" stated {judged.stated:.2g}," if judged.stated else ""
    words = f": {judged.words[:200]}" if judged.words and judged.verdict in ("WRONG", "refused", "no truth", "slow") else ""
    run = (judged.runs or {}).get("asked")
    methods = f" by {', '.join(run.methods)}" if run and run.methods else ""
    return f"seed {judged.scene.seed}: {judged.verdict},{error}{stated} {judged.scene.words}{methods}{words}"


def _keep(folder: Path, lot: Lot, about: dict[str, Any]) -> None:
    rows = [_row(lot.judged[seed]) for seed in lot.seeds if seed in lot.judged]
    document = {
        **about,
        "summary": lot.summary(),
        "missing": lot.missing,
        "scenes": [row | {"document": lot.judged[row["seed"]].scene.document} for row in rows],
    }
    keep_files(folder, {"random.csv": csv_text(COLUMNS, rows), "random.json": json_text(document)})


def _row(judged: Judged) -> dict[str, Any]:
    runs = judged.runs or {}

    def told(value: float) -> float | str:
        return "" if math.isnan(value) else value

    row = {
        "seed": judged.scene.seed,
        "verdict": judged.verdict,
        "rough": int(judged.rough),
        "error_tolerances": told(judged.error),
        "stated_tolerances": judged.stated,
        "tight_error_tolerances": told(judged.tight_error),
        "truth": judged.truth,
        "apart_tolerances": told(judged.apart),
        "last_rung": min((run.step for run in runs.values() if run.step == run.step), default=""),
        "methods": "; ".join(runs["asked"].methods) if "asked" in runs else "",
        "rungs_s": round(sum(run.run_time for name, run in runs.items() if name in RUNGS), 3),
        "scene": judged.scene.words,
        "words": judged.words,
    }
    for name in ("asked", "tight"):
        row |= {f"{name}_steps": runs[name].internal_steps, f"{name}_s": round(runs[name].run_time, 3)} if name in runs else {}
    return row
