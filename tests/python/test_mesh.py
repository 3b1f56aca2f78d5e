"""Facts about meshes and their files, the damaged ones above all."""

import json
import logging
import struct
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from softffd.errors import MeshError
from softffd.mesh import Mesh, load_mesh, merge_by_position, save_mesh

SHARED = Path(__file__).resolve().parents[2].parent / "shared" / "data"
ENDINGS = ["obj", "stl", "ply", "glb"]

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
FACES = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"

PLY_HEAD = """ply
format {format} 1.0
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""
PLY_TEXT = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")


def ball(uv=False, texture=None):
    sphere = trimesh.creation.icosphere(1)
    coordinates = np.random.default_rng(0).random((len(sphere.vertices), 2)) if uv else None
    return Mesh(sphere.vertices, sphere.faces, coordinates, "ball", texture)


def written(tmp_path, name, content):
    file = tmp_path / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return file


def loaded(tmp_path, name, content, **keys):
    return load_mesh(written(tmp_path, name, content), **keys)


def saved(tmp_path, kind, mesh=None):
    file = tmp_path / f"ball.{kind}"
    save_mesh(mesh or ball(), file)
    return file.read_bytes()


def ply(vertices=4, faces=4, format="ascii"):
    return PLY_HEAD.format(vertices=vertices, faces=faces, format=format)


def binary_ply(faces=((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)), order="little"):
    mark = {"little": "<", "big": ">"}[order]
    lists = b"".join(struct.pack(f"{mark}B{len(face)}i", len(face), *face) for face in faces)
    head = ply(faces=len(faces), format=f"binary_{order}_endian").encode()
    return head + CORNERS.astype(mark + "f4").tobytes() + lists


def text_stl():
    return trimesh.Trimesh(CORNERS, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).export(file_type="stl_ascii")


def glb_with(change):
    """A sound GLB whose JSON went through `change`."""
    data = trimesh.Trimesh(CORNERS, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).export(file_type="glb")
    size = struct.unpack("<I", data[12:16])[0]
    header = json.loads(data[20 : 20 + size])
    change(header)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON") + text + rest


def faults():
    """Damaged or unfit files: name, content, what the message must say."""
    flat = TETRAHEDRON.replace("0 0 1", "1 1 0") + FACES
    binary = struct.pack("<80sI", b"", 4) + bytes(4 * 50)
    return {
        "unknown ending": ("a.step", "x", "ends with one of .obj, .stl, .ply, .glb, got .step"),
        "no ending": ("mesh", "x", "ends with one of .obj, .stl, .ply, .glb, got no ending"),
        "empty": ("a.obj", "", r"empty \(0 bytes\)"),
        "only comments": ("a.obj", "# nothing\n", "no vertices"),
        "another kind of file": ("a.obj", b"\x89PNG\r\n\x1a\n\0\0", "line 1.* no record of an OBJ file"),
        "zeros in the file": ("a.obj", TETRAHEDRON.encode() + bytes(512), "line 5.* no record of an OBJ file"),
        "point cloud obj": ("a.obj", TETRAHEDRON, "4 vertices but no faces"),
        "lines only": ("a.obj", TETRAHEDRON + "l 1 2 3\n", "4 vertices but no faces"),
        "vertex beyond the last": (
            "a.obj",
            TETRAHEDRON + FACES + "f 1 2 9\n",
            "line 9: .* vertex 9, but the file has 4",
        ),
        "vertex zero": ("a.obj", TETRAHEDRON + "f 0 1 2\n", "line 5, 'f 0 1 2': .* record 0"),
        "vertex before the first": ("a.obj", TETRAHEDRON + "f -5 1 2\n", "line 5.* record -5"),
        "texture coordinate beyond": ("a.obj", TETRAHEDRON + "vt 0 0\nf 1/1 2/7 3/1\n", "texture coordinate 7"),
        "face cut off": ("a.obj", TETRAHEDRON + FACES + "f 1 2", "line 9, 'f 1 2': a face needs at least 3 corners"),
        "vertex cut off": ("a.obj", "v 0 0 0\nv 1 0", "line 2, 'v 1 0': wanted 3 numbers, got 2"),
        "no number": ("a.obj", "v 0 0 zero\n", "line 1, 'v 0 0 zero': wanted numbers"),
        "huge index": ("a.obj", TETRAHEDRON + f"f 1 2 {10**30}\n", "beyond all files"),
        "nan obj": (
            "a.obj",
            TETRAHEDRON.replace("0 1 0", "0 nan 0") + FACES,
            r"1 of 4 vertices are not finite.*\[0.0, nan",
        ),
        "inf obj": ("a.obj", TETRAHEDRON.replace("0 1 0", "0 1e999 0") + FACES, "1 of 4 vertices are not finite"),
        "flat": ("a.obj", flat, r"flat along z \(it spans 1 x 1 x 0 m\).*thickness"),
        "one place": ("a.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n", "flat along x and y and z"),
        "no area": ("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 3\n", "none of its 2 faces has an area"),
        "stl too short": ("a.stl", binary[:-1], "promises 4 triangles, which makes 284 bytes, but it has 283 bytes"),
        "stl too long": ("a.stl", binary + b"\0" * 50, "promises 4 triangles, .* has 334 bytes"),
        "stl no head": ("a.stl", binary[:50], "it has 50 bytes, and every binary STL file begins with 84"),
        "stl without triangles": ("a.stl", bytes(84), "no vertices"),
        "stl of one place": ("a.stl", binary, "flat along x and y and z"),
        "stl nan": (
            "a.stl",
            binary[:100] + struct.pack("<f", np.nan) + binary[104:],
            "1 of 12 vertices are not finite",
        ),
        "text stl cut off": ("a.stl", text_stl()[:-60], "not closed by the line 'endsolid'"),
        "text stl without a vertex": ("a.stl", text_stl().replace("vertex", "vortex", 1), "with 11 vertices"),
        "text stl no number": ("a.stl", text_stl().replace("1.0", "one"), "not three numbers"),
        "ply no header": ("a.ply", "hello", "begins with the line 'ply'"),
        "ply header cut off": ("a.ply", ply()[:80], "ends with 'end_header'"),
        "ply header line": (
            "a.ply",
            ply().replace("property float x", "property flaot x") + PLY_TEXT,
            "flaot x' means nothing",
        ),
        "ply without format": (
            "a.ply",
            ply().replace("format ascii 1.0\n", "") + PLY_TEXT,
            "names none of the formats ascii,",
        ),
        "ply without z": ("a.ply", ply().replace("float z", "float q") + PLY_TEXT, "no x, y and z"),
        "ply too few": ("a.ply", ply(faces=5) + PLY_TEXT, "file ends within the data"),
        "ply far too few": ("a.ply", ply(vertices=10**12) + PLY_TEXT, "promises 1000000000000 records 'vertex'"),
        "ply too many": ("a.ply", ply(faces=3) + PLY_TEXT, "4 numbers follow after all that the header describes"),
        "ply fewer vertices": ("a.ply", ply(vertices=3) + PLY_TEXT, "damaged or cut off"),
        "ply vertex beyond": (
            "a.ply",
            ply() + PLY_TEXT.replace("3 2 0 3", "3 2 0 4"),
            r"face 3 \(from 0\) refers to vertex 4",
        ),
        "ply negative vertex": ("a.ply", ply() + PLY_TEXT.replace("3 2 0 3", "3 2 0 -1"), "refers to vertex -1"),
        "ply two corners": ("a.ply", ply(faces=1) + PLY_TEXT[:24] + "2 0 1\n", r"face 0 \(from 0\) has fewer than 3"),
        "ply infinite list": ("a.ply", ply(faces=1) + PLY_TEXT[:24] + "inf 0 1\n", "has the length inf"),
        "ply words": ("a.ply", ply() + PLY_TEXT.replace("0 0 1", "0 0 one", 1), "something that is not a number"),
        "ply point cloud": ("a.ply", ply(faces=0) + PLY_TEXT[:24], "4 vertices but no faces"),
        "ply nothing": ("a.ply", ply(0, 0), "no vertices"),
        "ply binary cut off": (
            "a.ply",
            ply(format="binary_little_endian").encode() + CORNERS.tobytes(),
            "promises 4 records 'face'",
        ),
        "ply binary too long": ("a.ply", binary_ply() + b"\0\0", "2 bytes follow after all that the header describes"),
        "glb magic": (
            "a.glb",
            b"glTX" + glb_with(lambda h: None)[4:],
            "not a GLB file: wanted one that begins with b'glTF'",
        ),
        "glb version": (
            "a.glb",
            b"glTF\1\0\0\0" + glb_with(lambda h: None)[8:],
            "wanted glTF version 2, got version 1",
        ),
        "glb cut off": ("a.glb", glb_with(lambda h: None)[:-7], "promises .* bytes, but it has"),
        "glb only magic": ("a.glb", b"glTF\2\0\0\0\x0c\0\0\0", "not a whole block of JSON"),
        "glb no json": ("a.glb", struct.pack("<4sIII4s", b"glTF", 2, 24, 4, b"JSON") + b"{{{{", "JSON cannot be read"),
        "glb other json": ("a.glb", glb_with(lambda h: h.update(meshes=[{}])), "not that of a glTF scene"),
        "glb accessor": (
            "a.glb",
            glb_with(lambda h: h["accessors"][0].update(count=10**6)),
            "do not fit their description",
        ),
        "glb draco": (
            "a.glb",
            glb_with(lambda h: h.update(extensionsUsed=["KHR_draco_mesh_compression"])),
            "uses KHR_draco",
        ),
        "glb sparse": ("a.glb", glb_with(lambda h: h["accessors"][0].update(sparse={})), "uses sparse accessors"),
        "glb without meshes": ("a.glb", glb_with(lambda h: [h.pop("meshes"), h.update(nodes=[{}])]), "no vertices"),
    }


@pytest.mark.parametrize("case", faults())
def test_every_fault_of_a_file_is_one_clear_paragraph(case, tmp_path):
    name, content, expected = faults()[case]
    with warnings.catch_warnings(), pytest.raises(MeshError, match=expected) as refusal:
        warnings.simplefilter("error")
        loaded(tmp_path, name, content)
    text = str(refusal.value)
    assert text.startswith(str(tmp_path / name)) and "\n" not in text
    assert "anted" in text


def test_a_missing_file_and_a_directory_are_refused(tmp_path):
    with pytest.raises(MeshError, match="no such file"):
        load_mesh(tmp_path / "none.obj")
    (tmp_path / "folder.obj").mkdir()
    for folder in (tmp_path, tmp_path / "folder.obj"):
        with pytest.raises(MeshError, match="is a directory"):
            load_mesh(folder)
        with pytest.raises(MeshError, match="is a directory"):
            save_mesh(ball(), folder)


@pytest.mark.parametrize("kind", [*ENDINGS, "text.stl", "text.ply"])
def test_a_file_cut_anywhere_is_refused_or_has_fewer_faces_only_in_obj(kind, tmp_path):
    """OBJ counts nothing, so a cut between two faces cannot be seen; all other cuts are."""
    whole = text_stl().encode() if kind == "text.stl" else (ply() + PLY_TEXT).encode()
    whole = whole if kind.startswith("text") else saved(tmp_path, kind)
    ends = range(1, len(whole.rstrip()), max(1, len(whole) // 120))
    for end in ends:
        file = written(tmp_path, "cut." + kind.removeprefix("text."), whole[:end])
        if kind == "obj":
            _load_or_refuse(file)
        elif end < len(whole.rstrip()) - 1:
            with pytest.raises(MeshError):
                load_mesh(file)


@pytest.mark.parametrize("kind", [*ENDINGS, "text.stl", "text.ply"])
def test_whatever_bytes_change_nothing_but_a_mesh_error_comes_out(kind, tmp_path):
    whole = text_stl().encode() if kind == "text.stl" else (ply() + PLY_TEXT).encode()
    whole = bytearray(whole if kind.startswith("text") else saved(tmp_path, kind))
    random = np.random.default_rng(7)
    for _ in range(150):
        damaged = whole.copy()
        for place in random.integers(len(whole), size=random.integers(1, 5)):
            damaged[place] = random.choice([0, 255, 45, 57, random.integers(256)])
        _load_or_refuse(written(tmp_path, "changed." + kind.removeprefix("text."), bytes(damaged)))


def _load_or_refuse(file):
    try:
        mesh = load_mesh(file)
    except MeshError:
        return
    assert np.isfinite(mesh.vertices).all() and mesh.faces.max() < len(mesh.vertices)


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
    with pytest.raises(MeshError, match="cannot be written: No such file or directory"):
        save_mesh(ball(), tmp_path / "none" / "a.ply")
    with pytest.raises(MeshError, match="not written: 42 of 42 vertices are not finite"):
        save_mesh(ball(), tmp_path / "a.ply", vertices=ball().vertices * np.nan)


def test_obj_is_written_with_the_decimals_asked_for(tmp_path):
    save_mesh(ball(), tmp_path / "a.obj", decimals=2)
    assert (tmp_path / "a.obj").read_text().startswith("v -0.53 0.85 0.00\n")


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


@pytest.mark.parametrize("keys", [{"up": "w"}, {"up": "-z"}, {"scale": 0.0}, {"scale": -1.0}, {"scale": float("nan")}])
def test_wrong_scale_and_up_are_refused(keys, tmp_path):
    with pytest.raises(MeshError, match=f"mesh.{next(iter(keys))}: wanted"):
        loaded(tmp_path, "a.obj", TETRAHEDRON + FACES, **keys)


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


def test_a_mesh_refuses_arrays_of_other_shapes():
    with pytest.raises(ValueError, match=r"vertices: wanted the shape \(any, 3\), got \(4, 2\)"):
        Mesh(np.zeros((4, 2)), [[0, 1, 2]])
    with pytest.raises(ValueError, match=r"uv: wanted the shape \(4, 2\), got \(3, 2\)"):
        Mesh(np.zeros((4, 3)), [[0, 1, 2]], np.zeros((3, 2)))


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


@pytest.mark.skipif(not SHARED.is_dir(), reason=f"the folder of real meshes, {SHARED}, is absent")
class TestRealMeshes:
    def test_the_beetle_is_open_and_has_no_texture(self):
        beetle = load_mesh(SHARED / "beetle.obj", up="y")
        assert (len(beetle.vertices), len(beetle.faces)) == (1148, 2053)
        assert not beetle.closed and beetle.uv is None

    def test_spot_is_closed_across_the_seams_of_its_texture(self):
        spot = load_mesh(SHARED / "spot.obj", up="y")
        assert len(merge_by_position(spot.vertices)[1]) == 2930 < len(spot.vertices)
        assert spot.closed and spot.uv.shape == (len(spot.vertices), 2)

    @pytest.mark.parametrize("kind", ["obj", "ply", "glb"])
    def test_spot_s_texture_coordinates_survive(self, kind, tmp_path):
        spot = load_mesh(SHARED / "spot.obj", up="y")
        save_mesh(spot, tmp_path / f"spot.{kind}")
        again = load_mesh(tmp_path / f"spot.{kind}")
        np.testing.assert_array_equal(again.faces, spot.faces)
        np.testing.assert_allclose(again.uv, spot.uv, atol=1e-7)
