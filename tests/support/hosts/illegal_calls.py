"""Calls that are illegal in some phase of an instance's life, on any host of the C functions."""

import random
from collections.abc import Callable
from typing import Any

from c_host import ERROR, Host, check_message
from straight_run import check_as_new, straight

FRESH, INITIALIZING, RUNNING, ENDED, FAILED = PHASES = ("fresh", "initializing", "running", "ended", "failed")
ALIVE, SETTABLE = (INITIALIZING, RUNNING), (FRESH, INITIALIZING, RUNNING)

Illegal = tuple[tuple[str, ...], str, Callable[[Any], int]]
"""Phases in which a call is illegal; what the message must hold; the call."""


def check_random_calls(host: Host, bring_to: Callable[[Any, str], None], illegal: list[Illegal], *, seed: int, lives: int) -> None:
    """In each life some illegal calls of a phase in random order; after it a reset runs as new."""
    generator, expected = random.Random(seed), straight(host.fmu, 3)
    for _ in range(lives):
        host.must("Reset")
        phase = generator.choice(PHASES)
        bring_to(host, phase)
        for _ in range(generator.randrange(1, 5)):
            wanted, call = generator.choice([(wanted, call) for phases, wanted, call in illegal if phase in phases])
            assert call(host) == ERROR
            check_message(host, wanted)
            if not any(word in wanted for word in ("FMUstate: wanted", "the state is")):
                phase = FAILED
        check_as_new(host, expected)
    host.free()
