"""Bare internal steps, explicit and implicit, and their cost by the size of the lattice."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from boxes import STEP, box
from measured import NotMeasured, Pair, require_alike, row

from softffd import Simulation
from validation.mechanics import spring_list

SPRING_STEPS = 8_000_000
"""Springs times internal steps of a call"""


def steps_of(side: int) -> int:
    """Returns the internal steps of a call, all in one communication step, so that the cost of the communication step itself vanishes."""
    return max(1, round(SPRING_STEPS / springs(side)))


def springs(side: int) -> int:
    return len(spring_list([side] * 3, "distinct")[0])


@row("steps", "an explicit step, 4^3", "numba, a loop over the springs", goal=0.35)
def internal_step() -> Iterator[Pair]:
    """Measures a lattice of 4 x 4 x 4 points."""
    from plain_step import steps_of as plain_steps_of

    scene, count = box(), steps_of(4)
    plain, after = plain_steps_of(scene)
    with Simulation(scene) as simulation:
        simulation.step(50 * STEP)
        require_alike("50 steps", simulation.positions.transpose(2, 1, 0, 3).reshape(-1, 3), after, 1e-12)
        yield Pair(lambda: simulation.step(count * STEP), lambda: plain.run(count, STEP), per=count)


def of_size(side: int, goal: float | None = None) -> None:
    """Adds a row for a lattice: the cost of a spring."""

    @row("steps", f"a spring of {side}^3, each step", "a spring of 4^3", goal=goal)
    def spring() -> Iterator[Pair]:
        own, base = steps_of(side), steps_of(4)
        with Simulation(box(side)) as large, Simulation(box()) as small:
            yield Pair(lambda: large.step(own * STEP), lambda: small.step(base * STEP), per=own * springs(side), per_base=base * springs(4))


of_size(8)
of_size(16)
of_size(32, goal=1.0)


SOLID: dict[str, Any] = {
    "material": {"model": "solid", "youngs_modulus": 10.0, "poissons_ratio": 0.45, "density": 1.0, "stiffness": None},
    "mass": {"total": None},
    "lattice": {"basis": "patches"},
}


def of_solid(side: int, goal: float) -> None:
    """Adds a row for a solid of side x side x side points: an explicit step against an explicit step of springs."""

    @row("steps", f"an explicit step of a solid, {side}^3", "of springs", goal=goal)
    def solid() -> Iterator[Pair]:
        count = steps_of(side)
        with Simulation(box(side, **SOLID)) as own, Simulation(box(side)) as base:
            yield Pair(lambda: own.step(count * STEP), lambda: base.step(count * STEP), per=count)


of_solid(4, goal=0.85)
of_solid(7, goal=0.95)
of_solid(16, goal=1.25)


def of_two_threads(name: str, together: int, goal: float | None = None) -> None:
    """Adds a row for 32^3 points with two threads: 100 internal steps, with `together` of them in a communication step."""

    @row("steps", name, "with one thread, wall time", goal=goal)
    def two_threads() -> Iterator[Pair]:
        """Needs two processors; with one processor there is nothing to measure."""
        with all_processors(2), Simulation(box(32, solver={"threads": 2})) as two, Simulation(box(32)) as one:
            for each in (one, two):
                each.step(STEP)
            yield Pair(*(partial(wall_time, each, 100 // together, together * STEP) for each in (two, one)), per=100)


of_two_threads("32^3 with two threads", 100, goal=1 / 1.7)
of_two_threads("the same, each step a communication step", 1)


def wall_time(simulation: Simulation, steps: int, length: float) -> float:
    began = time.perf_counter()
    for _ in range(steps):
        simulation.step(length)
    return time.perf_counter() - began


@contextmanager
def all_processors(least: int) -> Iterator[None]:
    """Lets this process use all processors instead of one. Raises NotMeasured if there are fewer than `least`."""
    if not hasattr(os, "sched_setaffinity") or (os.cpu_count() or 1) < least:
        raise NotMeasured(f"wants {least} processors")
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, range(os.cpu_count() or 1))
    try:
        if len(os.sched_getaffinity(0)) < least:
            raise NotMeasured(f"wants {least} processors")
        yield
    finally:
        os.sched_setaffinity(0, before)


def implicit_of_size(side: int, **material: Any) -> None:
    """Adds rows for a lattice against the explicit step and SciPy. An implicit step of springs includes assembly, factor and solutions; a
    step of a solid, which is compared with the explicit step only, has solutions alone because it reuses the matrix of earlier steps."""
    h, count, of_solid = 1e-3, 40 if side == 4 else 3, " of a solid" * bool(material)

    def simulation() -> Simulation:
        found = Simulation(box(side, "backward_euler", solver={"method": "backward_euler", "step": h}, **material))
        found.step(h)
        if not any("as set" in message.text and "0.001 s" in message.text for message in found.component.messages):
            raise NotMeasured("steps are not the implicit ones that were asked for")
        return found

    @row("steps", f"an implicit step{of_solid}, {side}^3", f"an explicit step, {side}^3")
    def against_explicit() -> Iterator[Pair]:
        steps = steps_of(side)
        with simulation() as implicit, Simulation(box(side, **material)) as explicit:
            yield Pair(lambda: implicit.step(count * h), lambda: explicit.step(steps * STEP), per=count, per_base=steps)

    if material:
        return

    @row("steps", f"an implicit step, {side}^3, as equations", "numpy and SciPy, banded Cholesky")
    def against_scipy() -> Iterator[Pair]:
        from banded import Banded

        system = Banded(box(side), h)
        with simulation() as implicit:
            yield Pair(lambda: implicit.step(count * h), system.solve, per=count, per_base=1)


implicit_of_size(4)
implicit_of_size(8)
for side in (4, 7, 10, 13):
    implicit_of_size(side, **SOLID)
