"""What modelDescription.xml says, and what it leaves to the standards' defaults."""

import fmpy
import pytest

from scenes import box
from softffd import load_scene, package_fmu
from softffd.fmu.interface import elements
from softffd.fmu.model_description import model_description
from softffd.fmu.package import scene_masses
from softffd.fmu.variables import variables
from softffd.installed import table
from softffd.names import parse_name

INITIAL = {"output": "calculated", "parameter": "exact"}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", ["car_drop", "press", "stiff_pull"])
def test_what_is_left_out_is_the_default_of_the_standard(name, fmi, tmp_path):
    """fmpy completes what it reads by the standard's tables; its validation takes the schema and these tables."""
    fmu = package_fmu(load_scene(name), tmp_path / "scene.fmu", fmi=fmi)
    description = fmpy.read_model_description(str(fmu), validate=True)
    rows = {(row["key"], row["causality"]): row for row in table()["family"]}
    for variable in description.modelVariables:
        assert variable.initial == INITIAL.get(variable.causality, variable.initial), variable.name
        found = parse_name(variable.name)
        row = rows.get((found.family, variable.causality)) if found else None
        assert row is None or variable.variability == row["variability"], variable.name


@pytest.mark.parametrize("name", ["car_drop", "press", "stiff_layer"])
def test_the_number_of_elements_is_known_without_making_them(name):
    scene = load_scene(name).replace({"outputs.energy": True, "outputs.velocities": "x-"})
    for variable in variables(scene, scene_masses(scene).mass):
        assert variable.count == len(list(elements(variable)))


def test_a_position_is_one_short_line_and_two_numbers():
    """Names and numbers are 90 of its bytes, the words of the standard that it needs 110, its description 50."""

    def size(selection: str) -> int:
        scene = box(points=[16, 16, 16], outputs={"positions": selection})
        return len(model_description(scene, variables(scene, scene_masses(scene).mass)))

    assert (size("all") - size("none")) / (3 * 16**3) < 260
