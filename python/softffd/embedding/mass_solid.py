"""Masses of a solid's nodes.

A box of one density gives each node the weight of the quadrature there, so that mass, centre and inertia are those of the box. An object
in the box is first distributed to the nodes around each part, by hat functions along each axis, which give no negative mass: mass and
centre are the object's. The masses nearest to these that have its inertia too are then found (inertia.py). Every node has a fraction
FLOORS of what the box would give at least: a lighter one makes the steps shorter, because the stiffness is that of the box. For a thin
object there are no such masses, since masses at the places x_i and x_i+1 around an X have at least the variance (X - x_i) (x_i+1 - X);
then the inertia is as near to the object's as possible.
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
"""Least fractions of the box's mass at a node; the first that is possible counts."""


def node_masses(
    distribution: str, *, counts: tuple[int, int, int], origin: ArrayLike, size: ArrayLike, mesh: Mesh | None, total: float | None = None,
    density: float | None = None,
) -> Masses:  # fmt: skip
    """Returns the masses of a solid's nodes, as `point_masses` does for control points: for "box", "vertices", "surface" and "volume".

    Raises SoftffdError if the mesh does not fit, or if no masses have the object's centre.
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
    """Returns the parts (nx, ny, nz) of a mesh's vertices, surface or volume that the nodes have by hat functions; they do not yet sum to
    one."""
    degree = 4 if distribution == "volume" else 3  # degree of W_i W_j I_k, and of W_i W_j W_k
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
