"""An independent implementation of the finite-element solid in numpy, from its formulas and not from the component.

The module computes strain, energy and frequencies. Nodes are in flat order, p = i + nx (j + ny k); node arrays are (n, 3), in SI units.
"""

from __future__ import annotations

import numpy as np

from softffd.scene.scene import Scene

PLACES = np.array([0.0, (1 - 1 / np.sqrt(5)) / 2, (1 + 1 / np.sqrt(5)) / 2, 1.0])
"""Gauss-Lobatto points on an axis of a patch, from 0 to 1"""
WEIGHTS = np.array([1.0, 5.0, 5.0, 1.0]) / 12
"""Quadrature weights of the points PLACES"""
LEAST_VOLUME = 0.3
"""Volume ratio J below which a penalty energy pushes a node apart"""


class Patches:
    """The solid of a scene. Computes strain, energy and frequencies from the positions of the nodes."""

    def __init__(self, scene: Scene):
        material, counts, size = scene.material, np.array(scene.lattice.points), np.array(scene.lattice_box.size)
        assert material.youngs_modulus is not None and material.poissons_ratio is not None
        self.mu = material.youngs_modulus / (2 * (1 + material.poissons_ratio))
        self.la = 2 * self.mu * material.poissons_ratio / (1 - 2 * material.poissons_ratio)
        along = counts // 3
        sides = size / along
        slope = np.array([np.polyder(np.poly1d(PLACES[np.arange(4) != s], r=True))(PLACES) for s in range(4)])
        scale = [np.prod(PLACES[s] - PLACES[np.arange(4) != s]) for s in range(4)]
        derivative = (slope / np.array(scale)[:, None]).T  # [i, s]: at node i, of the cubic that is 1 at node s
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
        """Returns the deformation gradient dx/dX at the nodes of each patch (..., patches, 64, 3, 3). y: node positions (..., n, 3) [m]."""
        return np.einsum("agn,...pnc->...pgca", self.gradient, y[..., self.patches, :])

    def volumes(self, y: np.ndarray) -> np.ndarray:
        """Returns the volume ratio J at the nodes of each patch (..., patches, 64) for node positions y (..., n, 3) [m]."""
        return np.linalg.det(self.strain(y))

    def energy(self, y: np.ndarray) -> np.ndarray:
        """Returns the elastic energy (...) [J] for node positions y (..., n, 3) [m]."""
        f = self.strain(y)
        j = np.linalg.det(f)
        q, less = j - 1, np.maximum(LEAST_VOLUME - j, 0)
        projected = np.einsum("gh,...ph->...pg", self.projection, q)
        own = self.mu / 2 * ((f**2).sum(axis=(-1, -2)) - 3) - self.mu * q + self.mu / 2 * q**2 + self.la / 3 / LEAST_VOLUME * less**3
        return ((own + self.la / 2 * projected**2) @ self.weight).sum(axis=-1)

    def stiffness(self) -> np.ndarray:
        """Returns the stiffness matrix at rest (3 n, 3 n) [N/m]. The unknowns are the x displacements of all nodes, then y, then z."""
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
        """Returns the frequencies [rad/s] and shapes (modes, n, 3) of vibrations about rest; the largest displacement of a shape is 1.

        mass: of the nodes (n,) [kg]; held: mask (n,) of the nodes that do not move."""
        free = np.tile(np.ones(len(mass), bool) if held is None else ~held, 3)
        root = np.sqrt(np.tile(mass, 3))[free]
        squares, vectors = np.linalg.eigh(self.stiffness()[np.ix_(free, free)] / np.outer(root, root))
        flat = np.zeros((len(squares), 3 * len(mass)))
        flat[:, free] = (vectors / root[:, None]).T
        shapes = flat.reshape(len(squares), 3, -1).transpose(0, 2, 1)
        return np.sqrt(np.maximum(squares, 0)), shapes / np.abs(shapes).max(axis=(1, 2), keepdims=True)
