"""The shapes of solid obstacles: triangles for drawing, and distances from the solids.

A shape lies about the origin, along its own axes. The third axis is the axis of a cylinder and carries the pole of a sphere. A sphere's
triangles are finest around the pole, so that a sphere far larger than the object is round where it comes near the object.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from softffd.obstacles import SolidShape
from softffd.show.skin import cage_surface

AROUND, RINGS = 64, 48  # number of sides of round shapes, and of rings of a sphere from pole to pole
FINEST = 2000  # largest number of sides of a cylinder
SAGITTA = 1e-3  # allowed distance of a cylinder's sides from the circle, as a fraction of the size of the scene


@dataclass(frozen=True, eq=False)
class Form:
    """Triangles of a `shape`: `vertices` (V, 3) [m] with outward unit `normals` (V, 3), `faces` (F, 3). The solid is the intersection of
    the insides of K surfaces at right angles; `beyond` returns how far places (N, 3) [m] are outside each of them, (N, K) [m]."""

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    shape: SolidShape
    beyond: Callable[[np.ndarray], np.ndarray]

    def gap(self, places: np.ndarray) -> np.ndarray:
        """Returns the signed distances (N,) [m] of places (N, 3) [m] from the solid, negative inside."""
        beyond = self.beyond(places)
        return np.linalg.norm(beyond.clip(0), axis=1) + beyond.max(axis=1).clip(max=0)


def form_of(solid: SolidShape, scale: float) -> Form:
    """Returns the form of a SolidShape, for pictures of a scene of size `scale` [m]."""
    return FORMS[solid.kind](solid, scale)


def _sphere(solid: SolidShape, scale: float) -> Form:
    """Returns the form of a sphere; half of its rings are within `scale` of the pole."""
    crowded = np.log2(max(2.0, np.pi * solid.radius / scale))
    angle = np.pi * np.linspace(0, 1, RINGS + 1) ** crowded
    profile = np.column_stack([np.sin(angle), np.cos(angle)])
    lathed = _lathed([(solid.radius * profile, profile)], AROUND)
    return Form(*lathed, solid, lambda places: np.linalg.norm(places, axis=1, keepdims=True) - solid.radius)


def _cylinder(solid: SolidShape, scale: float) -> Form:
    r, h = solid.radius, solid.length / 2
    sides = np.clip(np.pi * np.sqrt(r / (2 * SAGITTA * scale)), AROUND, FINEST)
    profile = [((0, h), (r, h), (0, 1)), ((r, h), (r, -h), (1, 0)), ((r, -h), (0, -h), (0, -1))]
    lathed = _lathed([(np.array([a, b], float), np.array([out, out], float)) for a, b, out in profile], int(sides))

    def beyond(places: np.ndarray) -> np.ndarray:
        return np.column_stack([np.hypot(places[:, 0], places[:, 1]) - r, np.abs(places[:, 2]) - h])

    return Form(*lathed, solid, beyond)


def _box(solid: SolidShape, scale: float) -> Form:
    half = np.array(solid.size) / 2
    vertices, faces = cage_surface(-half, 2 * half, divisions=1)
    normals = np.repeat([side * axis for axis in np.eye(3) for side in (-1, 1)], 4, axis=0)
    return Form(vertices, normals, faces, solid, lambda places: np.abs(places) - half)


FORMS = {"sphere": _sphere, "cylinder": _cylinder, "box": _box}


def _lathed(lines: Sequence[tuple[np.ndarray, np.ndarray]], sides: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns vertices, normals and faces of the surfaces that profiles generate when they turn around the third axis.

    lines: pairs of places (P, 2) [m] and normals (P, 2), each as distance from the axis and height.
    """
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    vertices, normals, faces, first = [], [], [], 0
    for places, out in lines:
        vertices.append(_turned(places, angle))
        normals.append(_turned(out, angle))
        a = first + (np.arange(len(places) - 1)[:, None] * (sides + 1) + np.arange(sides)).ravel()
        b = a + sides + 1
        faces += [np.column_stack([a, b, a + 1]), np.column_stack([a + 1, b, b + 1])]
        first += len(vertices[-1])
    return np.concatenate(vertices), np.concatenate(normals), np.concatenate(faces)


def _turned(profile: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Returns the profile (P, 2) at each angle (A,), (P * A, 3)."""
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1) * profile[:, None, :1]
    return np.concatenate([around, np.broadcast_to(profile[:, None, 1:], (*around.shape[:2], 1))], axis=2).reshape(-1, 3)
