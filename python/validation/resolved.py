"""Converts a scene into the input of the mechanics in numpy: plain numbers and lists, with all defaults and selections resolved."""

from __future__ import annotations

from typing import Any

import numpy as np

from softffd.fmu.package import scene_masses
from softffd.lattice import point_at
from softffd.names import variable_name
from softffd.scene.scene import Scene
from softffd.scene.selection import Selection


def resolved(scene: Scene, mass: np.ndarray | None = None) -> dict[str, Any]:
    """Returns the data of a scene that `validation.mechanics` needs, serializable as JSON. mass: (n,) [kg], if already known."""

    def points(selection: Selection) -> list[int]:
        return scene.select(selection).tolist()

    lattice, material, stiffness = scene.lattice, scene.material, scene.material.stiffness
    masses = scene_masses(scene)
    return {
        "counts": lattice.points,
        "origin": lattice.origin,
        "size": lattice.size,
        "topology": lattice.springs,
        "rest": scene.rest_positions().tolist(),
        "mass": (masses.mass if mass is None else mass).tolist(),
        "weight": None if masses.weight is None else masses.weight.tolist(),
        "stiffness": None if stiffness is None else [stiffness.edge, stiffness.face, stiffness.body],
        "youngs_modulus": material.youngs_modulus,
        "damping": material.damping,
        "internal_damping": material.internal_damping,
        "regions": [
            {"points": points(r.points), "stiffness": r.stiffness, "youngs_modulus": r.youngs_modulus, "damping": r.damping}
            | {"internal_damping": r.internal_damping}
            for r in scene.region
        ],
        "forces": {variable_name("load", load.name): points(load.points) for load in scene.load}
        | {variable_name("force", point_at(p, lattice.points)): [p] for p in points(scene.inputs.forces)},
        "initial": scene.initial.model_dump() | {"rotation": scene.initial.rotation_vector()},
    }
