"""3MF: what is not read is refused or told, and an archive that unpacks to too much is not unpacked."""

import zipfile

import pytest

from mesh_files import loaded
from softffd.errors import MeshError
from softffd.mesh.files import load_mesh

pytest.importorskip("networkx", reason="networkx is not installed")

CORE = "http://schemas.microsoft.com/3dmanufacturing/{}/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
MESH = (
    "<mesh><vertices>"
    + "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in CORNERS)
    + "</vertices><triangles>"
    + "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
    + "</triangles></mesh>"
)
BODY, ITEM = f'<object id="1">{MESH}</object>', '<item objectid="1"/>'


def model(objects=BODY, items=ITEM, root=""):
    spaces = f'xmlns="{CORE.format("core")}" xmlns:p="{PRODUCTION}" xmlns:s="{CORE.format("slice")}" {root}'
    return f"<model {spaces}><resources>{objects}</resources><build>{items}</build></model>"


def archive(path, main, **others):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, text in ({"3dmodel": main} | others).items():
            file.writestr(f"3D/{name}.model", text)
    return path


def outer(*numbers, file="other"):
    parts = "".join(f'<component p:path="/3D/{file}.model" objectid="{number}"/>' for number in numbers)
    return f'<object id="9"><components>{parts}</components></object>'


REFUSED = {
    "slices": ({"root": 'requiredextensions="p s"'}, "requires http.*/slice/.*, which is not read"),
    "an item elsewhere": ({"items": '<item objectid="1" p:path="/3D/other.model"/>'}, r"parts in other files .*\(3D/other.model\)"),
    "two of one file": ({"objects": outer("1", "2"), "items": '<item objectid="9"/>'}, r"parts in other files .*\(3D/other.model\)"),
    "a file that is not there": ({"objects": outer("1", file="gone"), "items": '<item objectid="9"/>'}, r"\(3D/gone.model\)"),
    "no such object": ({"items": '<item objectid="7"/>'}, r"none of its bodies can be read: broken references \(object 7\)"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_read_is_refused_by_name(case, tmp_path):
    keys, message = REFUSED[case]
    with pytest.raises(MeshError, match=message):
        load_mesh(archive(tmp_path / "a.3mf", model(**keys), other=model(BODY + BODY.replace('"1"', '"2"'), "")))


def test_what_is_left_out_is_told_and_the_rest_is_read(tmp_path):
    mesh = load_mesh(archive(tmp_path / "a.3mf", model(items=ITEM + '<item objectid="7"/>', root='requiredextensions="p"')))
    assert (len(mesh.faces), mesh.looks.notes) == (4, ("broken references (object 7)",))
    part = model(outer("1"), '<item objectid="9"/>')
    assert len(load_mesh(archive(tmp_path / "b.3mf", part, other=model(items=""))).faces) == 4


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_byte_order_mark_is_no_part_of_the_text(encoding, tmp_path):
    colours = '<basematerials id="5"/>'
    mesh = load_mesh(archive(tmp_path / "a.3mf", model(colours + BODY).encode(encoding)))
    assert (len(mesh.faces), mesh.looks.notes) == (4, ("colours of a 3MF file are not read; OBJ, PLY and GLB keep theirs",))


def test_an_archive_that_unpacks_to_far_more_than_itself_is_not_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr("softffd.mesh.threemf._MOST", 100_000)
    file = archive(tmp_path / "a.3mf", model() + " " * 1_000_000)
    monkeypatch.setattr(zipfile.ZipFile, "open", lambda *_: pytest.fail("it was unpacked"))
    with pytest.raises(MeshError, match=r"unpacks to 1,000,.* bytes, over 100 times its own"):
        load_mesh(file)


def test_an_archive_without_a_model_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as file:
        file.writestr("other.txt", "x")
    with pytest.raises(MeshError, match=r"it has no part 3D/3dmodel.model"):
        loaded(tmp_path, "b.3mf", (tmp_path / "a.3mf").read_bytes())


@pytest.mark.parametrize(("place", "value", "message"), [(60, 255, "damaged or cut off"), (8, 77, "packed in a way that is not read")])
def test_a_damaged_or_otherwise_packed_part_is_refused(place, value, message, tmp_path):
    data = bytearray(archive(tmp_path / "a.3mf", model()).read_bytes())
    data[place] = value
    if place == 8:  # how it is packed stands in the list of parts too
        data[data.index(b"PK\1\2") + 10] = value
    with pytest.raises(MeshError, match=message):
        loaded(tmp_path, "b.3mf", bytes(data))
