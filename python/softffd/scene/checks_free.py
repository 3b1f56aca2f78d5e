"""The checks of free bodies: obstacles and pins with a mass of their own."""

from collections.abc import Iterator

import numpy as np

from softffd.lattice import point_at
from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, KeyPath, either, refused, toml_text
from softffd.scene.keys import SOLIDS
from softffd.scene.rigid import Pin, Solid
from softffd.scene.selection import flat_indices

METHODS = ("auto", "leapfrog", "sdirk2")  # methods under which the object moves free bodies
KEYS = ("mass", "density", "inertia", "guide")  # keys that only free bodies have
FREE, NO_TURNING = 'motion = "free"', "none beside guide, along which the body does not turn"
ROUNDING = 1e-9  # fraction by which a moment of inertia may exceed the sum of the others, and a velocity deviate from its guide


def free_check(draft: Draft) -> Iterator[Fault]:
    """Yields the problems of the free bodies of a draft, and of keys that only free bodies may have."""
    free = False
    for section in (*SOLIDS, "pin"):
        for position, item in enumerate(getattr(draft.keys, section)):
            path: KeyPath = (section, position)
            if not draft.sound(*path, "motion"):
                continue
            if item.motion == "free":
                free = True
                yield from _masses(draft, path, item)
                yield from _inertia(draft, path, item)
                yield from _guide(path, item)
                if isinstance(item, Pin):
                    yield from _bonded(draft, path, item)
            else:
                yield from _idle(path, item)
    method = draft.keys.solver.method
    if free and method not in METHODS:
        yield refused(("solver", "method"), f"{either(METHODS)} beside a body with {FREE}", method)


def _bonded(draft: Draft, path: KeyPath, pin: Pin) -> Iterator[Fault]:
    """Checks that the points of a free pin determine its rotation, unless it has a guide, and that obstacles act on the mesh, if any."""
    keys = draft.keys
    if keys.obstacles and (keys.mesh is None or keys.contact.of == "lattice") and draft.sound("mesh") and draft.sound("contact", "of"):
        needs = '; it needs a [mesh], and [contact] of = "surface"'
        yield refused((*path, "motion"), '"fixed" or "input" where control points meet obstacles', "free", needs)
    if pin.guide is not None or draft.counts is None or not draft.sound(*path, "points"):
        return
    try:
        chosen = flat_indices(pin.points, draft.counts)
    except ValueError:
        return  # `_selections` in checks.py reports this fault
    places = np.array([point_at(int(each), draft.counts) for each in chosen], dtype=float).reshape(-1, 3)
    if len(places) > 0 and np.linalg.matrix_rank(places - places[0]) < 2:
        why = ": they do not hold the part against turning"
        yield refused((*path, "points"), "control points that are not on one line, or a guide", pin.points, why)


def _idle(path: KeyPath, item: Solid | Pin) -> Iterator[Fault]:
    for key in KEYS:
        if (given := getattr(item, key, None)) is not None:
            yield Fault((*path, key), f'wanted none with motion = "{item.motion}", got {toml_text(given)}; it needs {FREE}')


def _masses(draft: Draft, path: KeyPath, item: Solid | Pin) -> Iterator[Fault]:
    density = getattr(item, "density", None)
    ways = "mass" if isinstance(item, Pin) else "mass or density"
    if item.mass is not None and density is not None:
        yield Fault(path, f"wanted {ways}, got mass = {item.mass:g} and density = {density:g}")
    elif item.mass is None and density is None:
        if draft.sound(*path, "mass") and draft.sound(*path, "density"):
            yield Fault(path, f"wanted {ways} beside {FREE}, got none")
    elif isinstance(item, Solid) and all(draft.sound(*path, key) for key in ("radius", "length", "size", "mass", "density")):
        made = np.array([item.own_mass(), *item.own_inertia()])
        if not (np.isfinite(made).all() and (made > 0).all()):
            yield refused((*path, "mass" if item.mass else "density"), "a mass and moments of inertia > 0", float(made.min()))


def _inertia(draft: Draft, path: KeyPath, item: Solid | Pin) -> Iterator[Fault]:
    given = item.inertia
    if given is None:
        if isinstance(item, Pin) and item.guide is None and draft.sound(*path, "inertia") and draft.sound(*path, "guide"):
            yield Fault(path, f"wanted inertia beside {FREE}, or a guide, along which it does not turn, got neither")
    elif item.guide is not None:
        yield refused((*path, "inertia"), NO_TURNING, given)
    elif max(given) > (1 + ROUNDING) * (sum(given) - max(given)):
        yield refused((*path, "inertia"), "moments of a rigid body, of which none exceeds the sum of the other two", given)


def _guide(path: KeyPath, item: Solid | Pin) -> Iterator[Fault]:
    if item.guide is None or isinstance(item, Pin):
        return
    if any(item.angular_velocity):
        yield refused((*path, "angular_velocity"), NO_TURNING, item.angular_velocity)
    along, velocity = np.array(item.guide) / max(map(abs, item.guide)), np.array(item.velocity)
    nearest = along * (velocity @ along) / (along @ along)
    if np.abs(velocity - nearest).max() > ROUNDING * np.abs(velocity).max():
        instead = f"; {toml_text([float(f'{each:.6g}') for each in nearest])} is nearest"
        yield refused((*path, "velocity"), f"a velocity along guide = {toml_text(item.guide)}", item.velocity, instead)
