"""The baseline of an implicit step: M / h^2 + K of the springs at the start, assembled in numpy, solved by SciPy's banded Cholesky."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solveh_banded

from softffd import Scene
from validation.mechanics import Body, start
from validation.resolved import resolved


class Banded:
    """A scene of springs alone at its start. The sparsity pattern of the matrix is found once."""

    def __init__(self, scene: Scene, h: float):
        parts = resolved(scene)
        self.body, self.h = Body.of(parts), h
        self.x, _ = start(parts)
        first, second = np.sort(self.body.pairs, axis=1).T
        axis, other = np.divmod(np.arange(9), 3)
        size = 3 * len(self.x)
        band = int(3 * (second - first).max() + 2)
        rows = [3 * p[:, None] + axis for p in (first, second, second)]
        columns = [3 * p[:, None] + other for p in (first, second, first)]
        places = [((row - column) * size + column).ravel() for row, column in zip(rows, columns, strict=True)]
        self._lower = [(row >= column).ravel() for row, column in zip(rows, columns, strict=True)]
        self._places = [place[lower] for place, lower in zip(places, self._lower, strict=True)]
        self._shape = band + 1, size

    def solve(self) -> np.ndarray:
        """Returns the linearised displacement (3 n,) [m] that the spring forces cause in a step."""
        body = self.body
        a, b = body.pairs.T
        way = self.x[b] - self.x[a]
        length = np.sqrt((way * way).sum(axis=1))
        unit = way / length[:, None]
        tension = body.stiffness * (1 - body.length / length)
        along = (body.stiffness - tension)[:, None, None] * unit[:, :, None] * unit[:, None, :]
        block = (along + tension[:, None, None] * np.eye(3)).reshape(-1)
        entries = [sign * block[lower] for sign, lower in zip((1, 1, -1), self._lower, strict=True)]
        matrix = np.bincount(np.concatenate(self._places), np.concatenate(entries), self._shape[0] * self._shape[1]).reshape(self._shape)
        matrix[0] += np.repeat(body.mass, 3) / self.h**2
        return solveh_banded(matrix, body.spring_force(self.x).ravel(), lower=True, overwrite_ab=True, check_finite=False)
