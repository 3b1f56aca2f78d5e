"""An obstacle plane in a picture: a translucent patch with a grid and the soft shadow of what is above it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from softffd.show.raster import fragments

TEXELS = 192
TAPS = 128
SPREAD = 0.5
DENSE = 100_000
"""Faces of a mesh that casts its shadow by its vertices alone."""


@dataclass(frozen=True, eq=False)
class Patch:
    """What is drawn of the plane through `point` (3,) [m]: its part about the foot of `centre` (3,) [m].

    `normal` and `tangent`: unit and orthogonal. The grid of `spacing` [m] is anchored at `point`. The patch fades out
    towards `reach` [m]; with `plate` (2,) [m] it is a rectangle of these half sides along tangent and normal x tangent,
    with an edge, and stops at `floors`, pairs of point and normal.
    """

    point: np.ndarray
    normal: np.ndarray
    tangent: np.ndarray
    centre: np.ndarray
    reach: float
    spacing: float
    tint: tuple[float, float, float]
    plate: np.ndarray | None = None
    floors: tuple = ()

    @cached_property
    def foot(self):
        """Where the patch has its middle, (3,) [m]."""
        return self.centre - self.normal * (self.normal @ (self.centre - self.point))

    @cached_property
    def frame(self):
        """Rows tangent, normal x tangent, normal."""
        return np.stack([self.tangent, np.cross(self.normal, self.tangent), self.normal])

    def holds(self, place):
        """Which of the places (2, P) [m] from the foot, along the frame's first axes, belong to the patch."""
        if self.plate is None:
            return np.hypot(*place) < self.reach
        held = (np.abs(place) < np.float32(self.plate)[:, None]).all(axis=0)
        for point, normal in self.floors:
            along, across = np.float32(self.frame[:2] @ normal)
            held &= place[0] * along + place[1] * across > np.float32(normal @ (point - self.foot))
        return held

    def lines(self, place, size):
        """How dark the grid and the edge are at the places (2, P) where pixels have the sizes (2, P) [m]."""
        shift = np.float32(self.frame[:2] @ (self.foot - self.point) % (5 * self.spacing))
        anchored = place + shift[:, None]
        line = 0.26 * _grid(anchored, size, self.spacing) + 0.2 * _grid(anchored, size, 5 * self.spacing)
        if self.plate is None:
            return line
        inside = np.minimum(*((np.float32(self.plate)[:, None] - np.abs(place)) / size))
        return line + 0.6 * (1 - _smooth(inside / 2 - 1))

    def fade(self, place):
        """Opacity at the places (2, P), as a share."""
        return 1.0 if self.plate is not None else 1 - _smooth((np.hypot(*place) / self.reach - 0.55) / 0.45)


def draw_plane(canvas, patch, *, surface=None):
    """Lay `patch` over `canvas`; surface: vertices (V, 3) [m] and faces of the object that darkens it.

    The plane's back is nearly clear, so that it hides nothing.
    """
    front = patch.normal @ (canvas.camera.eye - patch.foot) > 0
    opacity = 0.62 if patch.plate is None else 0.45
    pixel, place, size = _seen(canvas, patch)
    line = patch.lines(place, size)
    cover = (opacity if front else 0.10) + (1 - opacity) * line * (1.0 if front else 0.5)
    colour = np.float32(patch.tint) * (1 - 0.55 * line)[:, None]
    if surface is not None and front:
        dark = 0.8 * _sampled(_occlusion(*surface, patch.foot, patch.frame, patch.reach), place / patch.reach)
        colour, cover = colour * (1 - dark)[:, None], cover + (1 - cover) * dark
    canvas.blend(pixel, colour, cover * patch.fade(place))


def _seen(canvas, patch):
    """Fine pixels (P,) in which the patch is nearest, and on its two axes their places (2, P) and sizes (2, P) [m]."""
    right, above, back = np.float32(canvas.camera.axes @ patch.frame.T)
    x, y = canvas.sight()
    away = np.float32(patch.frame @ (canvas.camera.eye - patch.foot))
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (-away[2] / (x * right[2] + y[:, None] * above[2] - back[2])).ravel()
        pixel = np.flatnonzero((distance > 0) & (distance * canvas.depth <= 1.0005))
    x, y, distance = x[pixel % canvas.width], y[pixel // canvas.width], distance[pixel]
    place = np.stack([away[a] + distance * (x * right[a] + y * above[a] - back[a]) for a in (0, 1)])
    held = patch.holds(place)
    pixel, place, distance = pixel[held], place[:, held], distance[held]
    size = [  # |d place / d column| + |d place / d row|, where place = away - away_2 slope_a / slope_2
        sum(np.abs(step[a] + (place[a] - away[a]) * step[2] / away[2]) for step in (right, above)) * distance for a in (0, 1)
    ]
    return pixel, place, np.stack(size) / canvas.focal


def _grid(at, footprint, spacing):
    """How much of a pixel the lines at multiples of `spacing` cover; none where they crowd."""
    distance = np.abs(at - spacing * np.round(at / spacing))
    line = (1.0 - _smooth(distance / footprint - 0.7)) * (1 - _smooth((footprint / spacing - 0.15) / 0.3))
    return np.maximum(*line)


def _occlusion(vertices, faces, foot, frame, reach):
    """Share of the sky that the object hides from each texel of the patch, (TEXELS, TEXELS).

    A piece dA of the object's underside at height h and lateral distance r hides h^2 / (pi (h^2 + r^2)^2) dA of it.
    """
    height = _heights(vertices, faces, foot, frame, reach)
    hidden = np.zeros_like(height)
    least = 2 * SPREAD / TAPS
    for tap in range(TAPS):
        r, angle = SPREAD * (tap + 0.5) / TAPS, 2.399963 * tap
        shift = np.round(0.5 * r * TEXELS * np.array([np.cos(angle), np.sin(angle)])).astype(int)
        h = np.maximum(np.roll(height, tuple(shift), axis=(0, 1)), least)
        hidden += np.where(h < 1, 2 * r * SPREAD / TAPS * h**2 / (h**2 + r**2) ** 2, 0.0)
    for axis in (0, 1, 0, 1):
        hidden = (np.roll(hidden, 1, axis) + hidden + np.roll(hidden, -1, axis)) / 3
    return np.float32(hidden.clip(0, 1))


def _heights(vertices, faces, foot, frame, reach):
    """Height of the object's underside above each texel in patch radii, (TEXELS, TEXELS); 1 where there is none."""
    offset = (vertices - foot) / reach
    along, across, height = (offset @ frame.T).T
    screen = np.column_stack([(along + 1) * TEXELS / 2, (across + 1) * TEXELS / 2, 1 - height.clip(0, 1)])
    nearest = np.zeros(TEXELS * TEXELS, dtype=np.float32)
    for pixel, depth in _covered(screen, faces):
        np.maximum.at(nearest, pixel, depth)
    return 1.0 - nearest.reshape(TEXELS, TEXELS)


def _covered(screen, faces):
    """Texels and depths of the triangles, or, where these are hardly larger than a texel, of their vertices."""
    if len(faces) <= DENSE:
        return ((pixel, depth) for pixel, _, _, depth in fragments(screen, faces, TEXELS, TEXELS))
    column, row = np.floor(screen[:, :2]).astype(np.int64).T
    within = (column >= 0) & (column < TEXELS) & (row >= 0) & (row < TEXELS)
    return [((row * TEXELS + column)[within], screen[within, 2].astype(np.float32))]


def _sampled(image, offset):
    """`image` (TEXELS, TEXELS) at `offset` (2, P), -1 .. 1, between the texels."""
    x, y = ((offset + 1) * TEXELS / 2 - 0.5).clip(0, TEXELS - 1.001)
    i, j = x.astype(int), y.astype(int)
    a, b = x - i, y - j
    rows = [image[j + k, i] * (1 - a) + image[j + k, i + 1] * a for k in (0, 1)]
    return rows[0] * (1 - b) + rows[1] * b


def _smooth(t):
    t = t.clip(0, 1)
    return t * t * (3 - 2 * t)
