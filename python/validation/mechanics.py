"""The mechanics in numpy, against which the component is checked: springs, dashpots, masses, damping, external forces, initial state.

The module follows Xia & Wang 2009, sections 1.1 and 1.2. The twin, the oracles of the stability cases and the right-hand side for SciPy
use it. The module imports numpy alone because it is copied into the twin's FMU. `scene` is the dictionary that `validation.resolved`
makes. Control points are in flat order, p = i + nx (j + ny k); arrays of control points are (n, 3), in SI units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from softffd.rotation import turned

AXES = "xyz"


def spring_list(counts: Sequence[int], topology: str) -> tuple[np.ndarray, np.ndarray]:
    """Returns the pairs of control points (s, 2) that springs join, and the kinds (s,): 1 edge, 2 face, 3 body diagonal (figure 1).

    topology "paper" makes edge springs face by face, so that springs on the edges of the box occur twice.
    """
    place = np.arange(np.prod(counts)).reshape(counts[::-1]).T  # place[i, j, k] = p
    pairs, kinds = [], []
    for way in product((-1, 0, 1), repeat=3):
        if way <= (0, 0, 0):
            continue  # the opposite direction gives the same springs
        here = tuple(slice(max(0, -d), n - max(0, d)) for d, n in zip(way, counts, strict=True))
        there = tuple(slice(max(0, d), n + min(0, d)) for d, n in zip(way, counts, strict=True))
        found = np.stack([place[here], place[there]], axis=-1).reshape(-1, 2)
        if topology == "paper" and np.abs(way).sum() == 1:
            found = np.repeat(found, 1 + _on_box_edge(found, counts), axis=0)
        pairs.append(found)
        kinds.append(np.full(len(found), np.abs(way).sum()))
    return np.concatenate(pairs), np.concatenate(kinds)


def _on_box_edge(pairs: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Returns 1 for each edge spring (s, 2) that lies on one of the twelve edges of the box, else 0: (s,)."""
    ends = np.stack(np.unravel_index(pairs, counts, order="F"), axis=-1)  # (s, 2, axis)
    outside = (ends == 0) | (ends == np.array(counts) - 1)
    along = ends[:, 0] != ends[:, 1]
    return ((outside.all(axis=1) & ~along).sum(axis=1) == 2).astype(int)


def solid_shares(sides: Sequence[float]) -> dict[tuple[int, int, int], float]:
    """Returns the stiffness [N/m] of a cell's springs for modulus 1 Pa, by the axes that a spring spans: (1, 1, 0) is an x-y face diagonal.

    sides: of the cell [m]. The six stiffnesses give homogeneous strains the energy of an isotropic solid of Poisson's ratio 1/4,
    C_iijj = sum of k (l_i l_j / |l|)^2 / V over the springs attributed to one cell, 3 edges and 6 diagonals.
    """
    squares = np.array(sides, float) ** 2
    ways = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1)])
    number = ways.sum(axis=1)  # one edge, two diagonals
    strains = [(i, j) for i in range(3) for j in range(i, 3)]
    reach = ways * squares
    cost = [number * reach[:, i] * reach[:, j] / reach.sum(axis=1) / np.prod(sides) for i, j in strains]
    solid = [1.2 if i == j else 0.4 for i, j in strains]
    return dict(zip(map(tuple, ways.tolist()), np.linalg.solve(cost, solid).tolist(), strict=True))


class Cells:
    """The cells of a scene's lattice, and the springs (s, 2) between control points that the cells share."""

    def __init__(self, scene: Mapping[str, Any], pairs: np.ndarray):
        self.counts = np.array(scene["counts"])
        ends = np.stack(np.unravel_index(pairs, self.counts, order="F"), axis=-1)  # (s, 2, axis)
        low, high, self.ways = ends.min(axis=1), ends.max(axis=1), np.ptp(ends, axis=1)
        shares = solid_shares(np.array(scene["size"]) / (self.counts - 1))
        neighbours = 2 ** (3 - self.ways.sum(axis=1))  # number of cells that share an interior spring
        self.share = np.array([shares.get(tuple(way), 0.0) for way in self.ways.tolist()]) / neighbours
        self.around = []  # for each of 8 positions beside a spring: the springs with a cell there, and the cells
        for step in product((0, 1), repeat=3):
            cell = high - 1 + step
            held = np.flatnonzero(((cell >= 0) & (cell < self.counts - 1) & (cell <= low)).all(axis=1))
            self.around.append((held, tuple(cell[held].T)))

    def values(self, of_all: float, regions: Sequence[Mapping[str, Any]], key: str) -> np.ndarray:
        """Returns a value per cell: the value of a region that contains all corners of the cell, else `of_all`."""
        found = np.full(self.counts - 1, of_all, float)
        for region in regions:
            if region[key] is not None:
                inside = np.isin(np.arange(np.prod(self.counts)), region["points"]).reshape(self.counts, order="F")
                whole = np.lib.stride_tricks.sliding_window_view(inside, (2, 2, 2)).all(axis=(3, 4, 5))
                found[whole] = region[key]
        return found

    def stiffness(self, modulus: np.ndarray) -> np.ndarray:
        """Returns the stiffness of each spring (s,) [N/m]. modulus: of each cell [Pa]."""
        total = np.zeros(len(self.share))
        for held, cell in self.around:
            total[held] += self.share[held] * modulus[cell]
        return total


@dataclass(frozen=True, eq=False)
class Body:
    """The quantities of the object in eq. (3) and (6): springs between pairs (s, 2) of points, and the points."""

    pairs: np.ndarray
    stiffness: np.ndarray  # (s,) N/m
    length: np.ndarray  # (s,) m
    mass: np.ndarray  # (n,) kg
    weight: np.ndarray  # (n,) kg, mass on which gravity acts
    damping: np.ndarray  # (n,) N s/m
    dashpot: np.ndarray  # (s,) N s/m

    @classmethod
    def of(
        cls,
        scene: Mapping[str, Any],
        *,
        total: float | None = None,
        stiffness: Sequence[float] | None = None,
        youngs_modulus: float | None = None,
        damping: float | None = None,
        internal_damping: float | None = None,
    ) -> Body:
        """Returns the body of a scene. Given arguments replace the total mass [kg], the stiffness of edge, face and body springs (3,) [N/m]
        or the modulus [Pa], the damping of a point [N s/m] or the internal damping [s]. Regions keep their own values."""
        mass, rest = np.array(scene["mass"]), np.array(scene["rest"])
        pairs, kinds = spring_list(scene["counts"], scene["topology"])
        time = scene["internal_damping"] if internal_damping is None else internal_damping
        if scene["youngs_modulus"] is None:
            of_springs = np.array(scene["stiffness"] if stiffness is None else stiffness, float)[kinds - 1]
            of_springs = _of_regions(of_springs, pairs, scene["regions"], "stiffness")
            dashpots = of_springs * _of_regions(np.full(len(pairs), time, float), pairs, scene["regions"], "internal_damping")
        else:
            cells = Cells(scene, pairs)
            modulus = scene["youngs_modulus"] if youngs_modulus is None else youngs_modulus
            moduli = cells.values(modulus, scene["regions"], "youngs_modulus")
            of_springs = cells.stiffness(moduli)
            dashpots = cells.stiffness(moduli * cells.values(time, scene["regions"], "internal_damping"))
        of_points = np.full(len(mass), scene["damping"] if damping is None else damping, float)
        for region in scene["regions"]:
            if region["damping"] is not None:
                of_points[region["points"]] = region["damping"]
        length = np.linalg.norm(rest[pairs[:, 1]] - rest[pairs[:, 0]], axis=1)
        weight = mass if scene["weight"] is None else np.array(scene["weight"])
        scale = 1.0 if total is None else total / mass.sum()
        return cls(pairs, of_springs, length, mass * scale, weight * scale, of_points, dashpots)

    def stretch(self, x: np.ndarray) -> np.ndarray:
        """Returns the elongation of the springs relative to rest (s,) [m]."""
        a, b = self.pairs.T
        return np.linalg.norm(x[b] - x[a], axis=1) - self.length

    def elastic_energy(self, x: np.ndarray) -> float:
        """Returns the elastic energy of all springs [J]."""
        return float(0.5 * self.stiffness @ self.stretch(x) ** 2)

    def kinetic_energy(self, v: np.ndarray) -> float:
        """Returns the kinetic energy of all points [J]."""
        return float(0.5 * self.mass @ (v**2).sum(axis=1))

    def spring_force(self, x: np.ndarray) -> np.ndarray:
        """Returns the spring forces on the points (n, 3) [N], eq. (6). Stretched springs attract; a spring of zero length has no force."""
        a, b = self.pairs.T
        d = x[b] - x[a]
        r = np.linalg.norm(d, axis=1)
        share = np.divide(self.length, r, out=np.ones_like(r), where=r > 0)
        pull = (self.stiffness * (1 - share))[:, None] * d
        return np.stack([np.bincount(a, f, len(x)) - np.bincount(b, f, len(x)) for f in pull.T], axis=1)

    def dashpot_force(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Returns the dashpot forces on the points (n, 3) [N]. They act along each spring, against the rate of its length."""
        a, b = self.pairs.T
        d = x[b] - x[a]
        r2 = (d**2).sum(axis=1)
        rate = ((v[b] - v[a]) * d).sum(axis=1)
        pull = np.divide(self.dashpot * rate, r2, out=np.zeros_like(r2), where=r2 > 0)[:, None] * d
        return np.stack([np.bincount(a, f, len(x)) - np.bincount(b, f, len(x)) for f in pull.T], axis=1)

    def stable_step(self) -> float:
        """Returns a step [s] that is stable in any configuration: 2 / omega, with omega bounded as in fmu_src/core/body/stability.hpp."""
        square = np.zeros(len(self.mass))
        for here, there in (self.pairs.T, self.pairs.T[::-1]):
            share = 1 + np.sqrt(self.mass[here] / self.mass[there])
            square += np.bincount(here, self.stiffness * share, len(square))
        most = (square / self.mass).max()
        return 2 / np.sqrt(most) if most > 0 else np.inf


def _of_regions(values: np.ndarray, pairs: np.ndarray, regions: Sequence[Mapping[str, Any]], key: str) -> np.ndarray:
    """Returns the values of the springs (s,), with a region's value for springs that have both ends in the region."""
    for region in regions:
        if region[key] is not None:
            values[np.isin(pairs, region["points"]).all(axis=1)] = region[key]
    return values


def start(scene: Mapping[str, Any], *, rotation: Sequence[float] | np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Returns the positions [m] and velocities [m/s] at the start, (n, 3) each, before pins and planes act.

    rotation: initial rotation vector (3,) [rad] of the body about the centre of its box; by default that of the scene.
    """
    initial = {key: np.array(value) for key, value in scene["initial"].items()}
    origin, half = np.array(scene["origin"]), np.array(scene["size"]) / 2
    x = origin + initial["stretch"] * (np.array(scene["rest"]) - origin) + initial["offset"]
    centre = origin + initial["stretch"] * half + initial["offset"]
    turn = initial["rotation"] if rotation is None else np.array(rotation)
    if turn.any():
        x = centre + turned(x - centre, turn)
    if initial["spin_about"] == "mass":
        centre = np.average(x, axis=0, weights=scene["mass"])
    return x, initial["velocity"] + np.cross(initial["angular_velocity"], x - centre)


def outside_force(scene: Mapping[str, Any], values: Mapping[str, Any]) -> np.ndarray:
    """Returns the forces of the scene's loads and force inputs on the points (..., n, 3) [N], without gravity.

    values: numbers, or arrays (...) of one shape, by name; missing values are 0. A load is divided equally among its points.
    """
    shape = np.shape(next(iter(values.values()), 0.0))
    force = np.zeros((*shape, len(scene["mass"]), 3))
    for name, points in scene["forces"].items():
        for a, axis in enumerate(AXES):
            if (value := values.get(f"{name}.{axis}")) is not None:
                force[..., points, a] += np.asarray(value)[..., None] / len(points)
    return force
