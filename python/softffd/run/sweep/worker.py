"""The runs of a sweep: one component, opened once, reset between them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.block import KINDS, Blocks
from softffd.run.simulation import Simulation
from softffd.run.sweep.plan import END, Plan
from softffd.run.times import step_lengths

FOLD: dict[str, Callable[[np.ndarray], Any]] = {END: lambda column: column[-1], "max": np.max, "min": np.min, "mean": np.mean}


def run_all(plan: Plan, indices: Sequence[tuple[int, ...]]) -> Iterator[np.ndarray | str]:
    """Of each run of the grid its readings (r,), or the words of what failed. After a failure the component is opened anew."""
    if plan.folder:
        os.chdir(plan.folder)
    runner: Runner | None = None
    try:
        for index in indices:
            result: np.ndarray | str
            try:
                runner = runner or Runner(plan)
                result = runner.run(plan.start(index))
            except FmuError as error:
                result = str(error)
                if runner:
                    runner.close()
                runner = None
            yield result
    finally:
        if runner:
            runner.close()


class Runner:
    """An opened component with the buffers of its runs."""

    def __init__(self, plan: Plan):
        self._plan = plan
        self._simulation = Simulation(plan.source)
        component = self._simulation.component
        variables = list(dict.fromkeys(component.variable(reading.name) for reading in plan.readings))
        self._inputs = Blocks(component, [component.variable(name) for name in plan.driven])
        self._blocks = [component.block_of(some) for kind in KINDS if (some := [v for v in variables if v.kind == kind])]
        self._times = plan.times.tolist()
        self._steps = step_lengths(plan.times, plan.step)
        self._rows = [np.zeros((len(self._times), len(block.names))) for block in self._blocks]
        self._follows = any(reading.fold != END for reading in plan.readings)
        self.close = self._simulation.close

    def run(self, start_values: dict[str, Any]) -> np.ndarray:
        """The readings of one run from its start; the bits are those of `simulate`. FmuError with the time where it fails."""
        simulation, plan = self._simulation, self._plan
        simulation.restart(start_values=start_values, stop_time=plan.stop_time, **plan.settings)
        self._drive(0)
        simulation.initialize()
        try:
            for row, step in enumerate(self._steps):
                if row:
                    self._drive(row)
                if self._follows:
                    self._record(row)
                simulation.step(step, end=self._times[row + 1])
        except FmuError as error:
            raise FmuError(f"at {simulation.time:g} s: {error}") from None
        self._record(-1)
        columns = {name: rows[:, n] for block, rows in zip(self._blocks, self._rows, strict=True) for n, name in enumerate(block.names)}
        return np.array([FOLD[reading.fold](columns[reading.name]) for reading in plan.readings], dtype=float)

    def _drive(self, row: int) -> None:
        if self._inputs.names:
            self._inputs.set(self._plan.course[row])

    def _record(self, row: int) -> None:
        for block, rows in zip(self._blocks, self._rows, strict=True):
            rows[row] = block.get()
