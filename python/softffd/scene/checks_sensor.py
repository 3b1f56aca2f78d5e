"""The checks of sensors: a patch that is there, and something that may touch it."""

from collections.abc import Iterator

from softffd.embedding.patches import FACES, group_names, lattice_areas, lattice_places, points_on, vertices_on
from softffd.lattice import LatticeBox
from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, toml_text
from softffd.scene.sensor import Sensor
from softffd.spelling import did_you_mean, nearest_of


def sensor_check(draft: Draft) -> Iterator[Fault]:
    """The problems of a draft's sensors."""
    keys = draft.keys
    for position, sensor in enumerate(keys.sensor):
        if not keys.obstacles and draft.sound("plane"):
            yield Fault(("sensor", position), "wanted an obstacle beside it, such as a [[plane]], got none: nothing can touch it")
        elif draft.sound("sensor", position, "on") and draft.sound("contact", "of") and draft.sound("mesh"):
            fault = _of_surface(draft, sensor) if keys.contact.of == "surface" else _of_lattice(draft, sensor)
            if fault:
                yield Fault(("sensor", position, "on"), fault)


def _of_surface(draft: Draft, sensor: Sensor) -> str | None:
    if draft.mesh is None:
        return None
    names = group_names(draft.mesh)
    if isinstance(sensor.on, str) and sensor.on not in FACES and sensor.on not in names:
        near = did_you_mean(nearest_of(sensor.on, [*names, *FACES]))
        there = f"; the mesh has {', '.join(names)}" if names and not near else "" if names else "; the mesh has no groups"
        return f'wanted a face such as "z-", a group of the mesh or {{ box = }}, got {toml_text(sensor.on)}{near or there}'
    if not vertices_on(sensor.where, draft.mesh).any():
        return "wanted a part of the surface, got one on which the mesh has no vertex"
    return None


def _of_lattice(draft: Draft, sensor: Sensor) -> str | None:
    """Of the control points, or of the nodes of a solid."""
    if isinstance(sensor.on, str):
        near = did_you_mean(nearest_of(sensor.on, FACES))
        text = f'a face such as "z-" or {{ box = }} with contact.of = "lattice", got {toml_text(sensor.on)}{near}'
        return None if sensor.on in FACES else f"wanted {text}"
    if draft.counts is None or draft.box is None:
        return None
    solid = draft.keys.material.model == "solid"
    box = LatticeBox(draft.counts, *draft.box, draft.keys.lattice.basis)
    if points_on(sensor.where, lattice_areas(box, solid=solid), lattice_places(box, solid=solid)).any():
        return None
    return f"wanted a box with a {'node' if solid else 'control point'} of the surface in it, got {toml_text(sensor.on.box)}"
