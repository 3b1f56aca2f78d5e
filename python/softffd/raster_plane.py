"""An obstacle plane in a picture: a translucent patch with a grid and the soft shadow of what is above it."""

import numpy as np

from softffd.raster import fragments

TEXELS = 192
TAPS = 128
SPREAD = 0.5


def draw_plane(canvas, point, normal, tangent, *, centre, reach, spacing, tint, surface=None, opacity=0.62):
    """Lay over `canvas` the patch of `reach` [m] about the foot of `centre` (3,) on the plane through `point`.

    normal, tangent: unit and orthogonal; the grid of `spacing` [m] is anchored at `point`. surface: vertices (V, 3) [m] and faces
    of the object that darkens the patch. The back of the plane is nearly clear, so that it hides nothing.
    """
    foot = centre - normal * (normal @ (centre - point))
    frame = np.stack([tangent, np.cross(normal, tangent)])
    pixel, place, footprint = _patch(canvas, foot, normal, frame, reach)
    offset = (place - foot) @ frame.T / reach
    front = normal @ (canvas.camera.eye - foot) > 0
    at = (place - point) @ frame.T
    line = 0.26 * _grid(at, footprint, spacing) + 0.2 * _grid(at, footprint, 5 * spacing)
    cover = (opacity if front else 0.14) + (1 - opacity) * line * (1.0 if front else 0.5)
    colour = np.asarray(tint) * (1 - 0.55 * line)[:, None]
    if surface is not None and front:
        dark = 0.8 * _sampled(_occlusion(*surface, foot, normal, frame, reach), offset)
        colour, cover = colour * (1 - dark)[:, None], cover + (1 - cover) * dark
    fade = 1 - _smooth((np.linalg.norm(offset, axis=1) - 0.55) / 0.45)
    canvas.blend(pixel, colour, cover * fade)


def _patch(canvas, foot, normal, frame, reach):
    """Fine pixels (P,) in which the patch is nearest, its points (P, 3) there, and a pixel's size (P, 2) on it along `frame`."""
    distance = canvas.distances(foot, normal)
    pixel = np.flatnonzero((distance > 0) & (distance * canvas.depth <= 1.0005))
    rays = canvas.rays(pixel)
    place = canvas.camera.eye + rays * distance[pixel, None]
    near = np.einsum("pa,pa->p", place - foot, place - foot) < reach**2
    pixel, rays, place = pixel[near], rays[near], place[near]
    footprint = np.zeros((len(pixel), 2))
    for step in canvas.camera.axes[:2] / canvas.focal:
        moved = step @ frame.T - (rays @ frame.T) * (step @ normal / (rays @ normal))[:, None]
        footprint += np.abs(moved * distance[pixel, None])
    return pixel, place, footprint


def _grid(at, footprint, spacing):
    """How much of a pixel the lines at multiples of `spacing` cover; none where they crowd."""
    distance = np.abs(at - spacing * np.round(at / spacing))
    line = (1.0 - _smooth(distance / footprint - 0.7)) * (1 - _smooth((footprint / spacing - 0.15) / 0.3))
    return line.max(axis=1)


def _occlusion(vertices, faces, foot, normal, frame, reach):
    """Share of the sky that the object hides from each texel of the patch, (TEXELS, TEXELS).

    A piece dA of the object's underside at height h and lateral distance r hides h^2 / (pi (h^2 + r^2)^2) dA of it.
    """
    height = _heights(vertices, faces, foot, normal, frame, reach)
    hidden = np.zeros_like(height)
    least = 2 * SPREAD / TAPS
    for tap in range(TAPS):
        r, angle = SPREAD * (tap + 0.5) / TAPS, 2.399963 * tap
        shift = np.round(0.5 * r * TEXELS * np.array([np.cos(angle), np.sin(angle)])).astype(int)
        h = np.maximum(np.roll(height, tuple(shift), axis=(0, 1)), least)
        hidden += np.where(h < 1, 2 * r * SPREAD / TAPS * h**2 / (h**2 + r**2) ** 2, 0.0)
    for axis in (0, 1, 0, 1):
        hidden = (np.roll(hidden, 1, axis) + hidden + np.roll(hidden, -1, axis)) / 3
    return hidden.clip(0, 1)


def _heights(vertices, faces, foot, normal, frame, reach):
    """Height of the object's underside above each texel in patch radii, (TEXELS, TEXELS); 1 where there is none."""
    offset = (vertices - foot) / reach
    height = (offset @ normal).clip(0, 1)
    screen = np.column_stack([(offset @ frame.T + 1) * TEXELS / 2, 1 - height])
    nearest = np.zeros(TEXELS * TEXELS, dtype=np.float32)
    for pixel, _, _, depth in fragments(screen, faces, TEXELS, TEXELS):
        np.maximum.at(nearest, pixel, depth)
    return 1.0 - nearest.reshape(TEXELS, TEXELS)


def _sampled(image, offset):
    """`image` (TEXELS, TEXELS) at `offset` (P, 2), -1 .. 1, between the texels."""
    x, y = ((offset + 1) * TEXELS / 2 - 0.5).clip(0, TEXELS - 1.001).T
    i, j = x.astype(int), y.astype(int)
    a, b = x - i, y - j
    rows = [image[j + k, i] * (1 - a) + image[j + k, i + 1] * a for k in (0, 1)]
    return rows[0] * (1 - b) + rows[1] * b


def _smooth(t):
    t = t.clip(0, 1)
    return t * t * (3 - 2 * t)
