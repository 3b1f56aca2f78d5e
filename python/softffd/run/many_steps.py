"""Many communication steps in one call of the library (fmu_src/fmi/calls/many_steps.hpp), where no Python is needed between them."""

from __future__ import annotations

import signal
import threading
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from ctypes import POINTER, Structure, byref, c_int, c_longlong, c_size_t, c_void_p, cast
from functools import cache
from typing import Any

import numpy as np

from softffd.fmu.block import Block
from softffd.fmu.component import Component, Message
from softffd.installed import library_function

PATIENCE = 0.02
"""A call takes about so long [s]: after it Ctrl-C is heard."""


class _Recorded(Structure):
    _fields_ = (("count", c_size_t), ("references", c_void_p), ("values", c_void_p), ("rows", c_void_p))


class _Run(Structure):
    _fields_ = (
        *((name, c_void_p) for name in ("component", "set_real", "get_real", "get_integer", "do_step", "times", "steps")),
        *((name, _Recorded) for name in ("inputs", "reals", "integers")),
        ("done", c_longlong),
    )


class ManySteps:
    """Steps between given times, whose inputs are set from rows and whose outputs go to rows, (T, m) each."""

    def __init__(
        self, component: Component, times: np.ndarray, steps: list[float], rows: dict[str, tuple[Block, np.ndarray]], *, single: bool
    ):
        """times: (T,) [s]. steps: their lengths [s]. rows: a block and its rows for "inputs", "reals", "integers" (int64).
        single: steps are asked for one by one, too short for Ctrl-C to be kept waiting."""
        self._component, self._single = component, single
        self._kept = times, np.array(steps), rows
        self._run = _Run(component.instance, *map(component.address, ("fmi2SetReal", "fmi2GetReal", "fmi2GetInteger", "fmi2DoStep")))
        self._run.times, self._run.steps = self._kept[0].ctypes.data, self._kept[1].ctypes.data
        for name, (block, values) in rows.items():
            references = cast(block.references, c_void_p).value
            setattr(self._run, name, _Recorded(len(block.names), references, block.values.ctypes.data, values.ctypes.data))
        self.together = 1
        """How many at a time take about PATIENCE, as far as is known"""
        self.said: list[tuple[int, Message]] = [(0, message) for message in component.messages]
        """All messages with the step, from 0, in which they came; those before the first step are its own"""

    @property
    def done(self) -> int:
        """Steps that are done and recorded."""
        return int(self._run.done)

    def go_on(self, until: int) -> None:
        """Steps until so many are done; FmuError as `Component.do_step`, where `done` is then the step before."""
        begin, began = self.done, clock.perf_counter()
        with nullcontext() if self._single else _interrupted_afterwards():
            status = _library_many_steps()(byref(self._run), until)
        self._component.check(status)
        took = clock.perf_counter() - began
        if took < PATIENCE / 2:
            self.together = max(self.together, 2 * (until - begin))
        elif took > 2 * PATIENCE:
            self.together = max(1, self.together // 2)

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Meanwhile what the component says is noted in `said`."""
        listener = self._component.listener

        def hear(message: Message) -> None:
            self.said.append((self.done, message))
            if listener:
                listener(message)

        self._component.listener = hear
        try:
            yield
        finally:
            self._component.listener = listener


@contextmanager
def _interrupted_afterwards() -> Iterator[None]:
    """Signals such as Ctrl-C wait until the end: raised where the library calls back to tell something, they would be lost."""
    before = {number: action for number in (signal.SIGINT, signal.SIGTERM) if callable(action := signal.getsignal(number))}
    if threading.current_thread() is not threading.main_thread() or not before:
        yield
        return
    heard: list[Any] = []
    for number in before:
        signal.signal(number, lambda *told: heard.append(told))
    try:
        yield
    finally:
        for number, action in before.items():
            signal.signal(number, action)
        if heard:
            before[heard[-1][0]](*heard[-1])


@cache
def _library_many_steps() -> Any:
    function = library_function("softffd_many_steps")
    function.argtypes, function.restype = [POINTER(_Run), c_longlong], c_int
    return function
