"""Files that are damaged, cut or no meshes: a clear refusal, whatever they hold."""

import struct
import warnings

import numpy as np
import pytest

from mesh_files import CORNERS, ENDINGS, FACES, OFF, PLY_TEXT, TETRAHEDRON, ball, glb_with, loaded, ply, saved, text_stl, written
from softffd.errors import MeshError
from softffd.mesh.files import load_mesh, save_mesh

TEXTS = {"text.stl": text_stl, "text.ply": lambda: ply() + PLY_TEXT, "text.off": lambda: OFF}


def faults():
    """Damaged or unfit files: name, content, what the message must say."""
    flat = TETRAHEDRON.replace("0 0 1", "1 1 0") + FACES
    binary = struct.pack("<80sI", b"", 4) + bytes(4 * 50)
    return {
        "unknown ending": ("a.step", "x", "ends with one of .obj, .stl, .ply, .glb, .gltf, .off, .3mf, .dae, got .step"),
        "no ending": ("mesh", "x", "ends with one of .obj, .stl, .ply, .glb, .gltf, .off, .3mf, .dae, got no ending"),
        "empty": ("a.obj", "", r"empty \(0 bytes\)"),
        "only comments": ("a.obj", "# nothing\n", "no vertices"),
        "another kind of file": ("a.obj", b"\x89PNG\r\n\x1a\n\0\0", "line 1.* no record of an OBJ file"),
        "zeros in the file": ("a.obj", TETRAHEDRON.encode() + bytes(512), "line 5.* no record of an OBJ file"),
        "point cloud obj": ("a.obj", TETRAHEDRON, "4 vertices but no faces"),
        "lines only": ("a.obj", TETRAHEDRON + "l 1 2 3\n", "4 vertices but no faces"),
        "vertex beyond the last": ("a.obj", TETRAHEDRON + FACES + "f 1 2 9\n", r"line 9: .* vertex 9 \(from 1\), but there are 4"),
        "vertex zero": ("a.obj", TETRAHEDRON + "f 0 1 2\n", "line 5, 'f 0 1 2': .* record 0"),
        "vertex before the first": ("a.obj", TETRAHEDRON + "f -5 1 2\n", "line 5.* record -5"),
        "texture coordinate beyond": ("a.obj", TETRAHEDRON + "vt 0 0\nf 1/1 2/7 3/1\n", "texture coordinate 7"),
        "face cut off": ("a.obj", TETRAHEDRON + FACES + "f 1 2", "line 9, 'f 1 2': a face needs at least 3 corners"),
        "vertex cut off": ("a.obj", "v 0 0 0\nv 1 0", "line 2, 'v 1 0': wanted 3 numbers, got 2"),
        "no number": ("a.obj", "v 0 0 zero\n", "line 1, 'v 0 0 zero': wanted numbers"),
        "huge index": ("a.obj", TETRAHEDRON + f"f 1 2 {10**30}\n", "line 5, .*beyond all files"),
        "huge texture index": ("a.obj", TETRAHEDRON + f"vt 0 1\nf 1/1 2/1 3/{10**30}\n", "line 6, .*beyond all files"),
        "nan obj": ("a.obj", TETRAHEDRON.replace("0 1 0", "0 nan 0") + FACES, r"1 of 4 vertices are not finite.*\[0.0, nan"),
        "inf obj": ("a.obj", TETRAHEDRON.replace("0 1 0", "0 1e999 0") + FACES, "1 of 4 vertices are not finite"),
        "flat": ("a.obj", flat, r"flat along z \(it spans 1 x 1 x 0 m\).*thickness"),
        "one place": ("a.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n", "flat along x and y and z"),
        "no area": ("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 3\n", "none of its 2 faces has an area"),
        "stl too short": ("a.stl", binary[:-1], "promises 4 triangles, which makes 284 bytes, but it has 283 bytes"),
        "stl cut off after a word": ("a.stl", b"solid" + bytes(75) + (1000).to_bytes(4, "little") + bytes(60), "promises 1000 triangles"),
        "stl no head": ("a.stl", binary[:50], "it has 50 bytes, and every binary STL file begins with 84"),
        "stl without triangles": ("a.stl", bytes(84), "no vertices"),
        "stl of one place": ("a.stl", binary, "flat along x and y and z"),
        "stl nan": ("a.stl", binary[:100] + struct.pack("<f", np.nan) + binary[104:], "1 of 12 vertices are not finite"),
        "text stl cut off": ("a.stl", text_stl()[:-60], "each facet has 3"),
        "text stl without a vertex": ("a.stl", text_stl().replace("vertex", "vortex", 1), "with 11 vertices"),
        "text stl no number": ("a.stl", text_stl().replace("1.0", "one"), "not three numbers"),
        "ply no header": ("a.ply", "hello", "begins with the line 'ply'"),
        "ply header cut off": ("a.ply", ply()[:80], "ends with 'end_header'"),
        "ply header line": ("a.ply", ply().replace("property float x", "property flaot x") + PLY_TEXT, "flaot x' means nothing"),
        "ply without format": ("a.ply", ply().replace("format ascii 1.0\n", "") + PLY_TEXT, "names none of the formats ascii,"),
        "ply without z": ("a.ply", ply().replace("float z", "float q") + PLY_TEXT, "no x, y and z"),
        "ply too few": ("a.ply", ply(faces=5) + PLY_TEXT, "file ends within the data"),
        "ply far too few": ("a.ply", ply(vertices=10**12) + PLY_TEXT, "promises 1000000000000 records 'vertex'"),
        "ply too many": ("a.ply", ply(faces=3) + PLY_TEXT, "4 numbers follow after all that the header describes"),
        "ply fewer vertices": ("a.ply", ply(vertices=3) + PLY_TEXT, "damaged or cut off"),
        "ply vertex beyond": ("a.ply", ply() + PLY_TEXT.replace("3 2 0 3", "3 2 0 4"), r"face 3 \(from 0\) refers to vertex 4"),
        "ply negative vertex": ("a.ply", ply() + PLY_TEXT.replace("3 2 0 3", "3 2 0 -1"), "refers to vertex -1"),
        "ply two corners": ("a.ply", ply(faces=1) + PLY_TEXT[:24] + "2 0 1\n", r"face 0 \(from 0\) has fewer than 3"),
        "ply infinite list": ("a.ply", ply(faces=1) + PLY_TEXT[:24] + "inf 0 1\n", "has the length inf"),
        "ply words": ("a.ply", ply() + PLY_TEXT.replace("0 0 1", "0 0 one", 1), "something that is not a number"),
        "ply point cloud": ("a.ply", ply(faces=0) + PLY_TEXT[:24], "4 vertices but no faces"),
        "ply nothing": ("a.ply", ply(0, 0), "no vertices"),
        "ply binary cut off": ("a.ply", ply(format="binary_little_endian").encode() + CORNERS.tobytes(), "promises 4 records 'face'"),
        "ply strip beyond": ("a.ply", ply(faces=0).replace("face 0", "tristrips 1") + PLY_TEXT[:24] + "4 0 1 2 7\n", "refers to vertex 7"),
        "off no head": ("a.off", "4 4 0\n", "first word is OFF"),
        "off binary": ("a.off", b"OFF BINARY\n\0\0\0\4", "wanted a text"),
        "off no counts": ("a.off", "OFF\n", "numbers of vertices and of faces: wanted 2"),
        "off half a vertex": ("a.off", "OFF\n1.5 1 0\n", "a count is no whole number"),
        "off cut off": ("a.off", OFF[:-8], "promises 4 vertices and 4 faces, but ends after 7 lines"),
        "off cut in a line": ("a.off", OFF[:-4], "corners of each face: wanted 3 numbers"),
        "off vertex cut": ("a.off", OFF.replace("0 1 0", "0 1"), "coordinates of each vertex: wanted 3 numbers"),
        "off vertex beyond": ("a.off", OFF.replace("2 0 3", "2 0 4"), r"face 3 \(from 0\) refers to vertex 4 \(from 0\), but there are 4"),
        "off two corners": ("a.off", OFF.replace("3 2 0 3", "2 2 0"), r"face 3 \(from 0\) has fewer than 3"),
        "off point cloud": ("a.off", "OFF\n1 0 0\n0 0 0\n", "1 vertices but no faces"),
        "a pointer of Git LFS": ("a.obj", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", "pointer of Git LFS"),
        "gltf no json": ("a.gltf", "{", "JSON cannot be read"),
        "gltf version": ("a.gltf", '{"asset": {"version": "1.0"}}', "wanted glTF version 2, got version 1.0"),
        "gltf no version": ("a.gltf", "{}", "wanted glTF version 2, got no version"),
        "gltf no data": ("a.gltf", '{"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin"}]}', "names 'a.bin', which is not beside it"),
        "glb magic": ("a.glb", b"glTX" + glb_with(lambda h: None)[4:], "not a GLB file: wanted one that begins with b'glTF'"),
        "glb version": ("a.glb", b"glTF\1\0\0\0" + glb_with(lambda h: None)[8:], "wanted glTF version 2, got version 1"),
        "glb without a version": ("a.glb", b"glTF" + bytes(8), "wanted glTF version 2, got version 0"),
        "glb cut off": ("a.glb", glb_with(lambda h: None)[:-7], "promises .* bytes, but it has"),
        "glb only magic": ("a.glb", b"glTF\2\0\0\0\x0c\0\0\0", "not a whole block of JSON"),
        "glb no json": ("a.glb", struct.pack("<4sIII4s", b"glTF", 2, 24, 4, b"JSON") + b"{{{{", "JSON cannot be read"),
        "glb other json": ("a.glb", glb_with(lambda h: h.update(meshes=[{}])), "not that of a glTF scene"),
        "glb accessor": ("a.glb", glb_with(lambda h: h["accessors"][0].update(count=10**6)), "do not fit their description"),
        "glb draco": ("a.glb", glb_with(lambda h: h.update(extensionsUsed=["KHR_draco_mesh_compression"])), "uses KHR_draco"),
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
    assert text.startswith(str(tmp_path / name)) and "\n" not in text and len(text) < 500
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


@pytest.mark.parametrize(
    "keys", [*({"scale": scale} for scale in (0, -1.0, np.nan, "mm", [1.0], None)), {"up": "w"}, {"up": "-z"}], ids=str
)
def test_a_scale_that_is_no_number_above_0_and_an_up_that_is_no_axis_are_refused(keys, tmp_path):
    with pytest.raises(MeshError, match=r"a\.obj: mesh\.(scale: wanted (a number > 0|one number)|up: wanted one of x, y, z), got "):
        loaded(tmp_path, "a.obj", TETRAHEDRON + FACES, **keys)


@pytest.mark.parametrize("kind", [*ENDINGS, "text.stl", "text.ply", "text.off"])
def test_a_file_cut_anywhere_is_refused_or_has_fewer_faces_only_in_obj(kind, tmp_path):
    """OBJ counts nothing, so a cut between two faces cannot be seen; all other cuts are, in texts of STL that between facets by a note."""
    whole = TEXTS[kind]().encode() if kind in TEXTS else saved(tmp_path, kind)
    faces = len(loaded(tmp_path, "whole." + kind.removeprefix("text."), whole).faces)
    ends = range(1, len(whole.rstrip()), max(1, len(whole) // 120))
    for end in ends:
        file = written(tmp_path, "cut." + kind.removeprefix("text."), whole[:end])
        if kind == "obj":
            mesh = _load_or_refuse(file)
            assert mesh is None or len(mesh.faces) < faces or whole.rstrip().count(b"\n") == whole[:end].count(b"\n")
        elif end < len(whole.rstrip()) - 1:
            if kind == "text.stl" and (mesh := _load_or_refuse(file)):
                assert mesh.looks.notes and whole[:end].count(b"endfacet") == len(mesh.faces)
                continue
            with pytest.raises(MeshError):
                load_mesh(file)


@pytest.mark.parametrize("kind", [*ENDINGS, "text.stl", "text.ply", "text.off"])
def test_whatever_bytes_change_nothing_but_a_mesh_error_comes_out(kind, tmp_path):
    whole = bytearray(TEXTS[kind]().encode() if kind in TEXTS else saved(tmp_path, kind))
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
        return None
    assert np.isfinite(mesh.vertices).all() and mesh.faces.max() < len(mesh.vertices)
    return mesh


@pytest.mark.parametrize(("kind", "packages"), [("3mf", "lxml and networkx"), ("dae", "pycollada")])
def test_a_file_that_needs_more_packages_says_which(kind, packages, tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(MeshError, match=rf"wanted {packages}: pip install 'softffd\[meshes\]', or save the mesh as OBJ, PLY or GLB"):
        loaded(tmp_path, f"a.{kind}", "x")


@pytest.mark.parametrize(("kind", "module"), [("3mf", "networkx"), ("dae", "collada")])
def test_a_damaged_file_of_those_is_refused(kind, module, tmp_path):
    pytest.importorskip(module, reason=f"{module} is not installed")
    for content in (b"x", b"PK\3\4", b"<COLLADA>", b"<?xml version='1.0'?><COLLADA/>"):
        with pytest.raises(MeshError, match=r"damaged or cut off|no vertices"):
            loaded(tmp_path, f"a.{kind}", content)
