"""Callbacks for fmpy's slaves. Its default ones go through a logger that fmpy shares between runs and that dangles after
simulate_fmu(logger=...); these are the slave's own."""

from fmpy import calloc, free
from fmpy.fmi2 import (
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)


def own_callbacks(messages: list[str]) -> fmi2CallbackFunctions:
    """Appends the text of every message to `messages`."""

    def note(_environment, _instance, _status, _category, message: bytes) -> None:
        messages.append(message.decode())

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = fmi2CallbackLoggerTYPE(note)
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    return callbacks
