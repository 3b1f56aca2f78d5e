"""The surface shown where there is no mesh; the skin of a surface: a tint at every vertex, and pictures (textures) that multiply tints."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from softffd.mesh.looks import Picture
from softffd.mesh.mesh import Mesh

Painter = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Returns the colours (3, P), 0 .. 1, at places on a surface, given by face (P,) and barycentric coordinates (3, P)."""


def single(values: ArrayLike) -> np.ndarray:
    """Returns the values in single precision."""
    return np.asarray(values, dtype=np.float32)


def cage_surface(origin: ArrayLike, size: ArrayLike, *, divisions: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Builds the six faces of the box `origin` .. `origin + size` [m], each cut into `divisions` x `divisions` squares.

    Returns vertices (6 (divisions+1)^2, 3) [m] and faces (12 divisions^2, 3), wound so that normals point outwards.
    """
    t = np.linspace(0.0, 1.0, divisions + 1)
    first, second = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
    corner = (np.arange(divisions)[:, None] * (divisions + 1) + np.arange(divisions)).ravel()
    lower = np.stack([corner, corner + divisions + 1, corner + 1], axis=1)
    upper = np.stack([corner + 1, corner + divisions + 1, corner + divisions + 2], axis=1)
    square = np.concatenate([lower, upper])
    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []
    for axis in range(3):
        for side in (0.0, 1.0):
            coordinates = np.empty((len(first), 3))
            coordinates[:, axis], coordinates[:, axis - 2], coordinates[:, axis - 1] = side, first, second
            faces.append(len(first) * len(faces) + (square if side else square[:, ::-1]))
            vertices.append(coordinates)
    return np.asarray(origin) + np.concatenate(vertices) * np.asarray(size), np.concatenate(faces)


PAINT = (0.15, 0.45, 0.68)  # colour of surfaces without a colour of their own


@dataclass(frozen=True, eq=False)
class Skin:
    """`tints` (V, 3): sRGB, 0 .. 1, linear between the vertices. `picture_of` (F,): the index of each face's picture in `pictures`, -1
    for none. `uv` (V, 2): the places of the vertices in their pictures, (0, 0) at the lower left corner."""

    tints: np.ndarray
    picture_of: np.ndarray
    uv: np.ndarray
    pictures: tuple[Picture, ...] = ()

    def painter(self, faces: np.ndarray) -> Painter:
        of_corners = single(self.tints).T[:, faces.T]
        even = bool((of_corners == of_corners[:, :1]).all())
        images = [np.asarray(picture.convert("RGB"), dtype=np.float32) / 255 for picture in self.pictures]
        uv = single(self.uv).T[:, faces.T]

        def paint(face: np.ndarray, share: np.ndarray) -> np.ndarray:
            colours = of_corners[:, 0].take(face, axis=1) if even else np.einsum("kp,akp->ap", share, of_corners.take(face, axis=2))
            for number, image in enumerate(images):
                held = np.flatnonzero(self.picture_of[face] == number)
                place = np.einsum("kp,akp->ap", share[:, held], uv.take(face[held], axis=2))
                place -= np.floor(place)
                rows, columns = image.shape[:2]
                row = ((1 - place[1]) * rows).astype(int).clip(0, rows - 1)
                texel = row * columns + (place[0] * columns).astype(int).clip(0, columns - 1)
                colours[:, held] *= image.reshape(-1, 3).T.take(texel, axis=1)
            return colours

        return paint


def painted(vertices: np.ndarray, faces: np.ndarray) -> Skin:
    """Returns the skin of a surface without looks."""
    return Skin(np.tile(PAINT, (len(vertices), 1)), np.full(len(faces), -1), np.zeros((len(vertices), 2)))


def skinned(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, Skin]:
    """Returns a mesh as it is shown: vertices (W, 3) [m] that each have one material, the faces (F, 3) of them, and their skin."""
    looks = mesh.looks
    source, material, faces = looks.apart(mesh.faces)
    vertices = mesh.vertices[source]
    if not looks.materials and looks.colours is None:
        return vertices, faces, painted(vertices, faces)
    tints = np.ones((len(vertices), 3)) if looks.colours is None else looks.colours[source]
    uv = np.zeros((len(vertices), 2)) if mesh.uv is None else mesh.uv[source]
    pictures = looks.textures if mesh.uv is not None else []
    picture_of = np.full(len(faces), -1)
    if looks.materials:
        number = {id(picture): n for n, picture in enumerate(pictures)}
        numbers = np.array([number.get(id(each.texture), -1) for each in looks.materials])
        bare = PAINT if looks.colours is None else (1.0, 1.0, 1.0)
        colours = [each.colour or ((1.0, 1.0, 1.0) if n >= 0 else bare) for each, n in zip(looks.materials, numbers, strict=True)]
        tints, picture_of = tints * np.array(colours)[material], numbers[looks.material_of]
    return vertices, faces, Skin(tints, picture_of, uv, tuple(pictures))
