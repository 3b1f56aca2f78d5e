"""solver.method is an Integer, which every master can set; this package goes on calling its values by their names."""

import re
import zipfile
from xml.etree import ElementTree as Xml

import numpy as np
import pytest

from scenes import box
from softffd import FmuError, Simulation, package_fmu, simulate
from softffd.fmu.variables import list_of_values, listed_values
from softffd.installed import table

METHODS = {method["key"]: method["value"] for method in table()["method"]}


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    return package_fmu(box(stop_time=0.1), tmp_path_factory.mktemp("method") / "box.fmu")


def description_of(fmu) -> str:
    with zipfile.ZipFile(fmu) as archive:
        return archive.read("modelDescription.xml").decode()


def with_enumeration(fmu, target):
    """The FMU with the description that declares solver.method as an enumeration."""
    items = "".join(f'<Item name="{name}" value="{value}"/>' for name, value in METHODS.items())
    types = f'<TypeDefinitions><SimpleType name="Method"><Enumeration>{items}</Enumeration></SimpleType></TypeDefinitions>'
    text, integers = re.subn(
        rf'<Integer min="1" max="{len(METHODS)}" start="1"/>', '<Enumeration declaredType="Method" start="1"/>', description_of(fmu)
    )
    text, _ = re.subn(r'description="Time integration method[^"]*"', 'description="Time integration method"', text)
    assert integers == 1
    with zipfile.ZipFile(fmu) as archive, zipfile.ZipFile(target, "w") as written:
        for name in archive.namelist():
            is_description = name == "modelDescription.xml"
            written.writestr(name, text.replace("<LogCategories>", types + "<LogCategories>") if is_description else archive.read(name))
    return target


@pytest.mark.parametrize("points", [[3, 3, 3], [9, 9, 9]])
def test_the_description_has_an_integer_with_its_bounds_and_lists_its_values(points, tmp_path):
    root = Xml.fromstring(description_of(package_fmu(box(points=points, method="leapfrog"), tmp_path / "box.fmu")))
    assert not root.findall(".//Enumeration") and not root.findall(".//SimpleType")
    variable = root.find(".//ScalarVariable[@name='solver.method']")
    assert variable.find("Integer").attrib == {"min": "1", "max": str(len(METHODS)), "start": "3"}
    assert listed_values(variable.get("description")) == METHODS


def test_a_list_of_values_reads_back_and_other_descriptions_have_none():
    assert listed_values("Time integration method: " + list_of_values(METHODS)) == METHODS
    for text in ("", "Internal steps since the start", "Number of points: 3", "Gear: 1 first, or 2 second"):
        assert listed_values(text) is None


def test_numbers_and_names_mean_the_same_for_a_scene_its_fmu_and_an_older_fmu(fmu, tmp_path):
    for source in (box(stop_time=0.1), fmu, with_enumeration(fmu, tmp_path / "older.fmu")):
        by_name, by_number = (simulate(source, start_values={"solver.method": method}) for method in ("bm4", METHODS["bm4"]))
        np.testing.assert_array_equal(by_name.positions, by_number.positions)
        with Simulation(source, method="leapfrog") as sim:
            assert sim["solver.method"] == "leapfrog" and sim.number("solver.method") == METHODS["leapfrog"]
            sim["solver.method"] = METHODS["dop853"]
            assert sim["solver.method"] == "dop853" and sim.variables["solver.method"].items == METHODS
            with pytest.raises(FmuError, match=r"wanted one of auto, .*, got 'leapfrg', did you mean .leapfrog."):
                sim["solver.method"] = "leapfrg"


@pytest.mark.parametrize("number", [0, len(METHODS) + 1, -1, 2**31 - 1])
def test_a_number_out_of_range_is_refused_with_the_list_of_values(fmu, number):
    with Simulation(fmu) as sim:
        with pytest.raises(FmuError) as refused:
            sim["solver.method"] = number
        assert f"solver.method: wanted one of {list_of_values(METHODS)}, got {number}" in str(refused.value)
        assert sim["solver.method"] == "auto"
