"""COLLADA: bodies and looks that are not read are told, each for what it is."""

import re

import pytest

from mesh_files import loaded
from softffd.errors import MeshError

pytest.importorskip("collada", reason="pycollada is not installed")

FILE = """<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="metre" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_images><image id="picture"><init_from>{picture}</init_from></image></library_images>
<library_effects><effect id="look"><profile_COMMON><technique sid="common"><lambert><diffuse><color>1 0 0 1</color></diffuse></lambert>
</technique></profile_COMMON></effect></library_effects>
<library_materials><material id="paint"><instance_effect url="#look"/></material></library_materials>
<library_geometries><geometry id="body"><mesh>
<source id="at"><float_array id="numbers" count="12">{numbers}</float_array><technique_common>
<accessor source="#numbers" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<source id="shades"><float_array id="reds" count="12">1 0 0 0 1 0 0 0 1 1 1 1</float_array><technique_common>
<accessor source="#reds" count="4" stride="3"><param name="R" type="float"/><param name="G" type="float"/><param name="B" type="float"/>
</accessor></technique_common></source>
<vertices id="points"><input semantic="POSITION" source="#at"/></vertices>
<triangles count="4" material="paint"><input semantic="VERTEX" source="#points" offset="0"/>{colour}
<p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles>
</mesh></geometry></library_geometries>
<library_controllers><controller id="bones"><skin source="#body"/></controller></library_controllers>
<library_visual_scenes><visual_scene id="scene"><node id="node">{bodies}</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>"""

NUMBERS = "0 0 0 1 0 0 0 1 0 0 0 1"
BODY = (
    '<instance_geometry url="#body"><bind_material><technique_common><instance_material symbol="paint" target="#paint"/>'
    "</technique_common></bind_material></instance_geometry>"
)


def text(**parts):
    return FILE.format_map({"picture": "", "numbers": NUMBERS, "colour": "", "bodies": BODY} | parts)


LOST = {
    '<instance_controller url="#bones"/>': r"bodies on a skin or morph \(#bones\), which are not read: apply the armature",
    '<instance_geometry url="#gone"/>': r"broken references \(#gone\)",
    '<instance_geometry url="other.dae#body"/>': r"bodies in other files \(other.dae#body\), which are not read",
}


@pytest.mark.parametrize("body", LOST)
def test_bodies_that_are_not_read_are_told_for_what_they_are(body, tmp_path):
    with pytest.raises(MeshError, match=f"none of its bodies can be read: {LOST[body]}"):
        loaded(tmp_path, "a.dae", text(bodies=body))
    mesh = loaded(tmp_path, "b.dae", text(bodies=BODY + body))
    assert len(mesh.faces) == 4
    assert any(re.match(LOST[body], note) for note in mesh.looks.notes)


def test_decimal_commas_are_named(tmp_path):
    with pytest.raises(MeshError, match="numbers with a decimal comma, such as 0,5; wanted decimal points"):
        loaded(tmp_path, "a.dae", text(numbers=NUMBERS.replace("1", "0,5")))


def test_looks_that_are_not_kept_are_told(tmp_path):
    names = "the names of its materials are not read"
    (tmp_path / "here it is.png").touch()
    assert loaded(tmp_path, "a.dae", text(picture="here%20it%20is.png")).looks.notes == (names,)
    missing = loaded(tmp_path, "b.dae", text(picture="gone.png")).looks
    assert missing.notes == (names, "pictures that are not beside it: gone.png")
    colour = '<input semantic="COLOR" source="#shades" offset="0"/>'
    coloured = loaded(tmp_path, "c.dae", text(colour=colour)).looks
    assert coloured.notes == (names, "colours of vertices of bodies that have a material")
    assert coloured.materials[0].colour == (1.0, 0.0, 0.0)
    unbound = loaded(tmp_path, "d.dae", text(colour=colour, bodies='<instance_geometry url="#body"/>')).looks
    assert unbound.notes == () and unbound.colours[1].tolist() == [0.0, 0.0, 1.0]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_byte_order_mark_is_no_part_of_the_text(encoding, tmp_path):
    content = text().replace('<?xml version="1.0"?>', "")
    assert len(loaded(tmp_path, "a.dae", content.encode(encoding)).faces) == 4
