"""A progress line on stderr, where somebody is there to see it."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

Note = Callable[[str], None]
"""Is told in words how far something is, as `ProgressLine.note` and `.say` are."""


def silent(_text: str) -> None:
    """A Note for nobody."""


class ProgressLine:
    """Shows share and simulated time of a run; silent where stderr is no terminal. Use as a context manager and as a callback."""

    def __init__(self, what: str):
        self._what = what
        self._shown = 0.0
        self._visible = sys.stderr.isatty()

    def __enter__(self) -> ProgressLine:
        return self

    def __call__(self, share: float, simulated: float) -> None:
        """share in 0..1, simulated time [s]."""
        self.note(f"{share:4.0%}, {simulated:.3g} s", at_once=share >= 1)

    def note(self, text: str, *, at_once: bool = False) -> None:
        """Shows other words for how far it is; several within a tenth of a second show as the first of them."""
        now = time.monotonic()
        if self._visible and (now - self._shown > 0.1 or at_once):
            self._shown = now
            print(f"\r{self._what}: {text}\033[K", end="", file=sys.stderr, flush=True)

    def say(self, text: str) -> None:
        """Prints a line to stdout where the progress line was."""
        self._clear()
        print(text, flush=True)

    def _clear(self) -> None:
        if self._visible and self._shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def __exit__(self, *_exception: object) -> None:
        self._clear()
