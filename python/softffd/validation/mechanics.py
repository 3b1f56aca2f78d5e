"""The mechanics once more, in numpy, to check the component against: springs, masses, damping, outside forces, the start.

After Xia & Wang 2009, sections 1.1 and 1.2. The twin, the oracles of the stability cases and the right-hand side for SciPy stand on it.
Imports numpy alone, for it travels inside the twin's FMU. `scene` is the dictionary that `softffd.validation.resolved` makes. Control
points are in flat order, p = i + nx (j + ny k); arrays of them are (n, 3); SI units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

AXES = "xyz"


def spring_list(counts: Sequence[int], topology: str) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of control points (s, 2) and their kind (s,): 1 edge, 2 face, 3 body diagonal (figure 1).

    topology "paper" makes edge springs face by face: those on the edges of the box come twice.
    """
    place = np.arange(np.prod(counts)).reshape(counts[::-1]).T  # place[i, j, k] = p
    pairs, kinds = [], []
    for way in product((-1, 0, 1), repeat=3):
        if way <= (0, 0, 0):
            continue  # the opposite way makes the same springs
        here = tuple(slice(max(0, -d), n - max(0, d)) for d, n in zip(way, counts, strict=True))
        there = tuple(slice(max(0, d), n + min(0, d)) for d, n in zip(way, counts, strict=True))
        found = np.stack([place[here], place[there]], axis=-1).reshape(-1, 2)
        if topology == "paper" and np.abs(way).sum() == 1:
            found = np.repeat(found, 1 + _on_box_edge(found, counts), axis=0)
        pairs.append(found)
        kinds.append(np.full(len(found), np.abs(way).sum()))
    return np.concatenate(pairs), np.concatenate(kinds)


def _on_box_edge(pairs: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """1 for the edge springs (s, 2) that lie on one of the twelve edges of the box."""
    ends = np.stack(np.unravel_index(pairs, counts, order="F"), axis=-1)  # (s, 2, axis)
    outside = (ends == 0) | (ends == np.array(counts) - 1)
    along = ends[:, 0] != ends[:, 1]
    return ((outside.all(axis=1) & ~along).sum(axis=1) == 2).astype(int)


@dataclass(frozen=True, eq=False)
class Body:
    """What eq. (3) and (6) know of the object: springs between pairs (s, 2) of points, and the points."""

    pairs: np.ndarray
    stiffness: np.ndarray  # (s,) N/m
    length: np.ndarray  # (s,) m
    mass: np.ndarray  # (n,) kg
    damping: np.ndarray  # (n,) N s/m

    @classmethod
    def of(
        cls,
        scene: Mapping[str, Any],
        *,
        total: float | None = None,
        stiffness: Sequence[float] | None = None,
        damping: float | None = None,
    ) -> Body:
        """The scene's body, with another mass [kg], stiffness of edge, face and body springs (3,) [N/m] or damping of a point [N s/m] if
        that is given. Regions keep their own."""
        mass, rest = np.array(scene["mass"]), np.array(scene["rest"])
        pairs, kinds = spring_list(scene["counts"], scene["topology"])
        of_springs = np.array(scene["stiffness"] if stiffness is None else stiffness, float)[kinds - 1]
        of_points = np.full(len(mass), scene["damping"] if damping is None else damping, float)
        for region in scene["regions"]:
            if region["stiffness"] is not None:
                of_springs[np.isin(pairs, region["points"]).all(axis=1)] = region["stiffness"]
            if region["damping"] is not None:
                of_points[region["points"]] = region["damping"]
        length = np.linalg.norm(rest[pairs[:, 1]] - rest[pairs[:, 0]], axis=1)
        return cls(pairs, of_springs, length, mass if total is None else mass * (total / mass.sum()), of_points)

    def stretch(self, x: np.ndarray) -> np.ndarray:
        """How much longer than at rest the springs are (s,) [m]."""
        a, b = self.pairs.T
        return np.linalg.norm(x[b] - x[a], axis=1) - self.length

    def elastic_energy(self, x: np.ndarray) -> float:
        """Of all springs [J]."""
        return float(0.5 * self.stiffness @ self.stretch(x) ** 2)

    def kinetic_energy(self, v: np.ndarray) -> float:
        """Of all points [J]."""
        return float(0.5 * self.mass @ (v**2).sum(axis=1))

    def spring_force(self, x: np.ndarray) -> np.ndarray:
        """Forces on the points (n, 3) [N], eq. (6): stretched pairs attract; no length, no pull."""
        a, b = self.pairs.T
        d = x[b] - x[a]
        r = np.linalg.norm(d, axis=1)
        share = np.divide(self.length, r, out=np.ones_like(r), where=r > 0)
        pull = (self.stiffness * (1 - share))[:, None] * d
        return np.stack([np.bincount(a, f, len(x)) - np.bincount(b, f, len(x)) for f in pull.T], axis=1)

    def stable_step(self) -> float:
        """A step [s] stable in any configuration: 2 / omega, bounded as in fmu_src/core/forces/stability.hpp."""
        square = np.zeros(len(self.mass))
        for here, there in (self.pairs.T, self.pairs.T[::-1]):
            share = 1 + np.sqrt(self.mass[here] / self.mass[there])
            square += np.bincount(here, self.stiffness * share, len(square))
        most = (square / self.mass).max()
        return 2 / np.sqrt(most) if most > 0 else np.inf


def start(scene: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Positions [m] and velocities [m/s] at the start, (n, 3) each; pins and planes have not acted yet."""
    initial = {key: np.array(value) for key, value in scene["initial"].items()}
    origin, half = np.array(scene["origin"]), np.array(scene["size"]) / 2
    x = origin + initial["stretch"] * (np.array(scene["rest"]) - origin) + initial["offset"]
    centre = origin + initial["stretch"] * half + initial["offset"]
    return x, initial["velocity"] + np.cross(initial["angular_velocity"], x - centre)


def outside_force(scene: Mapping[str, Any], values: Mapping[str, Any]) -> np.ndarray:
    """Forces of the scene's loads and force inputs on the points (..., n, 3) [N], without gravity.

    values: numbers, or arrays (...) of one shape, by name; what is not there is 0. A load is shared equally by its points.
    """
    shape = np.shape(next(iter(values.values()), 0.0))
    force = np.zeros((*shape, len(scene["mass"]), 3))
    for name, points in scene["forces"].items():
        for a, axis in enumerate(AXES):
            if (value := values.get(f"{name}.{axis}")) is not None:
                force[..., points, a] += np.asarray(value)[..., None] / len(points)
    return force
