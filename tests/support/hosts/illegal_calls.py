"""Calls that are illegal in some phase of an instance's life, on any host of the C functions."""

import random
import re
from collections.abc import Callable
from typing import Any

from c_host import ERROR, OK, STEP, Host, check_message
from straight_run import apply, check_as_new, straight

FRESH, INITIALIZING, RUNNING, ENDED, FAILED = PHASES = ("fresh", "initializing", "running", "ended", "failed")
ALIVE, SETTABLE = (INITIALIZING, RUNNING), (FRESH, INITIALIZING, RUNNING)

Illegal = tuple[tuple[str, ...], str, Callable[[Any], int]]
"""Phases in which a call is illegal; what the message must hold, which begins with a function as FMI 2.0 calls it; the call."""


def bring_to(host: Host, phase: str) -> None:
    if phase == FRESH:
        return
    assert host.enter(stop=10.0) == OK
    if phase == INITIALIZING:
        return
    host.must("ExitInitializationMode")
    apply(host, 0)
    host.must("DoStep", 0.0, STEP, 1)
    if phase == ENDED:
        host.must("Terminate")
    if phase == FAILED:
        assert host("DoStep", 77.0, STEP, 1) == ERROR
        host.messages.clear()


def require_refusal(host: Host, wanted: str, call: Callable[[Any], int]) -> None:
    assert call(host) == ERROR, wanted
    check_message(host, re.sub(r"^fmi2(\w+)", lambda match: host.fmu.standard + host.fmu.spelled(match[1]), wanted))


def check_random_calls(host: Host, illegal: list[Illegal], *, seed: int, lives: int) -> None:
    """In each life some illegal calls of a phase in random order; after it a reset runs as new."""
    generator, expected = random.Random(seed), straight(host.fmu, 3)
    for _ in range(lives):
        host.must("Reset")
        phase = generator.choice(PHASES)
        bring_to(host, phase)
        for _ in range(generator.randrange(1, 5)):
            wanted, call = generator.choice([(wanted, call) for phases, wanted, call in illegal if phase in phases])
            require_refusal(host, wanted, call)
            if not any(word in wanted for word in ("FMUstate: wanted", "the state is")):
                phase = FAILED
        check_as_new(host, expected)
    host.free()
