"""Saved moments of a simulation, in memory and as bytes."""

from __future__ import annotations

import struct
from typing import NoReturn

from softffd.errors import FmuError
from softffd.fmu.component import Component

HEAD = struct.Struct("<8sd?")
"""Before the FMU's own bytes of a state: a mark, the time [s], whether the first step is still to come"""
MARK = b"softffd1"


class State:
    """A moment of a simulation, made by `Simulation.save`. `bytes(state)` goes to a file or another process.

    It is freed with the last reference to it, or with the simulation.
    """

    def __init__(self, component: Component, time: float, initializing: bool):
        self.component, self.handle = component, component.get_state()
        self.time, self.initializing = time, initializing

    def __bytes__(self) -> bytes:
        return HEAD.pack(MARK, self.time, self.initializing) + self.component.state_bytes(self.handle)

    def __reduce__(self) -> NoReturn:
        raise FmuError("a State belongs to its simulation: bytes(state) is what is pickled and copied, and what restore takes elsewhere")

    def __del__(self) -> None:
        if hasattr(self, "handle"):
            self.component.free_state(self.handle)


def taken_apart(data: bytes) -> tuple[float, bool, bytes]:
    """Time [s], whether the first step is still to come, and the FMU's own bytes of a state's bytes; FmuError for others."""
    if len(data) < HEAD.size or not data.startswith(MARK):
        raise FmuError(f"restore: wanted a state of Simulation.save or its bytes, got {data[:20]!r}")
    _, time, initializing = HEAD.unpack_from(data)
    return time, initializing, data[HEAD.size :]
