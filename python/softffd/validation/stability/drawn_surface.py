"""Scenes drawn at random in which obstacles meet the object's own surface: those of drawn.py with a round or a square body in the box.

What explicit steps would take minutes for is left out: stiffnesses are softer, 1e2 to 1e6 N/m, and no points are light.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softffd.validation.bodies import Shape, cube, sphere
from softffd.validation.stability.drawn import Drawn, Draws, drawn

OWN = 1_000_000
"""Added to a seed for the draws of the body."""


def drawn_surface(seed: int) -> Drawn:
    """The scene of a seed, of a body with a surface."""
    scene = drawn(seed)
    document = scene.document
    stiffness = {kind: float(f"{1e2 * (value / 1e2) ** 0.5:.4g}") for kind, value in document["material"]["stiffness"].items()}
    material = document["material"] | {"stiffness": stiffness}
    regions = [region for region in document["region"] if "mass" not in region]
    surface, words = _body(Draws(OWN + seed), np.array(document["lattice"]["size"]))
    return replace(scene, document=document | {"material": material, "region": regions}, surface=surface, body=words)


def _body(draws: Draws, size: np.ndarray) -> tuple[Shape, str]:
    """An ellipsoid or a cuboid in a box of this size (3,) [m], touching its sides or further in, and what it is."""
    margin = draws.between(0.02, 0.15) * draws.chance(0.7)
    if draws.chance(0.6):
        vertices, faces = sphere(draws.whole(1, 4), radius=0.5 - margin)
    else:
        vertices, faces = cube(draws.whole(2, 9), margin)
    return (size * vertices, faces), f"{len(vertices)} vertices, {margin:g} inside"
