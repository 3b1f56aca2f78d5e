"""A run's curve at the points of the data: over time, or over another quantity that goes back and forth, as force over displacement.

A force over displacement has one value on loading and another on unloading. So the curves of data and run are both cut into *branches*
where the displacement turns. The first branch of the data belongs to the first of the run, and so on.

      force |       ..*   turn: end of branch 1, begin of branch 2
            |    .*. /
            |  .*  .*
            | *..*
            +----------- displacement

A mean over a communication step, such as a reaction, counts as the value in the middle of the step. Taken as the value at the end, it
would come half a step late, which a fit would take for damping.
"""

from typing import NamedTuple

import numpy as np

from softffd.errors import FmuError

SLACK = 0.02
"""A displacement turns where it goes back by more than this fraction of the measured range; data may lie so far beyond the run's ends"""
STILL = 1e-9  # fraction of a branch's range within which a displacement rests


class Branch(NamedTuple):
    """Rows of a column between two turns."""

    first: int
    last: int
    sign: int  # 1 where the values grow, -1 where they fall


def branches(values: np.ndarray, slack: float) -> list[Branch]:
    """Returns the branches of a column (n,), whose ends are the turns; a way back of `slack` or less is no turn."""
    turns, signs, extreme, sign = [0], [], 0, 0
    for n, value in enumerate(values.tolist()):
        ahead = value - float(values[extreme])
        if sign == 0 and abs(ahead) > slack:
            sign, extreme = (1 if ahead > 0 else -1), n
        elif sign and sign * ahead > 0:
            extreme = n
        elif sign and -sign * ahead > slack:
            turns.append(extreme)
            signs.append(sign)
            sign, extreme = -sign, n
    if sign:
        turns.append(len(values) - 1)
        signs.append(sign)
    return [Branch(first, last, sign) for first, last, sign in zip(turns, turns[1:], signs, strict=False)]


def at_middles(times: np.ndarray, column: np.ndarray, *, mean: bool, means: bool) -> np.ndarray:
    """Returns a column (T,) of a run where the matched column is known: at the communication points, or, if the matched column has means
    of steps (`means`), in the middles of the steps (T - 1,). mean: whether the returned column has means itself."""
    if not means:
        return np.interp(times, (times[1:] + times[:-1]) / 2, column[1:]) if mean else column
    return column[1:] if mean else (column[1:] + column[:-1]) / 2


class OverAnother:
    """Evaluates curves of runs at the rows of the data over another quantity than time. The branches of the data are found once."""

    def __init__(self, name: str, measured: np.ndarray):
        """name: of the quantity that replaces time. measured: its values (m,) in their order. Raises FmuError if they do not change."""
        self.name, self.measured = name, measured
        self.slack = SLACK * float(np.ptp(measured))
        self.branches = branches(measured, self.slack)
        if not self.branches:
            raise FmuError(f"{name}: wanted a column that changes, for it takes the place of time; got {measured[0]:g} in all rows")

    def __call__(self, along: np.ndarray, values: np.ndarray, *, strict: bool = False) -> np.ndarray:
        """Returns a run's values (n,) over `along` (n,) at the rows of the data (m,). Raises FmuError if the run has other branches than
        the data, and, if strict, if the run does not reach as far as the data."""
        own, result = branches(along, self.slack), np.empty(len(self.measured))
        ways = [branch.sign for branch in self.branches]
        if [branch.sign for branch in own[: len(ways)]] != ways:
            raise FmuError(f"{self.name}: in the data it {_told(ways)}, in the run it {_told([branch.sign for branch in own])}")
        for n, (there, here) in enumerate(zip(self.branches, own, strict=False)):
            rows = slice(there.first + (n > 0), there.last + 1)
            x, y = _moving(here, along, values)
            if strict:
                self._require_within(rows, x)
            result[rows] = over_time(x, y, self.measured[rows])
        return result

    def _require_within(self, rows: slice, x: np.ndarray) -> None:
        outside = np.maximum(x.min() - self.measured[rows], self.measured[rows] - x.max())
        if outside.max() > self.slack:
            row = rows.start + int(outside.argmax())
            raise FmuError(
                f"{self.name}: the run goes from {x.min():g} to {x.max():g} there, row {row} of the data has {self.measured[row]:g}"
            )


def _moving(branch: Branch, along: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the rows of a branch where the quantity advances, in growing order. Of a rest at the begin it keeps the last row, of other
    rests the first row."""
    x, y = along[branch.first : branch.last + 1], values[branch.first : branch.last + 1]
    ahead = branch.sign * (x - x[0])
    begin = int(np.flatnonzero(ahead > STILL * ahead.max())[0]) - 1
    x, y, ahead = x[begin:], y[begin:], ahead[begin:]
    furthest = np.maximum.accumulate(ahead)
    on = np.append(True, ahead[1:] > furthest[:-1])
    return x[on][:: branch.sign], y[on][:: branch.sign]


def over_time(times: np.ndarray, values: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Returns values (n,) at growing times, linear between them and beyond the ends, at the times wanted (m,)."""
    if len(times) < 2:
        return np.full(len(wanted), values[0])
    places = np.clip(np.searchsorted(times, wanted) - 1, 0, len(times) - 2)
    ahead, step = wanted - times[places], times[places + 1] - times[places]
    return values[places] + ahead * (values[places + 1] - values[places]) / step


def _told(signs: list[int]) -> str:
    return ", ".join("grows" if sign > 0 else "falls" for sign in signs) or "rests"
