"""A rigid mass that strikes a clamped bar along its axis, by the waves in it: Saint-Venant's and Boussinesq's problem."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Struck:
    """Time in passages of the wave, L / c; speed in that of the blow, V; pressure in rho c V."""

    time: np.ndarray
    speed: np.ndarray
    pressure: np.ndarray
    partings: tuple[float, ...]


def struck(ratio: float, until: float, n: int = 5000) -> Struck:
    """The mass over that of the bar is `ratio`; n instants in the time of the wave's way there and back.

    d'Alembert: u = f(t - x / c) - f(t + x / c - 2 L / c), clamped at x = L. With the wave w = f' that the struck end sends and `back`, that
    of 2 L / c before, the end moves with w - back and is pressed by rho c (w + back). In contact the mass moves with the end,
    M dv/dt = - A rho c (v + 2 back); apart from it the end is free, w = - back, until it meets the mass again. Goldsmith, Impact (1960),
    section 3.3, has the first contact alone, which ends at 3.068, 4.708, 5.900 L / c for ratios of 1, 2, 4.
    """
    step = 2.0 / n
    count = int(np.ceil(until / step)) + 2
    wave, pressure, speed, partings = np.zeros(count), np.zeros(count), np.ones(count), []
    touches, gap, brake = True, 0.0, step / (2 * ratio)
    for i in range(count):
        back = wave[i - n] if i >= n else 0.0
        if i > 0:
            before = wave[i - 1 - n] if i > n else 0.0
            speed[i] = (speed[i - 1] * (1 - brake) - 2 * brake * (before + back)) / (1 + brake) if touches else speed[i - 1]
        if not touches:
            gap += step * (-2 * back - speed[i])
            touches = gap < 0
        elif speed[i] + 2 * back < 0:
            touches, gap = False, 0.0
            partings.append(i * step)
        wave[i] = speed[i] + back if touches else -back
        pressure[i] = wave[i] + back
    return Struck(step * np.arange(count), speed, pressure, tuple(partings))
