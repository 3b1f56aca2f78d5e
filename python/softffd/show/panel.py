"""Images of the object in single frames: its surface, its lattice, the obstacles, and flat marks of contact."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from softffd.lattice import bounding_box
from softffd.mesh.normals import ShadingNormals, face_normals
from softffd.show.raster import FIELD, Camera, Canvas, Tint, fragments
from softffd.show.raster_plane import Patch, draw_plane, draw_solid
from softffd.show.sight import first_sight, view_axes
from softffd.show.skin import Painter
from softffd.show.stage import FREE, PINNED, Stage, beside, round_length
from softffd.show.touch import INK, MARK, Touch

SMOOTH_FACES = 150_000  # most faces with smoothed normals; the triangles of larger meshes are hardly larger than a pixel
ROUND = 16  # corners of a dot
FILLED = 0.84  # fraction of the image's width or height that the lattices may take


class Panels:
    """Images of a stage in the given `frames`, `width` x `height` pixels each, all by one camera.

    tints: colours (V, 3) of the vertices by frame, in place of the colours of the stage's skin. touch: the contacts to draw, or None.
    lattice: draw the whole lattice, not only the pinned control points. view: turn and lift [rad] as in sight.py; default: `first_sight`.
    """

    def __init__(
        self, stage: Stage, frames: Sequence[int], width: int, height: int, *, tints: Mapping[int, np.ndarray] | None = None,
        touch: Touch | None = None, lattice: bool = True, view: tuple[float, float] | None = None,
    ):  # fmt: skip
        self._tints, self._touch, self._lattice = tints or {}, touch, lattice
        self._stage, self._width, self._height = stage, width, height
        self._axes = view_axes(stage.up, view or first_sight([stage]))
        smooth = len(stage.faces) <= SMOOTH_FACES
        self._corner_normals = ShadingNormals(stage.vertices, stage.faces).corners if smooth else self._flat_normals
        self._paint = stage.skin.painter(stage.faces)
        points = np.concatenate([stage.positions[frame].reshape(-1, 3) for frame in frames])
        covered = np.stack(bounding_box(points))
        self._beside = {frame: [beside(covered, solid, frame) for solid in stage.solids] for frame in frames}
        points = np.concatenate([points, *(ends for each in self._beside.values() for ends in each)])
        low, high = bounding_box(points)
        self._centre, self._half = (low + high) / 2, (high - low) / 2
        self._distance = float(max(self._needed(frame) for frame in frames))

    def image(self, frame: int) -> np.ndarray:
        """Returns the image (height, width, 3), values 0 .. 1, of one of the frames."""
        stage, points = self._stage, self._stage.positions[frame]
        canvas = Canvas(Camera(self._centre + self._distance * self._axes[2], self._centre, stage.up), self._width, self._height)
        surface = stage.deformed(points), stage.faces
        canvas.triangles(*surface, self._corner_normals(surface[0]), self._painter(frame))
        solids = [(*solid.surface(frame), solid.form.faces) for solid in stage.solids]
        for solid, parts in zip(stage.solids, solids, strict=True):
            draw_solid(canvas, *parts, tint=solid.tint)
        self._draw_planes(canvas, frame, [surface, *((vertices, faces) for vertices, _, faces in solids)])
        self._draw_lattice(canvas, points)
        if self._touch:
            self._draw_touch(canvas, frame, self._touch)
        return canvas.image()

    def _painter(self, frame: int) -> Painter:
        if frame not in self._tints:
            return self._paint
        return replace(self._stage.skin, tints=self._tints[frame], pictures=()).painter(self._stage.faces)

    def _needed(self, frame: int) -> float:
        """Returns the distance [m] from which the frame's lattice, its contact arrows and the nearby parts of solids fit into the image."""
        points = np.concatenate([self._stage.positions[frame].reshape(-1, 3), *(list(product(*ends.T)) for ends in self._beside[frame])])
        if self._touch:
            points = np.concatenate([points, self._touch.arrows(frame)[:, 1]])
        right, above, back = self._axes @ (points - self._centre).T
        tall = FILLED * FIELD
        return (back + np.maximum(np.abs(right) * self._height / self._width, np.abs(above)) / tall).max()

    def _flat_normals(self, vertices: np.ndarray) -> np.ndarray:
        return np.repeat(face_normals(vertices, self._stage.faces)[:, None], 3, axis=1)

    def _draw_planes(self, canvas: Canvas, frame: int, surfaces: Sequence[tuple[np.ndarray, np.ndarray]]) -> None:
        reach, spacing = 0.8 * self._distance, round_length(0.15 * self._distance)
        floors = [(p.points[frame], p.normals[frame]) for p in self._stage.planes if p.is_floor]
        for plane in self._stage.planes:
            pose = plane.points[frame], plane.normals[frame], plane.tangents[frame]
            patch = Patch(*pose, self._centre, reach, spacing, plane.tint)
            if not plane.is_floor:
                plate = np.abs(patch.frame[:2]) @ self._half + 0.2 * np.linalg.norm(self._half)
                patch = replace(patch, plate=plate, reach=float(plate.max()), floors=floors)
            draw_plane(canvas, patch, surfaces=surfaces)

    def _draw_touch(self, canvas: Canvas, frame: int, touch: Touch) -> None:
        points, vertices = touch.places(frame)
        _draw_dots(canvas, vertices, radius=self._height / 160, colour=MARK, outline=INK)
        _draw_dots(canvas, points, radius=self._ball, colour=MARK, outline=INK)
        for start, end in touch.arrows(frame):
            _draw_arrow(canvas, start, end, width=self._height / 90, colour=MARK, outline=INK)

    @property
    def _ball(self) -> float:
        """Radius of a drawn control point [pixels]."""
        return self._height / 90 * min(1.0, 4 / max(self._stage.counts))

    def _draw_lattice(self, canvas: Canvas, points: np.ndarray) -> None:
        flat = points.transpose(2, 1, 0, 3).reshape(-1, 3)
        colours = np.tile(FREE, (len(flat), 1))
        colours[self._stage.pinned] = PINNED
        shown = slice(None) if self._lattice else self._stage.pinned
        if self._lattice:
            canvas.lines(flat, self._stage.edges, width=max(0.8, self._height / 500))
        canvas.balls(flat[shown], radius=self._ball, colours=colours[shown])


def _draw_arrow(canvas: Canvas, start: np.ndarray, end: np.ndarray, *, width: float, colour: Tint, outline: Tint) -> None:
    """Draws an arrow from `start` to `end` (3,) [m]; its shaft is `width` pixels wide, that of a short arrow less."""
    a, b = canvas.project(np.stack([start, end]))
    along = (b - a)[:2]
    length = float(np.linalg.norm(along))
    along = along / length if length > 0 else np.array([0.0, 1.0])
    wide = min(2 * width, length / 6.5)
    for extra, tint in ((0.45 * wide, outline), (0.0, colour)):
        _fill(canvas, _arrow_corners(a, b, along, wide, extra), _ARROW, tint, 0.55)


_ARROW = np.array([[0, 1, 2], [1, 3, 2], [4, 5, 6]])


def _arrow_corners(a: np.ndarray, b: np.ndarray, along: np.ndarray, wide: float, extra: float) -> np.ndarray:
    """Returns the screen positions (7, 3) of the corners of shaft and head, all enlarged by `extra` fine pixels."""
    side = np.array([along[1], -along[0]])
    neck = b[:2] - along * 4 * wide
    shaft, wing = 0.5 * wide + extra, 1.6 * (wide + extra)
    flat = [a[:2] - extra * along - shaft * side, a[:2] - extra * along + shaft * side, neck - shaft * side, neck + shaft * side]
    flat += [neck - extra * along - wing * side, neck - extra * along + wing * side, b[:2] + 2 * extra * along]
    return np.column_stack([flat, [a[2]] * 2 + [b[2]] * 5])


def _draw_dots(canvas: Canvas, points: np.ndarray, *, radius: float, colour: Tint, outline: Tint) -> None:
    """Draws dots of `radius` pixels at points (N, 3) [m], in front of the surfaces that they touch."""
    angle = np.linspace(0, 2 * np.pi, ROUND, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(ROUND)])
    fan = np.column_stack([np.zeros(ROUND - 2, dtype=int), np.arange(1, ROUND - 1), np.arange(2, ROUND)])
    centres = canvas.project(points) * [1.0, 1.0, 1.01]
    faces = (ROUND * np.arange(len(points))[:, None, None] + fan).reshape(-1, 3)
    for size, tint in ((2 * radius, outline), (1.3 * radius, colour)):
        _fill(canvas, (centres[:, None] + size * circle).reshape(-1, 3), faces, tint, 0.4)


def _fill(canvas: Canvas, screen: np.ndarray, faces: np.ndarray, colour: Tint, hidden: float) -> None:
    """Blends `colour` over triangles `faces` of screen positions (N, 3), each pixel once. hidden: opacity behind other things."""
    for pixel, _, depth in fragments(screen, faces, canvas.width, canvas.height):
        pixel, first = np.unique(pixel, return_index=True)
        canvas.blend(pixel, colour, np.where(depth[first] >= 0.99 * canvas.depth[pixel], 1.0, hidden))
