"""A mesh keeps its looks: what files say of materials, groups and colours is read, shown and written."""

import re
import zipfile

import numpy as np
import pytest
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from mesh_files import (
    FACES,
    GREEN,
    PARTS,
    PLY_TEXT,
    RED,
    TETRAHEDRON,
    TWO_COLOURS,
    glb_with,
    loaded,
    ply,
    saved,
    two_colours,
    unit_box,
    written,
)
from softffd.mesh.files import load_mesh, save_mesh
from softffd.mesh.looks import Group, Looks, Material, to_light, to_screen
from softffd.mesh.mesh import Mesh
from softffd.show.skin import PAINT, skinned

BYTES = 0.02
"""glTF holds the light of a colour in a byte, which is 0.02 of a dark shade on the screen."""


def shown(mesh):
    """The colours (F, 3) at the middles of the faces, as pictures show them."""
    _, faces, skin = skinned(mesh)
    return skin.painter(faces)(np.arange(len(faces)), np.full((3, len(faces)), 1 / 3)).T


def require_two_colours(mesh):
    upper = mesh.vertices[mesh.faces].mean(axis=1)[:, 2] > 1
    assert upper.sum() == 12 and len(upper) == 24
    np.testing.assert_allclose(shown(mesh), np.where(upper[:, None], GREEN, RED), atol=BYTES)


@pytest.mark.parametrize("name", TWO_COLOURS)
def test_two_colours_are_read_and_written(name, tmp_path):
    mesh = load_mesh(two_colours(tmp_path, name))
    require_two_colours(mesh)
    assert mesh.looks.notes == ()
    for kind in ("obj", "ply", "glb"):
        save_mesh(mesh, tmp_path / f"again.{kind}")
        if kind != "ply" or len(mesh.looks.textures) < 2:
            require_two_colours(load_mesh(tmp_path / f"again.{kind}"))


def test_collada_has_two_colours_and_no_names(tmp_path):
    pytest.importorskip("collada", reason="pycollada is not installed")
    dae = pytest.importorskip("trimesh.exchange.dae")
    bodies = load_mesh(two_colours(tmp_path, "factors.glb"))
    parts = [trimesh.Trimesh(unit_box(z).vertices, unit_box(z).faces, process=False) for z, _ in PARTS.values()]
    for part, (_, colour) in zip(parts, PARTS.values(), strict=True):
        part.visual = TextureVisuals(material=PBRMaterial(baseColorFactor=[*colour, 1.0]))
    mesh = loaded(tmp_path, "two.dae", dae.export_collada(parts))
    require_two_colours(mesh)
    assert mesh.closed and len(mesh.vertices) == len(bodies.vertices)
    assert mesh.looks.notes == ("the names of its materials are not read",)


def test_a_3mf_is_read_and_says_that_its_colours_are_not(tmp_path):
    pytest.importorskip("networkx", reason="networkx is not installed")
    data = trimesh.Scene([unit_box(0.0)]).export(file_type="3mf")
    mesh = loaded(tmp_path, "a.3mf", data)
    assert mesh.closed and len(mesh.vertices) == 8 and mesh.looks.notes == ()
    with zipfile.ZipFile(written(tmp_path, "b.3mf", data), "a") as archive:
        archive.writestr("3D/other.model", "<model><basematerials/></model>")
    assert load_mesh(tmp_path / "b.3mf").looks.notes == ("colours of a 3MF file are not read; OBJ, PLY and GLB keep theirs",)


@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_names_of_materials_and_groups_are_written(kind, tmp_path):
    mesh = load_mesh(two_colours(tmp_path, f"pictures.{kind}"))
    save_mesh(mesh, tmp_path / f"again.{kind}")
    again = load_mesh(tmp_path / f"again.{kind}")
    assert [material.name for material in again.looks.materials] == list(PARTS)
    assert [group.object for group in again.looks.groups] == list(PARTS)
    assert again.looks.groups == mesh.looks.groups
    np.testing.assert_array_equal(again.looks.group_of, mesh.looks.group_of)
    np.testing.assert_array_equal(again.faces, mesh.faces)
    np.testing.assert_allclose(again.vertices, mesh.vertices, atol=1e-6)


def test_a_glb_keeps_all_faces_of_groups_with_several_materials_and_of_groups_whose_names_read_alike(tmp_path):
    box, groups = unit_box(0.0), (Group("a", "b c"), Group("a b", "c"))
    looks = Looks((Material("red", RED), Material("green", GREEN)), np.arange(12) % 2, None, groups, np.arange(12) // 6)
    again = loaded(tmp_path, "again.glb", saved(tmp_path, "glb", Mesh(box.vertices, box.faces, looks=looks)))
    assert len(again.faces) == 12 and again.closed and again.looks.groups == (Group("a b c"),)
    assert np.bincount(again.looks.material_of).tolist() == [6, 6]


def test_materials_do_not_change_vertices_or_their_order(tmp_path):
    two_colours(tmp_path, "kd.obj")
    text = (tmp_path / "kd.obj").read_text()
    plain = loaded(tmp_path, "plain.obj", "".join(line for line in text.splitlines(True) if line[:2] in ("v ", "vt", "f ")))
    mesh = load_mesh(tmp_path / "kd.obj")
    np.testing.assert_array_equal(mesh.vertices, plain.vertices)
    np.testing.assert_array_equal(mesh.faces, plain.faces)
    assert plain.looks.materials == () and np.allclose(shown(plain), PAINT)


def test_a_written_obj_keeps_the_order_of_faces_whose_materials_alternate(tmp_path):
    box = unit_box(0.0)
    looks = Looks(
        (Material("a b", RED), Material("", None)), np.arange(12) % 2, None, (Group("x", "y"), Group("x", "")), np.arange(12) // 6
    )
    save_mesh(Mesh(box.vertices, box.faces, looks=looks), tmp_path / "a.obj")
    again = load_mesh(tmp_path / "a.obj")
    np.testing.assert_array_equal(again.faces, box.faces)
    assert [material.name for material in again.looks.materials] == ["a b", "none"]
    np.testing.assert_array_equal(again.looks.material_of, looks.material_of)
    assert again.looks.groups == looks.groups and (again.looks.group_of == looks.group_of).all()
    np.testing.assert_allclose(shown(again), np.where(np.arange(12)[:, None] % 2 == 0, RED, PAINT))


MTL = {
    "tabs and capitals": ("newmtl\tm\n\tKd\t0.8 0.2 0\n", RED, ()),
    "one number is grey": ("newmtl m\nKd 0.5\n", (0.5, 0.5, 0.5), ()),
    "Kd is black under a picture": ("newmtl m\nKd 0 0 0\nmap_Kd -clamp on red.png\n", RED, ()),
    "a picture elsewhere": ("newmtl m\nmap_Kd C:\\art\\red.png\n", RED, ()),
    "a picture with a blank": ("newmtl m\nmap_Kd -bm 1.0 bright red.png\n", RED, ()),
    "a picture's colour space": ("newmtl m\nmap_Kd -colorspace sRGB red.png # red\n", RED, ()),
    "a picture in quotes": ('newmtl m\nmap_Kd "bright red.png"\n', RED, ()),
    "a moved picture": ("newmtl m\nmap_Kd -s 2 2 1 red.png\n", RED, "m: its picture is taken without being moved or scaled"),
    "a missing picture": ("newmtl m\nKd 0.8 0.2 0\nmap_Kd none.png\n", RED, "m: its picture none.png is missing"),
    "a damaged picture": ("newmtl m\nKd 0.8 0.2 0\nmap_Kd bad.png\n", RED, "picture bad.png is missing or cannot be read"),
    "another picture": ("newmtl m\nKd 0.8 0.2 0\nmap_Bump b.png\n", RED, "other than map_Kd are not kept: map_bump"),
    "half transparent": ("newmtl m\nKd 0.8 0.2 0\nd 0.5\n", RED, "transparent materials are shown opaque: m"),
    "another name": ("newmtl n\nKd 0.8 0.2 0\n", PAINT, r"without a colour \(m\): no material library"),
    "no library": (None, PAINT, r"without a colour \(m\): a.mtl cannot be read"),
}


@pytest.mark.parametrize("case", MTL)
def test_a_material_is_what_its_library_says_and_what_is_lost_is_said(case, tmp_path):
    text, colour, note = MTL[case]
    for file in ("red.png", "bright red.png"):
        Image.new("RGB", (2, 2), (204, 51, 0)).save(tmp_path / file)
    (tmp_path / "bad.png").write_bytes(b"\x89PNG")
    if text is not None:
        written(tmp_path, "a.mtl", text)
    mesh = loaded(tmp_path, "a.obj", "mtllib a.mtl\nusemtl m\nvt 0.5 0.5\n" + TETRAHEDRON + _textured())
    np.testing.assert_allclose(shown(mesh), np.tile(colour, (4, 1)), atol=1e-6)
    assert len(mesh.looks.notes) == bool(note)
    assert not note or re.search(note, mesh.looks.notes[0])


def _textured():
    return "".join("f " + " ".join(f"{corner}/1" for corner in line.split()[1:]) + "\n" for line in FACES.splitlines())


def test_opacity_is_written(tmp_path):
    written(tmp_path, "a.mtl", "newmtl m\nKd 0.8 0.2 0\nTr 0.75\n")
    mesh = loaded(tmp_path, "a.obj", "mtllib a.mtl\nusemtl m\n" + TETRAHEDRON + FACES)
    for kind in ("obj", "glb"):
        save_mesh(mesh, tmp_path / f"again.{kind}")
        assert load_mesh(tmp_path / f"again.{kind}").looks.materials[0].opacity == pytest.approx(0.25, abs=1 / 255)


def test_libraries_may_stand_in_one_line_and_names_of_files_have_blanks(tmp_path):
    written(tmp_path, "a.mtl", "newmtl a\nKd 1 0 0\n")
    written(tmp_path, "b.mtl", "newmtl b\nKd 0 1 0\n")
    written(tmp_path, "a b.mtl", "newmtl a\nKd 0 0 1\n")
    body = TETRAHEDRON + "usemtl a\n" + FACES
    assert (shown(loaded(tmp_path, "one.obj", "mtllib b.mtl a.mtl\n" + body)) == [1, 0, 0]).all()
    assert (shown(loaded(tmp_path, "two.obj", "mtllib a b.mtl\n" + body)) == [0, 0, 1]).all()


STRIPS = ["6 0 1 2 3 0 1", "12 0 1 2 -1 1 3 2 -1 2 3 0 1", "9 0 1 2 3 3 3 0 0 1"]


@pytest.mark.parametrize("strip", STRIPS)
def test_triangle_strips_of_a_ply_are_triangles(strip, tmp_path):
    """Every second triangle is turned round; -1 begins anew; a corner given again makes no triangle."""
    head = ply(faces=0).replace("element face 0", "element tristrips 1").replace("uchar int", "int int")
    points = "0 0 0\n0 1 0\n1 0 0\n0 0 1\n"
    mesh = loaded(tmp_path, "a.ply", head + points + strip + "\n")
    if strip is not STRIPS[2]:
        assert mesh.closed and len(mesh.faces) == 4
        assert np.linalg.det(mesh.vertices[mesh.faces]).sum() / 6 == pytest.approx(1 / 6)
    else:
        assert mesh.faces.tolist() == [[0, 1, 2], [1, 3, 2]]


def test_a_ply_with_several_pictures_gives_each_face_its_own(tmp_path):
    for name, colour in (("one.png", (204, 51, 0)), ("two.png", (0, 153, 102))):
        Image.new("RGB", (2, 2), colour).save(tmp_path / name)
    head = ply().replace("ascii 1.0", "ascii 1.0\ncomment TextureFile one.png\ncomment TextureFile two.png")
    head = head.replace("end_header", "property list uchar float texcoord\nproperty int texnumber\nend_header")
    corners = ("0 2 1", "0 1 3", "1 2 3", "2 0 3")
    body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + "".join(f"3 {f} 6 0 0 1 0 0 1 {n % 2}\n" for n, f in enumerate(corners))
    mesh = loaded(tmp_path, "a.ply", head + body)
    np.testing.assert_allclose(shown(mesh), [RED, GREEN, RED, GREEN], atol=1e-6)
    assert mesh.texture is None and [material.name for material in mesh.looks.materials] == ["one", "two"]


def test_a_glb_says_which_pictures_are_not_beside_it(tmp_path):
    images = {"images": [{"uri": "a%20b.png"}, {"uri": "none.png"}, {"uri": "data:,"}]}
    Image.new("RGB", (2, 2)).save(tmp_path / "a b.png")
    mesh = loaded(tmp_path, "a.glb", glb_with(lambda header: header.update(images)))
    assert mesh.looks.notes == ("pictures that are not beside it: none.png",)


def test_a_texture_given_alone_is_a_material(tmp_path):
    picture = Image.new("RGB", (2, 2), (204, 51, 0))
    box = unit_box(0.0)
    mesh = Mesh(box.vertices, box.faces, box.vertices[:, :2] + 0.5, texture=picture)
    assert mesh.texture is picture and len(mesh.looks.materials) == 1
    np.testing.assert_allclose(shown(mesh), np.tile(RED, (12, 1)), atol=1e-6)
    for kind in ("obj", "ply", "glb"):
        save_mesh(mesh, tmp_path / f"a.{kind}")
        np.testing.assert_allclose(shown(load_mesh(tmp_path / f"a.{kind}")), np.tile(RED, (12, 1)), atol=1e-6)


def test_looks_of_other_sizes_are_refused():
    box = unit_box(0.0)
    with pytest.raises(ValueError, match=r"looks.material_of: wanted the shape \(12,\), got \(3,\)"):
        Mesh(box.vertices, box.faces, looks=Looks((Material(),), np.zeros(3, dtype=int)))
    with pytest.raises(ValueError, match=r"looks.colours: wanted the shape \(8, 3\), got \(3, 3\)"):
        Mesh(box.vertices, box.faces, looks=Looks(colours=np.zeros((3, 3))))


def test_screen_and_light_are_inverse():
    shades = np.linspace(0, 1, 256)
    np.testing.assert_allclose(to_screen(to_light(shades)), shades, atol=1e-12)
    assert to_light(0.5) == pytest.approx(0.2140, abs=1e-4)  # IEC 61966-2-1


NAMES = {
    "numbers": ("red#1", "red#1", "a.mtl", "mtllib a.mtl"),
    "numbers after a blank": ("Material #25", "Material #25", "a.mtl", "mtllib a.mtl"),
    "comments": ("m # first", "m # use", "a.mtl", "mtllib a.mtl # of a"),
    "two blanks": ("White  Color", "White  Color", "a.mtl", "mtllib a.mtl"),
    "a library's name": ("m", "m", "car#2.mtl", "mtllib car#2.mtl"),
    "quotes": ("m", "m", "a b.mtl", 'mtllib "a b.mtl"'),
    "a folder elsewhere": ("m", "m", "a.mtl", "mtllib C:\\art\\a.mtl"),
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
@pytest.mark.parametrize("case", NAMES)
def test_names_of_materials_and_libraries_are_found_as_they_are_written(case, encoding, tmp_path):
    made, used, file, library = NAMES[case]
    written(tmp_path, file, f"newmtl {made}\nKd 0.8 0.2 0\nnewmtl Körper\nKd 0 1 0\n".encode(encoding))
    mesh = loaded(tmp_path, "a.obj", (f"{library}\nusemtl {used}\n{TETRAHEDRON}{FACES}usemtl Körper\n{FACES}").encode(encoding))
    assert mesh.looks.notes == () and [m.colour for m in mesh.looks.materials] == [RED, (0, 1, 0)]


@pytest.mark.parametrize("record", ["mtllib ../out/a.mtl", "mtllib {}/out/a.mtl"])
def test_what_lies_outside_of_the_mesh_s_folder_is_not_opened_and_that_is_said(record, tmp_path):
    for folder in ("in", "out"):
        (tmp_path / folder).mkdir()
    Image.new("RGB", (2, 2)).save(tmp_path / "out" / "p.png")
    text = f"newmtl m\nmap_Kd {tmp_path}/out/p.png\n"
    written(tmp_path / "out", "a.mtl", text)
    for library, note in ((record.format(tmp_path), "outside of its folder"), ("mtllib b.mtl", "outside of the mesh's folder")):
        written(tmp_path / "in", "b.mtl", text)
        mesh = loaded(tmp_path / "in", "a.obj", f"{library}\nusemtl m\n{TETRAHEDRON}{FACES}")
        assert mesh.texture is None and note in mesh.looks.notes[0]


def test_colours_with_opacity_and_lines_of_other_programs_are_read(tmp_path):
    coloured = "".join(f"{line} 0.8 0.2 0 1\n" for line in TETRAHEDRON.splitlines())
    mesh = loaded(tmp_path, "a.obj", f"$ of elsewhere\n{coloured}{FACES}\x1a")
    np.testing.assert_allclose(mesh.looks.colours, np.tile(RED, (4, 1)))
    assert mesh.looks.notes == ("lines that are no records of OBJ: 1, the first is line 1",)


@pytest.mark.parametrize("names", ["red green blue", "r g b", "diffuse_red diffuse_green diffuse_blue"])
@pytest.mark.parametrize(("kind", "whole"), [("float", 1), ("float", 255), ("uchar", 255)])
def test_colours_of_a_ply_count_to_one_or_to_255(names, kind, whole, tmp_path):
    properties = "".join(f"property {kind} {name}\n" for name in names.split())
    head = ply().replace("element face", properties + "element face")
    points = PLY_TEXT.splitlines()
    shade = " ".join(f"{whole * channel:g}" for channel in RED)
    mesh = loaded(tmp_path, "a.ply", head + "\n".join([f"{point} {shade}" for point in points[:4]] + points[4:]) + "\n")
    np.testing.assert_allclose(mesh.looks.colours, np.tile(RED, (4, 1)), atol=1e-6)


@pytest.mark.parametrize(("head", "attribute"), [(b"COLOR=\xff\0\0\xff", 0), (b"", 0x8000 | 31)])
def test_colours_of_an_stl_are_said_to_be_lost(head, attribute, tmp_path):
    data = bytearray(saved(tmp_path, "stl"))
    data[:80], data[84 + 48 : 84 + 50] = head.ljust(80, b"\0"), attribute.to_bytes(2, "little")
    assert "colours of an STL file are not read" in loaded(tmp_path, "a.stl", bytes(data)).looks.notes[0]


@pytest.mark.parametrize("mark", ["\n", "\r", "\v", "\x85", "\u2028"])
def test_names_of_several_lines_write_no_records(mark, tmp_path):
    name, box = f"a{mark}v 9 9 9", unit_box(0.0)
    looks = Looks((Material(name),), np.zeros(12, np.int64), groups=(Group(name, name),), group_of=np.zeros(12, np.int64))
    save_mesh(Mesh(box.vertices, box.faces, looks=looks), tmp_path / "a.obj")
    again = load_mesh(tmp_path / "a.obj")
    assert len(again.vertices) == 8 and again.looks.groups == (Group("a v 9 9 9", "a v 9 9 9"),)
    assert again.looks.materials[0].name == "a v 9 9 9"
