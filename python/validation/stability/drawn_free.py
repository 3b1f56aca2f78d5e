"""Random scenes with a free rigid body that has mass: an obstacle that flies at the object, or a part bonded to the object."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from softffd.scene.keys import SOLIDS
from validation.stability.drawn import FACES, Drawn, Draws, Ramp, drawn
from validation.stability.drawn_bodies import drawn_damped, drawn_solids, drawn_surface, solid_at
from validation.stability.drawn_elements import drawn_elements

OWN_FREE = 5_000_000  # added to a seed for the draws of the free body
GRIP = 0.05  # largest offset of a part's centre from the centroid of its points per axis, by the smallest side


def drawn_free(seed: int) -> Drawn:
    """Returns the scene of a seed with a free body of 1e-3 to 1e3 times the mass of the object."""
    draws = Draws(OWN_FREE + seed)
    bonded = draws.chance(0.3)
    families = (drawn, drawn_damped, drawn_elements) if bonded else (drawn_surface, drawn_surface, drawn_solids, drawn_elements)
    scene = draws.one_of(families)(seed)
    if not bonded and scene.surface is None:  # finite elements whose nodes meet planes
        scene = drawn_surface(seed)
    if bonded and scene.surface is None and scene.planes:  # the control points would meet obstacles
        scene = drawn_surface(seed)
    total = scene.document["mass"]["total"]
    mass = draws.log(1e-3, 1e3) * total
    return _part(draws, scene, mass) if bonded else _obstacle(draws, scene, mass)


def _obstacle(draws: Draws, scene: Drawn, mass: float) -> Drawn:
    """Returns the scene with a free solid that moves at the object from above, or starts in contact, with or without a guide."""
    document = scene.document
    size = np.array(document["lattice"]["size"]) * document["initial"]["stretch"]
    normal = draws.direction(0.7) if draws.chance(0.6) else draws.direction(0.0)
    normal = -normal / np.sqrt((normal**2).sum())  # out of the obstacle, towards the object
    clearance = draws.log(1e-4, 0.1) * draws.chance(0.8)
    kind, shape, _, depth = solid_at(draws, float(size.max()), normal, most=1.0)
    middle = size / 2
    reach = float((np.abs(normal) * middle).sum())
    place = np.round(middle - (reach + clearance + depth) * normal, 6)
    speed = draws.between(0.0, 1.5)
    across = np.array([draws.between(-0.3, 0.3) for _ in "xyz"])
    spin = [draws.between(-3, 3) for _ in "xyz"] if draws.chance(0.4) else [0.0] * 3
    keys: dict[str, Any] = {
        "name": "free", "motion": "free", "mass": float(f"{mass:.4g}"), "point": place.tolist(), **shape,
        "friction": 0.0 if draws.chance(0.3) else draws.between(0.05, 0.8),
    }  # fmt: skip
    if draws.chance(0.3):
        keys |= {"guide": normal.tolist(), "velocity": (speed * normal).tolist()}
    else:
        keys |= {"velocity": (speed * normal + across).tolist(), "angular_velocity": spin}
    pushes = _push(draws, scene, f"{kind}.free", mass)
    sections = {section: list(document.get(section, ())) for section in SOLIDS}
    sections[kind].append(keys)
    return replace(scene, document=document | sections, pushes=pushes)


def _part(draws: Draws, scene: Drawn, mass: float) -> Drawn:
    """Returns the scene with a free part bonded to a face that nothing else holds."""
    document = scene.document
    size = np.array(document["lattice"]["size"])
    held = {pin["points"] for pin in document["pin"]}
    opposite = {face[0] + "+-"[face[1] == "+"] for face in held}
    face = draws.one_of([each for each in FACES if not held or each in opposite])
    centroid = size / 2
    axis = "xyz".index(face[0])
    centroid[axis] = size[axis] if face[1] == "+" else 0.0
    off = np.array([draws.between(-1, 1) for _ in "xyz"]) * GRIP * size.min()
    moments = np.array([draws.between(0.5, 1.0) for _ in "xyz"]) * mass * size.min() ** 2 / 6
    keys: dict[str, Any] = {
        "name": "free", "motion": "free", "mass": float(f"{mass:.4g}"), "points": face, "origin": np.round(centroid + off, 6).tolist(),
    }  # fmt: skip
    if draws.chance(0.3):
        keys["guide"] = draws.direction().tolist() if held else [0.0, 0.0, 1.0]
    else:
        keys["inertia"] = [float(f"{each:.4g}") for each in moments]
    pushes = _push(draws, scene, "pin.free", mass)
    return replace(scene, document=document | {"pin": [*document["pin"], keys]}, pushes=pushes)


def _push(draws: Draws, scene: Drawn, name: str, mass: float) -> dict[str, Ramp]:
    """Returns, in some scenes, a force on the free body that is scaled by the masses of free body and object."""
    if not draws.chance(0.3):
        return {}
    most = draws.log(0.1, 10.0) * (mass + scene.document["mass"]["total"])
    return {f"{name}.force": Ramp(np.round(most * draws.direction(), 6), scene.duration * draws.between(0.2, 1.0), draws.chance(0.5))}
