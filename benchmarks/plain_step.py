"""The baseline of an internal step: leapfrog with a loop over the list of springs, as a user would write it for numba."""

from __future__ import annotations

import math

import numba
import numpy as np

from softffd import Scene
from validation.mechanics import Body, start
from validation.resolved import resolved


class PlainSteps:
    """A run of a scene of springs alone, from its start."""

    def __init__(self, scene: Scene):
        parts = resolved(scene)
        self.body = Body.of(parts)
        self.x, self.v = start(parts)
        self.force = self.body.spring_force(self.x)

    def run(self, steps: int, h: float) -> None:
        """Makes this number of steps of h [s]."""
        body = self.body
        run(steps, h, self.x, self.v, self.force, body.pairs, body.stiffness, body.length, body.mass)


@numba.njit
def run(steps, h, x, v, force, pairs, stiffness, length, mass):  # type: ignore[no-untyped-def]
    """Makes steps of half a kick, drift, forces, half a kick."""
    for _ in range(steps):
        for p in range(len(mass)):
            for a in range(3):
                v[p, a] += 0.5 * h / mass[p] * force[p, a]
                x[p, a] += h * v[p, a]
                force[p, a] = 0.0
        for s in range(len(pairs)):
            i, j = pairs[s, 0], pairs[s, 1]
            dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
            pull = stiffness[s] * (1.0 - length[s] / math.sqrt(dx * dx + dy * dy + dz * dz))
            force[i, 0] += pull * dx
            force[i, 1] += pull * dy
            force[i, 2] += pull * dz
            force[j, 0] -= pull * dx
            force[j, 1] -= pull * dy
            force[j, 2] -= pull * dz
        for p in range(len(mass)):
            for a in range(3):
                v[p, a] += 0.5 * h / mass[p] * force[p, a]


def steps_of(scene: Scene) -> tuple[PlainSteps, np.ndarray]:
    """Returns the compiled run at its start, and the positions after 50 steps (n, 3) [m] for comparison."""
    run(0, 0.0, *(np.zeros((1, 3)) for _ in range(3)), np.zeros((1, 2), dtype=np.int64), *(np.ones(1) for _ in range(3)))
    tried = PlainSteps(scene)
    tried.run(50, 1e-4)
    return PlainSteps(scene), tried.x
