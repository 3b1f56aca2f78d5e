"""Closed forms of textbook mechanics: a block that slides with Coulomb's friction, falls over an edge, spins on its corners."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

G = 9.81
"""m/s2"""
EXACT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}

Course = Callable[[float], float]


@dataclass(frozen=True)
class Belt:
    """The velocity [m/s] of a belt given at some times [s]: held from each to the next, or linear between them."""

    times: np.ndarray
    speeds: np.ndarray
    linear: bool = False

    def piece(self, start: float) -> tuple[float, float, float]:
        """From a time on: where the piece ends [s], the speed at its begin [m/s], the acceleration in it [m/s2]."""
        n = int(np.searchsorted(self.times, start + 1e-9, side="right")) - 1
        if n + 1 == len(self.times):
            return np.inf, self.speeds[n], 0.0
        rate = (self.speeds[n + 1] - self.speeds[n]) / (self.times[n + 1] - self.times[n]) if self.linear else 0.0
        return self.times[n + 1], self.speeds[n] + rate * (start - self.times[n]), rate


STILL = Belt(np.zeros(1), np.zeros(1))


def slide(times: np.ndarray, *, speed: float = 0.0, grip: float | Course, push: float | Course = 0.0, belt: Belt = STILL) -> np.ndarray:
    """The way (T,) [m] of a mass along a line at times (T,) from 0 on [s].

    It begins with `speed` [m/s]; friction can take up to `grip` [m/s2, per mass]; `push` accelerates it [m/s2]. Phases of sliding and of
    sticking end where the slip reverses, and where the push less what the belt takes along passes the grip.
    """
    grips, pushes = (f if callable(f) else (lambda _, f=f: f) for f in (grip, push))
    t, x, v, way = 0.0, 0.0, float(speed), np.zeros(len(times))
    last = float(times[-1])
    while t < last - 1e-12:
        until, at, rate = belt.piece(t)
        until, start = min(until, last), t
        slip = v - at
        sense = np.sign(slip) if abs(slip) > 1e-10 else 0.0
        wanted = pushes(t) - rate
        if sense == 0 and abs(wanted) > grips(t) * (1 + 1e-9):
            sense = np.sign(wanted)
        if sense == 0:
            ends = lambda time, _, rate=rate: abs(pushes(time) - rate) - grips(time) * (1 + 2e-9)  # noqa: E731
            goes = lambda time, y, rate=rate: [y[1], rate]  # noqa: E731
        else:
            # the slip is zero where a phase begins that breaks loose: it counts from there on alone
            ends = lambda time, y, at=at, rate=rate, start=start, s=sense: s * (y[1] - at - rate * (time - start)) + 1e-10  # noqa: E731
            goes = lambda time, y, s=sense: [y[1], pushes(time) - s * grips(time)]  # noqa: E731
        ends.terminal, ends.direction = True, 1 if sense == 0 else -1
        part = solve_ivp(goes, (t, until), [x, v], events=ends, dense_output=True, max_step=0.02, **EXACT)
        inside = (times >= t) & (times <= part.t[-1])
        way[inside] = part.sol(times[inside])[0]
        t, (x, v) = part.t[-1], part.y[:, -1]
        if sense == 0 or part.status == 1:
            v = at + rate * (t - start)
    return way


def fall_over(times: np.ndarray, *, lean: float, arm: float, inertia: float, pull: float = G) -> np.ndarray:
    """The lean (T,) [rad] from the vertical of a rigid body's centre of mass over an edge that holds, from rest at `lean`.

    arm: from the edge to the centre of mass [m]; inertia: about the edge, per mass [m2]; pull: gravity [m/s2].
    """
    rate = arm * pull / inertia
    fall = solve_ivp(lambda _, y: [y[1], rate * np.sin(y[0])], (0.0, times[-1]), [lean, 0.0], t_eval=times, **EXACT)
    return fall.y[0]


def spin_down(times: np.ndarray, *, spin: float, grip: float, table: float = 0.0) -> np.ndarray:
    """The turn (T,) [rad] of a body that spins at `spin` on a table that turns at `table` [rad/s], braked by `grip` [rad/s2] until it
    turns with it."""
    other, sense = spin - table, np.sign(spin - table)
    slipping = np.minimum(times, abs(other) / grip)
    return table * times + other * slipping - sense * grip * slipping**2 / 2


def slide_on_table(times: np.ndarray, *, spin: float, radius: float, height: float, friction: float) -> np.ndarray:
    """The distance along the table (T,) [m] between the axis and a mass at `height` above it, on a table that turns about a level axis,
    from level at time 0 on, at `spin` [rad/s]. The mass begins at rest on the table, at `radius` [m], and slides down where friction lets
    it go."""

    def pull(t, r, v):
        pressed = G * np.cos(spin * t) - 2 * spin * v - spin**2 * height
        return G * np.sin(spin * t) + spin**2 * r - friction * pressed

    loose = brentq(lambda t: pull(t, radius, 0.0), 0.0, np.pi / 2 / spin, xtol=1e-14)
    course = solve_ivp(lambda t, y: [y[1], pull(t, *y)], (loose, max(loose, times[-1])), [radius, 0.0], dense_output=True, **EXACT)
    return np.where(times <= loose, radius, course.sol(np.maximum(times, loose))[0])
