"""Runs what may hang or crash in a process of its own, so that a hang or a crash is a result and not the end."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import tempfile
import time as clock
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait
from types import ModuleType
from typing import Any

from softffd.errors import SoftffdError

START_UP = 60.0
"""A process gets this long to start [s]."""
GRACE = 0.5
"""So much later [s] than the processes, at most, is this one terminated where all are: then their jobs are not lost, but interrupted."""
LONGEST_FOLDER = 74
"""Bytes of the folder for temporary files: the server's socket lies in it, in 33 bytes more, and Linux gives the path of a socket 107."""

Work = Callable[[Sequence[Any]], Iterator[Any]]


@dataclass(frozen=True)
class Lost:
    """No result: why."""

    how: str
    """ "hang", "crash" or "fault" (of the program that measures)"""
    words: str


def guarded(
    work: Work, jobs: Sequence[Any], patience: Callable[[Any], float], processes: int = 1, together: int = 8
) -> Iterator[tuple[Any, Any]]:
    """Each job with its result, in order if there is one process. work(jobs) yields them elsewhere; both must be importable there.

    patience(job): a job that takes longer [s] is Lost as a hang; one that takes the process down is Lost as a crash. The jobs after it
    go to a new process. together: jobs that one of several processes runs one after the other. Leaving the iteration early ends the
    processes. SoftffdError if there are none.
    """
    if processes < 1:
        raise SoftffdError(f"--jobs {processes}: wanted at least 1")
    size = max(1, len(jobs) if processes == 1 else together)
    waiting = [_Batch(work, jobs[first : first + size], patience) for first in range(0, len(jobs), size)][::-1]
    running: list[_Batch] = []
    try:
        while waiting or running:
            while waiting and len(running) < processes:
                waiting[-1].begin()
                running.append(waiting.pop())
            earliest = min(batch.deadline for batch in running)
            ready = set(wait([batch.results for batch in running], max(0.0, earliest - clock.monotonic())))
            for batch in list(running):
                if batch.results in ready or clock.monotonic() >= batch.deadline:
                    yield from batch.news(batch.results in ready)
                if not batch.left:
                    running.remove(batch)
                    batch.end()
    finally:
        for batch in running:
            batch.end()


class _Batch:
    """Jobs for one process after another: a new one after each that is lost."""

    def __init__(self, work: Work, jobs: Sequence[Any], patience: Callable[[Any], float]):
        self._work, self.left, self._patience = work, list(jobs), patience

    def begin(self) -> None:
        context: Any = multiprocessing.get_context(_way(self._work))
        self.results, sender = context.Pipe(duplex=False)
        self._scratch = tempfile.TemporaryDirectory(prefix="softffd-", ignore_cleanup_errors=True)
        """The process's temporary files, which it may have no time to remove"""
        self._process = context.Process(target=_serve, args=(self._work, self.left, sender, self._scratch.name), daemon=True)
        with _no_script():
            self._process.start()
        sender.close()
        self._started = False
        self._allow(START_UP)

    def _allow(self, seconds: float) -> None:
        self._allowed, self.deadline = seconds, clock.monotonic() + seconds

    def news(self, ready: bool) -> list[tuple[Any, Any]]:
        """A job with its result, or nothing when the process has just told that it is up. ready: it has told something."""
        result = self._told() if ready else Lost("hang", f"no answer within {self._allowed:g} s")
        lost, news = isinstance(result, Lost), [(self.left[0], result)]
        if lost or self._started:
            self.left.pop(0)
        else:
            self._started, news = True, []
        if lost and self.left:
            self.end()
            self.begin()
        elif self.left:
            self._allow(self._patience(self.left[0]))
        return news

    def end(self) -> None:
        self._process.kill()
        self._process.join()
        self.results.close()
        self._scratch.cleanup()

    def _told(self) -> Any:
        try:
            return self.results.recv()
        except (EOFError, OSError):  # it ended, between messages or within one
            self._process.join()
            if self._process.exitcode == -signal.SIGTERM:
                clock.sleep(GRACE)
            return Lost("crash", f"the process ended with status {self._process.exitcode}")


def _way(work: Work) -> str:
    """The quickest safe way to start a process: forked from a server that has what the work needs imported, where there is such a thing."""
    long = len(os.fsencode(tempfile.gettempdir())) > LONGEST_FOLDER
    if "forkserver" not in multiprocessing.get_all_start_methods() or sys.platform == "darwin" or long:
        return "spawn"
    multiprocessing.set_forkserver_preload([getattr(work, "func", work).__module__])
    return "forkserver"


@contextmanager
def _no_script() -> Iterator[None]:
    """A process that starts meanwhile does not run the user's script again, which need not be made for that."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


def _serve(work: Work, jobs: list[Any], sender: Any, scratch: str) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends this process
    tempfile.tempdir = scratch
    sender.send(None)
    try:
        for result in work(jobs):
            sender.send(result)
    except Exception:
        sender.send(Lost("fault", traceback.format_exc(limit=-2).strip()))
