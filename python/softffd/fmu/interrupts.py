"""Blocks in which interrupts wait."""

import signal
import threading
from collections.abc import Callable
from typing import Any

NUMBERS = (int(signal.SIGINT), int(signal.SIGTERM))
_PLAIN: Any = getattr(signal, "_signal", signal)
"""The functions without the wrappers that turn actions into enumerations, which take fifty times as long in Python 3.11"""


class Undisturbed:
    """A context manager that delays signals such as Ctrl-C until its block ends: raised while the library calls back to report, they would
    be lost."""

    def __init__(self, then: Callable[[], None]):
        """then: called at the end of the block, before the signals are."""
        self._then = then
        self._before: list[tuple[int, Any]] = []
        self._heard: list[tuple[Any, ...]] = []

    def __enter__(self) -> None:
        if threading.current_thread() is threading.main_thread():
            self._before = [(number, action) for number in NUMBERS if callable(action := _PLAIN.getsignal(number))]
            for number, _ in self._before:
                _PLAIN.signal(number, self._hear)

    def _hear(self, *told: Any) -> None:
        self._heard.append(told)

    def __exit__(self, *_exception: object) -> None:
        try:
            self._then()
        finally:
            for number, action in self._before:
                _PLAIN.signal(number, action)
            if self._heard:
                dict(self._before)[self._heard[-1][0]](*self._heard[-1])
