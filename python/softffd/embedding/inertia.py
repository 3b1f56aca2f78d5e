"""Moments of inertia: of the object, of its lumped masses, and masses that match the object's.

Shares of the mass that follow the weights of the control points have the object's total and centre of mass, but not its inertia: a sample
at X counts with sum W_i X_i^2 = X^2 + variance of the weights. Shares m_i that match it solve

    minimise sum (m_i - r_i)^2 / r_i      subject to      sum m_i (1, x_i, x_i x_i^T) as of the object,      m_i >= floor,

r_i being the lumped ones. With multipliers y of the ten moments, m_i = max(floor, r_i (1 + y . a_i)), a_i the moments of control point i;
they are found by Newton's method on the concave dual, in which every step is a system of ten equations.
"""

import numpy as np
from numpy.typing import ArrayLike

from softffd.errors import SoftffdError
from softffd.lattice import rest_grid
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import area_vectors, merge_by_position

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
ROUNDS, ENOUGH = 60, 1e-13
"""Newton steps at most, and the largest error of a moment that ends them, in units of the box"""


def covariance(distribution: str, mesh: Mesh | None, size: ArrayLike) -> np.ndarray:
    """Second moments (3, 3) [m^2] of the object about its centre of mass, per unit of mass, as mass.distribution spreads it.

    "uniform" and "box": of the box with sides `size` (3,) [m]; "vertices", "surface", "volume": of the mesh.
    """
    if distribution in ("uniform", "box") or mesh is None:
        return np.diag(np.asarray(size, float) ** 2) / 12
    used = mesh.vertices[np.unique(mesh.faces)]
    middle = used.mean(axis=0)
    if distribution == "vertices":
        corners = (merge_by_position(used)[1] - middle)[:, None]
        content = np.ones(len(corners))
    else:
        corners = (mesh.vertices - middle)[mesh.faces]
        normals = area_vectors(corners)
        content = np.linalg.norm(normals, axis=1) if distribution == "surface" else (corners[:, 0] * normals).sum(axis=1)
    return _of_simplices(corners, content, at_origin=distribution == "volume")


def _of_simplices(corners: np.ndarray, content: np.ndarray, *, at_origin: bool) -> np.ndarray:
    """Second moments of points, triangles or tetrahedra, corners (m, 1 or 3, 3), with a further corner at the origin or not."""
    ends = corners.shape[1] + at_origin
    total, sums = content.sum(), corners.sum(axis=1)
    centre = content @ sums / (ends * total)
    own = np.einsum("f,fcx,fcy->xy", content, corners, corners) + np.einsum("f,fx,fy->xy", content, sums, sums)
    return own / (ends * (ends + 1) * total) - np.outer(centre, centre)


def lumped_covariance(shares: np.ndarray, size: ArrayLike) -> np.ndarray:
    """The same of shares (nx, ny, nz) of the control points of a box with sides (3,) [m]."""
    places = _places(shares.shape) * np.asarray(size)
    weights = shares.ravel() / shares.sum()
    places = places - weights @ places
    return np.einsum("p,px,py->xy", weights, places, places)


def inertia_ratio(shares: np.ndarray, wanted: np.ndarray, size: ArrayLike) -> np.ndarray:
    """How many times the inertia of an object of covariance `wanted` (3, 3) [m^2] shares have, (3,) about x, y and z."""
    have, want = (np.trace(each) - np.diag(each) for each in (lumped_covariance(shares, size), wanted))
    return np.divide(have, want, out=np.ones(3), where=want > 1e-12 * np.max(np.square(size)))


def matched_shares(rows: np.ndarray, object_rows: np.ndarray, wanted: np.ndarray, size: ArrayLike, floor: float) -> np.ndarray | None:
    """Shares (nx, ny, nz) near `rows`, none below `floor`, with the total and centre of `object_rows` and the covariance `wanted` [m^2].

    None where there are none.
    """
    places = _places(rows.shape)
    moments = np.stack([np.ones(len(places)), *places.T, *(places[:, a] * places[:, b] for a, b in PAIRS)])
    near, of_object = rows.ravel() / rows.sum(), object_rows.ravel() / object_rows.sum()
    centre = of_object @ places
    second = wanted / np.outer(np.asarray(size), np.asarray(size)) + np.outer(centre, centre)
    aim = np.array([1.0, *centre, *(second[a, b] for a, b in PAIRS)])
    found = _projected(near, moments, aim, floor)
    return None if found is None else found.reshape(rows.shape)


def require_matched(rows: np.ndarray, object_rows: np.ndarray, wanted: np.ndarray, size: ArrayLike, uniform_share: float) -> np.ndarray:
    """The same, each point with `uniform_share` of the mean at least. Raises SoftffdError where there are none, with what there is."""
    floor = uniform_share / rows.size
    found = matched_shares(rows, object_rows, wanted, size, floor)
    if found is not None and found.min() > 1e-12 / rows.size:
        return found
    if found is not None:
        raise SoftffdError(
            f'mass.uniform_share: with {uniform_share:g}, inertia = "matched" leaves control points without mass. Wanted a share '
            "above 0, such as 0.05: no point has less than that of the mean mass then."
        )
    most = _most_floor(rows, object_rows, wanted, size, floor)
    if most is None:
        raise SoftffdError(
            'mass.inertia: "matched" is not possible: no masses of these control points have the inertia of the object, which is too '
            'slender for so few of them, or fills too little of the box. Wanted more control points, a tighter box, or "lumped".'
        )
    raise SoftffdError(
        f'mass.uniform_share: wanted at most {np.floor(1000 * most * rows.size) / 1000:g} beside inertia = "matched", which cannot give '
        f"every control point {uniform_share:g} of the mean mass, got {uniform_share:g}. Light points take shorter steps; more control "
        "points allow more."
    )


def _most_floor(rows: np.ndarray, object_rows: np.ndarray, wanted: np.ndarray, size: ArrayLike, below: float) -> float | None:
    """The largest floor under `below` for which there are matched shares, to a twentieth; None where there is none."""
    low, high = 0.0, below
    if matched_shares(rows, object_rows, wanted, size, low) is None:
        return None
    while high - low > 0.05 * high and high > 1e-6 * below:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if matched_shares(rows, object_rows, wanted, size, middle) is None else (middle, high)
    return low


def _places(counts: tuple[int, ...]) -> np.ndarray:
    """The control points (n, 3) about the middle of a box of sides 1."""
    return rest_grid(counts, np.full(3, -0.5), np.ones(3)).reshape(-1, 3)


def _projected(near: np.ndarray, moments: np.ndarray, aim: np.ndarray, floor: float) -> np.ndarray | None:
    """Numbers (n,) of these moments (10, n) @ numbers = aim, none below the floor, nearest in the metric 1 / near."""

    def at(y: np.ndarray) -> tuple[np.ndarray, float]:
        """The shares of multipliers, and the dual's value."""
        push = moments.T @ y
        shares = np.maximum(floor, near * (1 + push))
        return shares, float(aim @ y - push @ shares + 0.5 * ((shares - near) ** 2 / near).sum())

    y = np.zeros(len(aim))
    shares, value = at(y)
    for _ in range(ROUNDS):
        missing = aim - moments @ shares
        if np.abs(missing).max() < ENOUGH:
            return shares
        free = shares > floor
        curvature = (moments[:, free] * near[free]) @ moments[:, free].T
        if np.linalg.cond(curvature) > 1e13:
            return None
        way, length = np.linalg.solve(curvature, missing), 1.0
        while True:
            shares, new = at(y + length * way)
            if new >= value + 1e-4 * length * (missing @ way) - 1e-15 * abs(value):
                break
            length /= 2
            if length < 1e-10:
                return None
        y, value = y + length * way, new
    return None
