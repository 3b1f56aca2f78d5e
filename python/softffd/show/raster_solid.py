"""A solid obstacle in a picture: its surface, shaded."""

import numpy as np

NEAR = 0.05
"""What is closer to the eye than this share of its distance from the target is not drawn."""


def draw_solid(canvas, vertices, normals, faces, *, tint):
    """Draw a convex solid of vertices (V, 3) [m] with outward normals (V, 3) and `faces` (F, 3) on `canvas`; from within it is not seen."""
    camera = canvas.camera
    seen = (normals[faces].sum(axis=1) * (camera.eye - vertices[faces].mean(axis=1))).sum(axis=1) > 0
    corners = np.concatenate([vertices, normals], axis=1)[faces[seen]]
    near = NEAR * np.linalg.norm(camera.eye - camera.target)
    corners = _in_front(corners, (camera.eye - corners[..., :3]) @ camera.axes[2] - near)
    flat, normals = corners[..., :3].reshape(-1, 3), corners[..., 3:]
    canvas.triangles(flat, np.arange(len(flat)).reshape(-1, 3), normals, lambda *_: np.float32(tint)[:, None])


def _in_front(corners, ahead):
    """Triangles (G, 3, C) that are the parts of triangles (F, 3, C) where `ahead` (F, 3), given at the corners, is positive."""
    inside = ahead > 0
    count = inside.sum(axis=1)
    parts = [corners[count == 3]]
    for n in (1, 2):
        some = np.flatnonzero(count == n)
        lone = (inside[some] == (n == 1)).argmax(axis=1)  # the corner that is alone on its side comes first
        order = some[:, None], (lone[:, None] + np.arange(3)) % 3
        (a, b, c), (at, bt, ct) = np.moveaxis(corners[order], 1, 0), ahead[order].T
        ab, ac = (a + (end - a) * (at / (at - t))[:, None] for end, t in ((b, bt), (c, ct)))
        pieces = [(a, ab, ac)] if n == 1 else [(ab, b, c), (ab, c, ac)]
        parts += [np.stack(piece, axis=1) for piece in pieces]
    return np.concatenate(parts)
