"""A progress line on stderr; where stderr is no terminal, a line now and then during what takes long."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable

Note = Callable[[str], None]  # takes words for how far something is, as `ProgressLine.note` and `.say` do
QUIET = 2.0  # after this time without news [s], the line shows how long the stage has taken so far
NOW_AND_THEN = 60.0  # interval of these reports where stderr is no terminal [s]


def silent(_text: str) -> None:
    """A Note that drops the text."""


class ProgressLine:
    """Shows what is being done and how far it is. Use as a context manager and as a callback."""

    def __init__(self, what: str):
        self._visible = sys.stderr.isatty()
        self._lock = threading.RLock()
        self._over = threading.Event()
        self._what, self._text, self._shown, self._began = what, "...", 0.0, time.monotonic()
        self._told = self._began

    def __enter__(self) -> ProgressLine:
        if self._visible:
            self.stage(self._what)
        threading.Thread(target=self._tick, daemon=True).start()
        return self

    def stage(self, what: str) -> None:
        """Begins another stage, in which `what` is done."""
        with self._lock:
            self._what, self._text, self._began = what, "...", time.monotonic()
            self._show(self._text)

    def __call__(self, share: float, simulated: float) -> None:
        """Shows the fraction done, in 0..1, the simulated time [s] and the time left."""
        took = time.monotonic() - self._began
        left = f", {took * (1 - share) / share:.0f} s left" if took > QUIET and 0 < share < 1 else ""
        self.note(f"{share:4.0%}, {simulated:.3g} s{left}", at_once=share >= 1)

    def note(self, text: str, *, at_once: bool = False) -> None:
        """Shows another text for how far it is; of several texts within a tenth of a second the first is shown."""
        with self._lock:
            self._text = text
            if time.monotonic() - self._shown > 0.1 or at_once:
                self._show(text)

    def say(self, text: str) -> None:
        """Prints a line to stdout where the progress line was."""
        with self._lock:
            self._clear()
            print(text, flush=True)

    def _show(self, text: str) -> None:
        if self._visible:
            self._shown = time.monotonic()
            print(f"\r{self._what}: {text}\033[K", end="", file=sys.stderr, flush=True)

    def _tick(self) -> None:
        while not self._over.wait(QUIET / 2):
            with self._lock:
                now = time.monotonic()
                if not self._visible and now - self._told > NOW_AND_THEN:
                    self._told = now
                    print(f"{self._what}: {self._text.strip()} ({now - self._began:.0f} s so far)", file=sys.stderr, flush=True)
                if self._visible and now - self._shown > 0.9 * QUIET and not self._over.is_set():
                    self._show(f"{self._text} ({now - self._began:.0f} s so far)")

    def _clear(self) -> None:
        if self._visible and self._shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def __exit__(self, *_exception: object) -> None:
        with self._lock:
            self._over.set()
            self._clear()
