"""The published model in numpy, written from Xia & Wang 2009 and not from the component: a list of springs, loops over steps.

Control points are in flat order, p = i + nx (j + ny k); arrays of them are (n, 3), SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import comb

import numpy as np

FACE_NEIGHBOURS = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
FACE_DIAGONALS = ((1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1))
BODY_DIAGONALS = ((1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1))


def rest_lattice(counts=(4, 4, 4), *, origin=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0)) -> np.ndarray:
    """Control points at rest (n, 3) [m]."""
    nx, ny, nz = counts
    cells = [(i, j, k) for k in range(nz) for j in range(ny) for i in range(nx)]
    return np.array(origin) + np.array(size) * np.array(cells) / (np.array(counts) - 1.0)


def spring_list(counts=(4, 4, 4), *, topology="distinct") -> np.ndarray:
    """Pairs of control points (s, 2); "paper" makes edge springs face by face, so that those on the box's edges come twice."""
    nx, ny, nz = counts
    pairs = []
    for i, j, k in product(range(nx), range(ny), range(nz)):
        for step in (*FACE_NEIGHBOURS, *FACE_DIAGONALS, *BODY_DIAGONALS):
            there = np.add((i, j, k), step)
            if np.any(there < 0) or np.any(there >= counts):
                continue
            faces = sum(a == b and a in (0, n - 1) for a, b, n in zip((i, j, k), there, counts, strict=True))
            twice = topology == "paper" and step in FACE_NEIGHBOURS and faces == 2
            pair = (i + nx * (j + ny * k), there[0] + nx * (there[1] + ny * there[2]))
            pairs += [pair] * (2 if twice else 1)
    return np.array(pairs)


@dataclass(frozen=True)
class Model:
    """Masses, springs and point damping of eq. (3) and (6)."""

    rest: np.ndarray
    """(n, 3) m"""
    springs: np.ndarray
    """(s, 2)"""
    stiffness: np.ndarray
    """(s,) N/m"""
    mass: np.ndarray
    """(n,) kg"""
    damping: np.ndarray
    """(n,) N s/m"""

    def __post_init__(self):
        incidence = np.zeros((len(self.springs), len(self.rest)))
        rows = np.arange(len(self.springs))
        incidence[rows, self.springs[:, 0]], incidence[rows, self.springs[:, 1]] = 1.0, -1.0
        object.__setattr__(self, "_incidence", incidence)
        object.__setattr__(self, "_transposed", np.ascontiguousarray(incidence.T))
        object.__setattr__(self, "_length", np.linalg.norm(incidence @ self.rest, axis=1))

    def spring_force(self, x: np.ndarray) -> np.ndarray:
        """Forces of the springs on the points (n, 3) [N], eq. (6); a spring of no length has no direction and pulls nowhere."""
        d = self._incidence @ x
        r = np.sqrt((d * d).sum(axis=1))
        share = np.divide(self._length, r, out=np.ones_like(r), where=r > 0)
        return self._transposed @ ((self.stiffness * (share - 1.0))[:, None] * d)

    def elastic_energy(self, x: np.ndarray) -> float:
        """J"""
        stretch = np.linalg.norm(self._incidence @ x, axis=1) - self._length
        return float(0.5 * (self.stiffness * stretch**2).sum())

    def highest_frequency(self, x: np.ndarray) -> float:
        """Highest angular frequency [rad/s] of small vibrations about any state x, by central differences of the forces (1e-6)."""
        nudges = 1e-6 * np.eye(x.size).reshape(-1, *x.shape)
        columns = [(self.spring_force(x - nudge) - self.spring_force(x + nudge)).ravel() / 2e-6 for nudge in nudges]
        root_mass = np.sqrt(np.repeat(self.mass, 3))
        scaled = np.array(columns) / np.outer(root_mass, root_mass)
        return float(np.sqrt(np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[-1]))

    def eigenmodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Small vibrations about rest: frequencies (3n,) [rad/s], ascending, and mass-orthonormal shapes (3n, 3n), columns.

        Degree of freedom 3 p + axis.
        """
        d = self._incidence @ self.rest
        direction = d / self._length[:, None]
        elongation = (self._incidence[:, :, None] * direction[:, None, :]).reshape(len(d), -1)
        root_mass = np.sqrt(np.repeat(self.mass, 3))
        scaled = elongation / root_mass
        squares, vectors = np.linalg.eigh(scaled.T @ (self.stiffness[:, None] * scaled))
        return np.sqrt(np.maximum(squares, 0.0)), vectors / root_mass[:, None]


def cube(*, stiffness=1e3, damping=0.0, topology="distinct", counts=(4, 4, 4), total=1.0) -> Model:
    """The uniform unit cube of the tests."""
    rest, springs = rest_lattice(counts), spring_list(counts, topology=topology)
    n = len(rest)
    return Model(rest, springs, np.full(len(springs), stiffness), np.full(n, total / n), np.full(n, damping))


def leapfrog(model: Model, x: np.ndarray, v: np.ndarray, h: float, steps: int, *, external=0.0) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities (n, 3) after `steps` steps h [s] from x, v with a constant external force (n, 3) [N].

    The central difference (13) in velocities: v(1/2) from v by half a step, then v <- ((1-g) v + h f/m)/(1+g), g = d h / 2m, and
    x <- x + h v. The velocity that goes with x in the end is that of eq. (10): the mean of the half-step velocities around it.
    """
    mass, g = model.mass[:, None], (model.damping * h / (2 * model.mass))[:, None]
    half = (1 - g) * v + 0.5 * h * (model.spring_force(x) + external) / mass
    for _ in range(steps):
        x = x + h * half
        force = model.spring_force(x) + external
        before, half = half, ((1 - g) * half + h * force / mass) / (1 + g)
    return x, 0.5 * (before + half) if steps else v


def central_difference(model: Model, x: np.ndarray, v: np.ndarray, h: float, steps: int, *, external=0.0, plane=None) -> np.ndarray:
    """Positions (steps + 1, n, 3) by eq. (13), started by eq. (11), with the published collision rule, its sign corrected.

    plane: (point, unit normal) of an obstacle at rest without friction. A point behind it at time t gets the normal acceleration
    that makes its normal velocity (x_{t+h} - x_{t-h}) . n / 2h zero, (14) and (15), unless it already leaves: (17).
    """
    mass, damping = model.mass[:, None], model.damping[:, None]
    inertia, drag = mass / h**2, damping / (2 * h)
    previous = x - h * v + 0.5 * h**2 * (model.spring_force(x) + external - damping * v) / mass
    course = [x]
    for _ in range(steps):
        force = model.spring_force(x) + external
        following = (2 * inertia * x - (inertia - drag) * previous + force) / (inertia + drag)
        if plane is not None:
            point, normal = plane
            inside = (x - point) @ normal < 0
            approach = (previous - following) @ normal
            following = following + np.where(inside & (approach > 0), approach, 0.0)[:, None] * normal
        previous, x = x, following
        course.append(x)
    return np.array(course)


def bezier_point(positions: np.ndarray, u) -> np.ndarray:
    """Q(u, v, w) of eq. (1) and (2) for control points (nx, ny, nz, 3)."""
    value = positions
    for t in u:
        degree = len(value) - 1
        value = sum(comb(degree, i) * t**i * (1 - t) ** (degree - i) * value[i] for i in range(degree + 1))
    return value
