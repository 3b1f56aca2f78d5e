"""Scenes of solids, the same solid written once more in numpy from its formulas and not from the component, and readings of runs.

Nodes and control points are in flat order, p = i + nx (j + ny k); arrays of them are (n, 3), SI units.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from readings import velocities
from scenes import box
from softffd import Result, Scene
from softffd.embedding.nodes import node_positions, volume_shares
from softffd.fmu.package import scene_masses
from softffd.lattice import to_flat, to_grid

PLACES = np.array([0.0, (1 - 1 / np.sqrt(5)) / 2, (1 + 1 / np.sqrt(5)) / 2, 1.0])
"""Gauss-Lobatto points on an axis of a patch"""
WEIGHTS = np.array([1.0, 5.0, 5.0, 1.0]) / 12
"""Of the quadrature at them"""
LEAST_VOLUME = 0.3
"""J below which a node is pressed apart"""


def solid(
    points: int | Sequence[int] = 4,
    *,
    modulus: float = 1.0,
    ratio: float = 0.25,
    density: float = 1.0,
    internal_damping: float = 0.0,
    **keys: Any,
) -> Scene:
    """The scene of a solid and these keys; the unit cube by default. modulus [Pa], density [kg/m3], internal_damping [s]."""
    material = {"model": "solid", "youngs_modulus": modulus, "poissons_ratio": ratio, "density": density}
    return box(points=counts_of(points), material=material | {"internal_damping": internal_damping}, **keys)


def counts_of(points: int | Sequence[int]) -> list[int]:
    return [points] * 3 if isinstance(points, int) else list(points)


def braked(points: int | Sequence[int], rate: float, mass: float = 1.0) -> list[dict[str, Any]]:
    """Regions of a box of this mass [kg] whose nodes have a drag of `rate` times their mass [1/s]: all motion decays by that rate."""
    shares = volume_shares(counts_of(points))
    kinds = np.unique(shares.round(12))
    places = [np.argwhere(np.isclose(shares, kind, rtol=1e-6)).tolist() for kind in kinds]
    return [{"points": where, "damping": rate * mass * float(kind)} for where, kind in zip(places, kinds, strict=True)]


def face_mean(values: np.ndarray) -> np.ndarray:
    """The mean over the area of a face of what its control points have, (..., n1, n2) to (...)."""
    for _ in range(2):
        n = values.shape[-1]
        share = np.zeros(n)
        for patch in range(n // 3):
            share[3 * patch : 3 * patch + 4] += 0.25 / (n // 3)  # the mean of a Bezier curve is that of its control points
        values = values @ share
    return values


def nodes(result: Result) -> np.ndarray:
    """Positions of the nodes (T, n, 3) [m]."""
    return to_flat(node_positions(result.positions))


def node_velocities(result: Result) -> np.ndarray:
    """(T, n, 3) [m/s]; the scene has outputs.velocities = "all"."""
    return to_flat(node_positions(to_grid(velocities(result), result.scene.lattice.points)))


def node_masses(scene: Scene) -> np.ndarray:
    """(n,) [kg]"""
    return scene_masses(scene).mass


class Patches:
    """The solid of a scene: strain, energy and frequencies of its nodes."""

    def __init__(self, scene: Scene):
        material, counts, size = scene.material, np.array(scene.lattice.points), np.array(scene.lattice.size)
        self.mu = material.youngs_modulus / (2 * (1 + material.poissons_ratio))
        self.la = 2 * self.mu * material.poissons_ratio / (1 - 2 * material.poissons_ratio)
        along = counts // 3
        sides = size / along
        slope = np.array([np.polyder(np.poly1d(PLACES[np.arange(4) != s], r=True))(PLACES) for s in range(4)])
        scale = [np.prod(PLACES[s] - PLACES[np.arange(4) != s]) for s in range(4)]
        derivative = (slope / np.array(scale)[:, None]).T  # of the cubic that is 1 at node s, at node i
        one, unit = derivative, np.eye(4)
        # axes: node (k, j, i) of a patch, from node (k, j, i)
        self.gradient = np.stack(
            [
                np.einsum("ad,be,cf->abcdef", *factors).reshape(64, 64) / side
                for factors, side in zip(((unit, unit, one), (unit, one, unit), (one, unit, unit)), sides, strict=True)
            ]
        )  # (axis, node, node)
        weights = np.einsum("a,b,c->abc", WEIGHTS, WEIGHTS, WEIGHTS).ravel()
        self.weight = weights * sides.prod()
        functions = np.stack([np.ones(4), 2 * PLACES - 1], axis=1)
        trilinear = np.einsum("ad,be,cf->abcdef", functions, functions, functions).reshape(64, 8)
        norms = weights @ trilinear**2
        self.projection = trilinear / norms @ trilinear.T * weights
        first = [(3 * i, 3 * j, 3 * k) for k in range(along[2]) for j in range(along[1]) for i in range(along[0])]
        inner = [(i, j, k) for k in range(4) for j in range(4) for i in range(4)]
        indices = np.array(first)[:, None] + np.array(inner)
        self.patches = indices @ [1, counts[0], counts[0] * counts[1]]  # (patches, 64)

    def strain(self, y: np.ndarray) -> np.ndarray:
        """dx/dX at the nodes of each patch (..., patches, 64, 3, 3) of their positions y (..., n, 3) [m]."""
        return np.einsum("agn,...pnc->...pgca", self.gradient, y[..., self.patches, :])

    def volumes(self, y: np.ndarray) -> np.ndarray:
        """J at the nodes of each patch (..., patches, 64)."""
        return np.linalg.det(self.strain(y))

    def energy(self, y: np.ndarray) -> np.ndarray:
        """Of positions (..., n, 3) [m], (...) [J]."""
        f = self.strain(y)
        j = np.linalg.det(f)
        q, less = j - 1, np.maximum(LEAST_VOLUME - j, 0)
        projected = np.einsum("gh,...ph->...pg", self.projection, q)
        own = self.mu / 2 * ((f**2).sum(axis=(-1, -2)) - 3) - self.mu * q + self.mu / 2 * q**2 + self.la / 3 / LEAST_VOLUME * less**3
        return ((own + self.la / 2 * projected**2) @ self.weight).sum(axis=-1)

    def stiffness(self) -> np.ndarray:
        """At rest, of the displacements' components x of all nodes, then y, then z: (3 n, 3 n) [N/m]."""
        n = self.patches.max() + 1
        whole = np.zeros((3, n, 3, n))
        w, g = self.weight, self.gradient
        traces = self.projection.T @ np.diag(w) @ self.projection
        for a in range(3):
            for b in range(3):
                part = self.mu * g[b].T @ (w[:, None] * g[a]) + self.la * g[a].T @ traces @ g[b]
                if a == b:
                    part = part + self.mu * sum(each.T @ (w[:, None] * each) for each in g)
                for patch in self.patches:
                    whole[a, patch[:, None], b, patch] += part
        return whole.reshape(3 * n, 3 * n)

    def modes(self, mass: np.ndarray, held: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies [rad/s] and shapes (modes, n, 3) about rest, largest displacement 1; held: nodes (n,) that do not move."""
        free = np.tile(np.ones(len(mass), bool) if held is None else ~held, 3)
        root = np.sqrt(np.tile(mass, 3))[free]
        squares, vectors = np.linalg.eigh(self.stiffness()[np.ix_(free, free)] / np.outer(root, root))
        shapes = np.zeros((len(squares), 3 * len(mass)))
        shapes[:, free] = (vectors / root[:, None]).T
        shapes = shapes.reshape(len(squares), 3, -1).transpose(0, 2, 1)
        return np.sqrt(np.maximum(squares, 0)), shapes / np.abs(shapes).max(axis=(1, 2), keepdims=True)
