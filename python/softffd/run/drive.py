"""The communication points of a run, and the steps from each point to the next.

The library does many steps in one call where no Python is needed between them (fmu_src/fmi/calls/many_steps.hpp).
"""

from __future__ import annotations

import math
import os
import time as clock
from collections.abc import Iterator, Sequence
from ctypes import POINTER, Structure, byref, c_int, c_longlong, c_size_t, c_void_p, cast
from typing import Any

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.block import Block, Blocks
from softffd.fmu.interface import ScalarVariable
from softffd.installed import library_function
from softffd.run.simulation import SLIVER, Simulation
from softffd.spelling import one_number

GIVEN_BY = {"communication step": "--step H, in Python step=H", "stop time": "--stop-time T, in Python stop_time=T"}
"""How a user gives a value for which an FMU has no default."""
NUMBERS = ("Real", "Integer", "Boolean")  # kinds of variables in a result, which holds Booleans as 0 and 1
PATIENCE = 0.02  # approximate duration of a call of the library [s]; Ctrl-C takes effect after the call


def positive(what: str, given: float | None, default: Any, *, after: float = 0.0) -> float:
    """Returns the given value, else the default, if it is a finite number > `after` [s]; FmuError says what is wrong otherwise.

    what: "communication step" or "stop time".
    """
    wanted = f"wanted > {after:g} s{', the start time' if after else ''}"
    if given is None and default is None:
        raise FmuError(f"{what}: {wanted}, got none; the FMU has no default: give {GIVEN_BY[what]}")
    value = one_number(what, default if given is None else given)
    if not (math.isfinite(value) and value > after):
        source = "given" if given is not None else "in the FMU's default experiment"
        raise FmuError(f"{what}: {wanted}, got {value:g} ({source})")
    return value


def communication_points(stop_time: float, step: float, start_time: float = 0.0, *, bytes_each: int) -> np.ndarray:
    """Returns the start time, the multiples of `step` after it, and the stop time: (T,) [s]. A remainder that is one of rounding belongs
    to the last step. FmuError if the values that a run keeps of all points, `bytes_each` for each point, would not fit into this
    machine's memory, and if times so late have no room for the steps."""
    count = (stop_time - start_time) / step
    if not count * bytes_each <= memory():
        raise FmuError(
            f"communication step {step:g} s and stop time {stop_time:g} s make {count:.3g} communication points, whose result would take "
            f"{count * bytes_each / 1e9:.3g} GB; wanted at most {memory() / 1e9:.3g} GB, this machine's memory: "
            "take a longer step, a shorter stop time or fewer outputs"
        )
    times = np.append(start_time + step * np.arange(max(1, math.ceil(count - max(SLIVER, 1e-9 * count)))), stop_time)
    if not (np.diff(times) > 0).all():
        raise FmuError(
            f"communication step: wanted one that changes the time, {start_time:g} to {stop_time:g} s, got {step:g} s: take a longer step, "
            "or an earlier start time"
        )
    return times


def memory() -> float:
    """Returns the memory of this machine [bytes]; 16 GB if the system does not report it."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return 16e9


def step_lengths(times: np.ndarray, step: float) -> list[float]:
    """Returns the lengths of the steps between the times: the same double for all steps but the last, if that has another length."""
    last = float(times[-1] - times[-2])
    whole = math.isclose(last, step, rel_tol=1e-9, abs_tol=4 * float(np.spacing(abs(times).max())))
    return [step] * (len(times) - 2) + [step if whole else last]


class _Recorded(Structure):
    _fields_ = (("count", c_size_t), ("references", c_void_p), ("values", c_void_p), ("rows", c_void_p))

    @classmethod
    def of(cls, block: Block, rows: np.ndarray) -> _Recorded:
        return cls(len(block.names), cast(block.references, c_void_p).value, block.values.ctypes.data, rows.ctypes.data)


class _ManySteps(Structure):
    _fields_ = (
        *((name, c_void_p) for name in ("component", "set_real", "get_real", "get_integer", "do_step", "times", "steps")),
        *((name, _Recorded) for name in ("inputs", "reals", "integers")),
        ("done", c_longlong),
    )


class Drive:
    """The steps of a run between given times. Inputs are set from rows and outputs are written to rows, of numbers (T, m). After a restart
    of the simulation, a drive can do its steps again.

    The library sets held inputs that are Reals when it does many steps at once; the host sets inputs of other kinds, and reads Booleans.
    """

    def __init__(
        self, simulation: Simulation, times: np.ndarray, step: float, inputs: Sequence[ScalarVariable], outputs: Sequence[ScalarVariable],
        *, single: bool = False,
    ):  # fmt: skip
        """times: (T,) [s], each a `step` [s] after the one before, the last perhaps less. single: one step in each call of the library."""
        component = self._component = simulation.component
        self._simulation, self.times, self._steps = simulation, times, np.array(step_lengths(times, step))
        self.inputs, self.input_rows = Blocks(component.calls, inputs), np.zeros((len(times), len(inputs)))
        self.outputs: dict[str, tuple[Block, np.ndarray]] = {}  # block and rows of the outputs of each kind
        for kind in NUMBERS:
            block = component.block_of([variable for variable in outputs if variable.kind == kind])
            self.outputs[kind] = block, np.zeros((len(times), len(block.names)), float if kind == "Real" else np.int64)
        reals = None if single or self.outputs["Boolean"][0].names else self.inputs.real
        self._single, self._set = reals is None, reals or component.block_of([])
        calls = map(component.address, ("fmi2SetReal", "fmi2GetReal", "fmi2GetInteger", "fmi2DoStep"))
        self._many = _ManySteps(component.instance, *calls, times.ctypes.data, self._steps.ctypes.data)
        self._many.inputs = _Recorded.of(self._set, self.input_rows)
        self._many.reals, self._many.integers = (_Recorded.of(*self.outputs[kind]) for kind in ("Real", "Integer"))
        self._together = 1  # number of steps that take about PATIENCE, as far as is known

    @property
    def done(self) -> int:
        """Number of steps that are done and recorded."""
        return int(self._many.done)

    def columns(self) -> dict[str, np.ndarray]:
        """Returns the outputs by name, (steps done + 1,) each."""
        pairs = ((block.names, rows[: self.done + 1]) for block, rows in self.outputs.values())
        return {name: column for names, rows in pairs for name, column in zip(names, rows.T, strict=True)}

    def fill(self, first: int, until: int) -> None:
        """Puts the inputs of some steps into their rows; here the rows hold the inputs from the beginning."""

    def apply(self, row: int) -> None:
        """Hands over the inputs of a row. The inputs of the first row have to be handed over before the initialization ends."""
        if self.inputs.names:
            self.inputs.set(self.input_rows[row])

    def retune(self, row: int) -> int:
        """Hands over the tunable parameters that change in a row; returns the next row in which some change, here none."""
        return len(self._steps)

    def run(self, *, most: int | None = None) -> Iterator[int]:
        """Does all steps of an initialized simulation; yields the number of steps done, at multiples of `most` at the latest.

        FmuError as from `Component.do_step`; `done` then counts the steps before the failure.
        """
        self._many.done, last, times = 0, len(self._steps), self.times.tolist()
        for block, rows in self.outputs.values():
            rows[0] = block.get()
        try:
            while self.done < last:
                until = self.done + 1 if self._single else min(last, self.done + self._together)
                until = min(until, (self.done // most + 1) * most) if most else until
                until = min(until, self.retune(self.done))
                self.fill(max(1, self.done), until)
                if self._single and self.done:
                    self.apply(self.done)
                self.go_on(until)
                self._simulation.time = times[until]
                yield until
        finally:
            self._simulation.time = times[self.done]

    def go_on(self, until: int) -> None:
        """Does steps until `until` steps are done, in one call of the library."""
        begin, began = self.done, clock.perf_counter()
        with self._component.undisturbed():
            status = library_function("softffd_many_steps", c_int, POINTER(_ManySteps), c_longlong)(byref(self._many), until)
            self._component.check(status)
            booleans, truths = self.outputs["Boolean"]
            if booleans.names:
                truths[until] = booleans.get()
        took = clock.perf_counter() - began
        if took < PATIENCE / 2:
            self._together = max(self._together, 2 * (until - begin))
        elif took > 2 * PATIENCE:
            self._together = max(1, self._together // 2)
