"""The surface that pictures show where there is no mesh: the boundary of the volume."""

import numpy as np


def cage_surface(origin, size, *, divisions=24):
    """The six faces of the box `origin` .. `origin + size` [m], each cut into `divisions` x `divisions` squares.

    Returns vertices (6 (divisions+1)^2, 3) [m] and faces (12 divisions^2, 3), wound so that normals point outwards.
    """
    t = np.linspace(0.0, 1.0, divisions + 1)
    first, second = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
    corner = (np.arange(divisions)[:, None] * (divisions + 1) + np.arange(divisions)).ravel()
    lower = np.stack([corner, corner + divisions + 1, corner + 1], axis=1)
    upper = np.stack([corner + 1, corner + divisions + 1, corner + divisions + 2], axis=1)
    square = np.concatenate([lower, upper])
    vertices, faces = [], []
    for axis in range(3):
        for side in (0.0, 1.0):
            coordinates = np.empty((len(first), 3))
            coordinates[:, axis], coordinates[:, axis - 2], coordinates[:, axis - 1] = side, first, second
            faces.append(len(first) * len(faces) + (square if side else square[:, ::-1]))
            vertices.append(coordinates)
    return np.asarray(origin) + np.concatenate(vertices) * np.asarray(size), np.concatenate(faces)
