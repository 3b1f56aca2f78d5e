"""Runs jobs that may hang or crash in separate processes, so that a hang or a crash is a result and does not end the program."""

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
"""Time allowed for the start of a process [s]"""
GRACE = 0.5
"""If all processes are terminated together, this process ends at most this much later than the others [s]. A wait of this length makes the
jobs count as interrupted, not as lost."""
LONGEST_FOLDER = 74
"""Longest path of the folder for temporary files [bytes]. The fork server's socket in that folder adds 33; Linux limits its path to 107."""

Work = Callable[[Sequence[Any]], Iterator[Any]]


@dataclass(frozen=True)
class Lost:
    """The reason why a job has no result."""

    how: str
    """ "hang", "crash" or "fault" (an exception of the measuring program)"""
    words: str


def guarded(
    work: Work, jobs: Sequence[Any], patience: Callable[[Any], float], processes: int = 1, together: int = 8
) -> Iterator[tuple[Any, Any]]:
    """Yields each job with its result, in order if there is one process. work(jobs) yields the results in another process, in which work
    and jobs must be importable.

    patience(job): time limit [s]. A job above the limit is Lost as a hang, and a job that ends the process is Lost as a crash. The jobs
    after a lost job go to a new process. together: number of jobs that one of several processes runs one after the other. Leaving the
    iteration early ends the processes. Raises SoftffdError if processes < 1."""
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
    """Jobs for one process at a time. A new process starts after each lost job."""

    def __init__(self, work: Work, jobs: Sequence[Any], patience: Callable[[Any], float]):
        self._work, self.left, self._patience = work, list(jobs), patience

    def begin(self) -> None:
        context: Any = multiprocessing.get_context(_way(self._work))
        self.results, sender = context.Pipe(duplex=False)
        self._scratch = tempfile.TemporaryDirectory(prefix="softffd-", ignore_cleanup_errors=True)
        """Folder for the temporary files of the process, which may have no time to remove them"""
        self._process = context.Process(target=_serve, args=(self._work, self.left, sender, self._scratch.name), daemon=True)
        with _no_script():
            self._process.start()
        sender.close()
        self._started = False
        self._allow(START_UP)

    def _allow(self, seconds: float) -> None:
        self._allowed, self.deadline = seconds, clock.monotonic() + seconds

    def news(self, ready: bool) -> list[tuple[Any, Any]]:
        """Returns a job with its result, or nothing if the process has just reported its start. ready: the process has sent a message."""
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
        except (EOFError, OSError):  # the process ended, between messages or within a message
            self._process.join()
            if self._process.exitcode == -signal.SIGTERM:
                clock.sleep(GRACE)
            return Lost("crash", f"the process ended with status {self._process.exitcode}")


def _way(work: Work) -> str:
    """Returns the fastest safe start method: a fork from a server that has imported the module of the work, where available, else spawn."""
    long = len(os.fsencode(tempfile.gettempdir())) > LONGEST_FOLDER
    if "forkserver" not in multiprocessing.get_all_start_methods() or sys.platform == "darwin" or long:
        return "spawn"
    multiprocessing.set_forkserver_preload([getattr(work, "func", work).__module__])
    return "forkserver"


@contextmanager
def _no_script() -> Iterator[None]:
    """Keeps a process that starts in this context from running the user's script again, which need not be written for that."""
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
