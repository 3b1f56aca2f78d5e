"""Draws obstacles: a convex solid; a plane as a translucent patch with a grid and the soft shadow of what is above the plane."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from softffd.mesh.normals import cut_triangles
from softffd.show.raster import Canvas, Tint, fragments
from softffd.show.skin import single

NEAR = 0.05  # parts of solids closer to the eye than this fraction of its distance from the target are not drawn


def draw_solid(canvas: Canvas, vertices: np.ndarray, normals: np.ndarray, faces: np.ndarray, *, tint: Tint) -> None:
    """Draws a convex solid of vertices (V, 3) [m] with outward normals (V, 3) and `faces` (F, 3) on `canvas`; invisible from inside."""
    camera = canvas.camera
    seen = (normals[faces].sum(axis=1) * (camera.eye - vertices[faces].mean(axis=1))).sum(axis=1) > 0
    corners = np.concatenate([vertices, normals], axis=1)[faces[seen]]
    near = NEAR * np.linalg.norm(camera.eye - camera.target)
    corners = _in_front(corners, (camera.eye - corners[..., :3]) @ camera.axes[2] - near)
    flat, normals = corners[..., :3].reshape(-1, 3), corners[..., 3:]
    canvas.triangles(flat, np.arange(len(flat)).reshape(-1, 3), normals, lambda *_: single(tint)[:, None])


def _in_front(corners: np.ndarray, ahead: np.ndarray) -> np.ndarray:
    """Returns triangles (G, 3, C): the parts of triangles (F, 3, C) where `ahead` (F, 3), given at the corners, is positive."""
    pieces = cut_triangles(np.concatenate([corners, ahead[..., None]], axis=2), ahead)
    return pieces[pieces[..., -1].sum(axis=1) > 0, :, :-1]


TEXELS = 192
TAPS = 128
SPREAD = 0.5
DENSE = 100_000  # a mesh with more faces than this casts its shadow by its vertices alone
BELOW = 0.01  # how far below a plane, in patch radii, a surface still casts a shadow on it


@dataclass(frozen=True, eq=False)
class Patch:
    """The drawn part of the plane through `point` (3,) [m], around the foot of the perpendicular from `centre` (3,) [m].

    `normal` and `tangent`: unit and orthogonal. The grid of `spacing` [m] is anchored at `point`. The patch fades out towards the radius
    `reach` [m]. With `plate` (2,) [m], the patch is instead a rectangle with an edge, of these half sides along tangent and normal x
    tangent, and stops at `floors`, pairs of point and normal.
    """

    point: np.ndarray
    normal: np.ndarray
    tangent: np.ndarray
    centre: np.ndarray
    reach: float
    spacing: float
    tint: Tint
    plate: np.ndarray | None = None
    floors: Sequence[tuple[np.ndarray, np.ndarray]] = ()

    @cached_property
    def foot(self) -> np.ndarray:
        """Middle of the patch, (3,) [m]."""
        return self.centre - self.normal * (self.normal @ (self.centre - self.point))

    @cached_property
    def frame(self) -> np.ndarray:
        """Rows tangent, normal x tangent, normal (3, 3)."""
        return np.stack([self.tangent, np.cross(self.normal, self.tangent), self.normal])

    def window(self, canvas: Canvas) -> np.ndarray:
        """Returns the first row and column of pixels that the patch may cover, and those after the last, (2, 2); the whole picture where
        the patch reaches behind the eye."""
        most = np.array([canvas.height, canvas.width]) // 2
        half = np.full(2, self.reach) if self.plate is None else self.plate
        corners = self.foot + half * [[-1, -1], [-1, 1], [1, -1], [1, 1]] @ self.frame[:2]
        if ((corners - canvas.camera.eye) @ canvas.camera.axes[2]).max() >= 0:
            return np.stack([0 * most, most])
        at = canvas.project(corners)[:, 1::-1] / 2
        return np.stack([at.min(axis=0) - 1, at.max(axis=0) + 2]).clip(0, most).astype(int)

    def share(self, place: np.ndarray, size: np.ndarray) -> np.ndarray:
        """Returns the fractions (P,) that the patch covers of pixels with sizes (2, P) [m] at places (2, P) [m] from the foot, along the
        frame's first axes."""
        if self.plate is None:
            return single(np.hypot(*place) < self.reach)
        held = ((single(self.plate)[:, None] - np.abs(place)) / size + 0.5).clip(0, 1).prod(axis=0)
        for point, normal in self.floors:
            slope = single(self.frame[:2] @ normal)
            above = slope[0] * place[0] + slope[1] * place[1] - single(normal @ (point - self.foot))
            pixel = np.abs(slope[0]) * size[0] + np.abs(slope[1]) * size[1]
            held *= (above / np.maximum(pixel, 1e-9 * self.reach) + 0.5).clip(0, 1)
        return held

    def lines(self, place: np.ndarray, size: np.ndarray) -> np.ndarray:
        """Returns the darkness (P,) of the grid and the edge at places (2, P) [m], in pixels of sizes (2, P) [m]."""
        shift = single(self.frame[:2] @ (self.foot - self.point) % (5 * self.spacing))
        anchored = place + shift[:, None]
        line = 0.26 * _grid(anchored, size, self.spacing) + 0.2 * _grid(anchored, size, 5 * self.spacing)
        if self.plate is None:
            return line
        inside = np.minimum(*((single(self.plate)[:, None] - np.abs(place)) / size))
        return line + 0.6 * (1 - _smooth(inside - 1))

    def hatching(self, place: np.ndarray, size: np.ndarray) -> np.ndarray:
        """Returns the fractions (P,) of pixels that the stripes of the solid side cover; arguments as in `lines`."""
        step = self.spacing / 2
        shift = (self.frame[:2] @ (self.foot - self.point)).sum() % step
        at, width = (place.sum(axis=0) + shift) / step, size.sum(axis=0) / step
        line, blurred = 1 - _smooth((np.abs(at % 1 - 0.5) - 0.11) / width), _smooth((width - 0.3) / 0.6)
        return single(line + blurred * (0.25 - line))

    def fade(self, place: np.ndarray) -> np.ndarray | float:
        """Returns the opacity at the places (2, P) [m], 0 .. 1."""
        return 1.0 if self.plate is not None else 1 - _smooth((np.hypot(*place) / self.reach - 0.55) / 0.45)


def draw_plane(canvas: Canvas, patch: Patch, *, surfaces: Sequence[tuple[np.ndarray, np.ndarray]] = ()) -> None:
    """Draws `patch` on `canvas`. surfaces: pairs of vertices (V, 3) [m] and faces, of the object and the solids that cast shadows on it.

    Colours and lines are computed for whole pixels, from the fractions that lines and patch cover; things in front of the plane hide fine
    pixels. The plane's back is hatched and nearly clear, so that it hides nothing.
    """
    front = patch.normal @ (canvas.camera.eye - patch.foot) > 0
    opacity = 0.62 if patch.plate is None else 0.45
    pixel, seen, place, size = _seen(canvas, patch)
    share = patch.share(place, size)
    within = np.flatnonzero(share > 0)
    pixel, seen, place, size, share = pixel[within], seen[within], place.take(within, axis=1), size.take(within, axis=1), share[within]
    line = patch.lines(place, size)
    cover = opacity + (1 - opacity) * line if front else 0.08 + 0.3 * patch.hatching(place, size) + 0.5 * (1 - opacity) * line
    colour = np.multiply.outer(single(patch.tint), 1 - 0.55 * line)
    if surfaces and front:
        dark = 0.8 * _sampled(_occlusion(surfaces, patch.foot, patch.frame, patch.reach), place / patch.reach)
        colour, cover = colour * (1 - dark), cover + (1 - cover) * dark
    canvas.lay(pixel, seen, colour, cover * share * patch.fade(place))


def _seen(canvas: Canvas, patch: Patch) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Returns the pixels (P,) in which the patch is somewhere the nearest thing, the mask (P,) of their visible fine pixels as packed by
    `in_pixels`, and along the patch's two axes the places of the pixels' centres (2, P) [m] and their sizes (2, P) [m]."""
    right, above, back = single(canvas.camera.axes @ patch.frame.T)
    away = single(patch.frame @ (canvas.camera.eye - patch.foot))
    (top, left), (low, end) = patch.window(canvas)
    x, y = (slopes[2 * a : 2 * b] for slopes, a, b in zip(canvas.sight(), (left, top), (end, low), strict=True))
    depth = canvas.depth.reshape(canvas.height, canvas.width)[2 * top : 2 * low, 2 * left : 2 * end]
    toward = (back[2] - x * right[2] - y[:, None] * above[2]) * np.sign(away[2])  # divided by |away_2| this is 1 / distance
    shown = canvas.in_pixels((toward > 0) & (np.abs(away[2]) * depth <= 1.0005 * toward))
    row, column = np.divmod(np.flatnonzero(shown), end - left)
    shown = shown[shown > 0]
    x, y = x.reshape(-1, 2).mean(axis=1)[column], y.reshape(-1, 2).mean(axis=1)[row]
    toward = (back[2] - x * right[2] - y * above[2]) * np.sign(away[2])
    pixel = (top + row) * (canvas.width // 2) + left + column
    before = toward > 0
    pixel, shown, x, y = pixel[before], shown[before], x[before], y[before]
    distance = np.abs(away[2]) / toward[before]
    place = np.stack([away[a] + distance * (x * right[a] + y * above[a] - back[a]) for a in (0, 1)])
    size = [  # |d place / d column| + |d place / d row|, where place = away - away_2 slope_a / slope_2
        sum(np.abs(step[a] + (place[a] - away[a]) * step[2] / away[2]) for step in (right, above)) * distance for a in (0, 1)
    ]
    return pixel, shown, place, 2 * np.stack(size) / canvas.focal


def _grid(at: np.ndarray, size: np.ndarray, spacing: float) -> np.ndarray:
    """Returns the fractions of pixels that the lines at multiples of `spacing` cover; 0 where the lines are too dense for the pixels."""
    distance = np.abs(at - spacing * np.round(at / spacing))
    line = (1.0 - _smooth(distance / size / 1.2)) * (1 - _smooth((size / spacing - 0.3) / 0.6))
    return np.maximum(*line)


def _occlusion(surfaces: Sequence[tuple[np.ndarray, np.ndarray]], foot: np.ndarray, frame: np.ndarray, reach: float) -> np.ndarray:
    """Returns the fraction of the sky that surfaces hide from each texel of the patch, (TEXELS, TEXELS).

    A piece dA of an underside at height h and lateral distance r hides the fraction h^2 / (pi (h^2 + r^2)^2) dA of the sky.
    """
    height = np.minimum.reduce([_heights(*surface, foot, frame, reach) for surface in surfaces])
    covered = np.nonzero(height < 1)
    hidden: np.ndarray = np.zeros((2 * TEXELS, 2 * TEXELS), dtype=np.float32)  # with a margin for what falls beside the patch
    if len(covered[0]):
        low = np.min(covered, axis=1)
        block = height[tuple(slice(a, b + 1) for a, b in zip(low, np.max(covered, axis=1), strict=True))]
        least = 2 * SPREAD / TAPS
        square = np.where(block < 1, np.maximum(block, least) ** 2, 0)
        for tap in range(TAPS):
            r, angle = SPREAD * (tap + 0.5) / TAPS, 2.399963 * tap
            shift = np.round(0.5 * r * TEXELS * np.array([np.cos(angle), np.sin(angle)])).astype(int)
            row, column = low + shift + TEXELS // 2
            hidden[row : row + block.shape[0], column : column + block.shape[1]] += 2 * r * SPREAD / TAPS * square / (square + r * r) ** 2
    hidden = hidden[TEXELS // 2 : -TEXELS // 2, TEXELS // 2 : -TEXELS // 2]
    for axis in (0, 1, 0, 1):
        hidden = (np.roll(hidden, 1, axis) + hidden + np.roll(hidden, -1, axis)) / 3
    return single(hidden.clip(0, 1))


def _heights(vertices: np.ndarray, faces: np.ndarray, foot: np.ndarray, frame: np.ndarray, reach: float) -> np.ndarray:
    """Returns the height of a surface's underside above each texel in patch radii, (TEXELS, TEXELS); 1 if there is none above the plane."""
    offset = (vertices - foot) / reach
    along, across, height = (offset @ frame.T).T
    screen = np.column_stack([(along + 1) * TEXELS / 2, (across + 1) * TEXELS / 2, 1 - height.clip(max=1)])
    nearest = np.zeros(TEXELS * TEXELS, dtype=np.float32)
    for pixel, depth in _covered(screen, faces):
        above = depth <= 1 + BELOW
        np.maximum.at(nearest, pixel[above], depth[above].clip(max=1))
    return 1.0 - nearest.reshape(TEXELS, TEXELS)


def _covered(screen: np.ndarray, faces: np.ndarray) -> Iterable[tuple[np.ndarray, np.ndarray]]:
    """Returns texels and depths of the triangles, or, where more than DENSE make them hardly larger than a texel, of their vertices."""
    if len(faces) <= DENSE:
        return ((pixel, depth) for pixel, _, depth in fragments(screen, faces, TEXELS, TEXELS))
    column, row = np.floor(screen[:, :2]).astype(np.int64).T
    within = (column >= 0) & (column < TEXELS) & (row >= 0) & (row < TEXELS)
    return [((row * TEXELS + column)[within], screen[within, 2].astype(np.float32))]


def _sampled(image: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Returns `image` (TEXELS, TEXELS) at `offset` (2, P), -1 .. 1, interpolated bilinearly between the texels."""
    x, y = ((offset + 1) * TEXELS / 2 - 0.5).clip(0, TEXELS - 1.001)
    i, j = x.astype(int), y.astype(int)
    a, b = x - i, y - j
    rows = [image[j + k, i] * (1 - a) + image[j + k, i + 1] * a for k in (0, 1)]
    return rows[0] * (1 - b) + rows[1] * b


def _smooth(t: np.ndarray) -> np.ndarray:
    t = t.clip(0, 1)
    return t * t * (3 - 2 * t)
