"""When a run communicates: its step and end, the points between them, and whether their values fit into memory."""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np

from softffd.errors import FmuError

GIVEN_BY = {"communication step": "--step H, in Python step=H", "stop time": "--stop-time T, in Python stop_time=T"}
"""How a user gives what an FMU has no default for."""


def positive(what: str, given: float | None, default: Any, *, after: float = 0.0) -> float:
    """The given value, else the default, if it is a number > 0, or > `after` [s]; FmuError says what is wrong otherwise.

    what: "communication step" or "stop time".
    """
    wanted = f"wanted > {after:g} s{', the start time' if after else ''}"
    if given is None and default is None:
        raise FmuError(f"{what}: {wanted}, got none; the FMU has no default: give {GIVEN_BY[what]}")
    value = one_number(what, default if given is None else given)
    if not (math.isfinite(value) and value > after):
        source = "given" if given is not None else "in the FMU's default experiment"
        raise FmuError(f"{what}: {wanted}, got {value:g} ({source})")
    return value


def one_number(what: str, value: Any) -> float:
    """A number that is given; FmuError for an array, text and other things."""
    try:
        if np.ndim(value) == 0 and not isinstance(value, str | bytes):
            return float(value)
    except (TypeError, ValueError):
        pass
    raise FmuError(f"{what}: wanted one number, got {value!r:.70}")


def communication_points(stop_time: float, step: float, start_time: float = 0.0) -> np.ndarray:
    """The start time, multiples of step after it, and the stop time: (T,) [s]."""
    count = math.ceil((stop_time - start_time) / step * (1 - 1e-9))
    return np.append(start_time + step * np.arange(count), stop_time)


def require_memory(stop_time: float, step: float, bytes_per_point: int) -> None:
    """FmuError where the values of all communication points would not fit into this machine's memory."""
    count = stop_time / step
    if not count * bytes_per_point <= memory():
        raise FmuError(
            f"communication step {step:g} s and stop time {stop_time:g} s make {count:.3g} communication points, whose result would take "
            f"{count * bytes_per_point / 1e9:.3g} GB; wanted at most {memory() / 1e9:.3g} GB, this machine's memory: "
            "take a longer step, a shorter stop time or fewer outputs"
        )


def memory() -> float:
    """Of this machine [bytes]; 16 GB where it does not tell."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return 16e9


def step_lengths(times: np.ndarray, step: float) -> list[float]:
    """Lengths between the times: the same double for all but a shorter last one."""
    last = float(times[-1] - times[-2])
    whole = math.isclose(last, step, rel_tol=1e-9, abs_tol=4 * float(np.spacing(abs(times).max())))
    return [step] * (len(times) - 2) + [step if whole else last]
