"""Where the object touches its obstacles, and the forces on them, as pictures and page draw them."""

from dataclasses import dataclass

import numpy as np

from softffd.lattice import to_flat
from softffd.names import vector_names
from softffd.run.history import reactions
from softffd.show.stage import Stage

INK, MARK = (0.10, 0.12, 0.16), (1.0, 0.84, 0.0)
"""Colours of the outlines, and of what is inside; no paint, control point or obstacle has these."""

NEAR = 1e-6
"""Share of the object's size that what touches may be off by: what was recorded may be rounded."""

LONGEST = 0.25
"""Of an arrow, as a share of the diagonal of the object's box."""

LEAST = 1e-6
"""Of the largest force: what has no arrow."""

MOST = 200
"""Vertices that are marked in a frame; of more, evenly chosen ones."""


@dataclass(frozen=True, eq=False)
class Touch:
    """What there is to see of contact in a run.

    `starts` and `ways` (P, T, 3) [m]: of the arrows of P obstacles, from the centre of pressure along the force of the object on the
    obstacle; 0 where there is none. The largest force of the run has the longest arrow, a quarter of it one of half that length.
    `of`: what touches, "lattice" or "surface"; None: either, for all that is known.
    """

    stage: Stage
    of: str | None
    starts: np.ndarray
    ways: np.ndarray

    def arrows(self, frame):
        """Beginnings and ends of the arrows in a frame, (A, 2, 3) [m]."""
        ways = self.ways[:, frame]
        there = ways.any(axis=1)
        return np.stack([self.starts[there, frame], self.starts[there, frame] + ways[there]], axis=1)

    def places(self, frame):
        """The control points (N, 3) [m] and the surface's vertices (M, 3) [m] on obstacles in a frame."""
        stage, none = self.stage, np.empty((0, 3))
        points = to_flat(stage.positions[frame])
        if not stage.solids and not self._near(frame, points, below=True).any():
            return none, none  # nor is anything that is between them
        on_points = none if self.of == "surface" else points[self._near(frame, points)]
        if self.of == "lattice" or stage.is_cage:
            return on_points, none
        vertices = stage.deformed(stage.positions[frame])
        vertices = np.unique(vertices[self._near(frame, vertices)], axis=0)
        return on_points, vertices[np.linspace(0, len(vertices) - 1, min(len(vertices), MOST)).astype(int)]

    def _near(self, frame, places, *, below=False):
        """Which places (N, 3) [m] are on an obstacle in a frame; `below`: or behind one."""
        found, limit = np.zeros(len(places), dtype=bool), NEAR * np.linalg.norm(self.stage.size)
        for plane in self.stage.planes:
            gap = (places - plane.points[frame]) @ plane.normals[frame]
            found |= gap <= limit if below else np.abs(gap) <= limit
        for solid in self.stage.solids:
            found |= np.abs(solid.gap(places, frame)) <= limit
        return found


def touch_of(result, stage):
    """What to draw of the contacts of `result`; without arrows where reactions or centres of pressure were not recorded."""
    forces = {part.name: force for part, force in reactions(result).items() if part.kind == "plane"}
    centres = {plane.name: vector_names("plane_centre", plane.name) for plane in (*stage.planes, *stage.solids)}
    drawn = [name for name, names in centres.items() if name in forces and all(each in result.outputs for each in names)]
    of = None if result.scene is None else result.scene.contact.of
    if not drawn:
        return Touch(stage, of, np.empty((0, len(stage.time), 3)), np.empty((0, len(stage.time), 3)))
    starts = np.stack([np.stack([result.outputs[each] for each in centres[name]], axis=1) for name in drawn])
    force = np.stack([forces[name] for name in drawn])
    size = np.linalg.norm(force, axis=2, keepdims=True)
    largest = size.max() or 1.0
    scale = LONGEST * np.linalg.norm(stage.size) / np.sqrt(largest)
    pressed = size > LEAST * largest
    return Touch(stage, of, starts, np.where(pressed, scale * force / np.sqrt(np.where(pressed, size, 1.0)), 0.0))
