"""The part of a run that is exported: the rows taken, the object's surface, its lattice, and the obstacles with their poses."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from softffd.errors import SoftffdError
from softffd.lattice import to_flat
from softffd.mesh.mesh import Mesh
from softffd.run.progress import Note, silent
from softffd.run.result import Result
from softffd.show.raster import Tint
from softffd.show.stage import PlaneTrack, SolidTrack, Stage, stage_of, surface_of

FLOOR, PLATE = 1.5, 1.0
"""Half the side of a plane's square, as a fraction of half the diagonal of all there is to see"""
CLEAR = 0.25
"""Opacity of planes that are no floor: seen from some side, they are in front of the object"""


@dataclass(frozen=True, eq=False)
class Rigid:
    """An obstacle: vertices (V, 3) [m] with unit normals (V, 3) and faces (F, 3), along the obstacle's own axes about its point; the
    point (T, 3) [m] and the axes, unit vectors as rows (T, 3, 3), at every row of the run. A plane is a square of the size of the scene."""

    name: str
    tint: Tint
    kind: Literal["floor", "plane", "solid"]
    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    points: np.ndarray
    axes: np.ndarray

    def at(self, row: int) -> np.ndarray:
        """Returns the vertices (V, 3) [m] at a row."""
        return self.points[row] + self.vertices @ self.axes[row]

    @property
    def moves(self) -> bool:
        return bool(np.ptp(self.points, axis=0).any() or np.ptp(self.axes, axis=0).any())


@dataclass(frozen=True, eq=False)
class Take:
    """A run with the settings of its export.

    `rows` (R,): the rows of the result to export, in their order. `tolerance`: error allowed where a format approximates, as a fraction
    of the largest side of the box. `shows_lattice`: draw the lattice in films; by default where there is no mesh. `note` receives the
    progress, `say` what the user should know.
    """

    result: Result
    rows: np.ndarray
    tolerance: float
    shows_lattice: bool | None = None
    note: Note = silent
    say: Note = silent

    @cached_property
    def stage(self) -> Stage:
        return stage_of(self.result)

    @cached_property
    def time(self) -> np.ndarray:
        """Times of the rows (R,) [s]"""
        return np.asarray(self.result.time, dtype=float)[self.rows]

    @cached_property
    def mesh(self) -> Mesh:
        """The object's surface at rest: the scene's mesh, or the boundary of the box."""
        return surface_of(self.result, self.stage)

    def deformed(self, row: int) -> np.ndarray:
        """Returns the vertices (V, 3) [m] of the mesh at a row."""
        return self.result.deformed(self.mesh, row=row)

    def lattice(self, row: int) -> np.ndarray:
        """Returns the corners of the lattice's cells at a row, in flat order (n, 3) [m]: control points, or a solid's material points."""
        if self.stage.basis != "patches":
            return to_flat(self.stage.positions[row])
        return self.result.deformed(to_flat(self.stage.rest), row=row)

    def require_within(self, name: str, error: float) -> None:
        """Raises SoftffdError if single precision leaves an error [m] above the tolerance in the format of this name."""
        side = float(self.stage.size.max())
        if error > self.tolerance * side:
            raise SoftffdError(
                f"export to {name}: the numbers of this format, in single precision, leave an error of {error / side:.2g} of the box; "
                f"wanted at most the tolerance, {self.tolerance:g}: a scene nearer to the origin, or glb with another --tolerance"
            )

    def told_rows(self, what: str = "row") -> Iterator[tuple[int, int]]:
        """Yields number and row, one after the other; reports the progress to `note`."""
        for number, row in enumerate(self.rows.tolist()):
            self.note(f"{what} {number + 1} of {len(self.rows)}")
            yield number, row

    @cached_property
    def obstacles(self) -> tuple[Rigid, ...]:
        return tuple(self._rigid(each) for each in self.stage.obstacles)

    def _rigid(self, track: PlaneTrack | SolidTrack) -> Rigid:
        if isinstance(track, SolidTrack):
            form = track.form
            return Rigid(track.name, track.tint, "solid", form.vertices, form.normals, form.faces, track.points, track.axes)
        half = self.stage.radius * (FLOOR if track.is_floor else PLATE)
        foot = track.axes[0] @ (self.stage.centre - track.points[0]) * [1.0, 1.0, 0.0]
        corners = foot + half * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
        normals, faces = np.tile([0.0, 0.0, 1.0], (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])
        return Rigid(track.name, track.tint, "floor" if track.is_floor else "plane", corners, normals, faces, track.points, track.axes)
