"""Facts about meshes and their files, the damaged ones above all."""

import logging
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from mesh_files import CORNERS, ENDINGS, FACES, OFF, PLY_TEXT, TETRAHEDRON, ball, binary_ply, glb_with, loaded, ply, saved, text_stl
from softffd.errors import MeshError, SoftffdError
from softffd.mesh.files import load_mesh, save_mesh
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import merge_by_position


@pytest.mark.parametrize("kind", ENDINGS)
def test_a_mesh_survives_saving_and_loading(kind, tmp_path):
    mesh = ball(uv=True)
    again = loaded(tmp_path, f"again.{kind}", saved(tmp_path, kind, mesh))
    assert again.closed and again.name == "again" and len(again.faces) == len(mesh.faces)
    single_precision = 1e-7
    if kind == "stl":
        assert again.uv is None and len(again.vertices) == len(mesh.vertices)
    else:
        np.testing.assert_array_equal(again.faces, mesh.faces)
        np.testing.assert_allclose(again.vertices, mesh.vertices, atol=single_precision)
        np.testing.assert_allclose(again.uv, mesh.uv, atol=single_precision)


@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_a_texture_survives_saving_and_loading(kind, tmp_path):
    pixels = np.random.default_rng(1).integers(0, 255, (4, 8, 3), dtype=np.uint8)
    save_mesh(ball(uv=True, texture=Image.fromarray(pixels)), tmp_path / f"ball.{kind}")
    texture = load_mesh(tmp_path / f"ball.{kind}").texture
    np.testing.assert_array_equal(np.asarray(texture.convert("RGB")), pixels)


def test_a_missing_or_damaged_texture_costs_only_the_texture(tmp_path):
    save_mesh(ball(uv=True, texture=Image.new("RGB", (4, 4))), tmp_path / "ball.obj")
    for spoil in (lambda f: f.write_bytes(f.read_bytes()[:40]), Path.unlink):
        spoil(tmp_path / "ball.png")
        mesh = load_mesh(tmp_path / "ball.obj")
        assert mesh.texture is None and mesh.uv is not None


def test_vertices_given_are_saved_in_place_of_the_mesh_s_own(tmp_path):
    mesh = ball(uv=True)
    save_mesh(mesh, tmp_path / "moved.obj", vertices=mesh.vertices + 5.0)
    np.testing.assert_allclose(load_mesh(tmp_path / "moved.obj").vertices, mesh.vertices + 5.0, atol=1e-8)
    with pytest.raises(ValueError, match="wanted the mesh's shape"):
        save_mesh(mesh, tmp_path / "moved.obj", vertices=mesh.vertices[1:])


def test_what_cannot_be_saved_says_why(tmp_path):
    with pytest.raises(MeshError, match=r"one of \.obj, \.stl, \.ply, \.glb, got \.dae"):
        save_mesh(ball(), tmp_path / "a.dae")
    (tmp_path / "file").write_text("")
    with pytest.raises(SoftffdError, match=r"wanted a folder to write to, but .*file is a file"):
        save_mesh(ball(), tmp_path / "file" / "a.ply")
    with pytest.raises(MeshError, match="not written: 42 of 42 vertices are not finite"):
        save_mesh(ball(), tmp_path / "a.ply", vertices=ball().vertices * np.nan)
    with pytest.raises(MeshError, match="not written: the mesh has no faces"):
        save_mesh(Mesh(CORNERS, np.zeros((0, 3))), tmp_path / "a.obj")
    for kind in ("stl", "ply", "glb"):
        with pytest.raises(MeshError, match=r"its coordinates go to .*e\+40 m, too far for single precision"):
            save_mesh(ball(), tmp_path / f"a.{kind}", vertices=ball().vertices * 1e40)
    assert list(tmp_path.iterdir()) == [tmp_path / "file"]


@pytest.mark.parametrize(
    "arrays, words",
    [
        *[((CORNERS, [[0, 1, corner]]), "faces: wanted indices of 4 vertices, got ") for corner in (4, -1)],
        ((np.zeros((4, 2)), [[0, 1, 2]]), r"vertices: wanted the shape \(any, 3\), got \(4, 2\)"),
        ((np.zeros((4, 3)), [[0, 1, 2]], np.zeros((3, 2))), r"uv: wanted the shape \(4, 2\), got \(3, 2\)"),
    ],
)
def test_arrays_that_do_not_go_together_are_no_mesh(arrays, words):
    with pytest.raises(ValueError, match=words):
        Mesh(*arrays)


def test_a_mesh_of_nothing_has_no_open_edges():
    assert Mesh(np.zeros((0, 3)), np.zeros((0, 3))).open_edges == 0


def test_texture_coordinates_that_are_no_places_become_the_corner_with_a_note(tmp_path):
    mesh = loaded(
        tmp_path, "a.obj", TETRAHEDRON + "vt 0.5 1\nvt nan 0\nvt 1e300 0\n" + "f 1/1 3/1 2/2\nf 1/1 2/2 4/3\nf 2/2 3/1 4/3\nf 3/1 1/1 4/3\n"
    )
    np.testing.assert_array_equal(mesh.uv, [[0.5, 1.0], [0.0, 0.0], [0.5, 1.0], [0.0, 0.0]])
    assert mesh.looks.notes == ("texture coordinates that are not finite, with (0, 0) in their place: 2",)


def test_obj_is_written_with_the_decimals_asked_for(tmp_path):
    save_mesh(ball(), tmp_path / "a.obj", decimals=2)
    assert (tmp_path / "a.obj").read_text().startswith("v -0.53 0.85 0.00\n")


@pytest.mark.parametrize("side", [1e-300, 1e-7, 1.0, 1e5])
def test_an_obj_of_any_size_holds_its_vertices_to_a_ten_millionth_of_its_side(side, tmp_path):
    uv = np.random.default_rng(7).random((len(ball().vertices), 2))
    mesh = replace(ball(), vertices=side * ball().vertices / np.ptp(ball().vertices), uv=uv)
    save_mesh(mesh, tmp_path / "a.obj")
    again = load_mesh(tmp_path / "a.obj")
    assert np.abs(again.vertices - mesh.vertices).max() < 1e-7 * side
    np.testing.assert_allclose(again.uv, uv, atol=1e-9)


def test_obj_reads_what_exporters_write(tmp_path):
    """Tabs, indentation, comments, continued lines, weights, relative indices, normals, vendors' records, CRLF."""
    text = (
        "mtllib none.mtl\no part\n  v\t0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5 # red\nv 0 1 \\\n 0\nv 0 0 1e0\nvn 0 0 1\n"
        "vp 0.1\nusemtl none\ns off\nf -4//1 -2//1 -3//1\nf 1//1 2//1 4//1\nf 2 3 4\nf 3 1 4\nv 7 7 7\n"
    ).replace("\n", "\r\n")
    mesh = loaded(tmp_path, "a.obj", text)
    np.testing.assert_array_equal(mesh.vertices, CORNERS)
    np.testing.assert_array_equal(mesh.faces, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    assert mesh.closed and mesh.uv is None


ALIKE = {
    "v": ["v 0 0 0", "v 1e1 -2 .5 1", "v 0 1 0 1 0 0", "v 0 0 1 1 0 0 1", "v 0 nan 1", "v 0 0 1 # 2", "v 1_0 2 3", "v 1 2", "v 1 2 v"],
    "vt": ["vt 0 0", "vt 1 0.5 0", "vt 0.5", "vt 0 0 [w]", "vt", "vt x 0"],
    "vn": ["vn 0 0 1", "vn x", "vn#"],
    "f": [
        *("f 1 2 3", "f 3 2 1 2", "f 1/1 2/2 3/1", "f 1//9 2//9 3//9", "f 1/1/7 2/2/7 3/1/7 2/2/7", "f -1 -2 -3", "f 1/1 2 3//1"),
        *("f 1//2//3 2//1//3 3", "f 1/2/1/2 2/1 3/1", "f 1 2", "f 1 2 0", "f 1 2 f 3", "f 1f2 2 3", "f 1/ 2/ 3/1/1", "f 1 2 99"),
        f"f 1 2 {10**30}",
    ],
}
"""Lines of each key, sound ones and others; runs of them are read at once where they are alike."""


@pytest.mark.parametrize("key", ALIKE)
def test_lines_that_are_read_at_once_are_what_they_are_one_by_one(key, tmp_path):
    """A record that says nothing between two lines parts them, and messages then name the line after it."""
    before = "v 0 0 0\nv 1 0 0\nv 0 1 1\n" + "vt 0 0\nvt 1 1\n"
    after = "f 1/1 2/2 3/1\n" if key == "vt" else "f 1 2 3\n"
    for first, second in product(ALIKE[key][:5], ALIKE[key]):
        found = [_read_or_refused(tmp_path, before + first + part + second + "\n" + after) for part in ("\n", "\ns off\n")]
        assert found[0] == found[1].replace("line 8", "line 7") if "line 6" not in found[1] else found[0] == found[1], (first, second)


def _read_or_refused(tmp_path, text):
    try:
        mesh = loaded(tmp_path, "a.obj", text)
    except MeshError as refusal:
        return str(refusal)
    parts = (mesh.vertices, mesh.faces, mesh.uv, mesh.looks.colours, mesh.looks.notes)
    return repr([part.tolist() if isinstance(part, np.ndarray) else part for part in parts])


def test_relative_indices_count_from_the_record_they_stand_in(tmp_path):
    block = "v {0} 0 0\nv {0} 1 0\nv {0} 0 1\nf -3 -2 -1\n"
    mesh = loaded(tmp_path, "a.obj", block.format(0) + block.format(9))
    assert mesh.vertices[mesh.faces][:, :, 0].tolist() == [[0, 0, 0], [9, 9, 9]]


def test_normals_do_not_split_vertices_but_texture_seams_do(tmp_path):
    records = "vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 1 0 0\n"
    faces = "f 1/1/1 3/3/2 2/2/1\nf 1/2/2 2/2/1 4/3/1\nf 2/2/2 3/3/1 4/3/1\nf 3/3/1 1/1/1 4/3/2\n"
    mesh = loaded(tmp_path, "a.obj", TETRAHEDRON + records + faces)
    assert len(mesh.vertices) == 5 and mesh.closed
    assert {tuple(uv) for uv in mesh.uv[(mesh.vertices == 0).all(axis=1)]} == {(0.0, 0.0), (1.0, 0.0)}


def test_corners_without_texture_coordinate_get_the_origin(tmp_path):
    mesh = loaded(tmp_path, "a.obj", TETRAHEDRON + "vt 0.5 0.25\nf 1/1 3/1 2/1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    assert {tuple(uv) for uv in mesh.uv} == {(0.0, 0.0), (0.5, 0.25)}


@pytest.mark.parametrize("order", ["little", "big"])
def test_binary_ply_may_mix_triangles_and_polygons(order, tmp_path):
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 2, 3]]
    mesh = loaded(tmp_path, "a.ply", binary_ply(faces, order))
    np.testing.assert_array_equal(mesh.vertices, CORNERS)
    np.testing.assert_array_equal(mesh.faces, [*faces[:4], [0, 1, 2], [0, 2, 3]])


def test_text_ply_has_other_elements_and_the_faces_own_texture_coordinates(tmp_path):
    head = ply().replace("end_header\n", "property list uchar float texcoord\nelement edge 1\nproperty int a\nend_header\n")
    lines = PLY_TEXT.splitlines()
    body = lines[:4] + [f"{line} 6 0 0 1 0 0 1" for line in lines[4:]] + ["7"]
    mesh = loaded(tmp_path, "a.ply", head.replace("ascii 1.0", "ascii 1.0\ncomment made by hand") + "\n".join(body))
    np.testing.assert_array_equal(mesh.uv[mesh.faces], [[[0, 0], [1, 0], [0, 1]]] * 4)
    assert mesh.closed


def test_text_and_binary_stl_share_the_corners_of_their_triangles(tmp_path):
    text = loaded(tmp_path, "text.stl", text_stl())
    binary = loaded(tmp_path, "binary.stl", saved(tmp_path, "stl", text))
    for mesh in (text, binary):
        assert mesh.vertices.shape == (4, 3) and mesh.closed
    named = loaded(tmp_path, "named.stl", text_stl().replace("solid \n", "solid vertex of facet\n", 1))
    np.testing.assert_array_equal(named.vertices, text.vertices)


def test_bodies_of_a_glb_scene_are_put_in_their_places(tmp_path):
    scene = trimesh.Scene()
    cube = trimesh.creation.box()
    for name, shift, mirror in [("a", 0.0, 1.0), ("b", 5.0, -1.0)]:
        matrix = np.diag([mirror, 1.0, 1.0, 1.0])
        matrix[0, 3] = shift
        scene.add_geometry(cube, geom_name=name, node_name=name, transform=matrix)
    mesh = loaded(tmp_path, "two.glb", scene.export(file_type="glb"))
    assert len(mesh.faces) == 24 and mesh.closed
    np.testing.assert_allclose(mesh.bounds, [[-0.5, -0.5, -0.5], [5.5, 0.5, 0.5]], atol=1e-6)
    assert np.linalg.det(mesh.vertices[mesh.faces]).sum() / 6 == pytest.approx(2.0, rel=1e-6)


def test_bodies_of_an_obj_become_one_mesh(tmp_path):
    second = TETRAHEDRON.replace("v ", "v 3") + "".join(
        f"f {' '.join(str(int(i) + 4) for i in line[2:].split())}\n" for line in FACES.splitlines()
    )
    mesh = loaded(tmp_path, "a.obj", "o one\nusemtl a\n" + TETRAHEDRON + FACES + "o two\nusemtl b\n" + second)
    assert mesh.vertices.shape == (8, 3) and mesh.closed


def test_unused_vertices_are_left_out_and_the_others_keep_their_order(tmp_path):
    mesh = loaded(tmp_path, "a.obj", "v 99 99 99\n" + TETRAHEDRON + "v nan 0 0\n" + "f 2 4 3\nf 2 3 5\nf 3 4 5\nf 4 2 5\n")
    np.testing.assert_array_equal(mesh.vertices, CORNERS)


@pytest.mark.parametrize(("up", "axis"), [("x", 0), ("y", 1), ("z", 2)])
def test_up_turns_the_named_axis_to_z_without_mirroring(up, axis, tmp_path):
    mesh = loaded(tmp_path, "a.obj", TETRAHEDRON + FACES, up=up)
    np.testing.assert_array_equal(mesh.vertices[axis + 1], [0, 0, 1])
    assert np.linalg.det(mesh.vertices[mesh.faces]).sum() > 0
    save_mesh(mesh, tmp_path / "again.obj", up=up)
    np.testing.assert_array_equal(load_mesh(tmp_path / "again.obj").vertices, CORNERS)


def test_scale_turns_the_file_s_units_into_metres(tmp_path):
    mesh = loaded(tmp_path, "a.obj", TETRAHEDRON + FACES, scale=0.001)
    np.testing.assert_allclose(mesh.bounds, [[0, 0, 0], [1e-3, 1e-3, 1e-3]], rtol=1e-15)


def test_closed_needs_every_edge_in_both_directions():
    mesh = ball()
    assert mesh.closed
    assert not Mesh(mesh.vertices, mesh.faces[1:]).closed
    turned = np.vstack([mesh.faces[:1, ::-1], mesh.faces[1:]])
    assert Mesh(mesh.vertices, turned).open_edges == 3


def test_merging_keeps_positions_and_the_first_order():
    points = np.array([[1.0, 0, 0], [0, 0, 0], [1, 0, 1e-10], [-0.0, 0, 0], [0, 5, 0]])
    index, positions = merge_by_position(points)
    assert index.tolist() == [0, 1, 0, 1, 2]
    np.testing.assert_allclose(positions[index], points, atol=1e-9)


def test_trimesh_keeps_quiet_and_its_log_is_left_as_it_was(tmp_path, capsys, caplog):
    level = logging.getLogger("trimesh").level
    loud = glb_with(lambda h: h.update(images=[{"uri": "none.png"}]))
    damaged = glb_with(lambda h: h["accessors"][0].update(count=10**6))
    with caplog.at_level(logging.DEBUG):
        with pytest.raises(MeshError):
            loaded(tmp_path, "a.glb", damaged)
        loaded(tmp_path, "b.glb", loud)
    assert capsys.readouterr() == ("", "") and not caplog.records
    assert logging.getLogger("trimesh").level == level


class TestRealMeshes:
    def test_the_beetle_is_open_and_has_no_texture(self, real_meshes):
        beetle = load_mesh(real_meshes / "beetle.obj", up="y")
        assert (len(beetle.vertices), len(beetle.faces)) == (1148, 2053)
        assert not beetle.closed and beetle.uv is None

    def test_spot_is_closed_across_the_seams_of_its_texture(self, real_meshes):
        spot = load_mesh(real_meshes / "spot.obj", up="y")
        assert len(merge_by_position(spot.vertices)[1]) == 2930 < len(spot.vertices)
        assert spot.closed and spot.uv.shape == (len(spot.vertices), 2)

    @pytest.mark.parametrize("kind", ["obj", "ply", "glb"])
    def test_spot_s_texture_coordinates_survive(self, kind, real_meshes, tmp_path):
        spot = load_mesh(real_meshes / "spot.obj", up="y")
        save_mesh(spot, tmp_path / f"spot.{kind}")
        again = load_mesh(tmp_path / f"spot.{kind}")
        np.testing.assert_array_equal(again.faces, spot.faces)
        np.testing.assert_allclose(again.uv, spot.uv, atol=1e-7)


def test_a_misspelt_axis_or_ending_is_told_the_nearest(tmp_path):
    save_mesh(ball(), tmp_path / "ball.obj")
    for use in (lambda: load_mesh(tmp_path / "ball.obj", up="Y"), lambda: save_mesh(ball(), tmp_path / "ball.obj", up="Y")):
        with pytest.raises(MeshError, match=r"wanted one of x, y, z, got 'Y', did you mean \"y\""):
            use()
    with pytest.raises(MeshError, match=r'got \.objj, did you mean "\.obj"'):
        save_mesh(ball(), tmp_path / "ball.objj")


SOLID = text_stl().strip()
READ_ALL_THE_SAME = {
    "stl after a blank": ("a.stl", " " + SOLID),
    "stl after a comment": ("a.stl", "# by hand\n\n" + SOLID),
    "stl after a mark": ("a.stl", SOLID.encode("utf-8-sig")),
    "stl in two bytes": ("a.stl", SOLID.encode("utf-16")),
    "stl that ends in two words": ("a.stl", SOLID.replace("endsolid", "end solid")),
    "obj after a mark": ("a.obj", (TETRAHEDRON + FACES).encode("utf-8-sig")),
    "ply after a mark": ("a.ply", (ply() + PLY_TEXT).encode("utf-8-sig")),
    "off after a mark": ("a.off", OFF.encode("utf-8-sig")),
    "off without a blank": ("a.off", OFF.replace("OFF\n", "OFF")),
    "off in small letters": ("a.off", OFF.lower()),
    "off without edges": ("a.off", OFF.replace("4 4 0\n", "4 4\n")),
}


@pytest.mark.parametrize("case", READ_ALL_THE_SAME)
def test_texts_may_begin_and_break_their_lines_as_programs_do(case, tmp_path):
    mesh = loaded(tmp_path, *READ_ALL_THE_SAME[case])
    assert mesh.closed and len(mesh.vertices) == 4 and len(mesh.faces) == 4 and mesh.looks.notes == ()


def test_a_text_without_its_last_line_is_read_and_told(tmp_path):
    mesh = loaded(tmp_path, "a.stl", SOLID[: SOLID.index("endsolid")])
    assert mesh.closed and len(mesh.faces) == 4
    assert mesh.looks.notes == ("no line 'endsolid' at its end, though all facets are whole",)


@pytest.mark.parametrize("rest", [b"\n", bytes(50)])
@pytest.mark.parametrize("kind", ["stl", "ply"])
def test_bytes_after_all_that_a_binary_file_promises_are_told(kind, rest, tmp_path):
    mesh = loaded(tmp_path, f"a.{kind}", saved(tmp_path, kind) + rest)
    assert mesh.closed and len(mesh.faces) == len(ball().faces)
    assert mesh.looks.notes[0].startswith(f"{len(rest)} bytes that follow after")


ROUND = trimesh.creation.icosphere(2)
ROUND = Mesh(ROUND.vertices, ROUND.faces)


@pytest.mark.parametrize(
    "mesh, normals", [(ROUND, 1), (Mesh(CORNERS, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), 3)], ids=["round", "sharp"]
)
def test_normals_are_written_smooth_across_gentle_edges_and_sharp_across_creases(mesh, normals, tmp_path):
    """normals: of a vertex."""
    save_mesh(mesh, tmp_path / "a.obj")
    save_mesh(mesh, tmp_path / "a.glb")
    rows = [line.split() for line in (tmp_path / "a.obj").read_text().splitlines()]
    corners = {(v, n) for row in rows if row[0] == "f" for v, _, n in (word.split("/") for word in row[1:])}
    assert len(corners) == normals * len(mesh.vertices)
    of_obj = np.array([row[1:] for row in rows if row[0] == "vn"], dtype=float)
    of_glb = trimesh.load(tmp_path / "a.glb", force="mesh", process=False)
    assert of_glb.vertices.shape == (normals * len(mesh.vertices), 3)
    for directions in (of_obj, of_glb.vertex_normals):
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, atol=2e-4)
    outwards = of_glb.vertices - mesh.vertices.mean(axis=0)
    assert (np.einsum("va,va->v", outwards, of_glb.vertex_normals) > 0).all()
    assert load_mesh(tmp_path / "a.glb").vertices.shape == load_mesh(tmp_path / "a.obj").vertices.shape == mesh.vertices.shape
