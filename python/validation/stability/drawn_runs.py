"""The runs of a random scene, their agreement, and the resulting verdict on `auto`.

All runs end at the same time, after the same communication steps and inputs:

    asked    auto at the scene's tolerance: the run that is judged
    tight    auto at a thirtieth of that tolerance
    rungs    leapfrog with steps that get four times shorter, from a seventh of the stable step on, as far as the work allows

The truth is the last rung that agrees with the rung before, or with tight, within a third of the tolerance; there the ladder ends. If no
runs agree, the last two rungs still convict asked if its distance from the last rung is ten times the distance of these rungs: a rough
truth. With fewer than four rungs, one rung more than the work allows has to confirm the rough truth. Otherwise there is no truth: the
motion is chaotic, or would take more work."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from validation.guard import Lost
from validation.stability.drawn import Drawn, drawn
from validation.stability.drawn_bodies import drawn_damped, drawn_solids, drawn_surface
from validation.stability.drawn_elements import drawn_elements
from validation.stability.drawn_free import drawn_free
from validation.stability.drive import GRAVITY, Drive, Refused, StateTouched
from validation.stability.verdict import STATED, stated_errors

RUNGS = ("rung 1", "rung 2", "rung 3", "rung 4")
RUNS = ("asked", "tight", *RUNGS)

TIGHTER = 30.0  # ratio of the tolerances of asked and tight; ratio of the stable step and the step of the second rung
FINER = 4.0  # ratio of the steps of a rung and the next rung
AGREED = 1 / 3  # largest distance of two runs that give the truth, by the tolerance
ROUGH = 0.1  # largest distance of two rungs that show a rough truth, by the error found
ALLOWED = 10.0  # largest permitted distance of asked from the truth, by the tolerance
BEHIND = 1e-12  # penetration that rounding explains, relative to the box
GAIN = 1.0
"""Permitted energy gain by the present energy. With steps near the stability limit the energy of vibrations oscillates almost as much."""

WORK = 1.2e9  # most springs times steps of a rung, about six seconds
POINT_WORK = 8  # work of a control point in a step, in units of the work of a spring
SURFACE_WORK = 4  # factor of the work of a step in which a surface may touch
NEAREST = 0.25  # longest step of the last rung by the stable step; friction and resonance excite vibrations nearer to it
PATIENCE = {"asked": 8.0, "tight": 12.0} | dict.fromkeys(RUNGS, 60.0)  # s
NOT_NEEDED, NO_MORE = "not needed", "no more work"

VERDICTS = ("right", "stated", "refused", "no truth", "slow", "SILENT", "WRONG")
"""right: within ten tolerances of the truth. stated: beyond, and a warning has stated the error. refused: fmi2Discard or fmi2Error, with
an unchanged state. no truth: nothing to compare with. slow: no answer within the time. SILENT: beyond, without a stated error. WRONG: a
crash, a result that is not finite, a control point behind a plane, energy that has doubled without work, a discarded step that has changed
the state."""
FAULTS = ("SILENT", "WRONG")

FAMILIES = {
    "lattice": drawn,
    "surface": drawn_surface,
    "solids": drawn_solids,
    "damped": drawn_damped,
    "elements": drawn_elements,
    "free": drawn_free,
}
"""Scene functions by family: obstacles meet control points; obstacles, or solid obstacles, meet the surface of the object; bodies with
internal damping; finite elements; free bodies beside any of these"""


@dataclass(frozen=True)
class Run:
    """One run: final positions of the control points, or the nodes of finite elements, and of points of free bodies."""

    x: np.ndarray | None  # (n, 3) [m]; None: the run did not reach its end
    words: str = ""  # why the run did not reach its end
    wrong: bool = False  # the run violated a guarantee
    stated: float = 0.0  # the largest error stated by a warning [m]
    warnings: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()  # methods that took over, each once
    step: float = math.nan  # step of leapfrog by the stable step
    internal_steps: int = 0
    run_time: float = 0.0  # s


@dataclass(frozen=True)
class Job:
    """One run of a scene."""

    seed: int
    run: str  # one of RUNS
    family: str = "lattice"  # one of FAMILIES

    @property
    def scene(self) -> Drawn:
        """Scene of the seed"""
        return FAMILIES[self.family](self.seed)


def patience(job: Job) -> float:
    """Returns the time limit of a run [s]."""
    return PATIENCE[job.run]


def run_jobs(jobs: Sequence[Job]) -> Iterator[Run]:
    """Yields the runs in the order of the jobs. The runs of a scene share one drive."""
    for _, several in groupby(jobs, lambda job: job.seed):
        group = list(several)
        scene = group[0].scene
        found: dict[str, Run] = {}
        try:
            drive = Drive(scene.document, surface=scene.surface)
        except Refused as refusal:
            yield from (Run(None, f"refused at the start: {refusal}") for _ in group)
            continue
        with drive:
            for job in group:
                run = found[job.run] = _run(drive, scene, job.run, found)
                yield run


def _run(drive: Drive, scene: Drawn, which: str, found: dict[str, Run]) -> Run:
    began = clock.perf_counter()
    if which in ("asked", "tight"):
        tolerance = scene.tolerance / (TIGHTER if which == "tight" else 1.0)
        return _followed(drive, scene, {}, tolerance, began, watched=which == "asked")
    place = RUNGS.index(which)
    shares = ladder(drive, scene)
    if truth_of(scene, drive.side, found):
        return Run(None, NOT_NEEDED)
    if not shares:
        return Run(None, f"leapfrog would take {scene.duration / (NEAREST * drive.value('solver.stable_step')):.1e} steps")
    if place == len(shares) and _convicts(drive, scene, found):
        shares.append(shares[-1] / FINER)
    if place >= len(shares):
        return Run(None, NO_MORE)
    step = shares[place] * drive.value("solver.stable_step")
    run = _followed(drive, scene, {"solver.method": "leapfrog", "solver.step": step}, scene.tolerance, began)
    return replace(run, step=shares[place])


def _convicts(drive: Drive, scene: Drawn, found: dict[str, Run]) -> bool:
    """True if the last two rungs show an error. In a chaotic motion both may be on another branch, which a finer rung reveals."""
    asked, done = found.get("asked"), [found[name] for name in RUNGS if name in found and found[name].x is not None]
    return asked is not None and asked.x is not None and len(done) > 1 and convicted(scene, drive.side, asked, *done[-2:])


def ladder(drive: Drive, scene: Drawn) -> list[float]:
    """Returns the steps of the rungs, relative to the stable step at the start; none if the work does not allow two rungs."""
    drive.restart({}, scene.duration)
    work = (len(drive.body.pairs) + POINT_WORK * len(drive.mass)) * (SURFACE_WORK if scene.surface else 1)
    least = scene.duration * work / WORK / drive.value("solver.stable_step")
    if least > NEAREST:
        return []
    if least > 1 / TIGHTER:
        return [2 * least, least]
    shares = [FINER ** (1 - place) / TIGHTER for place in range(len(RUNGS))]
    return [share for share in shares if share >= least]


def _followed(drive: Drive, scene: Drawn, settings: dict[str, Any], tolerance: float, began: float, *, watched: bool = False) -> Run:
    """Runs the scene to its end and checks its guarantees. watched: the energy gain is checked, too."""
    try:
        drive.restart(settings, scene.duration, tolerance=tolerance)
        scale = abs(drive.start_energy) + drive.mass.sum() * GRAVITY * drive.side
        for length in scene.lengths:
            scene.tell(drive, length)
            drive.step(length)
            if broken := _broken(drive, scene) or (watched and _grown(drive, scale)):
                return Run(None, broken, wrong=True, run_time=clock.perf_counter() - began)
    except Refused as refusal:
        return Run(None, f"refused at {drive.time:.3g} s: {refusal}", run_time=clock.perf_counter() - began)
    except StateTouched as fault:
        return Run(None, str(fault), wrong=True, run_time=clock.perf_counter() - began)
    warnings = tuple(drive.simulation.warnings)
    stated = stated_errors(drive, scene.duration)
    steps, elapsed = int(drive.value("solver.steps")), clock.perf_counter() - began
    methods = tuple(dict.fromkeys(method for method, _ in drive.simulation.methods()))
    x = np.concatenate([drive.material_points, drive.free.marks])
    return Run(x, stated=stated, warnings=warnings, methods=methods, internal_steps=steps, run_time=elapsed)


def _broken(drive: Drive, scene: Drawn) -> str:
    """Returns the guarantee that the state at a communication point violates, or an empty text."""
    if not drive.finite():
        return f"not finite at {drive.time:.3g} s"
    free = drive.touching
    if scene.surface is None:
        held = {p for pin in scene.document["pin"] for p in drive.scene.select(pin["points"]).tolist()}
        free = np.delete(free, sorted(held), axis=0)
    poses = {name: (drive.free.place(name), drive.free.axes(name)) for name in drive.free.names}
    for name, gaps in (scene.gaps(free, drive.time) | scene.gaps_of_free(free, poses)).items():
        behind = -float(gaps.min(initial=0.0)) / drive.side
        if behind > BEHIND:
            return f"{behind:.1e} of the box behind obstacle {name} at {drive.time:.3g} s"
    return ""


def _grown(drive: Drive, scale: float) -> str:
    """Returns a text about the energy gain if it exceeds the energy of the scene [J] and no warning reports it, else an empty text."""
    gain = drive.balance() / (scale + abs(drive.value("energy.work")))
    return (
        f"energy has grown out of nothing by {gain:.1e} of its own at {drive.time:.3g} s"
        if gain > GAIN and "has gained" not in drive.warned
        else ""
    )


def distance(one: Run | None, other: Run | None) -> float:
    """Returns the largest distance between the same points of two runs [m], or NaN if a run is missing."""
    if one is None or other is None or one.x is None or other.x is None:
        return math.nan
    return float(np.linalg.norm(one.x - other.x, axis=1).max())


def agree(scene: Drawn, side: float, one: Run | None, other: Run | None) -> bool:
    """True if two runs agree within AGREED tolerances. side: largest side of the box [m]."""
    return distance(one, other) <= AGREED * scene.tolerance * side


def truth_of(scene: Drawn, side: float, found: dict[str, Run]) -> tuple[str, str] | None:
    """Returns the names of two runs that agree, the one that counts as the truth first, or None if there is no truth."""
    done = [name for name in RUNGS if name in found and found[name].x is not None]
    pairs = [(name, other) for place, name in enumerate(done) for other in (*done[max(0, place - 1) : place], "tight")]
    return next((pair for pair in reversed(pairs) if agree(scene, side, found[pair[0]], found.get(pair[1]))), None)


def convicted(scene: Drawn, side: float, asked: Run, before: Run, last: Run) -> bool:
    """True if two rungs that do not agree still show a certain error."""
    error = distance(asked, last)
    return error > 2 * ALLOWED * scene.tolerance * side and distance(before, last) <= ROUGH * error


@dataclass(frozen=True)
class Judged:
    """A scene with its verdict."""

    scene: Drawn
    verdict: str  # one of VERDICTS
    error: float = math.nan  # error of asked, in tolerances
    stated: float = 0.0  # error stated by a warning of asked, in tolerances
    tight_error: float = math.nan  # error of tight, in tolerances of asked
    truth: str = ""  # the two runs that agree
    apart: float = math.nan  # distance of these two runs, or without a truth of the last two rungs, in tolerances
    rough: bool = False  # True if the truth is a rough truth
    words: str = ""
    runs: dict[str, Run] | None = None

    @property
    def run_time(self) -> float:
        """Run time of all runs [s]"""
        return sum(run.run_time for run in (self.runs or {}).values())


def judge(scene: Drawn, results: Sequence[Run | Lost]) -> Judged:
    """Returns the verdict on the runs of a scene, which are in the order of RUNS."""
    asked = results[0]
    side = max(scene.document["lattice"]["size"])
    unit = scene.tolerance * side
    runs = {name: result for name, result in zip(RUNS, results, strict=True) if isinstance(result, Run)}
    lost = {name: result for name, result in zip(RUNS, results, strict=True) if isinstance(result, Lost)}
    for name, result in lost.items():
        if result.how != "hang":
            return Judged(scene, "WRONG", words=f"{name}: {result.how}: {result.words}", runs=runs)
    for name, run in runs.items():
        if run.wrong:
            return Judged(scene, "WRONG", words=f"{name}: {run.words}", runs=runs)
    if isinstance(asked, Lost):
        return Judged(scene, "slow", words=asked.words, runs=runs)
    if asked.x is None:
        return Judged(scene, "refused", words=asked.words, runs=runs)
    done = [name for name in RUNGS if name in runs and runs[name].x is not None]
    pair = truth_of(scene, side, runs)
    rough = pair is None and len(done) > 1
    if rough and convicted(scene, side, asked, *(runs[name] for name in done[-2:])):
        pair = done[-1], done[-2]
    if pair is None:
        why = {f"{name}: {run.words}" for name, run in runs.items() if run.words not in ("", NOT_NEEDED, NO_MORE)}
        why |= {f"{name}: {result.words}" for name, result in lost.items()}
        apart = distance(*(runs[name] for name in done[-2:])) / unit if rough else math.nan
        return Judged(scene, "no truth", apart=apart, words="; ".join(sorted(why)), runs=runs)
    truth = runs[pair[0]]
    error, stated, apart = distance(asked, truth) / unit, asked.stated / unit, distance(truth, runs[pair[1]]) / unit
    verdict = "right" if error <= ALLOWED else "stated" if error <= STATED * stated else "SILENT"
    tight = distance(runs.get("tight"), truth) / unit
    words = "; ".join(asked.warnings)
    return Judged(scene, verdict, error, stated, tight, " = ".join(pair), apart, rough, words, runs)
