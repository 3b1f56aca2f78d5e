import numpy as np

from softffd.mesh.normals import ShadingNormals, _neighbouring_corners, face_normals, split_at_creases
from softffd.show.skin import cage_surface


def sphere(rings=24):
    polar, turn = np.meshgrid(np.linspace(0, np.pi, rings), np.linspace(0, 2 * np.pi, 2 * rings), indexing="ij")
    points = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=-1).round(12)
    corner = (np.arange(rings - 1)[:, None] * 2 * rings + np.arange(2 * rings - 1)).ravel()
    lower = np.stack([corner, corner + 2 * rings, corner + 1], axis=1)
    upper = np.stack([corner + 1, corner + 2 * rings, corner + 2 * rings + 1], axis=1)
    return points.reshape(-1, 3), np.concatenate([lower, upper])


def test_cage_surface_is_the_box_seen_from_outside():
    vertices, faces = cage_surface([1, 2, 3], [2, 4, 6], divisions=3)
    assert vertices.min(axis=0).tolist() == [1, 2, 3] and vertices.max(axis=0).tolist() == [3, 6, 9]
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    volume = np.einsum("fa,fa->f", a, np.cross(b, c)).sum() / 6
    assert np.isclose(volume, 2 * 4 * 6)


def test_normals_of_a_fine_sphere_point_away_from_its_centre_also_beside_faces_wound_the_wrong_way():
    vertices, faces = sphere()
    normals = ShadingNormals(vertices, faces).corners(vertices)
    proper = face_normals(vertices, faces).any(axis=1)
    cosine = np.einsum("fka,fka->fk", normals, vertices[faces])[proper]
    assert cosine.min() > 0.99
    turned = faces.copy()
    turned[100:110] = turned[100:110, ::-1]
    rest = np.r_[0:100, 110 : len(faces)]
    assert np.allclose(normals[rest], ShadingNormals(vertices, turned).corners(vertices)[rest], atol=1e-12)


def test_normals_stay_sharp_at_the_edges_of_a_box():
    vertices, faces = cage_surface([0, 0, 0], [1, 1, 1], divisions=2)
    normals = ShadingNormals(vertices, faces).corners(vertices)
    assert np.allclose(normals, face_normals(vertices, faces)[:, None])


def test_splitting_keeps_every_triangle_where_it_is():
    vertices, faces = cage_surface([0, 0, 0], [1, 1, 1], divisions=2)
    source, normals, split = split_at_creases(vertices, faces)
    assert np.array_equal(vertices[source][split], vertices[faces])
    assert np.allclose(normals[split], face_normals(vertices, faces)[:, None])


def test_the_corners_of_a_huge_fan_are_not_paired():
    turn = np.linspace(0, 2 * np.pi, 20_001)[:-1]
    vertices = np.vstack([[0, 0, 0.1], np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)])
    rim = 1 + np.arange(len(turn))
    faces = np.stack([0 * rim, rim, np.roll(rim, -1)], axis=1)
    assert sum(len(corner) for corner, _ in _neighbouring_corners(faces)) < 10 * len(faces)
    assert (ShadingNormals(vertices, faces).corners(vertices)[..., 2] > 0.99).all()
