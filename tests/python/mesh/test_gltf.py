"""glTF: where vertices are, which picture they have, and what is refused or told since it is not read."""

import base64
import io
import json

import numpy as np
import pytest
from PIL import Image

from mesh_files import CORNERS, glb_with, loaded
from softffd.errors import MeshError
from softffd.mesh.looks import Group

FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], dtype="<u2")
FIRST, SECOND = (np.array([[a, b], [0, b], [a, 0], [0, 0]], dtype="<f4") for a, b in ((1, 0.5), (0.25, 0.75)))


def _data(content):
    return "data:application/octet-stream;base64," + base64.b64encode(content).decode()


def tetrahedron(change=lambda header: None):
    """A textured one whose JSON went through `change`; two sets of coordinates for its red picture."""
    picture = io.BytesIO()
    Image.new("RGB", (2, 2), (204, 51, 0)).save(picture, "PNG")
    parts = [(CORNERS, 5126, "VEC3"), (FACES, 5123, "SCALAR"), (FIRST, 5126, "VEC2"), (SECOND, 5126, "VEC2")]
    counts = [4, 12, 4, 4]
    attributes = {"POSITION": 0, "TEXCOORD_0": 2, "TEXCOORD_1": 3}
    header = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": part.nbytes, "uri": _data(part.tobytes())} for part, _, _ in parts],
        "bufferViews": [{"buffer": n, "byteLength": part.nbytes} for n, (part, _, _) in enumerate(parts)],
        "accessors": [
            {"bufferView": n, "componentType": type, "count": counts[n], "type": kind} for n, (_, type, kind) in enumerate(parts)
        ],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 1, "material": 0}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "images": [{"uri": _data(picture.getvalue())}],
        "textures": [{"source": 0}],
        "materials": [{"name": "skin", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    }
    change(header)
    return json.dumps(header)


def _node(**keys):
    return lambda header: header["nodes"][0].update(keys)


def _texture(**keys):
    return lambda header: header["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].update(keys)


def _required(*extensions):
    return lambda header: header.update(extensionsRequired=list(extensions))


def _targets(header):
    header["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}]
    header["meshes"][0]["weights"] = [0.0]


def _bare(accessor):
    return lambda header: header["accessors"][accessor].pop("bufferView")


REFUSED = {
    "skin": (_node(skin=0), r"uses skins \(bones\), .*apply the armature"),
    "morph": (lambda header: [_targets(header), header["meshes"][0].update(weights=[1.0])], "uses morph targets .* apply the shape keys"),
    "morph of a node": (lambda header: [_targets(header), _node(weights=[0.5])(header)], "uses morph targets"),
    "instances": (_node(extensions={"EXT_mesh_gpu_instancing": {}}), "EXT_mesh_gpu_instancing, .* make the instances real"),
    "required": (_required("VENDOR_a", "KHR_materials_unlit"), r"uses VENDOR_a \(extensionsRequired\)"),
    "no positions": (_bare(0), "uses numbers without a bufferView"),
    "no corners": (_bare(1), "uses numbers without a bufferView"),
    "no POSITION": (lambda header: header["meshes"][0]["primitives"][0]["attributes"].pop("POSITION"), "uses primitives without POSITION"),
    "no such scene": (lambda header: header.update(scene=5), "scene: wanted the number of one of its 1 scenes, from 0, got 5"),
    "no such node": (_node(children=[7]), "wanted the number of one of its 1 nodes, from 0, got 7"),
    "a cycle": (_node(children=[0]), r"nodes\[0\]: wanted one parent .* that its scene reaches twice"),
    "no list": (lambda header: header.update(nodes=5), "not that of a glTF scene"),
    "no number": (_texture(texCoord=np.inf), "no.* glTF scene"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_says_where_vertices_are_and_is_not_read_is_refused(case, tmp_path):
    change, message = REFUSED[case]
    with pytest.raises(MeshError, match=message):
        loaded(tmp_path, "a.gltf", tetrahedron(change))


def _camera(header):
    header.update(nodes=[{"camera": 0, "translation": [5, 0, 0], "children": [1]}, {"mesh": 0}])
    header["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]


PLACED = {
    "as it is": (lambda header: None, 0),
    "morphs of no weight": (_targets, 0),
    "no scene": (lambda header: [header.pop("scenes"), header.update(nodes=[{"mesh": 0}, {"children": [0], "translation": [3, 0, 0]}])], 3),
    "on a camera": (_camera, 5),
    "required looks": (_required("KHR_materials_unlit", "KHR_texture_transform"), 0),
}


@pytest.mark.parametrize("case", PLACED)
def test_bodies_stand_where_the_file_puts_them(case, tmp_path):
    change, along = PLACED[case]
    np.testing.assert_allclose(loaded(tmp_path, "a.gltf", tetrahedron(change)).vertices, CORNERS + np.array([along, 0, 0]))


def test_all_primitives_of_a_node_are_the_group_of_its_name(tmp_path):
    def change(header):
        header["meshes"][0]["primitives"] *= 2
        header["nodes"] = [{"name": "body_1", "mesh": 0}, {"name": "body_1", "mesh": 0}, {"mesh": 0}]
        header["scenes"] = [{"nodes": [0, 1, 2]}]

    looks = loaded(tmp_path, "a.gltf", tetrahedron(change)).looks
    counts = np.bincount(looks.group_of).tolist()
    assert dict(zip(looks.groups, counts, strict=True)) == {Group("body_1"): 16, Group("2"): 8}


def _moved(**keys):
    return _texture(extensions={"KHR_texture_transform": keys})


def _turned(uv):
    """By 90 degrees as seen, with v down: what pointed right points up."""
    return np.column_stack([uv[:, 1], -uv[:, 0]])


COORDINATES = {
    "first": (_texture(), FIRST),
    "second": (_texture(texCoord=1), SECOND),
    "second of the transform": (_moved(texCoord=1), SECOND),
    "offset": (_moved(offset=[0.5, 0.25]), FIRST + np.array([0.5, 0.25])),
    "turned": (_moved(rotation=np.pi / 2), _turned(FIRST)),
    "scaled, turned, moved": (_moved(scale=[2, 3], rotation=np.pi / 2, offset=[1, 0]), _turned(FIRST * [2, 3]) + np.array([1, 0])),
}


@pytest.mark.parametrize("case", COORDINATES)
def test_a_picture_lies_where_its_set_of_coordinates_and_transform_put_it(case, tmp_path):
    change, down = COORDINATES[case]
    mesh = loaded(tmp_path, "a.gltf", tetrahedron(change))
    np.testing.assert_allclose(mesh.uv, np.column_stack([down[:, 0], 1 - down[:, 1]]), atol=1e-6)
    assert [(each.name, each.texture is not None) for each in mesh.looks.materials] == [("skin", True)]
    assert mesh.looks.notes == ()


def test_diffuse_colours_of_glossy_materials_are_the_colour(tmp_path):
    glossy = {"diffuseFactor": [1, 0, 0, 1], "glossinessFactor": 0.5}
    extension = {"name": "red", "extensions": {"KHR_materials_pbrSpecularGlossiness": glossy}}
    mesh = loaded(tmp_path, "a.gltf", tetrahedron(lambda header: header.update(materials=[extension])))
    assert mesh.looks.materials[0].name == "red"
    assert mesh.looks.materials[0].colour == pytest.approx((1.0, 0.0, 0.0))
    glossy["diffuseTexture"] = {"index": 0}
    assert loaded(tmp_path, "b.gltf", tetrahedron(lambda header: header.update(materials=[extension]))).texture is not None


def test_what_is_left_out_is_said(tmp_path):
    basisu = {"extensions": {"KHR_texture_basisu": {"source": 0}}}
    mesh = loaded(tmp_path, "a.gltf", tetrahedron(lambda header: header.update(textures=[basisu])))
    assert mesh.looks.notes == ("pictures in KTX2 (KHR_texture_basisu) are not read; PNG and JPEG are",)
    mesh = loaded(tmp_path, "b.gltf", tetrahedron(lambda header: header.update(textures=[basisu | {"source": 0}])))
    assert mesh.looks.notes == () and mesh.texture is not None
    points = {"attributes": {"POSITION": 0}, "mode": 0}
    mesh = loaded(tmp_path, "c.gltf", tetrahedron(lambda header: header["meshes"][0]["primitives"].append(points)))
    assert mesh.looks.notes == ("points and lines",)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_byte_order_mark_is_no_part_of_the_text(encoding, tmp_path):
    assert len(loaded(tmp_path, "a.gltf", tetrahedron().encode(encoding)).faces) == 4


def test_a_failure_of_the_program_that_reads_is_not_put_on_the_file(tmp_path, monkeypatch):
    def fails(*_, **__):
        raise AttributeError("module has no attribute")

    monkeypatch.setattr("trimesh.load_scene", fails)
    with pytest.raises(MeshError, match=r"trimesh .*, which reads this kind, stops \(AttributeError: .*save the mesh as OBJ, PLY or GLB"):
        loaded(tmp_path, "a.glb", glb_with(lambda header: None))
