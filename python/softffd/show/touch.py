"""Where the object touches its obstacles, and the forces on them, as pictures and page draw them; and the width of contact in cells of
the lattice, which decides force and size of a narrow contact patch."""

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from softffd.lattice import bounding_box, to_flat
from softffd.names import Part, vector_names
from softffd.run.findings import reactions
from softffd.run.result import Result
from softffd.show.stage import PlaneTrack, SolidTrack, Stage, stage_of

INK, MARK = (0.10, 0.12, 0.16), (1.0, 0.84, 0.0)
"""Colours of the outlines and of the insides of marks; no paint, control point or obstacle has these colours."""

NEAR = 1e-6  # largest gap of a touching point, as a fraction of the object's size: recorded values may be rounded
LONGEST = 0.25  # length of the longest arrow, as a fraction of the diagonal of the object's box
LEAST = 1e-6  # forces up to this fraction of the largest force have no arrow
MOST = 200  # most vertices marked in a frame; of more vertices, evenly chosen ones are marked


@dataclass(frozen=True, eq=False)
class Touch:
    """The visible contact of a run.

    `starts` and `ways` (P, T, 3) [m]: beginnings and vectors of the arrows of P obstacles. An arrow points from the centre of pressure
    along the force of the object on the obstacle; the vector is 0 where there is no arrow. The largest force of the run, `largest` [N],
    has the longest arrow; a quarter of that force has an arrow of half the length. `of`: what touches, "lattice" or "surface"; None:
    unknown, either.
    """

    stage: Stage
    of: str | None
    starts: np.ndarray
    ways: np.ndarray
    largest: float = 0.0

    def arrows(self, frame: int) -> np.ndarray:
        """Returns the beginnings and ends of the arrows in a frame, (A, 2, 3) [m]."""
        ways = self.ways[:, frame]
        there = ways.any(axis=1)
        return np.stack([self.starts[there, frame], self.starts[there, frame] + ways[there]], axis=1)

    def places(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Returns the points of the lattice (N, 3) [m] and the surface's vertices (M, 3) [m] that are on obstacles in a frame."""
        stage, none = self.stage, np.empty((0, 3))
        if not self._may_touch(frame, to_flat(stage.positions[frame])):
            return none, none  # nothing between the control points is on an obstacle either
        points = stage.contact_points(stage.positions[frame])
        on_points = none if self.of == "surface" else points[self._near(frame, points)]
        if self.of == "lattice" or stage.is_cage:
            return on_points, none
        vertices = stage.deformed(stage.positions[frame])
        vertices = np.unique(vertices[self._near(frame, vertices)], axis=0)
        return on_points, vertices[np.linspace(0, len(vertices) - 1, min(len(vertices), MOST)).astype(int)]

    def touched(self, frame: int, obstacle: PlaneTrack | SolidTrack) -> np.ndarray:
        """Returns the rest places (N, 3) [m] of the lattice points or surface vertices that are on one obstacle in a frame."""
        stage, positions = self.stage, self.stage.positions[frame]
        if self.of == "surface":
            places, rest = stage.deformed(positions), stage.vertices
        else:
            places, rest = stage.contact_points(positions), stage.contact_points(stage.rest)
        return rest[np.abs(obstacle.gap(frame, places)) <= self._limit]

    def _may_touch(self, frame: int, points: np.ndarray) -> bool:
        """False if nothing between the control points (N, 3) [m] is on an obstacle; for solids a sphere around the points is tested."""
        low, high = bounding_box(points)
        middle, reach = (low + high) / 2, np.linalg.norm(high - low) / 2 + self._limit
        return any((plane.gap(frame, points) <= self._limit).any() for plane in self.stage.planes) or any(
            solid.gap(frame, middle[None])[0] <= reach for solid in self.stage.solids
        )

    def _near(self, frame: int, places: np.ndarray) -> np.ndarray:
        """Returns which places (N, 3) [m] are on an obstacle in a frame, (N,)."""
        found = np.zeros(len(places), dtype=bool)
        for obstacle in self.stage.obstacles:
            found |= np.abs(obstacle.gap(frame, places)) <= self._limit
        return found

    @property
    def _limit(self) -> float:
        return NEAR * float(np.linalg.norm(self.stage.size))


def touch_of(result: Result, stage: Stage) -> Touch:
    """Returns the contacts of `result` to draw; without arrows where reactions or centres of pressure were not recorded."""
    forces = {part.name: force for part, force in reactions(result).items() if part.is_obstacle}
    paths = {part.name: part for part in result.obstacle_parts()}
    centres = {each.name: vector_names("plane_centre", paths[each.name]) for each in stage.obstacles}
    drawn = [name for name, names in centres.items() if name in forces and all(each in result.outputs for each in names)]
    of = None if result.obstacles is None else result.obstacles.meet
    if not drawn:
        return Touch(stage, of, np.empty((0, len(stage.time), 3)), np.empty((0, len(stage.time), 3)))
    starts = np.stack([np.stack([result.outputs[each] for each in centres[name]], axis=1) for name in drawn])
    force = np.stack([forces[name] for name in drawn])
    size = np.linalg.norm(force, axis=2, keepdims=True)
    largest = size.max() or 1.0
    scale = LONGEST * np.linalg.norm(stage.size) / np.sqrt(largest)
    pressed = size > LEAST * largest
    return Touch(stage, of, starts, np.where(pressed, scale * force / np.sqrt(np.where(pressed, size, 1.0)), 0.0), float(largest))


ENOUGH = 3.0  # number of cells across a patch from which on its force is correct for the material within some per cent


def contact_widths(result: Result) -> dict[Part, float]:
    """Returns the width of contact [cells] with each obstacle that the body presses on, at the largest force: the lesser extent of the
    touched patch at rest (the middle one of its three extents). Returns {} without obstacles, reactions or recorded positions."""
    forces = {part: np.linalg.norm(force, axis=1) for part, force in reactions(result).items() if part.is_obstacle and force.any()}
    if result.lattice is None or not result.has_positions or not forces:
        return {}
    stage = stage_of(result)
    touch, cells = touch_of(result, stage), stage.size / (np.array(stage.counts) - 1)
    widths: dict[Part, float] = {}
    for obstacle, (part, force) in product(stage.obstacles, forces.items()):
        if part.name == obstacle.name:
            last = int(force.argmax())  # places touched during the step may have separated at its end
            places = next(filter(len, (touch.touched(frame, obstacle) for frame in (last, last - 1) if frame >= 0)), None)
            if places is not None:
                widths[part] = float(np.sort(np.ptp(places / cells, axis=0))[1])
    return widths


def narrow_contact(result: Result) -> dict[str, Any]:
    """Returns entries for the summary: the widths by obstacle, and a line to read about the widths that are too narrow."""
    widths = contact_widths(result)
    narrow = {part.name: width for part, width in widths.items() if width < ENOUGH - 1e-6}
    entries: dict[str, Any] = {f"{part}.contact_cells": width for part, width in widths.items()}
    if not narrow:
        return entries | {"findings": []}
    listed = ", ".join(f"{name}: {f'{width:.2g}' if width >= 0.01 else 'a point or a line'}" for name, width in narrow.items())
    line = (
        f"contact is narrower than {ENOUGH:g} cells ({listed}): there the lattice, not the material, determines force and size of the "
        "patch; finer cells show by how much (docs/methods.md: How fine for contact)"
    )
    return entries | {"findings": [line]}
