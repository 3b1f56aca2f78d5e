"""Random scenes of finite-element bodies with one patch or a few. Their nodes or their surface meet planes or solids."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from validation.stability.drawn import Drawn, Draws, Ramp, drawn, masses_and_damping
from validation.stability.drawn_bodies import drawn_solids, drawn_surface

OWN_ELEMENTS = 4_000_000  # added to a seed for the draws of the elements
SAG = 0.25  # largest sag of a column under its own weight, as a fraction of its height
PRESSED = 0.03  # largest strain from a load alone
SLENDER = 2.5  # largest ratio of a cell's sides if there are several patches


def drawn_elements(seed: int) -> Drawn:
    """Returns the scene of a seed with a body of 1e3 to 1e7 Pa and Poisson's ratio 0 to 0.49."""
    draws = Draws(OWN_ELEMENTS + seed)
    scene = draws.one_of((drawn, drawn_surface, drawn_solids))(seed)
    document, size = scene.document, np.array(scene.document["lattice"]["size"])
    modulus = 1e3 * math.sqrt(drawn(seed).document["material"]["stiffness"]["edge"] / 1e2)
    modulus = float(f"{min(1e7, max(1e3, modulus)):.4g}")
    ratio = draws.one_of((0.0, 0.25, 0.45, 0.49, *[draws.between(0.0, 0.49)] * 4))
    counts = _counts(draws, size)
    density = draws.log(1.0, min(1e3, SAG * modulus / 10 / size.max()))
    total = float(f"{density * np.prod(size):.4g}")
    damping, regions = masses_and_damping(draws, counts, total)
    internal = draws.log(1e-6, 1e-2) * draws.chance(0.5)
    material = {"model": "solid", "youngs_modulus": modulus, "poissons_ratio": ratio, "internal_damping": internal, "damping": damping}
    sections: dict[str, Any] = {
        "lattice": document["lattice"] | {"points": counts},
        "mass": {"total": total},
        "material": material,
        "region": [region for region in regions if "mass" not in region],
    }
    louder, area = draws.log(1.0, 1e3), float(np.sort(size)[:2].prod())
    loads = {name: _louder(ramp, louder, PRESSED * modulus * area) for name, ramp in scene.loads.items()}
    body = ", ".join([scene.body] * bool(scene.body) + [f"internal damping {internal:.1e}"] * bool(internal))
    return replace(scene, document=document | sections, loads=loads, body=body)


def _counts(draws: Draws, size: np.ndarray) -> list[int]:
    """Returns the numbers of control points of one patch, of two along the longest side, or seldom of eight."""
    kind, longest = draws.one_of("1111111228"), int(size.argmax())
    counts = {"1": [4, 4, 4], "2": [7 if axis == longest else 4 for axis in range(3)], "8": [7, 7, 7]}[kind]
    cells = size / (np.array(counts) - 1)
    return counts if cells.max() <= SLENDER * cells.min() else [4, 4, 4]


def _louder(ramp: Ramp, factor: float, most: float) -> Ramp:
    """Returns a load multiplied by a factor, up to a largest force [N]."""
    force = factor * ramp.force
    norm = math.sqrt((force**2).sum())
    return replace(ramp, force=np.round(force * min(1.0, most / norm), 6))
