"""The FMU as an archive and a library: what importers and checkers look at before they run it."""

import re
import shutil
import subprocess
import time
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from scenes import LED, MOVED, box
from signatures import HEADERS
from softffd import SoftffdError, load_scene, package_fmu
from softffd.fmu.package import scene_texts
from softffd.installed import data_folder

LOAD = {"name": "push", "points": "all"}


@pytest.fixture(scope="module")
def standard(tmp_path_factory) -> Path:
    return package_fmu(load_scene("standard"), tmp_path_factory.mktemp("fmu") / "standard.fmu")


def test_entries_are_where_the_standard_wants_them(standard):
    names = zipfile.ZipFile(standard).namelist()
    assert names[0] == "modelDescription.xml"
    for wanted in ("model.png", "documentation/index.html", "documentation/licenses/license.txt", "resources/scene.txt"):
        assert wanted in names
    assert any(name.startswith("binaries/") for name in names)


def described(fmu: Path) -> ElementTree.Element:
    return ElementTree.fromstring(zipfile.ZipFile(fmu).read("modelDescription.xml"))


def test_the_licence_is_where_importers_look_and_names_whom_the_description_names(standard):
    with zipfile.ZipFile(standard) as archive:
        text = archive.read("documentation/licenses/license.txt").decode()
        assert "licenses/license.txt" in archive.read("documentation/index.html").decode()
    assert text == (Path(__file__).parents[2] / "LICENSE").read_text()
    root = described(standard)
    assert root.get("copyright") in text.splitlines() and root.get("copyright").endswith(root.get("author"))
    assert root.get("license") == "BSD-2-Clause" and text.startswith("BSD 2-Clause License")


def test_builds_are_byte_identical_and_their_date_is_that_of_the_sources_and_no_part_of_the_guid(as_shipped, tmp_path, monkeypatch):
    def made(name: str) -> tuple[str, str, bytes]:
        fmu = package_fmu(box(), tmp_path / f"{name}.fmu")
        root = described(fmu)
        return root.get("generationDateAndTime"), root.get("guid"), fmu.read_bytes()

    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    date, guid, content = made("today")
    newest = max(file.stat().st_mtime for file in data_folder().rglob("*") if file.is_file())
    assert date == time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(newest))
    assert made("again") == (date, guid, content)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    then, same, other = made("then")
    assert (then, same) == ("2023-11-14T22:13:20Z", guid) and other != content


@pytest.mark.parametrize("given", ["", "yesterday", "-1", "1e9", "9" * 20])
def test_a_date_that_is_none_is_refused(tmp_path, monkeypatch, given):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", given)
    with pytest.raises(SoftffdError, match="SOURCE_DATE_EPOCH: wanted seconds since 1970, got"):
        package_fmu(box(), tmp_path / "box.fmu")


def test_every_input_has_a_nominal_value_of_the_size_of_the_scene():
    def nominals(scale: float, gravity: list[float] | None) -> dict[str, float]:
        plane, pin = {"name": "table", **MOVED}, {"name": "grip", **LED}
        scene = box(
            size=[0.5 * scale, scale, 0.2 * scale],
            mass={"total": 3.0},
            gravity=gravity,
            plane=[plane],
            pin=[pin | {"points": "z-"}],
            load=[LOAD],
            forces=[[0, 0, 0]],
        )
        root = ElementTree.fromstring(scene_texts(scene)[0]["modelDescription.xml"])
        inputs = [v for v in root.find("ModelVariables") if v.get("causality") == "input"]
        return {v.get("name").removesuffix(".x"): float(v[0].get("nominal")) for v in inputs}

    found = nominals(2.0, [0.0, 0.0, -8.0])
    wanted = {"force[0,0,0]": 24, "load.push": 24, "plane.table.point": 2, "plane.table.normal": 1, "plane.table.velocity": 4}
    wanted |= {"plane.table.angular_velocity": 2, "pin.grip.position": 2, "pin.grip.velocity": 4, "pin.grip.angular_velocity": 2}
    assert {name: found[name] for name in wanted} == wanted and found["pin.grip.orientation.w"] == 1
    assert min(found.values()) > 0
    assert nominals(1.0, None)["load.push"] == nominals(1.0, [0.0, 0.0, 0.0])["load.push"] == pytest.approx(3 * 9.80665)


PACKAGE_CALLS = {"softffd_deform", "softffd_farthest_first", "softffd_many_steps", "softffd_most_behind"}
"""What the Python package calls of the library beside the standards' functions."""


@pytest.fixture(scope="module")
def library(standard, tmp_path_factory) -> Path:
    with zipfile.ZipFile(standard) as archive:
        return Path(archive.extract("binaries/linux64/softffd.so", tmp_path_factory.mktemp("library")))


def told(*command: str | Path) -> str:
    if not shutil.which(command[0]):
        pytest.skip(f"{command[0]} is not on this machine")
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_the_library_exports_the_functions_of_both_standards_and_what_the_package_calls(library):
    exported = {line.split()[-1] for line in told("nm", "-D", "--defined-only", library).splitlines()}
    fmi3 = set(re.findall(r"FMI3_Export (fmi3\w+)TYPE\s+fmi3\w+;", (HEADERS / "fmi3Functions.h").read_text()))
    assert exported == declared_functions() | fmi3 | PACKAGE_CALLS
    assert (len(declared_functions()), len(fmi3)) == (34, 75)


def test_the_library_needs_the_c_library_alone_and_names_no_path(library):
    listed = told("readelf", "-d", library)
    needed = set(re.findall(r"NEEDED.*\[(.*?)\.so", listed))
    assert needed <= {"libm", "libc", "ld-linux-x86-64", "ld-linux-aarch64", "libpthread", "libdl"}
    assert "RPATH" not in listed and "RUNPATH" not in listed and "BIND_NOW" in listed
    assert str(Path(__file__).resolve().parents[2]).encode() not in library.read_bytes()


def test_writing_past_an_array_of_the_component_ends_the_process(library):
    """Compilers put a call of the C library's last words behind functions with arrays; here they are asked to."""
    assert "__stack_chk_fail" in told("nm", "-D", "--undefined-only", library)


def declared_functions() -> set[str]:
    """The co-simulation functions that the standard's header declares."""
    text = (HEADERS / "fmi2Functions.h").read_text()
    names = set(re.findall(r"FMI2_Export (fmi2\w+)TYPE\s+fmi2\w+;", text))
    model_exchange = {
        "fmi2EnterEventMode", "fmi2NewDiscreteStates", "fmi2EnterContinuousTimeMode", "fmi2CompletedIntegratorStep", "fmi2SetTime",
        "fmi2SetContinuousStates", "fmi2GetDerivatives", "fmi2GetEventIndicators", "fmi2GetContinuousStates",
        "fmi2GetNominalsOfContinuousStates",
    }  # fmt: skip
    return names - model_exchange


def test_every_output_is_listed_with_its_dependencies(standard):
    root = described(standard)
    assert root.find("CoSimulation").get("providesDirectionalDerivative") in (None, "false")
    variables = root.find("ModelVariables")
    outputs = [index for index, v in enumerate(variables, start=1) if v.get("causality") == "output"]
    for section in ("Outputs", "InitialUnknowns"):
        unknowns = root.find(f"ModelStructure/{section}")
        assert [int(u.get("index")) for u in unknowns] == outputs
        assert all(u.get("dependencies") is not None for u in unknowns)
    first = root.find("ModelStructure/InitialUnknowns")[0].get("dependencies").split()
    names = {variables[int(index) - 1].get("name").rsplit(".", 1)[0] for index in first}
    assert names == {f"plane.{plane}.{what}" for plane in ("lower", "upper") for what in ("point", "normal")}


@pytest.mark.parametrize("key", ["stiffness", "damping"])
def test_scenes_that_differ_only_in_what_the_library_alone_reads_have_different_guids(key):
    """The guid refuses states of another scene, so it has to know all of it; nothing of regional springs is in the description."""

    def described(value: float) -> tuple[str, str]:
        scene = box(damping=0.1, region=[{"points": "z-", key: value}])
        root = ElementTree.fromstring(scene_texts(scene)[0]["modelDescription.xml"])
        return root.attrib.pop("guid"), ElementTree.tostring(root, encoding="unicode")

    (guid, text), (other_guid, other_text) = described(1.0), described(2.0)
    assert text == other_text and guid != other_guid


def test_units_names_and_references_are_sound(standard):
    root = described(standard)
    units = {unit.get("name") for unit in root.find("UnitDefinitions")}
    variables = list(root.find("ModelVariables"))
    assert len({v.get("name") for v in variables}) == len(variables)
    assert len({v.get("valueReference") for v in variables}) == len(variables)
    assert all(int(v.get("valueReference")) < 2**31 for v in variables)
    assert all(v[0].get("unit") in units for v in variables if v[0].get("unit"))
    for v in variables:
        assert re.fullmatch(r"[A-Za-z0-9_.,\[\]]+", v.get("name"))
        assert (v[0].get("start") is not None) == (v.get("causality") != "output")
