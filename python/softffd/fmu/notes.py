"""What a user should know of a body before it runs: `softffd build` says it, the FMU carries it, and `softffd info` reads it there."""

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
"""Of the whole mass, what light points have in all at most; of the mean one, what the lightest has at most; how many times shorter steps
they make at least"""
WORTH_OF_NODES = 1.5  # the last one of a solid's nodes
READABLE = 20_000  # more variables than this make the descriptions slow to read in many tools


def body_notes(scene: Scene, masses: Masses, samples: Samples | None) -> list[str]:
    """How much of its box the mesh fills, where the centre of mass has moved, how many times too large the inertia is, which points are so
    light that steps are short, whether it is too wide for implicit steps, what the start does to centre of mass and pins, which points of
    the surface obstacles meet, which obstacles pass through each other."""
    of_mass = fill_note(scene), shift_note(scene, masses), inertia_note(scene, masses)
    of_steps = light_note(scene, masses), wide_note(scene)
    notes = *of_mass, *of_steps, spin_note(scene, masses), pins_note(scene), samples_note(samples), free_note(scene)
    return [note for note in notes if note]


def read_notes(resources: Path) -> Iterator[str]:
    """Those of an FMU, from its resources; none of one that has none."""
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
    """How many times the object's inertia the masses have; None where once, and where regions give masses of their own."""
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
    """How many times shorter explicit steps are because of the lightest points, and the key that gives those mass."""
    if scene.is_solid:
        return _light_node_note(scene, masses.mass)
    mass = masses.mass
    if mass.min() > LIGHTEST * mass.mean():
        return None
    squared, lightest = _squared_frequencies(scene, mass), np.argsort(mass, kind="stable")
    count = int((np.cumsum(mass[lightest]) <= LIGHT * mass.sum()).sum())
    raised = np.maximum(mass, mass[lightest[count]])  # to the least of the others
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
    """How many times shorter steps can be than with the masses that the box would give: the stiffness is that of the box, so that squared
    frequencies are greater by the largest ratio of both at most. Pinned nodes do not count."""
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
    """That a solid has too many points for implicit steps, where it would take them: damped, or beside an obstacle."""
    across = across_longest(scene.lattice.points)
    implicit = scene.material.internal_damping or scene.plane or scene.solids
    if not (scene.is_solid and across > WIDEST and implicit and scene.solver.method == "auto"):
        return None
    return (
        f"{across} points across the longest axis are more than implicit steps take, {WIDEST}, as 19 x 19: damped or at rest, the body "
        "takes explicit steps, which may be many times slower"
    )


def _squared_frequencies(scene: Scene, mass: np.ndarray) -> np.ndarray:
    """Bounds (n,) [1/s2] of the squared frequencies at rest by each point, of which the largest gives the explicit step: the greatest
    eigenvalue of the sum of k (1 + sqrt(m / m_other)) / m d d^T over its springs along d. 0 of pinned points: their mass is infinite."""
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
    """Of the scene, the key that a point has its mass from."""
    for key in ("mass", "density"):
        own = [n for n, region in enumerate(scene.region) if getattr(region, key) is not None and point in scene.select(region.points)]
        if own:
            return f"region[{own[-1]}].{key}"
    return "mass.uniform_share"


def spin_note(scene: Scene, masses: Masses) -> str | None:
    """The velocity that a spin about the box's centre gives the centre of mass."""
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
    """Of pins that stay at rest while the body starts elsewhere."""
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
    """How many of the mesh's vertices planes meet, and how far behind them the others can be."""
    if samples is None:
        return None
    if len(samples.places) == samples.vertices:
        return f"surface contact: {samples.vertices:,} samples, every vertex"
    taken = f"{len(samples.places):,} of {samples.vertices:,} vertices"
    return f"surface contact: {taken}; the others penetrate by at most {100 * samples.behind:.2g} % of the lattice's height"


def free_note(scene: Scene) -> str | None:
    """That free obstacles do not meet each other, where there are several."""
    free = [str(solid.part) for solid in scene.solids if solid.motion == "free"]
    return f"free obstacles do not meet each other: {', '.join(free)}" if len(free) > 1 else None


def size_warning(scene: Scene, count: int) -> str | None:
    """What to say about a scene of so many variables, and which keys make them; None where they are not too many."""
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
