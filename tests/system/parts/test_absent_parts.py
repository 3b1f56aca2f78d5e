"""What a scene does not use does not exist in its FMU: neither variables nor records."""

import zipfile
from xml.etree import ElementTree

import pytest

from softffd import package_fmu

PLAIN = """
[material]
stiffness = 1e3
damping = 0.0
[outputs]
positions = [[0, 0, 0]]
velocities = "none"
reactions = true
energy = false
solver = false
"""

ALWAYS = {"mass", "stiffness.edge", "stiffness.face", "stiffness.body", "solver.method", "solver.tolerance", "solver.step"}
ALWAYS_RECORDS = {"guid", "counts", "origin", "size", "topology", "mass", "stiffness", "positions", "initial", "reactions"}
ALWAYS_RECORDS |= {"method", "tolerance", "step"}

PLANE = ("point", "normal", "velocity", "angular_velocity", "reaction", "torque")
PIN = ("position", "orientation", "velocity", "angular_velocity", "reaction", "torque")

PARTS = {
    "damping": ("damping = 0.0", "damping = 0.1", {"damping"}, {"damping"}),
    "gravity": ("[outputs]", "[environment]\ngravity = [0, 0, -9]\n[outputs]", {f"gravity.{c}" for c in "xyz"}, {"gravity"}),
    "plane": (
        "[outputs]",
        '[[plane]]\nname = "q"\n[outputs]',
        {f"plane.q.{what}.{c}" for what in PLANE for c in "xyz"} | {"plane.q.friction", "plane.q.contacts"},
        {"plane"},
    ),
    "pin": (
        "[outputs]",
        '[[pin]]\nname = "a"\npoints = "z-"\n[outputs]',
        {f"pin.a.{what}.{c}" for what in ("reaction", "torque") for c in "xyz"},
        {"pin"},
    ),
    "pin moved by input": (
        "[outputs]",
        '[[pin]]\nname = "a"\npoints = "z-"\nmotion = "input"\n[outputs]',
        {f"pin.a.{what}.{c}" for what in PIN for c in "xyz"} | {"pin.a.orientation.w"},
        {"pin"},
    ),
    "load": ("[outputs]", '[[load]]\nname = "l"\npoints = "z-"\n[outputs]', {f"load.l.{c}" for c in "xyz"}, {"load"}),
    "forces": ("[outputs]", "[inputs]\nforces = [[1, 2, 3]]\n[outputs]", {f"force[1,2,3].{c}" for c in "xyz"}, {"forces"}),
    "probe": ("[outputs]", '[[probe]]\nname = "o"\nat = [0.5, 0.5, 0.5]\n[outputs]', {f"probe.o.{c}" for c in "xyz"}, {"probe"}),
    "velocities": ('velocities = "none"', "velocities = [[1, 2, 3]]", {f"velocity[1,2,3].{c}" for c in "xyz"}, {"velocities"}),
    "energy": (
        "energy = false",
        "energy = true",
        {"energy.kinetic", "energy.elastic", "energy.dissipated", "energy.work"},
        {"energy"},
    ),
    "solver": (
        "solver = false",
        "solver = true",
        {f"solver.{what}" for what in ("steps", "rejected", "contacts_resolved", "stable_step", "folded_cells")},
        {"solver"},
    ),
    "stiffness of a region": ("[outputs]", '[[region]]\npoints = "z-"\nstiffness = 5.0\n[outputs]', set(), {"region_stiffness"}),
}


def contents(scene, tmp_path, text):
    """Names of the variables and keys of the records of a scene's FMU."""
    with zipfile.ZipFile(package_fmu(scene(text), tmp_path / "scene.fmu")) as archive:
        description = ElementTree.fromstring(archive.read("modelDescription.xml"))
        records = archive.read("resources/scene.txt").decode().splitlines()[1:]
    names = [variable.get("name") for variable in description.iter("ScalarVariable")]
    assert len(names) == len(set(names))
    return set(names), {record.split()[0] for record in records}


def test_a_plain_scene_has_nothing_but_its_own_parameters_and_outputs(scene, tmp_path):
    names, records = contents(scene, tmp_path, PLAIN)
    assert names == ALWAYS | {f"position[0,0,0].{c}" for c in "xyz"}
    assert records - {"reactions"} == ALWAYS_RECORDS - {"reactions"}


@pytest.mark.parametrize("part", PARTS)
def test_each_part_brings_its_own_variables_and_records_and_no_others(scene, tmp_path, part):
    old, new, variables, keys = PARTS[part]
    assert old in PLAIN
    plain, with_part = contents(scene, tmp_path, PLAIN), contents(scene, tmp_path, PLAIN.replace(old, new))
    assert with_part[0] - plain[0] == variables
    assert plain[0] <= with_part[0]
    assert with_part[1] - plain[1] == keys


def test_reactions_that_are_not_wanted_are_absent(scene, tmp_path):
    obstacle_and_pin = '[[plane]]\nname = "q"\n[[pin]]\nname = "a"\npoints = "z+"\n'
    names, records = contents(scene, tmp_path, PLAIN.replace("reactions = true", "reactions = false") + obstacle_and_pin)
    assert not any("reaction" in name or "torque" in name or "contacts" in name for name in names)
    assert "reactions" not in records


def test_energy_without_gravity_has_no_energy_of_gravity(scene, tmp_path):
    with_gravity = PLAIN.replace("energy = false", "energy = true") + "[environment]\ngravity = [0.0, 0.0, -9.81]\n"
    assert "energy.gravity" in contents(scene, tmp_path, with_gravity)[0]
    assert "energy.gravity" not in contents(scene, tmp_path, with_gravity.split("[environment]")[0])[0]
