"""Scenes drawn at random in which the object's own surface meets solids: those of drawn_surface.py with one for each plane."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from softffd.validation.stability.drawn import Course, Drawn, Draws
from softffd.validation.stability.drawn_surface import drawn_surface

OWN = 2_000_000
"""Added to a seed for the draws of the solids."""


def drawn_solids(seed: int) -> Drawn:
    """The scene of a seed, of a body beside solids."""
    scene, draws = drawn_surface(seed), Draws(OWN + seed)
    size = max(scene.document["lattice"]["size"])
    sections: dict[str, Any] = {"plane": [], "sphere": [], "cylinder": []}
    courses = {}
    for plane in scene.document["plane"]:
        normal, course = scene.planes[plane["name"]]
        kind, shape, axis, depth = _solid(draws, size, normal)
        point = course.point - depth * normal
        keys = plane | shape | {"point": point.tolist()}
        if kind == "sphere":
            del keys["normal"]
        if "inputs" in keys:
            keys["inputs"] = [each for each in keys["inputs"] if each in keys or "velocity" in each]
        sections[kind].append(keys)
        courses[plane["name"]] = axis, Course(point, course.turning_at, course.velocities, course.spins)
    return replace(scene, document=scene.document | sections, planes=courses)


def _solid(draws: Draws, size: float, normal: np.ndarray) -> tuple[str, dict[str, Any], np.ndarray, float]:
    """The section, its keys, the axis, and how far the centre is below the outermost point in the direction of a normal [m]."""
    radius, length = draws.log(0.1, 10.0) * size, draws.log(0.3, 10.0) * size
    across = np.cross(normal, draws.direction())
    across = across / np.sqrt((across**2).sum())
    if draws.chance(0.4):
        return "sphere", {"radius": radius}, normal, radius
    axis, depth = (normal, length / 2) if draws.chance(0.3) else (across, radius)
    return "cylinder", {"radius": radius, "length": length, "normal": axis.tolist()}, axis, depth
