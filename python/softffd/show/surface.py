"""The surface that pictures show: without a mesh the boundary of the volume; and normals that shade it well."""

import numpy as np

from softffd.mesh.mesh import merge_by_position

CREASE = np.cos(np.radians(40.0))
FAN_LIMIT = 256
BLOCK = 1 << 15


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


class ShadingNormals:
    """Normals per face corner: smooth across gentle edges, sharp across creases of more than 40 degrees.

    Which faces a corner averages over is decided once, at rest: shading does not flicker while the object bends.
    Vertices at equal positions count as one, and a neighbour wound the other way round counts with its sign turned.
    """

    def __init__(self, vertices, faces):
        self._faces = faces
        direction = _unit(_face_normals(vertices, faces))
        index, _ = merge_by_position(vertices)
        kept = [_gentle(*pairs, direction) for pairs in _neighbouring_corners(index[faces])]
        self._corner, self._face, self._sign = (np.concatenate(parts) for parts in zip(*kept, strict=True))

    def corners(self, vertices):
        """Unit normals (F, 3, 3) of the corners of every face, for vertices (V, 3) [m] in any deformed state."""
        normals = _face_normals(vertices, self._faces)
        count = 3 * len(self._faces)
        sums = [np.bincount(self._corner, self._sign * normals[self._face, a], minlength=count) for a in range(3)]
        return _unit(np.stack(sums, axis=1)).reshape(-1, 3, 3)


def split_at_creases(vertices, faces):
    """An indexed surface whose vertices each have one normal.

    Returns for its W >= V vertices the vertex that each copies (W,) and the unit normal (W, 3); and its faces (F, 3).
    """
    normals = ShadingNormals(vertices, faces).corners(vertices).reshape(-1, 3)
    grid = np.round(normals * 500.0).astype(np.int64) + 512
    key = (((faces.ravel() << 10 | grid[:, 0]) << 10) | grid[:, 1]) << 10 | grid[:, 2]
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    return faces.ravel()[first], normals[first], index.reshape(-1, 3)


def face_normals(vertices, faces):
    """Unit normals (F, 3) of the triangles; zero for a triangle without area."""
    return _unit(_face_normals(vertices, faces))


def _face_normals(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _unit(vectors):
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def _neighbouring_corners(faces):
    """All pairs of face corners (3 f + k) at the same vertex, each with itself too, in blocks that bound the memory.

    A corner of a fan of more than FAN_LIMIT triangles is alone: the pairs grow with the square of the fan.
    """
    vertex = faces.ravel()
    order = np.argsort(vertex, kind="stable")
    degree = np.bincount(vertex)
    alone = degree[vertex[order]] > FAN_LIMIT
    start = np.where(alone, np.arange(len(order)), (np.cumsum(degree) - degree)[vertex[order]])
    count = np.where(alone, 1, degree[vertex[order]])
    for block in range(0, len(order), BLOCK):
        corner, first, n = (a[block : block + BLOCK] for a in (order, start, count))
        within = np.arange(n.sum()) - np.repeat(np.cumsum(n) - n, n)
        yield np.repeat(corner, n), order[np.repeat(first, n) + within]


def _gentle(corner, other, direction):
    """Of the pairs those without a crease between: corner, face of the other corner, sign of its winding."""
    cosine = np.einsum("pa,pa->p", direction[corner // 3], direction[other // 3])
    kept = (np.abs(cosine) > CREASE) | (corner == other)
    sign = np.where(cosine[kept] < 0, -1, 1).astype(np.int8)
    return corner[kept].astype(np.int32), (other[kept] // 3).astype(np.int32), sign
