"""The second pass of the validation of a scene: relations between its keys, and between its keys and the mesh."""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from softffd.embedding.patches import FACES, group_names, lattice_areas, lattice_places, points_on, vertices_on
from softffd.lattice import LatticeBox, point_at
from softffd.names import LARGEST, Part, flat_form, mistaken, structured
from softffd.scene.cells import MOST, cells_of
from softffd.scene.checks_free import free_check
from softffd.scene.checks_material import material_check, solid_check
from softffd.scene.draft import MEETING, Draft
from softffd.scene.faults import Fault, KeyPath, either, path_text, refused, toml_text
from softffd.scene.keys import OBSTACLES, SOLIDS
from softffd.scene.observed import Sensor
from softffd.scene.selection import Selection, flat_indices
from softffd.spelling import did_you_mean, nearest_of

ROUNDING = 1e-9  # fraction of the edge of the box by which a point may lie outside


def cross_check(draft: Draft) -> list[Fault]:
    """Returns the problems between the sound keys of a draft.

    A fault that a check finds at an unsound key is dropped here; a check asks `draft.sound` only for the other keys that it reads.
    """
    checks = (
        _names, _idle_inputs, _counts, _selections, _mass, _inertia, _margin, _box, _control_points, _probes, material_check, solid_check,
        _contact, _sensors, free_check,
    )  # fmt: skip
    with np.errstate(over="ignore", invalid="ignore"):  # huge boxes are refused in words
        found = [fault for check in checks for fault in check(draft)]
    return [fault for fault in found if len(fault.path) == 1 or draft.sound(*fault.path)]


def _names(draft: Draft) -> Iterator[Fault]:
    obstacles: dict[str, KeyPath] = {}  # obstacles of all kinds share one set of names
    for section in (*OBSTACLES, "pin", "load", "probe", "sensor"):
        owners = obstacles if section in OBSTACLES else {}
        for position, item in enumerate(getattr(draft.keys, section)):
            path = (section, position, "name")
            if not draft.sound(*path):
                continue
            if (owner := owners.setdefault(item.name, path)) != path:
                yield refused(path, "a unique name", item.name, f", already the name of {path_text(owner[:2])}")
            if draft.keys.fmu.names == "flat" and (lost := mistaken(Part(section, item.name))):
                what = f": its {lost} would be {(flat := flat_form(lost))}, which is {structured(flat)}"
                yield refused(path, 'another name beside fmu.names = "flat"', item.name, what)


def _idle_inputs(draft: Draft) -> Iterator[Fault]:
    for section in (*OBSTACLES, "pin"):
        for position, item in enumerate(getattr(draft.keys, section)):
            default = type(item).model_fields["inputs"].default
            if item.motion != "input" and item.inputs != default and draft.sound(section, position, "motion"):
                wanted, more = f'none with motion = "{item.motion}"', '; they need motion = "input"'
                yield refused((section, position, "inputs"), wanted, item.inputs, more)


def _counts(draft: Draft) -> Iterator[Fault]:
    lattice = draft.keys.lattice
    ways: dict[str, Any] = {"points": lattice.points} if "points" in lattice.model_fields_set else {}
    ways |= {key: value for key in ("cells", "spacing") if (value := getattr(lattice, key)) is not None}
    if len(ways) > 1:
        yield Fault(("lattice",), f"wanted {' or '.join(ways)}, got {' and '.join(f'{key} = {toml_text(ways[key])}' for key in ways)}")
    elif isinstance(lattice.points, str):
        if draft.sound("lattice", "cells") and draft.sound("lattice", "spacing"):
            yield Fault(("lattice", "points"), 'wanted cells or spacing beside "cubic", got neither')
    elif lattice.spacing is not None and draft.box:
        most = MOST // draft.multiple * draft.multiple
        if max(cells_of(None, lattice.spacing, draft.box[1], draft.multiple)) > most:
            wanted = f">= {max(draft.box[1]) / most:.3g} m, because a side has at most {most} cells"
            yield refused(("lattice", "spacing"), wanted, lattice.spacing)


def _selections(draft: Draft) -> Iterator[Fault]:
    pinned: dict[KeyPath, np.ndarray] = {}
    counts = draft.counts
    if counts is None:
        return
    for path, selection in _all_selections(draft):
        try:
            chosen = flat_indices(selection, counts)
        except ValueError as error:
            yield Fault(path, str(error))
            continue
        if len(chosen) == 0 and path[0] in ("pin", "load"):
            yield refused(path, "at least one control point", selection)
        if path[0] == "pin" and draft.sound(*path):
            pinned[path] = chosen
    taken = np.concatenate([*pinned.values(), np.empty(0, np.int64)])
    pairs = itertools.combinations(pinned.items(), 2) if len(np.unique(taken)) < len(taken) else ()
    for (first, ours), (second, theirs) in pairs:
        common = np.intersect1d(ours, theirs)
        if len(common):
            got = f"{list(point_at(int(common[0]), counts))}" + f" and {len(common) - 1} more" * (len(common) > 1)
            yield Fault(second, f"wanted control points that no other pin holds, got {got}, held by {path_text(first[:2])} too")


def _all_selections(draft: Draft) -> Iterator[tuple[KeyPath, Selection]]:
    keys = draft.keys
    for section, key in (("inputs", "forces"), ("outputs", "positions"), ("outputs", "velocities")):
        yield (section, key), getattr(getattr(keys, section), key)
    for section in ("region", "pin", "load"):
        for position, item in enumerate(getattr(keys, section)):
            yield (section, position, "points"), item.points


def _mass(draft: Draft) -> Iterator[Fault]:
    mass = draft.keys.mass
    if mass.total is not None and mass.density is not None:
        yield Fault(("mass",), f"wanted total or density, got total = {mass.total:g} and density = {mass.density:g}")
    if mass.distribution not in ("uniform", "box"):
        yield from _needs_mesh(draft, "distribution", closed=mass.distribution == "volume", instead='take "surface"')
    if mass.distribution == "box" and mass.uniform_share > 0 and draft.keys.material.model != "solid":
        yield refused(("mass", "uniform_share"), '0 with distribution = "box", which leaves no point without mass', mass.uniform_share)
    if mass.density is not None and draft.keys.mesh is not None:
        section = "mass" if "density" in mass.model_fields_set else "material"
        yield from _needs_mesh(draft, "density", closed=True, instead='give "total"', section=section)


def _needs_mesh(draft: Draft, key: str, *, closed: bool, instead: str, section: str = "mass") -> Iterator[Fault]:
    given, mesh = toml_text(getattr(draft.keys.mass, key)), draft.keys.mesh
    if mesh is None and draft.sound("mesh"):
        yield Fault((section, key), f"{given} needs a {'closed ' * closed}mesh, but the scene has no [mesh]")
    elif closed and mesh is not None and draft.mesh is not None and not draft.mesh.closed:
        why = f"{mesh.file.name} is open (holes in its surface, or faces turned inside out)"
        yield Fault((section, key), f"{given} needs a closed mesh, but {why}; {instead} instead")


def _inertia(draft: Draft) -> Iterator[Fault]:
    if draft.keys.mass.inertia == "lumped" or draft.keys.material.model == "solid":
        return
    if draft.counts and min(draft.counts) < 3:
        got = f"got {toml_text(draft.counts)}"
        yield Fault(("mass", "inertia"), f'"matched" wants 3 control points or more along each axis, {got}; take "lumped" instead')
    for number, region in enumerate(draft.keys.region):
        for name in ("mass", "density"):
            if (given := getattr(region, name)) is not None:
                yield refused(("region", number, name), 'none beside mass.inertia = "matched", which chooses the masses', given)


def _margin(draft: Draft) -> Iterator[Fault]:
    margin, mesh = draft.keys.lattice.margin, draft.keys.mesh
    if margin > 0 and draft.sound("mesh") and (mesh is None or draft.box_is_given):
        idle = "there is no [mesh] to enlarge" if mesh is None else "origin and size are both given"
        yield refused(("lattice", "margin"), f"0, because {idle}", margin)


def _box(draft: Draft) -> Iterator[Fault]:
    if draft.mesh is not None and (outside := _outside(draft, draft.mesh.bounds)):
        given = [key for key in ("origin", "size") if key in draft.keys.lattice.model_fields_set]
        got = f"got {_box_span(draft)}, which does not along {' and '.join(outside)}"
        text = f"wanted a box that holds the mesh ({_span(*draft.mesh.bounds)}), {got}; leave out {' and '.join(given)}"
        yield Fault(("lattice", "size" if "size" in given else "origin"), f"{text}: the box then follows the mesh")


def _control_points(draft: Draft) -> Iterator[Fault]:
    if not draft.box or not draft.counts:
        return
    for axis, count, origin, size in zip("xyz", draft.counts, *draft.box, strict=True):
        at = origin + size * np.linspace(0.0, 1.0, count)
        if not np.all(abs(at) < 1e150) or not np.all(np.diff(at) > 1e-130):  # squares of lengths have to be finite, and not 0
            got = f"got origin {origin:g} m and size {size:g} m, too large, small or unequal for double precision"
            yield Fault(("lattice",), f"wanted control points that differ along {axis}, {got}")


def _probes(draft: Draft) -> Iterator[Fault]:
    for position, probe in enumerate(draft.keys.probe):
        if _outside(draft, np.array([probe.at, probe.at])):
            yield refused(("probe", position, "at"), f"a position in the box {_box_span(draft)}", probe.at)
        if probe.maximum and not any(getattr(probe, word) for word in LARGEST):
            yield Fault(("probe", position, "maximum"), f"wanted one of {', '.join(LARGEST)} = true beside it, got none")


def _outside(draft: Draft, bounds: np.ndarray) -> list[str]:
    """Returns the axes along which `bounds` (2, 3) leave the box by more than rounding; an empty list if the box is not known."""
    if not draft.box:
        return []
    lower, size = np.array(draft.box)
    slack = ROUNDING * size
    outside = (bounds[0] < lower - slack) | (bounds[1] > lower + size + slack)
    return [axis for axis, out in zip("xyz", outside, strict=True) if out]


def _box_span(draft: Draft) -> str:
    assert draft.box
    lower, size = np.array(draft.box)
    return _span(lower, lower + size)


def _span(*corners: Sequence[float] | np.ndarray) -> str:
    return " to ".join(f"[{', '.join(f'{entry:.6g}' for entry in corner)}]" for corner in corners) + " m"


def _contact(draft: Draft) -> Iterator[Fault]:
    keys, contact, method = draft.keys, draft.keys.contact, draft.keys.solver.method
    if not draft.sound("contact", "of"):
        return
    if contact.of == "lattice":
        for section in SOLIDS:
            if getattr(keys, section):
                text = f'"lattice" supports only planes, but the scene has a [[{section}]]; take "surface", which needs a [mesh]'
                yield Fault(("contact", "of"), text)
        if "penetration" in contact.model_fields_set:
            yield refused(("contact", "penetration"), 'none with of = "lattice"', contact.penetration, '; it needs of = "surface"')
        return
    if keys.mesh is None and draft.sound("mesh"):
        solid = next((section for section in SOLIDS if getattr(keys, section)), None)
        instead = f"add one, which the [[{solid}]] needs too" if solid else 'take "lattice" instead'
        yield Fault(("contact", "of"), f'"surface" needs a mesh, but the scene has no [mesh]; {instead}')
    if method not in MEETING and keys.obstacles:
        yield refused(("solver", "method"), f'{either(MEETING)} with contact.of = "surface"', method)


def _sensors(draft: Draft) -> Iterator[Fault]:
    keys = draft.keys
    for position, sensor in enumerate(keys.sensor):
        if not keys.obstacles and draft.sound("plane"):
            yield Fault(("sensor", position), "wanted an obstacle beside it, such as a [[plane]], got none: nothing can touch it")
        elif all(draft.sound(*path) for path in (("sensor", position, "on"), ("contact", "of"), ("mesh",))):
            fault = _of_surface(draft, sensor) if keys.contact.of == "surface" else _of_lattice(draft, sensor)
            yield from [Fault(("sensor", position, "on"), fault)] if fault else []


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
