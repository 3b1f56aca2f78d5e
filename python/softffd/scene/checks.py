"""The second pass over a scene: what holds between its keys, or between them and the mesh."""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from softffd.lattice import point_at
from softffd.names import LARGEST, Part, flat_form, mistaken, structured
from softffd.scene.cells import MOST, cells_of
from softffd.scene.checks_free import free_check
from softffd.scene.checks_material import material_check
from softffd.scene.checks_sensor import sensor_check
from softffd.scene.checks_solid import solid_check
from softffd.scene.draft import MEETING, Draft
from softffd.scene.faults import Fault, KeyPath, either, path_text, toml_text
from softffd.scene.keys import OBSTACLES, SOLIDS
from softffd.scene.selection import Selection, flat_indices

ROUNDING = 1e-9
"""By how much of its edge a point may be outside the box"""


def cross_check(draft: Draft) -> list[Fault]:
    """The problems between the sound keys of a draft. A check of a single key need not ask whether that is sound; one of others does."""
    checks = (
        _names, _idle_inputs, _counts, _selections, _mass, _inertia, _margin, _box, _control_points, _probes, material_check, solid_check,
        _contact, sensor_check, free_check,
    )  # fmt: skip
    with np.errstate(over="ignore", invalid="ignore"):  # huge boxes are refused in words
        found = [fault for check in checks for fault in check(draft)]
    return [fault for fault in found if len(fault.path) == 1 or draft.sound(*fault.path)]


def _names(draft: Draft) -> Iterator[Fault]:
    obstacles: dict[str, KeyPath] = {}  # whose variables begin alike
    for section in (*OBSTACLES, "pin", "load", "probe", "sensor"):
        owners = obstacles if section in OBSTACLES else {}
        for position, item in enumerate(getattr(draft.keys, section)):
            path = (section, position, "name")
            if not draft.sound(*path):
                continue
            if (owner := owners.setdefault(item.name, path)) != path:
                yield Fault(path, f"wanted a unique name, got {toml_text(item.name)}, already the name of {path_text(owner[:2])}")
            if draft.keys.fmu.names == "flat" and (lost := mistaken(Part(section, item.name))):
                flat = flat_form(lost)
                what = f"its {lost} would be {flat}, which is {structured(flat)}"
                yield Fault(path, f'wanted another name beside fmu.names = "flat", got {toml_text(item.name)}: {what}')


def _idle_inputs(draft: Draft) -> Iterator[Fault]:
    for section in (*OBSTACLES, "pin"):
        for position, item in enumerate(getattr(draft.keys, section)):
            default = type(item).model_fields["inputs"].default
            if item.motion != "input" and item.inputs != default and draft.sound(section, position, "motion"):
                text = f'wanted none with motion = "{item.motion}", got {toml_text(list(item.inputs))}; they need motion = "input"'
                yield Fault((section, position, "inputs"), text)


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
            wanted = f"wanted >= {max(draft.box[1]) / most:.3g} m, because a side has at most {most} cells"
            yield Fault(("lattice", "spacing"), f"{wanted}, got {lattice.spacing:g}")


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
            yield Fault(path, f"wanted at least one control point, got {toml_text(selection)}")
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
    yield ("inputs", "forces"), keys.inputs.forces
    yield ("outputs", "positions"), keys.outputs.positions
    yield ("outputs", "velocities"), keys.outputs.velocities
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
        text = f'wanted 0 with distribution = "box", which leaves no point without mass, got {mass.uniform_share:g}'
        yield Fault(("mass", "uniform_share"), text)
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
    """Masses that match the object's inertia are chosen for the whole lattice."""
    if draft.keys.mass.inertia == "lumped" or draft.keys.material.model == "solid":
        return
    if draft.counts and min(draft.counts) < 3:
        got = f"got {toml_text(draft.counts)}"
        yield Fault(("mass", "inertia"), f'"matched" wants 3 control points or more along each axis, {got}; take "lumped" instead')
    for number, region in enumerate(draft.keys.region):
        for name in ("mass", "density"):
            if (given := getattr(region, name)) is not None:
                text = f'wanted none beside mass.inertia = "matched", which chooses the masses, got {given:g}'
                yield Fault(("region", number, name), text)


def _margin(draft: Draft) -> Iterator[Fault]:
    margin, mesh = draft.keys.lattice.margin, draft.keys.mesh
    if margin > 0 and draft.sound("mesh") and (mesh is None or draft.box_is_given):
        idle = "there is no [mesh] to enlarge" if mesh is None else "origin and size are both given"
        yield Fault(("lattice", "margin"), f"wanted 0, because {idle}, got {margin:g}")


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
        if not np.all(np.isfinite(at)) or not np.all(np.diff(at) > 0):
            got = f"got origin {origin:g} m and size {size:g} m, too large or unequal for double precision"
            yield Fault(("lattice",), f"wanted control points that differ along {axis}, {got}")


def _probes(draft: Draft) -> Iterator[Fault]:
    for position, probe in enumerate(draft.keys.probe):
        if _outside(draft, np.array([probe.at, probe.at])):
            yield Fault(("probe", position, "at"), f"wanted a position in the box {_box_span(draft)}, got {toml_text(probe.at)}")

        if probe.maximum and not any(getattr(probe, word) for word in LARGEST):
            yield Fault(("probe", position, "maximum"), f"wanted one of {', '.join(LARGEST)} = true beside it, got none")


def _outside(draft: Draft, bounds: np.ndarray) -> list[str]:
    """The axes along which `bounds` (2, 3) leave the box by more than rounding; none where the box is not known."""
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
    """Contact of the surface needs a mesh, and a method that supports it."""
    keys, contact, method = draft.keys, draft.keys.contact, draft.keys.solver.method
    if not draft.sound("contact", "of"):
        return
    if contact.of == "lattice":
        for section in SOLIDS:
            if getattr(keys, section):
                text = f'"lattice" supports only planes, but the scene has a [[{section}]]; take "surface", which needs a [mesh]'
                yield Fault(("contact", "of"), text)
        if "penetration" in contact.model_fields_set:
            text = f'wanted none with of = "lattice", got {contact.penetration:g}; it needs of = "surface"'
            yield Fault(("contact", "penetration"), text)
        return
    if keys.mesh is None and draft.sound("mesh"):
        yield Fault(("contact", "of"), '"surface" needs a mesh, but the scene has no [mesh]; take "lattice" instead')
    if method not in MEETING and keys.obstacles:
        text = f'wanted {either(MEETING)} with contact.of = "surface", got {toml_text(method)}'
        yield Fault(("solver", "method"), text)
