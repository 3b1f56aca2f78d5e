"""Flat marks over a picture, with an outline: arrows and dots."""

import numpy as np

from softffd.show.raster import Canvas, Tint, fragments

ROUND = 16  # corners of a dot


def draw_arrow(canvas: Canvas, start: np.ndarray, end: np.ndarray, *, width: float, colour: Tint, outline: Tint) -> None:
    """An arrow from `start` to `end` (3,) [m], or longer, so that it is one; its shaft is `width` pixels wide."""
    a, b = canvas.project(np.stack([start, end]))
    along = (b - a)[:2]
    length = np.linalg.norm(along)
    along = along / length if length > 0 else np.array([0.0, 1.0])
    wide = 2 * width
    b[:2] = a[:2] + along * max(length, 6.5 * wide)
    for extra, tint in ((0.45 * wide, outline), (0.0, colour)):
        _fill(canvas, _arrow_corners(a, b, along, wide, extra), _ARROW, tint, 0.55)


_ARROW = np.array([[0, 1, 2], [1, 3, 2], [4, 5, 6]])


def _arrow_corners(a: np.ndarray, b: np.ndarray, along: np.ndarray, wide: float, extra: float) -> np.ndarray:
    """Screen positions of the shaft's corners and the head's, all larger by `extra` fine pixels."""
    side = np.array([along[1], -along[0]])
    neck = b[:2] - along * 4 * wide
    shaft, wing = 0.5 * wide + extra, 1.6 * (wide + extra)
    flat = [a[:2] - extra * along - shaft * side, a[:2] - extra * along + shaft * side, neck - shaft * side, neck + shaft * side]
    flat += [neck - extra * along - wing * side, neck - extra * along + wing * side, b[:2] + 2 * extra * along]
    return np.column_stack([flat, [a[2]] * 2 + [b[2]] * 5])


def draw_dots(canvas: Canvas, points: np.ndarray, *, radius: float, colour: Tint, outline: Tint) -> None:
    """Dots of `radius` pixels at points (N, 3) [m], in front of what they touch."""
    angle = np.linspace(0, 2 * np.pi, ROUND, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(ROUND)])
    fan = np.column_stack([np.zeros(ROUND - 2, dtype=int), np.arange(1, ROUND - 1), np.arange(2, ROUND)])
    centres = canvas.project(points) * [1.0, 1.0, 1.01]
    faces = (ROUND * np.arange(len(points))[:, None, None] + fan).reshape(-1, 3)
    for size, tint in ((2 * radius, outline), (1.3 * radius, colour)):
        _fill(canvas, (centres[:, None] + size * circle).reshape(-1, 3), faces, tint, 0.4)


def _fill(canvas: Canvas, screen: np.ndarray, faces: np.ndarray, colour: Tint, hidden: float) -> None:
    """Lay triangles `faces` of screen positions (N, 3) over the picture, each pixel once. hidden: opacity behind other things."""
    for pixel, _, depth in fragments(screen, faces, canvas.width, canvas.height):
        pixel, first = np.unique(pixel, return_index=True)
        canvas.blend(pixel, colour, np.where(depth[first] >= 0.99 * canvas.depth[pixel], 1.0, hidden))
