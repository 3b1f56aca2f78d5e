"""A scene as the mechanics in numpy take it: plain numbers and lists, all defaults and selections spelt out."""

from __future__ import annotations

from typing import Any

import numpy as np

from softffd.fmu.package import scene_masses
from softffd.scene.scene import Scene


def resolved(scene: Scene, mass: np.ndarray | None = None) -> dict[str, Any]:
    """What `softffd.validation.mechanics` needs of a scene; `json` can keep it. mass: (n,) [kg], if it is known already."""

    def points(selection) -> list[int]:
        return scene.select(selection).tolist()

    lattice, stiffness = scene.lattice, scene.material.stiffness
    return {
        "counts": lattice.points,
        "origin": lattice.origin,
        "size": lattice.size,
        "topology": lattice.springs,
        "rest": scene.rest_positions().tolist(),
        "mass": (scene_masses(scene).mass if mass is None else mass).tolist(),
        "stiffness": [stiffness.edge, stiffness.face, stiffness.body],
        "damping": scene.material.damping,
        "regions": [{"points": points(r.points), "stiffness": r.stiffness, "damping": r.damping} for r in scene.region],
        "forces": {f"load.{load.name}": points(load.points) for load in scene.load}
        | {point_name("force", p, scene): [p] for p in points(scene.inputs.forces)},
        "initial": scene.initial.model_dump(),
    }


def point_name(family: str, p: int, scene: Scene) -> str:
    """The name, without its axis, of a variable that belongs to a control point: "position[0,1,2]"."""
    return f"{family}[{','.join(map(str, np.unravel_index(p, scene.lattice.points, order='F')))}]"
