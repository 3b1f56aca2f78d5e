"""The sensors of a scene as the library reads them: their patches' places, and the areas around all places that obstacles may touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from softffd.embedding.patches import (
    Patch,
    Patches,
    areas_around,
    lattice_areas,
    lattice_places,
    nearest,
    points_on,
    taxel_shares,
    vertices_on,
)  # fmt: skip

if TYPE_CHECKING:
    from softffd.embedding.samples import Samples
    from softffd.scene.scene import Scene


def scene_patches(scene: Scene, samples: Samples | None) -> Patches | None:
    """Those of the scene's sensors; None without any. samples: by which the scene's obstacles are met; None: by the control points."""
    if not scene.sensor:
        return None
    if samples is None:
        places, areas = (find(scene.lattice_box, solid=scene.is_solid) for find in (lattice_places, lattice_areas))
        around = [points_on(sensor.where, areas, places) for sensor in scene.sensor]
    else:
        mesh, places = scene.loaded_mesh, samples.places
        assert mesh is not None
        of_vertex = nearest(mesh.vertices, places)
        areas = areas_around(mesh, of_vertex, len(places))
        around = [np.bincount(of_vertex, vertices_on(sensor.where, mesh), len(places)).astype(np.float64) for sensor in scene.sensor]
    patches = []
    for sensor, weights in zip(scene.sensor, around, strict=True):
        mine = weights.nonzero()[0]
        shares = taxel_shares(mine, places, areas, sensor.taxels) if sensor.taxels else []
        patches.append(Patch(sensor.name, mine, weights[mine], sensor.taxels, shares))
    return Patches(areas, patches)
