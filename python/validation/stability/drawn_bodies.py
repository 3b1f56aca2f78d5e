"""Random scenes of bodies whose surface meets obstacles (planes or solids), and random scenes of bodies with internal damping."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from softffd.rotation import between_directions, turned
from softffd.scene.keys import SOLIDS
from validation.shapes import Shape, cube, sphere
from validation.stability.drawn import Course, Drawn, Draws, drawn

OWN_BODY = 1_000_000  # added to a seed for the draws of the body


def drawn_surface(seed: int) -> Drawn:
    """Returns the scene of a seed with a body that has a surface."""
    scene = drawn(seed)
    document = scene.document
    material = _softer(document["material"])
    regions = [region for region in document["region"] if "mass" not in region]
    surface, words = _body(Draws(OWN_BODY + seed), np.array(document["lattice"]["size"]))
    return replace(scene, document=document | {"material": material, "region": regions}, surface=surface, body=words)


def _softer(material: dict[str, Any]) -> dict[str, Any]:
    """Returns the material with stiffnesses reduced to up to 1e6 N/m instead of up to 1e10 N/m."""
    return material | {"stiffness": {kind: float(f"{1e2 * (value / 1e2) ** 0.5:.4g}") for kind, value in material["stiffness"].items()}}


def _body(draws: Draws, size: np.ndarray) -> tuple[Shape, str]:
    """Returns an ellipsoid or a cuboid in a box of this size (3,) [m], at the sides of the box or inside, and a description."""
    margin = draws.between(0.02, 0.15) * draws.chance(0.7)
    if draws.chance(0.6):
        vertices, faces = sphere(draws.whole(1, 4), radius=0.5 - margin)
    else:
        vertices, faces = cube(draws.whole(2, 9), margin)
    return (size * vertices, faces), f"{len(vertices)} vertices, {margin:g} inside"


OWN_SOLIDS = 2_000_000  # added to a seed for the draws of the solids


def drawn_solids(seed: int) -> Drawn:
    """Returns the scene of a seed with a body beside solids."""
    scene, draws = drawn_surface(seed), Draws(OWN_SOLIDS + seed)
    size = max(scene.document["lattice"]["size"])
    sections: dict[str, Any] = {"plane": [], **{section: [] for section in SOLIDS}}
    courses = {}
    for plane in scene.document["plane"]:
        normal, course = scene.planes[plane["name"]]
        kind, shape, axis, depth = solid_at(draws, size, normal)
        point = course.point - depth * normal
        keys = plane | shape | {"point": point.tolist()}
        if kind != "cylinder":
            del keys["normal"]
        if kind != "cylinder" and "inputs" in keys:
            keys["inputs"] = [each for each in keys["inputs"] if each != "normal"] + ["rotation"] * (kind == "box")
        sections[kind].append(keys)
        courses[plane["name"]] = axis, Course(point, course.turning_at, course.velocities, course.spins)
    return replace(scene, document=scene.document | sections, planes=courses)


def solid_at(draws: Draws, size: float, normal: np.ndarray, most: float = 10.0) -> tuple[str, dict[str, Any], np.ndarray, float]:
    """Returns the section, its keys, the axis, and the depth [m] of the centre below the outermost point in the direction of a normal.

    most: the largest radius and length, divided by the size [m]."""
    radius, length = draws.log(0.1, most) * size, draws.log(0.3, most) * size
    across = np.cross(normal, draws.direction())
    across = across / np.sqrt((across**2).sum())
    kind = draws.one_of(("sphere", "cylinder", "cylinder", "box", "box"))
    flat = draws.chance(0.4)
    if kind == "sphere":
        return kind, {"radius": radius}, normal, radius
    if kind == "cylinder":
        axis, depth = (normal, length / 2) if flat else (across, radius)
        return kind, {"radius": radius, "length": length, "normal": axis.tolist()}, axis, depth
    return _box(draws, size, normal, flat)


def _box(draws: Draws, size: float, normal: np.ndarray, flat: bool) -> tuple[str, dict[str, Any], np.ndarray, float]:
    """Returns a box as solid_at does, with a side up if flat, else with a corner up."""
    sides = [draws.log(0.2, 5.0) * size for _ in "xyz"]
    turn = between_directions(np.array([0.0, 0.0, 1.0]), normal if flat else draws.direction())
    angle = float(np.sqrt((turn**2).sum()))
    rotation = {"axis": (turn / angle).tolist() if angle > 0 else [0.0, 0.0, 1.0], "degrees": float(np.degrees(angle))}
    axes = np.array([turned(each, turn) for each in np.eye(3)])
    depth = float((np.array(sides) / 2 * np.abs((axes * normal).sum(axis=1))).sum())
    return "box", {"size": sides, "rotation": rotation}, axes[2], depth


OWN_DAMPING = 3_000_000  # added to a seed for the draw of the damping


def drawn_damped(seed: int) -> Drawn:
    """Returns the scene of a seed with a body that has internal damping of 1e-6 to 1e-2 s."""
    scene = drawn(seed)
    damping = Draws(OWN_DAMPING + seed).log(1e-6, 1e-2)
    material = _softer(scene.document["material"]) | {"internal_damping": damping}
    regions = [region for region in scene.document["region"] if "mass" not in region]
    return replace(scene, document=scene.document | {"material": material, "region": regions}, body=f"internal damping {damping:.1e}")
