"""Masses of a solid's nodes.

A box of one density gives each node the weight of the quadrature there, so that mass, centre and inertia are its own. Of an object in the
box each part goes first to the nodes around it, by hat functions along each axis, of which no share is negative: mass and centre are the
object's. The masses nearest to these have its inertia too (inertia.py), and at every node a part FLOORS of what the box would give: a
lighter one makes the steps shorter, because the stiffness is that of the box. A thin object leaves no such masses, since masses at the
places x_i and x_i+1 around an X have the variance (X - x_i) (x_i+1 - X) at least; then the inertia is as near to the object's as it goes.
"""

import numpy as np
from numpy.typing import ArrayLike

from softffd.embedding.inertia import covariance, inertia_ratio, nearest_shares
from softffd.embedding.mass import Masses, flat_shares, mesh_shares, total_mass
from softffd.embedding.mass_pieces import Axis, Local
from softffd.embedding.nodes import axis_nodes, rest_nodes, volume_shares
from softffd.errors import SoftffdError
from softffd.mesh.mesh import Mesh

FLOORS = (0.3, 0.25, 0.2, 0.15, 0.1)
"""The first that is possible counts."""


def node_masses(
    distribution: str, *, counts: tuple[int, int, int], origin: ArrayLike, size: ArrayLike, mesh: Mesh | None, total: float | None = None,
    density: float | None = None,
) -> Masses:  # fmt: skip
    """The masses of a solid's nodes, as `point_masses` gives those of control points: for "box", "vertices", "surface" and "volume".

    Raises SoftffdError where the mesh does not fit, or where no masses have the object's centre.
    """
    whole, box, wanted = total_mass(total, density, mesh, size), volume_shares(counts), covariance(distribution, mesh, size)
    places = rest_nodes(counts, np.full(3, -0.5), np.ones(3)).reshape(-1, 3)
    shares: np.ndarray | None = box
    if distribution != "box":
        assert mesh is not None
        shares = nearest_shares(hat_shares(distribution, counts, origin, size, mesh), box, places, wanted, size, FLOORS)
    if shares is None:
        raise SoftffdError(
            f'mass.distribution: "{distribution}" is not possible: no masses of these nodes have the centre of the object, which is at the '
            'rim of the box. Wanted a box that the object fills better, or "box".'
        )
    return Masses(whole * flat_shares(shares), np.zeros(3), inertia_ratio(shares, wanted, size, places))


def hat_shares(distribution: str, counts: tuple[int, ...], origin: ArrayLike, size: ArrayLike, mesh: Mesh) -> np.ndarray:
    """What the nodes (nx, ny, nz) have of a mesh's vertices, surface or volume by hat functions between them; not yet summing to one."""
    degree = 4 if distribution == "volume" else 3  # of W_i W_j I_k and of W_i W_j W_k
    return mesh_shares(distribution, [_hats(n) for n in counts], lambda pieces: np.full(len(pieces), degree), origin, size, mesh)


def _hats(n: int) -> Axis:
    nodes = axis_nodes(n)
    lengths = np.diff(nodes)
    halves = np.append(lengths, 0) / 2 + np.append(0, lengths) / 2

    def cell(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first = np.clip(np.searchsorted(nodes, t, side="right") - 1, 0, n - 2)
        return first, (t - nodes[first]) / lengths[first]

    def weights(t: np.ndarray) -> Local:
        first, share = cell(t)
        return first, np.stack([1 - share, share], axis=1)

    def integrals(t: np.ndarray) -> Local:
        first, share = cell(t)
        rising = lengths[first] * share**2 / 2
        before = np.append(0, lengths)[first] / 2
        return first, np.stack([before + lengths[first] * share - rising, rising], axis=1)

    return Axis(nodes, weights, integrals, halves)
