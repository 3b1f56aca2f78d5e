"""Masses of the control points: the object's mass, distributed by the weights with which the object follows them.

A sample of mass m_s at (u_s, v_s, w_s) gives control point ijk the part m_s B_i(u_s) B_j(v_s) B_k(w_s). The weights sum to one and
reproduce positions, so the total and the centre of mass are the object's own (Xia & Wang 2009 leave the rule open). For a surface or a
solid the sum becomes an integral. Its integrand is a polynomial in the coordinates of each triangle, and a quadrature that is exact for
its degree leaves only rounding. The solid's integral is turned into one over its surface by the divergence theorem:

    integral of B_i B_j B_k dV  =  integral of B_i(u) B_j(v) I_k(w) n_z dA,

where n_z dA is a triangle's shadow on the x-y plane and I_k(w) = integral of B_k from 0 to w = sum over l > k of B_l(w) / nz, with the
Bernstein polynomials B_l of one degree more. mass_pieces.py integrates.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from softffd.embedding.deform import lattice_coordinates
from softffd.embedding.inertia import covariance, inertia_ratio, require_matched
from softffd.embedding.mass_pieces import Axes, Degrees, control_axis, control_degrees, triangle_shares, vertex_shares
from softffd.errors import SoftffdError
from softffd.lattice import rest_grid, shared_by_corners, to_flat
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import merge_by_position


@dataclass(frozen=True, eq=False)
class Masses:
    """Masses of the control points.

    mass: (n,) kg, flat order p = i + nx (j + ny k). shift: (3,) m, how far `uniform_share` moved the centre of mass.
    weight: (n,) kg, the masses on which gravity acts, if they differ from `mass`. inertia: (3,), ratio of the masses' moments of inertia
    to those of the object, about x, y and z through the centre of mass.
    """

    mass: np.ndarray
    shift: np.ndarray
    inertia: np.ndarray
    weight: np.ndarray | None = None


def point_masses(
    distribution: str, *, counts: tuple[int, int, int], origin: ArrayLike, size: ArrayLike, mesh: Mesh | None, total: float | None = None,
    density: float | None = None, uniform_share: float = 0.1, basis: str = "bezier", inertia: str = "lumped",
) -> Masses:  # fmt: skip
    """Returns the masses of the control points of a lattice: `counts` in the box `origin`, `size` (3,) m.

    distribution: "uniform" (equal masses), "box" (even through the box: each cell gives an eighth to each of its corners), "vertices" (an
    equal mass at each distinct vertex position), "surface" (even over the area) or "volume" (even through the solid); all but the first
    two need `mesh`, "volume" a closed one.
    total: kg, > 0; or density: kg/m^3, > 0, times the volume of a closed mesh, or of the box without a mesh. Exactly one of the two.
    uniform_share: 0 to 1; this fraction of the total is spread evenly instead, which moves the centre of mass by `shift`. basis: of the
    volume, "bezier" or "bspline".
    inertia: "lumped" (each sample's mass to the control points that move it) or "matched" (with the inertia of the object; gravity acts
    on the lumped masses, and every point has at least `uniform_share` of the mean mass).
    Raises SoftffdError if the mesh does not fit, or a control point would have no mass. The scene has already checked the values.
    """
    total = total_mass(total, density, mesh, size)
    shares = _shares(distribution, counts, origin, size, mesh, basis)
    shares /= shares.sum()
    blended = (1 - uniform_share) * shares + uniform_share / shares.size
    wanted = covariance(distribution, mesh, size)
    if inertia == "matched":
        found = require_matched(blended, shares, wanted, size, uniform_share)
        return Masses(total * flat_shares(found), np.zeros(3), np.ones(3), total * flat_shares(shares))
    _require_all_positive(blended, uniform_share)
    shift = _centre(blended, origin, size) - _centre(shares, origin, size)
    return Masses(total * flat_shares(blended), shift, inertia_ratio(blended, wanted, size))


def total_mass(total: float | None, density: float | None, mesh: Mesh | None, size: ArrayLike) -> float:
    """Returns the given mass [kg], or that of a density [kg/m3] in a closed mesh, or without a mesh in a box of `size` [m]."""
    if density is not None:
        total = density * (enclosed_volume(mesh) if mesh is not None else float(np.prod(np.asarray(size))))
    assert total is not None  # one of the two is given
    return total


def flat_shares(shares: np.ndarray) -> np.ndarray:
    """Returns shares (nx, ny, nz) in flat order (n,)."""
    return to_flat(shares[..., None])[:, 0]


def filled_words(mesh: Mesh | None, size: tuple[float, ...] | np.ndarray) -> str | None:
    """Returns in words how much of the box of `size` [m] a closed mesh fills, and below 60 % that the elastic body is the whole box; None
    without a closed mesh."""
    if mesh is None or not mesh.closed:
        return None
    try:
        share = enclosed_volume(mesh) / float(np.prod(size))
    except SoftffdError:
        return None
    return f"fills {100 * share:.0f} % of its box" + ("; the elastic body is the whole box" if share < 0.6 else "")


def enclosed_volume(mesh: Mesh) -> float:
    """Returns the volume inside a closed mesh, m^3. Raises SoftffdError if the mesh is open or encloses nothing."""
    if not mesh.closed:
        raise SoftffdError(
            f"mesh '{mesh.name}' is not closed: {mesh.open_edges} edges have no neighbour that runs the other way (a hole, or faces that "
            "look inwards), so it has no volume. Wanted a closed mesh for mass.density and for mass.distribution = 'volume'; close it, or "
            "give mass.total with the distribution 'surface'."
        )
    corners = (mesh.vertices - mesh.bounds.mean(axis=0))[mesh.faces]
    volume = abs(float(np.linalg.det(corners).sum()) / 6)
    if volume <= 1e-12 * np.prod(np.ptp(mesh.bounds, axis=0)):
        raise SoftffdError(f"mesh '{mesh.name}' is closed but encloses no volume; wanted a solid body")
    return volume


def _shares(distribution: str, counts: tuple[int, ...], origin: ArrayLike, size: ArrayLike, mesh: Mesh | None, basis: str) -> np.ndarray:
    """Returns the fractions (nx, ny, nz) of the control points, which do not yet sum to one."""
    if distribution == "uniform":
        return np.ones(counts)
    if distribution == "box":
        return shared_by_corners(np.ones([count - 1 for count in counts]))
    assert mesh is not None
    axes, degrees = [control_axis(n, basis) for n in counts], control_degrees(counts, basis, solid=distribution == "volume")
    return mesh_shares(distribution, axes, degrees, origin, size, mesh)


def mesh_shares(distribution: str, axes: Axes, degrees: Degrees, origin: ArrayLike, size: ArrayLike, mesh: Mesh) -> np.ndarray:
    """Returns the parts (nx, ny, nz) of a mesh's vertices, surface or volume that points have, which do not yet sum to one. Raises
    SoftffdError if a body of a volume is inside out."""
    if distribution == "vertices":
        _, positions = merge_by_position(mesh.vertices[np.unique(mesh.faces)])
        return vertex_shares(axes, lattice_coordinates(positions, origin, size))
    if distribution == "surface":
        return triangle_shares(axes, mesh, origin, size, degrees, solid=False)
    enclosed_volume(mesh)
    shares = triangle_shares(axes, mesh, origin, size, degrees, solid=True)
    shares /= shares.sum()
    if shares.min() < -1e-9 / shares.size:
        raise SoftffdError(
            f"mesh '{mesh.name}': some of its bodies are inside out, so that their volume would count as negative. Wanted faces that all "
            "run counter-clockwise seen from outside; recalculate the normals in the modelling program."
        )
    return np.maximum(shares, 0.0)


def _require_all_positive(shares: np.ndarray, uniform_share: float) -> None:
    if shares.min() > 1e-12 / shares.size:
        return
    point = [int(index) for index in np.unravel_index(shares.argmin(), shares.shape)]
    raise SoftffdError(
        f"mass.uniform_share: with {uniform_share:g}, control point {point} has practically no mass "
        f"({shares.min() * shares.size:.2g} of the mean), since the mesh has nothing near it, and could not be "
        "simulated. Wanted a fraction that gives every point some mass; 0.1 is usual."
    )


def _centre(shares: np.ndarray, origin: ArrayLike, size: ArrayLike) -> np.ndarray:
    """Returns the centre of mass (3,) m of shares (nx, ny, nz) that sum to one."""
    grid = rest_grid(shares.shape, np.zeros(3), np.ones(3))
    return np.asarray(origin) + np.asarray(size) * [float((shares * grid[..., axis]).sum()) for axis in range(3)]
