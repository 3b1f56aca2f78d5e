"""The checks that need more than one key of a scene, or its mesh."""

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np

from softffd.lattice import point_at
from softffd.names import Part, flat_form, mistaken, structured
from softffd.scene.cells import MOST, cells_of
from softffd.scene.checks_contact import contact_check
from softffd.scene.checks_material import material_check
from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, KeyPath, path_text, toml_text
from softffd.scene.keys import OBSTACLES
from softffd.scene.sections import Lattice
from softffd.scene.selection import flat_indices
from softffd.scene.sound import box_is_given, box_is_sound, counts_are_sound


def cross_check(draft: Draft) -> list[Fault]:
    """The problems between the sound values of a draft whose box and mesh are settled."""
    checks = (
        _names,
        _idle_inputs,
        _counts,
        _selections,
        _mass,
        _inertia,
        _margin,
        _box,
        _control_points,
        _probes,
        material_check,
        contact_check,
    )
    with np.errstate(over="ignore", invalid="ignore"):  # huge boxes are refused in words
        return [fault for check in checks for fault in check(draft)]


def _names(draft: Draft) -> Iterator[Fault]:
    obstacles: dict[str, KeyPath] = {}  # whose variables begin alike
    for section in (*OBSTACLES, "pin", "load", "probe"):
        owners = obstacles if section in OBSTACLES else {}
        for position, item in enumerate(getattr(draft.scene, section)):
            path = (section, position, "name")
            if draft.sound(*path) and (owner := owners.setdefault(item.name, path)) != path:
                taken = f"already the name of {path_text(owner[:2])}"
                yield Fault(path, f"wanted a name of its own, got {toml_text(item.name)}, {taken}")
            if draft.scene.fmu.names == "flat" and draft.sound(*path) and (lost := mistaken(Part(section, item.name))):
                flat = flat_form(lost)
                what = f"its {lost} would be {flat}, which is {structured(flat)}"
                yield Fault(path, f'wanted another name beside fmu.names = "flat", got {toml_text(item.name)}: {what}')


def _idle_inputs(draft: Draft) -> Iterator[Fault]:
    for section in (*OBSTACLES, "pin"):
        for position, item in enumerate(getattr(draft.scene, section)):
            path = (section, position, "inputs")
            default = type(item).model_fields["inputs"].default
            if item.motion == "fixed" and item.inputs != default and draft.sound(*path) and draft.sound(section, position, "motion"):
                yield Fault(path, f'wanted them beside motion = "input" only, got {toml_text(list(item.inputs))} with motion = "fixed"')


def _counts(draft: Draft) -> Iterator[Fault]:
    lattice = draft.scene.lattice
    if not all(draft.sound("lattice", key) for key in ("points", "cells", "spacing")):
        return
    ways = {key: value for key in ("points", "cells", "spacing") if (value := getattr(lattice, key)) is not None}
    if "points" not in lattice.model_fields_set:
        del ways["points"]
    if len(ways) > 1:
        yield Fault(("lattice",), f"wanted {' or '.join(ways)}, got {' and '.join(f'{key} = {toml_text(ways[key])}' for key in ways)}")
    elif "spacing" in ways and box_is_sound(draft) and max(cells_of(lattice, lattice.size)) > MOST:
        least = max(lattice.size) / MOST
        yield Fault(("lattice", "spacing"), f"wanted >= {least:.3g} m, for a side has at most {MOST} cells, got {lattice.spacing:g}")


def _selections(draft: Draft) -> Iterator[Fault]:
    counts = draft.scene.lattice.points
    pinned = {}
    for path, selection in _all_selections(draft):
        try:
            chosen = flat_indices(selection, counts)
        except ValueError as error:
            yield Fault(path, str(error))
            continue
        if len(chosen) == 0 and path[0] in ("pin", "load"):
            yield Fault(path, f"wanted at least one control point, got {toml_text(selection)}")
        if path[0] == "pin":
            pinned[path] = chosen
    yield from _pinned_twice(pinned, counts)


def _all_selections(draft: Draft) -> Iterator[tuple[KeyPath, Any]]:
    scene = draft.scene
    single = (("inputs", "forces"), ("outputs", "positions"), ("outputs", "velocities"))
    found: list[tuple[KeyPath, Any]] = [(path, getattr(getattr(scene, path[0]), path[1])) for path in single]
    for section in ("region", "pin", "load"):
        found += [((section, n, "points"), item.points) for n, item in enumerate(getattr(scene, section))]
    if counts_are_sound(draft):
        yield from ((path, selection) for path, selection in found if draft.sound(*path))


def _pinned_twice(pinned: dict[KeyPath, np.ndarray], counts: tuple[int, int, int]) -> Iterator[Fault]:
    for (first, ours), (second, theirs) in itertools.combinations(pinned.items(), 2):
        common = np.intersect1d(ours, theirs)
        if len(common):
            i, j, k = point_at(int(common[0]), counts)
            more = f" and {len(common) - 1} more" * (len(common) > 1)
            got = f"got [{i}, {j}, {k}]{more}, held by {path_text(first[:2])} too"
            yield Fault(second, f"wanted control points that no other pin holds, {got}")


def _mass(draft: Draft) -> Iterator[Fault]:
    mass = draft.scene.mass
    both = draft.sound("mass", "total") and draft.sound("mass", "density")
    if both and None not in (mass.total, mass.density):
        got = f"total = {mass.total:g} and density = {mass.density:g}"
        yield Fault(("mass",), f"wanted total or density, got {got}")
    if draft.sound("mass", "distribution") and mass.distribution not in ("uniform", "box"):
        inside = mass.distribution == "volume"
        yield from _needs_mesh(draft, "distribution", closed=inside, instead='take "surface"')
    if mass.distribution == "box" and mass.uniform_share > 0 and draft.sound("mass", "uniform_share"):
        got = f"got {mass.uniform_share:g}"
        yield Fault(("mass", "uniform_share"), f'wanted 0 where the distribution is "box", which leaves no point without mass, {got}')
    if draft.sound("mass", "density") and mass.density is not None and draft.scene.mesh is not None:
        yield from _needs_mesh(draft, "density", closed=True, instead='give "total"')


def _inertia(draft: Draft) -> Iterator[Fault]:
    """Masses that match the object's inertia are chosen for the whole lattice."""
    if draft.scene.mass.inertia == "lumped" or not draft.sound("mass", "inertia"):
        return
    counts = draft.scene.lattice.points
    if counts_are_sound(draft) and min(counts) < 3:
        got = f"got {toml_text(list(counts))}"
        yield Fault(("mass", "inertia"), f'"matched" wants 3 control points or more along each axis, {got}; take "lumped" instead')
    for number, region in enumerate(draft.scene.region):
        for name in ("mass", "density"):
            if getattr(region, name) is not None and draft.sound("region", number, name):
                text = f'wanted none beside mass.inertia = "matched", which chooses the masses, got {getattr(region, name):g}'
                yield Fault(("region", number, name), text)


def _needs_mesh(draft: Draft, key: str, *, closed: bool, instead: str) -> Iterator[Fault]:
    given = toml_text(getattr(draft.scene.mass, key))
    if draft.scene.mesh is None and draft.sound("mesh"):
        yield Fault(("mass", key), f"{given} needs a {'closed ' * closed}mesh, but the scene has no [mesh]")
    elif closed and draft.mesh is not None and not draft.mesh.closed:
        why = f"{draft.scene.mesh.file.name} is open (holes in its surface, or faces turned inside out)"
        yield Fault(("mass", key), f"{given} needs a closed mesh, but {why}; {instead} instead")


def _margin(draft: Draft) -> Iterator[Fault]:
    lattice = draft.scene.lattice
    idle = "origin and size are both given" if box_is_given(lattice) else None
    idle = "there is no [mesh] whose box it would grow" if draft.scene.mesh is None else idle
    if lattice.margin > 0 and idle and draft.sound("mesh"):
        yield Fault(("lattice", "margin"), f"wanted 0, for {idle}, got {lattice.margin:g}")


def _box(draft: Draft) -> Iterator[Fault]:
    lattice, mesh = draft.scene.lattice, draft.mesh
    if mesh is not None and box_is_sound(draft) and (outside := _not_in_box(mesh.bounds, lattice)):
        got = f"got {_box_span(lattice)}, which does not along {' and '.join(outside)}"
        given = " and ".join(key for key in ("origin", "size") if key in lattice.model_fields_set)
        text = f"wanted a box that holds the mesh ({_span(*mesh.bounds)}), {got}; leave out {given}: the box then follows the mesh"
        yield Fault(("lattice", "size" if "size" in lattice.model_fields_set else "origin"), text)


def _control_points(draft: Draft) -> Iterator[Fault]:
    lattice = draft.scene.lattice
    if not box_is_sound(draft) or not counts_are_sound(draft):
        return
    for axis, count, origin, size in zip("xyz", lattice.points, lattice.origin, lattice.size, strict=True):
        at = origin + size * np.linspace(0.0, 1.0, count)
        if not np.all(np.isfinite(at)) or not np.all(np.diff(at) > 0):
            got = f"got origin {origin:g} m and size {size:g} m, too large or unequal for double precision"
            yield Fault(("lattice",), f"wanted control points that differ along {axis}, {got}")


def _probes(draft: Draft) -> Iterator[Fault]:
    lattice = draft.scene.lattice
    if not box_is_sound(draft):
        return
    for position, probe in enumerate(draft.scene.probe):
        path = ("probe", position, "at")
        if draft.sound(*path) and _not_in_box(np.array([probe.at, probe.at]), lattice):
            yield Fault(path, f"wanted a place in the box {_box_span(lattice)}, got {toml_text(probe.at)}")


def _not_in_box(bounds: np.ndarray, lattice: Lattice) -> list[str]:
    """The axes along which `bounds` (2, 3) leave the box by more than rounding (1e-9 of its edge)."""
    lower, size = np.array(lattice.origin), np.array(lattice.size)
    slack = 1e-9 * size
    outside = (bounds[0] < lower - slack) | (bounds[1] > lower + size + slack)
    return [axis for axis, out in zip("xyz", outside, strict=True) if out]


def _box_span(lattice: Lattice) -> str:
    lower = np.array(lattice.origin)
    return _span(lower, lower + np.array(lattice.size))


def _span(lower: Any, upper: Any) -> str:
    corners = (", ".join(f"{entry:.6g}" for entry in corner) for corner in (lower, upper))
    return " to ".join(f"[{corner}]" for corner in corners) + " m"
