"""Error against run time of every method on one scene, measured through the FMU as a host would run it."""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from softffd.accuracy.records import Record, Records
from softffd.accuracy.reference import find_reference
from softffd.accuracy.rig import NOTHING_MOVES, Rig, Setting, TooLong
from softffd.errors import FmuError, Interrupted
from softffd.run.progress import Note, silent
from softffd.scene.checks_free import METHODS as WITH_FREE_BODIES
from softffd.scene.scene import Scene
from softffd.spelling import wanted_one_of

FIXED_STEP = ("central_difference", "leapfrog", "bm4", "sdirk2")
"""Methods that are measured over fixed internal steps; all others are measured over tolerances."""
IMPLICIT = ("sdirk2",)  # those of them without a stability bound of the step: their first step is a communication step
CONTACT = ("central_difference", "leapfrog", "auto", "sdirk2")
"""Methods that differ where contact is possible: the others pass such communication steps to leapfrog."""
AS_AUTO = ("backward_euler",)
"""Methods that do what `auto` does, except for impacts of stiff bodies, which they lose: beside `auto` they say nothing of the best
method."""
DAMPED_CONTACT = ("sdirk2",)  # methods for bodies with internal damping beside obstacles or free bodies
FINER, QUICK_FINER = 1.5, 2.0  # ratio of successive fixed steps; the largest stable step of leapfrog is among the steps
COARSER = 2  # so many steps exceed the stable one: some methods are stable there, for the others the FMU divides the steps
BUDGET, QUICK_BUDGET = 2.0, 0.2  # a method's sweep ends after a run of more CPU time [s]
FAILURES = 6  # a method's sweep ends after this many failed runs in a row
REPEATS = 5  # runs of each setting, of which the smallest time counts
Anchors = Callable[[Rig, Records, bool, Note], Iterator[Record]]  # measures other programs on a scene; the bool: quick


def measure(
    scene: Scene, *, methods: Sequence[str] | None = None, step: float | None = None, anchors: Anchors | None = None, quick: bool = False,
    repeats: int = REPEATS, note: Note = silent,
) -> Records:  # fmt: skip
    """Runs every applicable method over its steps or tolerances and compares each run with a much tighter reference.

    methods: some of the values of `solver.method`; all by default. step: communication step [s], by default the scene's own.
    anchors: makes records of other programs, after the FMU's. quick: fewer, shorter runs. repeats: of each run.
    note: called with what is being run. A failed run gives a record with its message.
    Raises FmuError for an unknown method, if nothing moves, and if no reference or no run can be made. On Ctrl-C raises Interrupted with
    the records so far.
    """
    with Rig(scene, step=step) as rig:
        records = Records(
            scene.name, scene.title, rig.communication_step, rig.stop_time, rig.times, len(scene.rest_positions()), scene.solver.tolerance
        )
        chosen = _applicable(rig, methods, records.left_out)
        try:
            reference = records.reference = find_reference(rig, quick=quick, note=note)
            if np.abs(reference.positions - reference.positions[0]).max() <= rig.rounding:
                raise FmuError(NOTHING_MOVES)
            for method in chosen:
                _sweep(rig, method, records, quick, repeats, note)
            for record in anchors(rig, records, quick, note) if anchors else ():
                records.runs.append(record)
            if records.runs and not records.good():
                raise FmuError(f"no run succeeded; the last: {records.runs[-1].failure}")
            records.complete = True
        except KeyboardInterrupt:
            raise Interrupted(records) from None
    return records


def _applicable(rig: Rig, methods: Sequence[str] | None, left_out: dict[str, str]) -> list[str]:
    for method in methods or ():
        if method not in rig.methods:
            raise FmuError(f"solver.method: {wanted_one_of(rig.methods, method)}")
    why = {method: _why_left_out(rig, method) for method in methods or rig.methods}
    left_out |= {method: reason for method, reason in why.items() if reason}
    return [method for method, reason in why.items() if not reason]


def _why_left_out(rig: Rig, method: str) -> str:
    """Returns why a method would add nothing to the other methods; empty if it is to be measured."""
    if rig.free and method not in WITH_FREE_BODIES:
        return "does not support free bodies"
    if method in AS_AUTO:
        return "does what auto does, but stiff bodies do not rebound"
    if rig.contact and method not in CONTACT:
        return "leaves communication steps with possible contact to leapfrog"
    if method in DAMPED_CONTACT and not ((rig.contact or rig.free) and rig.dashpots):
        return "is for bodies with internal damping beside obstacles or free bodies"
    if rig.dashpots and method == "central_difference":
        return "runs as leapfrog where there is internal damping"
    if (rig.damped and method == "rkn12") or (rig.dashpots and method == "bm4"):
        return f"runs as dop853 where there is {'internal ' * (method == 'bm4')}damping"
    return ""


def settings_of(method: str, rig: Rig, *, quick: bool = False) -> Iterator[Setting]:
    """Yields the settings of a method from coarse to fine: fixed steps without end, or tolerances 1e-1 .. 1e-11."""
    if method not in FIXED_STEP:
        for half_decades in range(2, 23, 2 if quick else 1):
            yield Setting(method, tolerance=10.0 ** (-half_decades / 2))
        return
    stable, finer = math.ceil(rig.communication_step / rig.stable_step), QUICK_FINER if quick else FINER
    first = 1 if method in IMPLICIT else stable * finer**-COARSER
    count = 0
    for power in itertools.count():
        count = max(count + 1, round(first * finer**power))
        yield Setting(method, step=rig.communication_step / count)


def _sweep(rig: Rig, method: str, records: Records, quick: bool, repeats: int, note: Note) -> None:
    """Adds the runs of a method until it is accurate enough, takes too long, or keeps failing."""
    budget = QUICK_BUDGET if quick else BUDGET
    before, failures = None, 0
    for setting in settings_of(method, rig, quick=quick):
        note(f"{records.scene}: {setting}")
        try:
            run = rig.run(setting, repeats=repeats, most=3 * budget, before=before)
        except FmuError as error:
            records.runs.append(Record(setting, failure=str(error)))
            failures += 1
            if isinstance(error, TooLong) or failures == FAILURES:
                return
            continue
        failures = 0
        if setting.step and before is not None and run.steps == before.steps:
            continue  # the FMU has shortened both steps to the same one
        before = run
        errors = records.reference.errors(run.positions, rig.side)
        record = Record(setting, "softffd", run.cpu_time, run.repeats, run.steps, run.rejected, errors)
        records.runs.append(record)
        if record.error < records.floor or run.cpu_time > budget:
            return
