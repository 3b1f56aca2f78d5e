"""The shipped scene free_vibration to a given error, with the loosest sufficient setting, against other solvers to the same error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np
from measured import NotMeasured, Pair, row

import softffd
from softffd.accuracy.reference import Reference, find_reference
from softffd.accuracy.rig import Rig, Setting

TOLERANCES = tuple(10.0**-n for n in range(1, 12))


@contextmanager
def judged() -> Iterator[tuple[Rig, Reference]]:
    """Yields the scene with its communication steps, and the reference result."""
    with Rig(softffd.load_scene("free_vibration")) as rig:
        yield rig, reference()


@cache
def reference() -> Reference:
    """Returns the reference result, which is computed once."""
    with Rig(softffd.load_scene("free_vibration")) as rig:
        return find_reference(rig, quick=True)


def loosest(settings: Any, run: Callable[[Any], np.ndarray], rig: Rig, expected: Reference, level: float) -> Any:
    """Returns the first setting whose largest error, relative to the box, is at most `level`. Raises NotMeasured if there is none."""
    for setting in settings:
        if expected.errors(run(setting), rig.side).max() <= level:
            return setting
    raise NotMeasured(f"no setting comes to {level:g}")


def own_run(rig: Rig, expected: Reference, level: float) -> Callable[[], float]:
    """Returns a call that runs `auto` and returns the smallest time [s] of three runs without opening."""
    tolerance = loosest(TOLERANCES, lambda tolerance: rig.run(Setting("auto", tolerance=tolerance)).positions, rig, expected, level)

    def run() -> float:
        return rig.run(Setting("auto", tolerance=tolerance)).cpu_time

    return run


@row("free vibration", "auto, to 1e-6 of the box", "SciPy's DOP853 over numpy, to 1e-6")
def against_dop853() -> Iterator[Pair]:
    from validation.scipy import Equations, integrate, nodal_forces, solver

    with judged() as (rig, expected):
        equations, forces, solve = Equations(rig.scene), nodal_forces(rig), solver()

        def base(tolerance: float) -> np.ndarray:
            return integrate(solve, equations, forces, rig, Setting("DOP853", tolerance=tolerance))[0]

        tolerance = loosest(TOLERANCES[3:], base, rig, expected, 1e-6)
        yield Pair(own_run(rig, expected, 1e-6), lambda: base(tolerance))


@row("free vibration", "auto, to 1e-4 of the box", "MuJoCo's flex, RK4, to 1e-4")
def against_mujoco() -> Iterator[Pair]:
    from flex import Flex

    with judged() as (rig, expected):
        flex = Flex(rig.scene)
        steps = loosest((200, 400, 800), lambda n: flex.run(rig.times, n), rig, expected, 1e-4)

        yield Pair(own_run(rig, expected, 1e-4), lambda: flex.run(rig.times, steps))
