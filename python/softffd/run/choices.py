"""Which methods took how much of a run, and why: read from what the component says when it changes between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

BEGINS = "; internal step"
"""What follows method and reason in the message of a choice."""


def choice_in(text: str) -> tuple[str, str] | None:
    """Method and reason in a message of a component; None in one that tells of no choice."""
    if BEGINS not in text:
        return None
    method, _, reason = text.split(BEGINS)[0].partition(": ")
    return method, reason


def shares(changes: Sequence[tuple[int, tuple[str, str]]], times: np.ndarray) -> list[dict[str, Any]]:
    """What each method with its reason took of a run, most first: method, reason, simulated_s, share in 0..1, communication_steps.

    changes: the communication steps, from 0, in which a choice was new, in their order, with it. times: communication points (T,) [s].
    Without changes, as of a component that tells of no choice, there is nothing.
    """
    if not changes:
        return []
    ends = [row for row, _ in changes[1:]] + [len(times) - 1]
    taken: dict[tuple[str, str], list[float]] = {}
    for (begin, choice), end in zip(changes, ends, strict=True):
        so_far = taken.setdefault(choice, [0.0, 0])
        so_far[0] += float(times[end] - times[begin])
        so_far[1] += end - begin
    whole = float(times[-1] - times[0])
    rows = [
        {"method": method, "reason": reason, "simulated_s": length, "share": length / whole, "communication_steps": int(steps)}
        for (method, reason), (length, steps) in taken.items()
        if steps
    ]
    return sorted(rows, key=lambda row: -float(row["share"]))
