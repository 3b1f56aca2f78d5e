"""Normals for shading a surface: smooth across gentle edges, sharp across creases."""

from collections.abc import Iterator

import numpy as np

CREASE = np.cos(np.radians(40.0))
FAN_LIMIT = 256
BLOCK = 1 << 15


class ShadingNormals:
    """Normals per face corner: smooth across gentle edges, sharp across creases of more than 40 degrees.

    The faces over which a corner averages are chosen once, at rest, so that the shading does not flicker while the object bends.
    Vertices at equal positions count as one, and a neighbour of opposite winding counts with the opposite sign.
    """

    def __init__(self, vertices: np.ndarray, faces: np.ndarray):
        self._faces = faces
        direction = face_normals(vertices, faces)
        index, _ = merge_by_position(vertices)
        kept = [_gentle(*pairs, direction) for pairs in _neighbouring_corners(index[faces])]
        self._corner, self._face, self._sign = (np.concatenate(parts) for parts in zip(*kept, strict=True))

    def corners(self, vertices: np.ndarray) -> np.ndarray:
        """Returns the unit normals (F, 3, 3) of the corners of all faces for vertices (V, 3) [m] in any deformed state."""
        normals = area_vectors(vertices[self._faces])
        count = 3 * len(self._faces)
        sums = [np.bincount(self._corner, self._sign * normals[self._face, a], minlength=count) for a in range(3)]
        return unit(np.stack(sums, axis=1)).reshape(-1, 3, 3)


def split_at_creases(
    vertices: np.ndarray, faces: np.ndarray, normals: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns an indexed surface whose vertices have one normal each, from corner normals (F, 3, 3), by default those of the vertices.

    The result has W vertices, W >= V if all are in use: the original vertex of each (W,), its unit normal (W, 3), and the faces (F, 3).
    """
    normals = (ShadingNormals(vertices, faces).corners(vertices) if normals is None else normals).reshape(-1, 3)
    grid = np.round(normals * 500.0).astype(np.int64) + 512
    key = (((faces.ravel() << 10 | grid[:, 0]) << 10) | grid[:, 1]) << 10 | grid[:, 2]
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    return faces.ravel()[first], normals[first], index.reshape(-1, 3)


def face_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Returns the unit normals (F, 3) of the triangles; zero for a triangle without area."""
    return unit(area_vectors(vertices[faces]))


def area_vectors(corners: np.ndarray) -> np.ndarray:
    """Returns the normals (F, 3) of triangles with corners (F, 3, 3); the length of a normal is twice the area."""
    a, b, c = corners.transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def cut_triangles(corners: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Cuts triangles (F, 3, c) with corner heights (F, 3) at the height 0 into triangles (G, 3, c) on one side each. A crossing triangle
    becomes three: one at the corner that is alone on its side, two on the other side. The c numbers are interpolated linearly."""
    crossing = (height.min(axis=1) < 0) & (height.max(axis=1) > 0)
    kept, corners, height = corners[~crossing], corners[crossing], height[crossing]
    above = height > 0
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (height < 0).argmax(axis=1))
    order = (alone[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(corners, order[:, :, None], axis=1).transpose(1, 0, 2)
    at, bt, ct = np.take_along_axis(height, order, axis=1).T[:, :, None]
    ab, ac = (b * at - a * bt) / (at - bt), (c * at - a * ct) / (at - ct)
    return np.concatenate([kept, *(np.stack(piece, axis=1) for piece in ((a, ab, ac), (ab, b, c), (ab, c, ac)))])


def unit(vectors: np.ndarray) -> np.ndarray:
    """Returns the vectors (..., 3) scaled to length 1; zero vectors remain zero."""
    length = np.sqrt(np.einsum("...a,...a->...", vectors, vectors))[..., None]
    return vectors / np.where(length > 0, length, 1.0)


def _neighbouring_corners(faces: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yields all pairs of face corners (3 f + k) at the same vertex, including each corner with itself, in blocks that bound the memory.

    A corner in a fan of more than FAN_LIMIT triangles is paired only with itself, since the pairs grow with the square of the fan.
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


def _gentle(corner: np.ndarray, other: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the pairs without a crease between them: corner, face of the other corner, sign of the winding of that face."""
    cosine = np.einsum("pa,pa->p", direction[corner // 3], direction[other // 3])
    kept = (np.abs(cosine) > CREASE) | (corner == other)
    sign = np.where(cosine[kept] < 0, -1, 1).astype(np.int8)
    return corner[kept].astype(np.int32), (other[kept] // 3).astype(np.int32), sign


def merge_by_position(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns index (V,) and positions (U, 3) with vertices = positions[index], up to about 1e-8 of the extent.

    vertices: (V, 3) [m]. Each position is that of the first vertex there; the positions keep the order of these vertices.
    """
    if not len(vertices):
        return np.zeros(0, dtype=np.int64), vertices
    extent = np.ptp(vertices, axis=0).max()
    index, first = first_of_each(np.round((vertices - vertices.min(axis=0)) / (1e-8 * extent or 1.0)))
    return index, vertices[first]


def first_of_each(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns for N >= 1 rows (N, c) the number of its distinct row (N,), and the first occurrence (U,) of each distinct row, ascending."""
    order = np.lexsort(rows.T)
    new = np.append(True, (rows[order[1:]] != rows[order[:-1]]).any(axis=1))
    first = order[new]
    index = np.empty(len(rows), dtype=np.int64)
    index[order] = first.argsort().argsort()[np.cumsum(new) - 1]
    return index, np.sort(first)
