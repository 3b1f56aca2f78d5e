"""Runs what may hang or crash in a process of its own, so that a hang or a crash is a result and not the end."""

from __future__ import annotations

import multiprocessing
import signal
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

START_UP = 60.0
"""A process gets this long to start [s]."""


@dataclass(frozen=True)
class Lost:
    """No result: why."""

    how: str
    """ "hang", "crash" or "fault" (of the program that measures)"""
    words: str


def guarded(work: Callable[[Sequence[Any]], Iterator[Any]], jobs: Sequence[Any], patience: Callable[[Any], float]) -> Iterator[Any]:
    """One result per job, in order. work(jobs) yields them in another process; both must be importable there.

    patience(job): a job that takes longer [s] is Lost as a hang; one that takes the process down is Lost as a crash. The jobs after it
    go to a new process. Leaving the iteration early ends the process.
    """
    left = list(jobs)
    while left:
        with _Process(work, left) as process:
            while left:
                result = process.next(patience(left[0]))
                left.pop(0)
                yield result
                if isinstance(result, Lost):
                    break


class _Process:
    def __init__(self, work, jobs):
        context = multiprocessing.get_context(_way())
        self._results, sender = context.Pipe(duplex=False)
        self._process = context.Process(target=_serve, args=(work, jobs, sender), daemon=True)
        self._process.start()
        sender.close()
        self._ready = False

    def next(self, patience: float) -> Any:
        if not self._ready:
            first = self._receive(START_UP)
            if isinstance(first, Lost):
                return first
            self._ready = True
        return self._receive(patience)

    def _receive(self, patience: float) -> Any:
        try:
            if not self._results.poll(patience):
                return Lost("hang", f"no answer within {patience:g} s")
            return self._results.recv()
        except EOFError:
            self._process.join()
            return Lost("crash", f"the process ended with status {self._process.exitcode}")

    def __enter__(self) -> _Process:
        return self

    def __exit__(self, *_exception) -> None:
        self._process.kill()
        self._process.join()
        self._results.close()


def _way() -> str:
    """The quickest safe way to start a process: forked from a server that has everything imported, where there is such a thing."""
    if "forkserver" not in multiprocessing.get_all_start_methods() or sys.platform == "darwin":
        return "spawn"
    multiprocessing.set_forkserver_preload(["softffd.validation.stability.map"])
    return "forkserver"


def _serve(work, jobs, sender) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends this process
    sender.send(None)
    try:
        for result in work(jobs):
            sender.send(result)
    except Exception:
        sender.send(Lost("fault", traceback.format_exc(limit=-2).strip()))
