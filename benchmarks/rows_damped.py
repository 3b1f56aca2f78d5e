"""A damped box beside an obstacle: runs by `auto` against explicit steps, per second of run, and the cost of a stage of SDIRK2.

The box is 0.1 x 0.1 x 0.05 m, has 0.5 kg, 4^3 points and 1e6 N/m, or is a solid; friction is 0.5. A run by `auto` lasts 0.2 s. The cost of
explicit steps is constant along a run, and the whole run would take up to a minute. Explicit steps therefore cover only the first
milliseconds, at whose end both runs have to agree within the tolerance.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from boxes import STEP, box
from measured import NotMeasured, Pair, require_alike, row
from rows_steps import steps_of

from softffd import Simulation
from softffd.scene.scene import Scene, scene_from

SIZE, TOLERANCE = (0.1, 0.1, 0.05), 1e-4
SPRINGS = {"stiffness": 1e6, "damping": 0.0}
LATTICE = {"size": SIZE, "origin": [0.0, 0.0, 0.0]}
STOP, COMMUNICATION_STEP = 0.2, 5e-3
STRETCHES = {1e-4: 4, 1e-3: 1}
"""Communication steps of the explicit runs, by internal damping [s]"""

Drive = Callable[[Simulation, int], None]
"""Sets the inputs of a run for the communication step with a given number"""


def stay(_simulation: Simulation, _number: int) -> None:
    """Sets no inputs."""


def press(simulation: Simulation, _number: int) -> None:
    """Presses the upper face down."""
    simulation.load["weight"] = [0.0, 0.0, -500.0]


def lead(simulation: Simulation, number: int) -> None:
    """Prescribes the motion of the pinned upper face: 0.2 mm down within 10 ms, and sideways by 1 mm at 20 Hz."""
    begin, end = (_led_place(n * COMMUNICATION_STEP) for n in (number, number + 1))
    simulation.pin["finger"].position = begin
    simulation.pin["finger"].velocity = (end - begin) / COMMUNICATION_STEP


def _led_place(time: float) -> np.ndarray:
    sideways, down = 1e-3 * math.sin(2 * math.pi * 20 * time), 2e-4 * min(time / 0.01, 1.0)
    return np.array([SIZE[0] / 2 + sideways, SIZE[1] / 2, SIZE[2] - down])


def scene_of(internal_damping: float, material: dict[str, Any] = SPRINGS, **sections: Any) -> Scene:
    return scene_from(
        {
            "lattice": LATTICE,
            "mass": {"total": 0.5},
            "material": material | {"internal_damping": internal_damping},
            "environment": {"gravity": [0.0, 0.0, -9.81]},
            "outputs": {"positions": "all"},
            "solver": {"tolerance": TOLERANCE},
            **sections,
        }
    )


def run(simulation: Simulation, method: str, drive: Drive, steps: int) -> float:
    """Returns the processor time [s] of `steps` communication steps from the start."""
    simulation.restart(method=method)
    simulation.initialize()
    began = time.process_time()
    for number in range(steps):
        drive(simulation, number)
        simulation.step(COMMUNICATION_STEP)
    return time.process_time() - began


def of_scene(name: str, drive: Drive, goals: dict[float, float | None], **sections: Any) -> None:
    """Adds a row for each internal damping [s] in `goals`: the cost of a second of run, by `auto` and in explicit steps."""
    for internal_damping, goal in goals.items():

        @row("damped contact", f"{name}, tau {1e3 * internal_damping:g} ms", "explicit steps, a second of run", goal=goal, every_set=False)
        def second(internal_damping: float = internal_damping) -> Iterator[Pair]:
            stretch = STRETCHES[internal_damping]
            with Simulation(scene_of(internal_damping, **sections)) as simulation:
                own, base = (partial(run, simulation, method, drive) for method in ("auto", "leapfrog"))
                places = []
                for either in (own, base):
                    either(stretch)
                    places.append(simulation.positions.copy())
                require_alike("the run", *places, TOLERANCE * max(SIZE))
                whole = round(STOP / COMMUNICATION_STEP)
                yield Pair(
                    partial(own, whole), partial(base, stretch), per=whole * COMMUNICATION_STEP, per_base=stretch * COMMUNICATION_STEP
                )


PLANE = [{"name": "ground", "friction": 0.5}]
of_scene("hangs from a face", stay, {1e-4: None, 1e-3: None}, pin=[{"name": "finger", "points": "z+"}])
of_scene("rests", stay, {1e-4: 1 / 50, 1e-3: 1 / 200}, plane=PLANE)
of_scene("slides", stay, {1e-4: 1 / 50, 1e-3: 1 / 200}, plane=PLANE, initial={"velocity": [0.3, 0.0, 0.0]})
of_scene("is pressed", press, {1e-4: 1 / 50, 1e-3: 1 / 200}, plane=PLANE, load=[{"name": "weight", "points": "z+"}])
LED = {"plane": PLANE, "pin": [{"name": "finger", "points": "z+", "motion": "input"}], "environment": {"gravity": [0.0, 0.0, 0.0]}}
of_scene("is led by a face", lead, {1e-4: 1 / 50, 1e-3: 1 / 1000}, **LED)


def rubber(modulus: float) -> dict[str, Any]:
    """Returns the sections that make the box a solid. modulus: [Pa]."""
    return {"material": {"model": "solid", "youngs_modulus": modulus, "poissons_ratio": 0.45, "density": 1000.0}, "mass": {}}


of_scene("a solid is led by a face", lead, {1e-3: None}, **LED, **rubber(40e6))
of_scene("a solid of 7 x 7 x 4 rests", stay, {1e-3: None}, plane=PLANE, lattice=LATTICE | {"cells": 6}, **rubber(1e6))


def explicit_step(name: str, material: dict[str, Any], **sections: Any) -> None:
    """Adds a row for an explicit step with an internal damping of 10 us. The program chooses the step; the body swings from a face."""

    @row("damped contact", f"an explicit step, {name}", "without internal damping", goal=2.3)
    def damped() -> Iterator[Pair]:
        bodies = [
            scene_from(
                {
                    "lattice": {"size": [0.1] * 3, "origin": [0.0] * 3},
                    "material": material | damping,
                    "environment": {"gravity": [0.0, 0.0, -9.81]},
                    "pin": [{"name": "finger", "points": "z+"}],
                    "outputs": {"solver": True},
                    "solver": {"method": "leapfrog", "tolerance": 1e-8},
                    **sections,
                }
            )
            for damping in ({"internal_damping": 1e-5}, {})
        ]
        with Simulation(bodies[0]) as own, Simulation(bodies[1]) as base:
            counts = []
            for each in (own, base):
                each.step(0.2)
                counts.append(int(each.number("solver.steps")))
            yield Pair(partial(call, own), partial(call, base), per=counts[0], per_base=counts[1])


def call(simulation: Simulation) -> float:
    """Returns the processor time [s] of a communication step of 0.2 s from the start."""
    simulation.restart()
    simulation.initialize()
    began = time.process_time()
    simulation.step(0.2)
    return time.process_time() - began


explicit_step("springs", {"stiffness": 1e3, "damping": 0.0}, mass={"total": 0.5})
explicit_step("a solid", {"model": "solid", "youngs_modulus": 1e5, "poissons_ratio": 0.45, "density": 500.0})


def stage_of_size(side: int, seconds: float | None, sliding: Callable[[int, float], Scene], name: str = "") -> None:
    """Adds a row for a lattice whose lower face slides on a plane: half a step of SDIRK2, which has two stages."""
    h, count, touching = 1e-3, 40 if side == 4 else 3, side * side

    @row("damped contact", f"a stage, {name}{side}^3, {touching} touching", f"an explicit step, {side}^3", seconds=seconds)
    def stage() -> Iterator[Pair]:
        steps = steps_of(side)
        with Simulation(sliding(side, h)) as implicit, Simulation(box(side)) as explicit:
            implicit.step(20 * h)
            require_stages(implicit, touching, lambda: implicit.step(count * h), count)
            yield Pair(lambda: implicit.step(count * h), lambda: explicit.step(steps * STEP), per=2 * count, per_base=steps)


def springs(side: int, step: float) -> Scene:
    return box(
        side,
        plane=[{"name": "ground", "friction": 0.3}],
        environment={"gravity": [4.0, 0.0, -9.81]},
        material={"stiffness": 1e6, "internal_damping": 1e-3},
        lattice={"size": [1.0] * 3, "origin": [0.0] * 3},
        initial={"stretch": [1.0] * 3},
        outputs={"solver": True},
        solver={"method": "sdirk2", "step": step},
    )


def solid(side: int, step: float) -> Scene:
    return scene_from(
        {
            "lattice": {"points": [side] * 3, "size": [1.0, 1.0, 0.3], "origin": [0.0] * 3},
            "plane": [{"name": "ground", "friction": 0.3}],
            "environment": {"gravity": [4.0, 0.0, -9.81]},
            "material": {"model": "solid", "youngs_modulus": 1e6, "poissons_ratio": 0.3, "density": 1.0, "internal_damping": 1e-3},
            "outputs": {"solver": True, "reactions": False, "positions": "all"},
            "solver": {"method": "sdirk2", "step": step},
        }
    )


def require_stages(simulation: Simulation, touching: int, call: Callable[[], object], steps: int) -> None:
    """Raises NotMeasured unless a call makes `steps` steps of two stages with `touching` points in contact in each stage."""
    before = [simulation[f"solver.{what}"] for what in ("steps", "contacts_resolved")]
    call()
    taken, resolved = (simulation[f"solver.{what}"] - was for what, was in zip(("steps", "contacts_resolved"), before, strict=True))
    if taken != steps or resolved != 2 * steps * touching:
        raise NotMeasured(f"{taken:g} steps with {resolved:g} contacts, wanted {steps} of two stages with {touching}")


stage_of_size(4, 100e-6, springs)
stage_of_size(8, 5e-3, springs)
stage_of_size(4, None, solid, "a solid, ")
