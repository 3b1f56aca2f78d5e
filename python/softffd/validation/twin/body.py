"""The object of the twin: rest lattice, a plain list of springs, masses and damping.

After Xia & Wang 2009, sections 1.1 and 1.2. Control points are in flat order, p = i + nx (j + ny k);
arrays of them are (n, 3); SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np


def rest_positions(counts, origin, size) -> np.ndarray:
    """Control points at rest (n, 3) [m]."""
    k, j, i = np.indices(counts[::-1]).reshape(3, -1)
    return np.array(origin) + np.array(size) * np.stack([i, j, k], axis=1) / (np.array(counts) - 1)


def spring_list(counts, topology: str) -> tuple[np.ndarray, np.ndarray]:
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


def _on_box_edge(pairs: np.ndarray, counts) -> np.ndarray:
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

    def spring_force(self, x: np.ndarray) -> np.ndarray:
        """Forces on the points (n, 3) [N], eq. (6): stretched pairs attract; no length, no pull."""
        a, b = self.pairs.T
        d = x[b] - x[a]
        r = np.linalg.norm(d, axis=1)
        share = np.divide(self.length, r, out=np.ones_like(r), where=r > 0)
        pull = (self.stiffness * (1 - share))[:, None] * d
        return np.stack([np.bincount(a, f, len(x)) - np.bincount(b, f, len(x)) for f in pull.T], axis=1)

    def stable_step(self) -> float:
        """A step [s] stable in any configuration: 2 / omega, bounded as in fmu_src/core/stability.hpp."""
        square = np.zeros(len(self.mass))
        for here, there in (self.pairs.T, self.pairs.T[::-1]):
            share = 1 + np.sqrt(self.mass[here] / self.mass[there])
            square += np.bincount(here, self.stiffness * share, len(square))
        most = (square / self.mass).max()
        return 2 / np.sqrt(most) if most > 0 else np.inf
