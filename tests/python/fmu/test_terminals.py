"""Each part of a scene is a terminal of its FMU, by the schema of FMI 3.0, with the inputs and outputs that have its name."""

from pathlib import Path
from xml.etree import ElementTree as Xml
from zipfile import ZipFile

import fmpy
import pytest
from lxml import etree

from scenes import LED, MOVED, meshed
from softffd import load_scene, package_fmu
from softffd.fmu.terminals import PLACE
from validation import shapes

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
PARTS = {
    "plane": [{"name": "table"}, {"name": "press", "point": [0.0, 0.0, 2.0], "normal": [0.0, 0.0, -1.0], **MOVED}],
    "box": [{"name": "block", "size": [1.0, 1.0, 1.0], "point": [0.0, 0.0, 5.0], "motion": "input"}],
    "sphere": [{"name": "ball", "radius": 0.1, "point": [0.0, 0.0, 9.0], "motion": "free", "mass": 1.0}],
    "pin": [{"name": "base", "points": "z-"}, {"name": "hand", "points": "z+", **LED}],
    "load": [{"name": "push", "points": "x+"}],
    "probe": [{"name": "nose", "at": [0.5, 0.5, 1.0]}],
    "sensor": [{"name": "foot", "on": "z-", "taxels": [2, 1]}],
}


def parts(folder: Path, names: str = "structured"):
    """A cube among a part of each kind."""
    return meshed(folder, shapes.cube(2, 0.1), **PARTS, reactions=True, fmu={"names": names})


def document(scene, folder: Path, fmi: int = 2) -> tuple[bytes, set[str]]:
    """The file in the scene's FMU, and the names of the FMU's variables."""
    file = package_fmu(scene, folder / f"terminals{fmi}.fmu", fmi=fmi)
    with ZipFile(file) as archive:
        text = archive.read(PLACE) if PLACE in archive.namelist() else b""
    return text, {variable.name for variable in fmpy.read_model_description(str(file)).modelVariables}


def members(text: bytes) -> dict[str, dict[str, str]]:
    return {
        terminal.get("name"): {member.get("memberName"): member.get("variableName") for member in terminal}
        for terminal in Xml.fromstring(text).iter("Terminal")
    }


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("names", ["structured", "flat"])
def test_the_schema_finds_nothing_and_every_member_is_a_variable(fmi, names, tmp_path):
    text, there = document(parts(tmp_path, names), tmp_path, fmi)
    etree.XMLSchema(etree.parse(SCHEMA)).assertValid(etree.fromstring(text))
    found = members(text)
    assert len(found) == 9 and {name for each in found.values() for name in each.values()} <= there
    kinds = {member.get("variableKind") for member in Xml.fromstring(text).iter("TerminalMemberVariable")}
    assert kinds == {"signal"} and {each.get("matchingRule") for each in Xml.fromstring(text).iter("Terminal")} == {"bus"}


def test_a_terminal_has_pose_velocity_and_wrench_of_its_part(tmp_path):
    text, _ = document(parts(tmp_path), tmp_path)
    found = members(text)
    assert set(found) == {f"{kind}.{part['name']}" for kind, several in PARTS.items() for part in several}
    words = ("point", "normal", "velocity", "angular_velocity", "reaction", "torque")
    assert {f"{word}.{c}" for word in words for c in "xyz"} <= set(found["plane.press"])
    assert found["plane.press"]["reaction.z"] == "plane.press.reaction.z" and "friction" not in found["plane.press"]
    assert {"position.x", "orientation.w", "velocity.y", "angular_velocity.z", "reaction.x", "torque.z"} <= set(found["pin.hand"])
    assert {"force.x", "torque.y", "position.z", "orientation.w", "velocity.x", "reaction.y"} <= set(found["sphere.ball"])
    assert found["load.push"] == {c: f"load.push.{c}" for c in "xyz"}
    assert not any(name.startswith("point") for name in found["plane.table"])  # a fixed one has its reaction only


def test_arrays_of_fmi_3_are_members_as_a_whole_and_names_are_flat_where_the_variables_are(tmp_path):
    found = members(document(parts(tmp_path), tmp_path, 3)[0])
    assert found["plane.press"]["reaction"] == "plane.press.reaction" and found["load.push"] == {"value": "load.push"}
    found = members(document(parts(tmp_path, "flat"), tmp_path)[0])
    assert found["plane_press"]["reaction_z"] == "plane_press_reaction_z"


def test_a_scene_without_parts_has_no_such_file(tmp_path):
    assert document(load_scene("free_vibration"), tmp_path)[0] == b""
