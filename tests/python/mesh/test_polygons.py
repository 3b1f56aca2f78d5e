"""Polygons of mesh files become triangles that cover them, and nothing beside them."""

import numpy as np
import pytest

from mesh_files import loaded, ply


@pytest.mark.parametrize("corners", [4, 5, 9])
def test_polygons_become_triangles_that_cover_them(corners, tmp_path):
    angles = 2 * np.pi * np.arange(corners) / corners
    ring = "".join(f"v {np.cos(a)} {np.sin(a)} {z}\n" for z in (0, 1) for a in angles)
    low, high = " ".join(map(str, range(corners, 0, -1))), " ".join(map(str, range(corners + 1, 2 * corners + 1)))
    sides = "".join(f"f {i + 1} {(i + 1) % corners + 1} {(i + 1) % corners + corners + 1} {i + corners + 1}\n" for i in range(corners))
    mesh = loaded(tmp_path, "a.obj", ring + f"f {low}\nf {high}\n" + sides)
    assert mesh.closed and len(mesh.faces) == 2 * (corners - 2) + 2 * corners
    area = corners / 2 * np.sin(2 * np.pi / corners)
    assert np.linalg.det(mesh.vertices[mesh.faces]).sum() / 6 == pytest.approx(area, rel=1e-12)


HOLES = [(x + dx, y) for x in (1, 3) for dx, y in [(0, 0), (0, 1), (0, 2), (1, 2), (1, 1), (0, 1), (0, 0)]]
OUTLINES = {
    "a C": ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (3, 2), (3, 3), (0, 3)], 7),
    "two holes by bridges": ([(0, 0), *HOLES, (5, 0), (5, 3), (0, 3)], 13),
    "a hole by a bridge from a corner": ([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], 12),
    "a slit": ([(0, 0), (4, 0), (4, 4), (2, 4), (2, 2), (2, 4), (0, 4)], 16),
    "corners given twice": ([(0, 0), (2, 0), (2, 0), (4, 0), (4, 4), (2, 2), (2, 2), (0, 4)], 12),
    "corners on sides": ([(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 1.5), (1, 2), (0, 2), (0, 1)], 3),
    "a dart": ([(0, 0), (2, -1), (0, 3), (-2, -1)], 6),
}


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("name", OUTLINES)
@pytest.mark.parametrize("kind", ["obj", "ply", "off"])
def test_concave_polygons_are_covered_and_nothing_beside_them(kind, name, first, tmp_path):
    """A prism in a slanting frame, whose volume would be right with fans that cover the notches too."""
    outline, area = OUTLINES[name]
    n = len(outline)
    flat = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in np.roll(outline, -first, axis=0)])
    points = flat @ np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    mesh = loaded(tmp_path, f"a.{kind}", _polygons(kind, points, [[*range(n - 1, -1, -1)], [*range(n, 2 * n)], *sides]))
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    around = np.linalg.norm(np.diff([*outline, outline[0]], axis=0), axis=1).sum()
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(2 * area + around, rel=1e-6)
    assert mesh.closed and len(mesh.faces) == 2 * (n - 2) + 2 * n and mesh.looks.notes == ()


def test_polygons_that_cross_themselves_are_told(tmp_path):
    mesh = loaded(tmp_path, "a.obj", "v 0 0 0\nv 3 3 1\nv 3 0 0\nv 0 2 0\nf 1 2 3 4\n")
    assert mesh.looks.notes == ("polygons that cross themselves: 1; what of them is filled is a guess",)


def _polygons(kind, points, faces):
    if kind == "obj":
        rows = [("v", *point) for point in points] + [("f", *(corner + 1 for corner in face)) for face in faces]
    else:
        rows = [*points, *((len(face), *face) for face in faces)]
    head = {"obj": "", "ply": ply(len(points), len(faces)), "off": f"OFF\n{len(points)} {len(faces)} 0\n"}[kind]
    return head + "".join(" ".join(map(str, row)) + "\n" for row in rows)
