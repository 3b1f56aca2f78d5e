"""Scenes of solids, and readings of runs.

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
from validation.patches import Patches

__all__ = ["Patches", "braked", "counts_of", "face_mean", "node_masses", "node_positions", "node_velocities", "nodes", "solid"]


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
