"""Notes for the user on a body before it runs: `softffd build` prints them, the FMU contains them, and `softffd info` reads them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from softffd.embedding.mass import Masses, filled_words, flat_shares
from softffd.embedding.nodes import volume_shares
from softffd.embedding.samples import Samples
from softffd.lattice import point_at
from softffd.rotation import turned
from softffd.scene.cells import WIDEST, across_longest
from softffd.scene.springs import WAYS, springs

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

NAME = "notes.txt"

LIGHT, LIGHTEST, WORTH = 0.02, 0.2, 2.0
"""Largest fraction of the whole mass that the light points have together; largest ratio of a light point's mass to the mean mass; least
factor by which light points shorten the steps, for there to be a note"""
WORTH_OF_NODES = 1.5  # WORTH for the nodes of a solid
READABLE = 20_000  # more variables than this make the descriptions slow to read in many tools


def body_notes(scene: Scene, masses: Masses, samples: Samples | None) -> list[str]:
    """Returns the notes: how much of its box the mesh fills, where the centre of mass has moved, by what factor the inertia is too large,
    which points are so light that steps are short, whether the solid is too wide for implicit steps, how the start affects centre of mass
    and pins, which points of the surface obstacles meet, and that free obstacles pass through each other."""
    of_mass = fill_note(scene), shift_note(scene, masses), inertia_note(scene, masses)
    of_steps = light_note(scene, masses), wide_note(scene)
    notes = *of_mass, *of_steps, spin_note(scene, masses), pins_note(scene), samples_note(samples), free_note(scene)
    return [note for note in notes if note]


def read_notes(resources: Path) -> Iterator[str]:
    """Yields the notes of an FMU from its folder of resources; none if the FMU has none."""
    path = resources / NAME
    if path.is_file():
        yield from path.read_text(encoding="utf-8").splitlines()


def fill_note(scene: Scene) -> str | None:
    words = filled_words(scene.loaded_mesh, scene.lattice_box.size)
    return words and f"the mesh {words}"


def shift_note(scene: Scene, masses: Masses) -> str | None:
    if np.abs(masses.shift).max() < 1e-9 * max(scene.lattice_box.size):
        return None
    return f"mass.uniform_share moves the centre of mass by ({_listed(masses.shift)}) m"


def inertia_note(scene: Scene, masses: Masses) -> str | None:
    """Returns the ratio of the masses' inertia to the object's, in words; None if it is 1, and if regions give masses of their own."""
    of_regions = any(region.mass is not None or region.density is not None for region in scene.region)
    least, most = masses.inertia.min(), masses.inertia.max()
    if of_regions or (least > 0.99 and most < 1.01):
        return None
    times = f"{most:.3g}" if most < 1.01 * least else f"{least:.3g} to {most:.3g}"
    whose = "box" if scene.mass.distribution in ("uniform", "box") else f"mesh ({scene.mass.distribution})"
    if scene.is_solid:
        return f"masses of nodes come no nearer than {times} times the inertia of the {whose}; more control points do"
    return f'lumped masses have {times} times the inertia of the {whose}; mass.inertia = "matched" corrects this, with shorter steps'


def light_note(scene: Scene, masses: Masses) -> str | None:
    """Returns the factor by which the lightest points shorten explicit steps, in words, and the key that gives these points mass."""
    if scene.is_solid:
        return _light_node_note(scene, masses.mass)
    mass = masses.mass
    if mass.min() > LIGHTEST * mass.mean():
        return None
    squared, lightest = _squared_frequencies(scene, mass), np.argsort(mass, kind="stable")
    count = int((np.cumsum(mass[lightest]) <= LIGHT * mass.sum()).sum())
    raised = np.maximum(mass, mass[lightest[count]])  # light points get the least mass of the others
    others = _squared_frequencies(scene, raised).max()
    light = [p for p in lightest[:count] if mass[p] <= LIGHTEST * mass.mean() and squared[p] > WORTH**2 * others]
    if not light:
        return None
    times, first = np.sqrt(squared[light].max() / others), int(light[0])
    place, key = list(point_at(first, scene.lattice.points)), _key_of_mass(scene, first)
    which = f"control point {place} with {mass[first]:.3g} kg makes"
    if len(light) > 1:
        share = f"{100 * mass[light].sum() / mass.sum():.2g} % of the mass"
        which = f"{len(light)} control points with {share} in all, such as {place} with {mass[first]:.3g} kg, make"
    return f"{which} explicit steps {times:.2g} times shorter than the others need; a larger {key} makes them longer"


def _light_node_note(scene: Scene, mass: np.ndarray) -> str | None:
    """Returns, in words, the largest factor by which steps can be shorter than with the masses that the box would give. The stiffness is
    that of the box, so squared frequencies grow by the largest ratio of these masses at most. Pinned nodes do not count."""
    of_box = mass.sum() * flat_shares(volume_shares(scene.lattice.points))
    ratio = of_box / mass
    for pin in scene.pin:
        ratio[scene.select(pin.points)] = 0.0
    first = int(ratio.argmax())
    if (times := float(np.sqrt(ratio[first]))) < WORTH_OF_NODES:
        return None
    place, key = list(point_at(first, scene.lattice.points)), _key_of_mass(scene, first)
    instead = 'mass.distribution = "box"' if key == "mass.uniform_share" else f"a larger {key}"
    which = f"node {place} with {mass[first]:.3g} kg, where the box has {of_box[first]:.3g} kg,"
    return f"{which} makes explicit steps up to {times:.2g} times shorter; {instead} makes them longer"


def wide_note(scene: Scene) -> str | None:
    """Returns a note if a solid has too many points for implicit steps, where it would take them: damped, or beside an obstacle."""
    across = across_longest(scene.lattice.points)
    implicit = scene.material.internal_damping or scene.plane or scene.solids
    if not (scene.is_solid and across > WIDEST and implicit and scene.solver.method == "auto"):
        return None
    return (
        f"{across} points across the longest axis are more than implicit steps take, {WIDEST}, as 19 x 19: damped or at rest, the body "
        "takes explicit steps, which may be many times slower"
    )


def _squared_frequencies(scene: Scene, mass: np.ndarray) -> np.ndarray:
    """Returns upper bounds (n,) [1/s2] of the squared frequencies at rest, one for each point; the largest determines the explicit step.
    A point's bound is the greatest eigenvalue of the sum of k (1 + sqrt(m / m_other)) / m d d^T over its springs along d, and 0 if it is
    pinned, as if its mass were infinite."""
    heavy, sides = mass.astype(float), np.array(scene.lattice_box.size) / (np.array(scene.lattice.points) - 1)
    for pin in scene.pin:
        heavy[scene.select(pin.points)] = np.inf
    loose, total = np.isfinite(heavy), np.zeros((len(mass), 3, 3))
    for way, (here, there, stiffness) in zip(WAYS, springs(scene), strict=True):
        along = np.array(way) * sides / np.linalg.norm(way * sides)
        for end, other in ((here, there), (there, here)):
            weight = stiffness * (1 + np.sqrt(np.where(loose[end], mass[end], 0) / heavy[other]))
            total[end] += weight[:, None, None] * np.outer(along, along)
    return np.where(loose, np.linalg.eigvalsh(total)[:, 2] / mass, 0.0)


def _key_of_mass(scene: Scene, point: int) -> str:
    """Returns the key of the scene that gives a point its mass."""
    for key in ("mass", "density"):
        own = [n for n, region in enumerate(scene.region) if getattr(region, key) is not None and point in scene.select(region.points)]
        if own:
            return f"region[{own[-1]}].{key}"
    return "mass.uniform_share"


def spin_note(scene: Scene, masses: Masses) -> str | None:
    """Returns, in words, the velocity that a spin about the box's centre gives the centre of mass."""
    initial, box = scene.initial, scene.lattice_box
    arm = np.average(scene.mass_positions(), axis=0, weights=masses.mass) - np.array(box.origin) - np.array(box.size) / 2
    given = np.cross(initial.angular_velocity, turned(np.array(initial.stretch) * arm, np.array(initial.rotation_vector())))
    if initial.spin_about == "mass" or np.linalg.norm(given) <= 1e-9 * np.linalg.norm(initial.angular_velocity) * max(box.size):
        return None
    return (
        f"initial.angular_velocity is about the centre of the box, which adds ({_listed(given)}) m/s to initial.velocity at the centre of "
        'mass; initial.spin_about = "mass" does not'
    )


def pins_note(scene: Scene) -> str | None:
    """Returns a note on pins that stay at rest while the body starts elsewhere."""
    fixed = [pin.name for pin in scene.pin if pin.motion == "fixed"]
    if not fixed or not any(scene.initial.offset):
        return None
    return (
        f"initial.offset moves the body by ({_listed(scene.initial.offset)}) m, and pin {', '.join(fixed)} stays at rest: the body "
        "between them is stretched from the start"
    )


def _listed(values: Iterable[float]) -> str:
    return ", ".join(f"{value:.3g}" for value in values)


def samples_note(samples: Samples | None) -> str | None:
    """Returns a note on how many of the mesh's vertices obstacles meet, and how far behind a plane the other vertices can be."""
    if samples is None:
        return None
    if len(samples.places) == samples.vertices:
        return f"surface contact: {samples.vertices:,} samples, every vertex"
    taken = f"{len(samples.places):,} of {samples.vertices:,} vertices"
    return f"surface contact: {taken}; the others penetrate by at most {100 * samples.behind:.2g} % of the lattice's height"


def free_note(scene: Scene) -> str | None:
    """Returns a note that free obstacles do not meet each other, if there are several."""
    free = [str(solid.part) for solid in scene.solids if solid.motion == "free"]
    return f"free obstacles do not meet each other: {', '.join(free)}" if len(free) > 1 else None


def size_warning(scene: Scene, count: int) -> str | None:
    """Returns a warning about a scene of so many variables, with the keys that create them; None if there are not too many."""
    if count <= READABLE:
        return None
    keys = {
        "outputs.positions": scene.outputs.positions,
        "outputs.velocities": scene.outputs.velocities,
        "inputs.forces": scene.inputs.forces,
    }
    made = sorted(((3 * len(scene.select(points)), key) for key, points in keys.items()), reverse=True)
    listed = ", ".join(f"{key} makes {number}" for number, key in made if number)
    return (
        f"{count} variables, of which {listed}: many tools are slow to read more than {READABLE}; select fewer control points there, "
        "follow places of the object by [[probe]] and push it by [[load]], or build for FMI 3.0 (--fmi 3), where each of these is one array"
    )
