"""Moments of inertia: of the object, of its lumped masses, and masses that match the object's.

Fractions of the mass that follow the weights of the points have the object's total and centre of mass, but not its inertia: a sample at X
contributes sum W_i X_i^2 = X^2 + variance of the weights. Fractions m_i that match the inertia solve

    minimise sum (m_i - r_i)^2 / d_i      subject to      sum m_i (1, x_i, x_i x_i^T) as of the object,      m_i >= floor_i,

where r_i are the lumped fractions. d_i are the lumped fractions too, or for the nodes of a solid the fractions of its box. With the
multipliers y of the ten moments, m_i = max(floor_i, r_i + d_i y . a_i), where a_i are the moments of point i. Newton's method finds the
m_i on the concave dual; every step is a system of ten equations. If no masses have the second moments, these are relaxed: the square of
their error over g is added to the sum above. Then the dual loses g |y|^2 / 2, with the multipliers y of the second moments, and has a
maximum wherever mass and centre are possible.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from softffd.errors import SoftffdError
from softffd.lattice import rest_grid
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import area_vectors, merge_by_position

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
ROUNDS, ENOUGH = 60, 1e-13
"""Most Newton steps, and the largest error of a moment that ends them, in units of the box"""
GIVES = (1e-5, 1e-4, 1e-3)
"""Values of g, by which second moments are relaxed if necessary: the first for which Newton's method converges is taken. With 1e-5
inertias are within 1 % of the nearest."""


def covariance(distribution: str, mesh: Mesh | None, size: ArrayLike) -> np.ndarray:
    """Returns the second moments (3, 3) [m^2] of the object about its centre of mass, per unit of mass, as mass.distribution spreads it.

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
    """Returns second moments of points, triangles or tetrahedra. corners: (m, 1 or 3, 3). at_origin: a further corner is at the
    origin."""
    ends = corners.shape[1] + at_origin
    total, sums = content.sum(), corners.sum(axis=1)
    centre = _times(sums.T, content) / (ends * total)
    own = np.einsum("f,fcx,fcy->xy", content, corners, corners) + np.einsum("f,fx,fy->xy", content, sums, sums)
    return own / (ends * (ends + 1) * total) - np.outer(centre, centre)


def inertia_ratio(shares: np.ndarray, wanted: np.ndarray, size: ArrayLike, places: np.ndarray | None = None) -> np.ndarray:
    """Returns the ratio (3,), about x, y, z, of the inertia of masses `shares` (nx, ny, nz) to that of the covariance `wanted` (3, 3)
    [m^2].

    places: (n, 3) in a box of sides 1; by default those of control points.
    """
    at, weights = (_places(shares.shape) if places is None else places) * np.asarray(size), shares.ravel() / shares.sum()
    at -= weights @ at
    have, want = (np.trace(each) - np.diag(each) for each in (np.einsum("p,px,py->xy", weights, at, at), wanted))
    return np.divide(have, want, out=np.ones(3), where=want > 1e-12 * np.max(np.square(size)))


def matched_shares(rows: np.ndarray, object_rows: np.ndarray, wanted: np.ndarray, size: ArrayLike, floor: float) -> np.ndarray | None:
    """Returns fractions (nx, ny, nz) near `rows`, >= `floor`, with total and centre of `object_rows` and the covariance `wanted` [m^2].

    Returns None if there are no such fractions.
    """
    near, of_object, places = rows.ravel() / rows.sum(), object_rows.ravel() / object_rows.sum(), _places(rows.shape)
    found = _projected(near, near, _moments(places), _aim(_times(places.T, of_object), wanted, size), np.full(near.shape, floor))
    return None if found is None else found.reshape(rows.shape)


def nearest_shares(
    rows: np.ndarray, metric: np.ndarray, places: np.ndarray, wanted: np.ndarray, size: ArrayLike, floors: Sequence[float]
) -> np.ndarray | None:
    """Returns fractions (nx, ny, nz) near `rows`, with their total and centre, and the covariance `wanted` [m^2] or the nearest possible.

    metric: fractions; every point keeps a part `floor` of its own, the first of `floors` that is possible. places: (n, 3) in a box of
    sides 1, about its middle. Returns None if no fractions have total and centre.
    """
    near, scale = rows.ravel() / rows.sum(), metric.ravel() / metric.sum()
    moments, aim = _moments(places), _aim(_times(places.T, near), wanted, size)
    tries = [*((floor, 0.0) for floor in floors), *((floors[-1], gives) for gives in GIVES)]
    found = (_projected(near, scale, moments, aim, floor * scale, gives) for floor, gives in tries)
    return next((each.reshape(rows.shape) for each in found if each is not None), None)


def require_matched(rows: np.ndarray, object_rows: np.ndarray, wanted: np.ndarray, size: ArrayLike, uniform_share: float) -> np.ndarray:
    """Returns matched fractions, each >= `uniform_share` of the mean. If there are none, raises SoftffdError that says what is
    possible."""
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
    """Returns the largest floor under `below` for which there are matched fractions, to a twentieth; None if there is none."""
    low, high = 0.0, below
    if matched_shares(rows, object_rows, wanted, size, low) is None:
        return None
    while high - low > 0.05 * high and high > 1e-6 * below:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if matched_shares(rows, object_rows, wanted, size, middle) is None else (middle, high)
    return low


def _places(counts: tuple[int, ...]) -> np.ndarray:
    """Returns the control points (n, 3) about the middle of a box of sides 1."""
    return rest_grid(counts, np.full(3, -0.5), np.ones(3)).reshape(-1, 3)


def _moments(places: np.ndarray) -> np.ndarray:
    """Returns the ten moments of points at places (n, 3), shape (10, n)."""
    return np.stack([np.ones(len(places)), *places.T, *(places[:, a] * places[:, b] for a, b in PAIRS)])


def _aim(centre: np.ndarray, wanted: np.ndarray, size: ArrayLike) -> np.ndarray:
    """Returns the moments (10,) of a mass of 1 with this centre (3,), in a box of sides 1, and this covariance [m^2]."""
    second = wanted / np.outer(np.asarray(size), np.asarray(size)) + np.outer(centre, centre)
    return np.array([1.0, *centre, *(second[a, b] for a, b in PAIRS)])


def _projected(
    near: np.ndarray, scale: np.ndarray, moments: np.ndarray, aim: np.ndarray, floor: np.ndarray, gives: float = 0.0
) -> np.ndarray | None:
    """Returns numbers (n,) with moments (10, n) @ numbers = aim, none below its floor (n,), nearest to `near` in the metric 1 / scale, or
    None.

    gives: the g by which second moments are relaxed; 0: not at all.
    """
    soft = np.append(np.zeros(4), np.full(6, gives))

    def at(y: np.ndarray) -> tuple[np.ndarray, float]:
        """Returns the fractions for these multipliers, and the value of the dual."""
        push = _times(moments.T, y)
        shares = np.maximum(floor, scale * (near / scale + push))
        return shares, float((aim * y - 0.5 * soft * y**2).sum() + (0.5 * (shares - near) ** 2 / scale - push * shares).sum())

    y = np.zeros(len(aim))
    shares, value = at(y)
    for _ in range(ROUNDS):
        missing = aim - _times(moments, shares) - soft * y
        if np.abs(missing).max() < ENOUGH:
            return shares
        free = shares > floor
        curvature = _times(moments[:, None], moments * scale * free) + np.diag(soft)
        if np.linalg.cond(curvature) > 1e13:
            return None
        way, length = _solved(curvature, missing), 1.0
        while True:
            shares, new = at(y + length * way)
            if new >= value + 1e-4 * length * (missing * way).sum() - 1e-15 * abs(value):
                break
            length /= 2
            if length < 1e-10:
                return None
        y, value = y + length * way, new
    return None


def _times(matrix: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Returns matrix (..., n) @ numbers (..., n), summed in an order that BLAS does not choose.

    BLAS sums as registers are wide: a scene's masses, and with them its results and its GUID, would differ by rounding between machines.
    """
    return (matrix * numbers).sum(axis=-1)


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Returns the solution (n,) of a symmetric positive definite system (n, n), without BLAS too: by elimination without pivots."""
    rows = np.column_stack([matrix, right])
    for i, row in enumerate(rows):
        row /= row[i]
        others = np.arange(len(rows)) != i
        rows[others] -= rows[others, i, None] * row
    return rows[:, -1]
