"""The FMU of FMI 3.0: valid, its arrays those of the library, and its runs the same bits as those of FMI 2.0."""

import zipfile
from ctypes import c_char_p, c_double, c_int64
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from c_host import DISCARD, ERROR, OK, STEP, WARNING, Fmu, check_message
from c_host3 import Fmu3
from scenes import LED, MOVED, box
from signatures import OTHER_TYPES
from softffd import FmuError, Scene, SoftffdError, load_scene, package_fmu, simulate
from softffd.cli.command import main
from softffd.fmu.component import Component
from softffd.lattice import all_points, rest_grid, to_flat, to_grid
from softffd.names import variable_names
from softffd.scene.document import shipped_scenes
from straight_run import BARE, RICH, straight

MIXED = box(
    points=[3, 4, 2],
    stiffness={"edge": 900.0, "face": 450.0, "body": 200.0},
    damping=0.3,
    gravity=[0.1, 0.2, -9.81],
    mass={"total": 2.5},
    plane=[
        {"name": "lid", "point": [0.1, 0.2, 1.3], "normal": [0.1, 0.0, -1.0], "velocity": [0.0, 0.3, 0.4],
         "angular_velocity": [0.5, 0.6, 0.7], "friction": 0.2, "motion": "input", "inputs": ["point.z", "velocity"]},
        {"name": "floor", "point": [0.3, 0.4, -0.5], "normal": [0.0, 0.2, 1.0], "velocity": [0.1, 0.2, -0.3],
         "angular_velocity": [0.4, 0.5, 0.6], "friction": 0.6, **MOVED},
        {"name": "wall", "point": [-1.0, 0.0, 0.0], "normal": [1.0, 0.1, 0.0], "velocity": [-0.1, 0.0, 0.0],
         "angular_velocity": [0.0, 0.1, 0.2], "friction": 0.1},
    ],
    pin=[
        {"name": "arm", "points": [[0, 0, 0]], "motion": "input", "inputs": ["orientation", "position.x"]},
        {"name": "hand", "points": [[2, 3, 1]], **LED},
    ],
    forces=[[2, 0, 1], [0, 1, 1]],
    velocities={"i": [1, 2], "k": [1, 1]},
    load=[{"name": "pull", "points": "x+"}],
    method="leapfrog",
    tolerance=2e-4,
    step=1e-3,
)  # fmt: skip
"""Of every kind, with start values that are none by default"""


@pytest.fixture(scope="module")
def rich(rich3) -> Fmu3:
    return rich3


@pytest.fixture(scope="module")
def mixed(tmp_path_factory) -> Fmu3:
    return Fmu3(MIXED, tmp_path_factory.mktemp("mixed") / "fmi3")


@pytest.mark.short("mixed", "rich", "bare")
@pytest.mark.parametrize("name", [*shipped_scenes(), "rich", "bare", "mixed"])
def test_the_description_is_valid(name, tmp_path):
    scene = {"rich": RICH, "bare": BARE, "mixed": MIXED}.get(name) or load_scene(name)
    assert validate_fmu(str(package_fmu(scene, tmp_path / "it.fmu", fmi=3))) == []


def test_entries_are_where_the_standard_wants_them(rich):
    names = set(zipfile.ZipFile(rich.package).namelist())
    wanted = {"modelDescription.xml", "terminalsAndIcons/icon.png", "documentation/index.html", "resources/scene.txt"}
    assert wanted <= names and "model.png" not in names
    folders = {name.split("/")[1] for name in names if name.startswith("binaries/")}
    assert folders and folders <= {"x86_64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-linux"}


def test_another_standard_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match="fmi: wanted 2 or 3, got 1"):
        package_fmu(BARE, tmp_path / "it.fmu", fmi=1)


def test_control_points_are_one_array_and_vectors_another(mixed):
    shapes = {name: shape for name, shape in mixed.shapes.items() if shape}
    assert shapes["position"] == (3, 4, 2, 3)
    assert shapes["velocity"] == (2, 4, 1, 3)  # the box of the selection
    assert shapes["force"] == (2, 3)  # points as the scene lists them
    assert (
        "(2,0,1), (0,1,1)" in mixed.arrays["force"].description and "i = 1 to 2, j = 0 to 3, k = 1" in mixed.arrays["velocity"].description
    )
    assert shapes["plane.floor.point"] == shapes["load.pull"] == shapes["gravity"] == (3,) and shapes["pin.hand.orientation"] == (4,)


def test_a_pose_that_is_partly_input_is_a_scalar_each(mixed):
    """An array has one causality."""
    of_lid = {name: v.causality for name, v in mixed.arrays.items() if name.startswith("plane.lid.point")}
    assert of_lid == {"plane.lid.point.x": "parameter", "plane.lid.point.y": "parameter", "plane.lid.point.z": "input"}
    assert mixed.arrays["plane.lid.velocity"].causality == "input" and mixed.arrays["plane.lid.normal"].causality == "parameter"


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("scene, count", [(RICH, 56), (MIXED, 85)], ids=["rich", "mixed"])
def test_start_values_of_the_description_are_those_of_the_library(scene, count, fmi, tmp_path):
    with Component(package_fmu(scene, tmp_path / "it.fmu", fmi=fmi)) as component:
        component.set_up()
        described = {name: float(v.start) for name, v in component.by_name.items() if v.causality != "output"}
        assert len(described) == count and described == {name: component.block([name]).get()[0] for name in described}


def test_every_array_has_the_number_of_elements_that_its_dimensions_say(mixed):
    host = mixed.host()
    host.begin()
    for name, variable in mixed.arrays.items():
        host.get(name, kind=variable.type)
    for name, variable in mixed.arrays.items():
        size, room = host.size([name]), c_double if variable.type == "Float64" else c_int64
        for wrong in (size - 1, size + 1):
            assert host(f"Get{variable.type}", *host.references([name]), (room * (size + 1))(), wrong) == ERROR, name
            check_message(host, f"nValues: wanted {size}, one for each element of the variables, got {wrong}")
    host.free()


def test_an_element_is_the_control_point_of_its_indices(mixed):
    host = mixed.host()
    host.begin()
    rest = rest_grid(MIXED.lattice.points, MIXED.lattice_box.origin, MIXED.lattice_box.size)
    np.testing.assert_allclose(host.get("position")["position"], rest, atol=1e-15)  # a unit cube: rounding
    host.free()


def test_time_is_a_variable(rich):
    host = rich.host()
    assert host.enter(start=2.0) == OK
    assert host.get("time")["time"] == 2.0
    host.must("ExitInitializationMode")
    host.must("DoStep", 2.0, 0.25, True)
    assert host.get("time", "mass", "gravity")["time"] == host.last.value == 2.25
    assert [flag.value for flag in host.flags] == [False] * 3
    host.free()


# ---- the same bits ----


@pytest.mark.parametrize("scene", [RICH, BARE, MIXED], ids=["rich", "bare", "mixed"])
def test_what_is_set_at_every_step_leads_to_the_same_bits_in_both_standards(scene, tmp_path):
    two, three = Fmu(scene, tmp_path / "fmi2"), Fmu3(scene, tmp_path / "fmi3")
    two.interpolates = False
    assert straight(three) == straight(two)
    assert straight(three, look=lambda host: host.slopes()) == straight(two, look=lambda host: host.slopes())


@pytest.mark.short("hanging", "press")
@pytest.mark.parametrize("name", shipped_scenes())
def test_a_shipped_scene_runs_with_the_same_bits_in_both_standards(name, tmp_path):
    scene = load_scene(name)
    steps = min(20, round(scene.experiment.stop_time / scene.experiment.communication_step))
    stop = steps * scene.experiment.communication_step
    three = package_fmu(scene, tmp_path / "it.fmu", fmi=3)
    two, three = (simulate(each, stop_time=stop, inputs=scene.default_inputs) for each in (scene, three))
    assert len(two.positions) == steps + 1 and list(three.outputs) == list(two.outputs)
    np.testing.assert_array_equal(three.positions, two.positions)
    for name, column in two.outputs.items():
        np.testing.assert_array_equal(three.outputs[name], column, err_msg=name)


def by_fmpy(scene: Scene, folder: Path, fmi: int, **options) -> np.ndarray:
    """Positions (T, nx, ny, nz, 3) of a run by fmpy's own loop."""
    path, step = package_fmu(scene, folder / f"{fmi}.fmu", fmi=fmi), scene.experiment.communication_step
    names = ["position"] if fmi == 3 else variable_names("position", all_points(scene.lattice.points))
    got = fmpy.simulate_fmu(str(path), stop_time=10 * step, output_interval=step, output=names, **options)
    flat = None if fmi == 3 else np.stack([got[name] for name in names], axis=1).reshape(len(got), -1, 3)
    return np.asarray(got["position"]) if fmi == 3 else to_grid(flat, scene.lattice.points)


@pytest.mark.parametrize("name", ["standard", "press"])
def test_fmpy_runs_it_with_the_same_bits(name, tmp_path):
    two, three = (by_fmpy(load_scene(name), tmp_path, fmi, start_values={"mass": 1.5}) for fmi in (2, 3))
    assert len(three) == 11
    np.testing.assert_array_equal(three, two)


def test_fmpy_drives_an_array_that_is_an_input(tmp_path):
    scene = box(damping=0.1, forces="all")
    force = np.zeros((4, 4, 4, 3))
    force[3, 0, 1] = [0.0, 2.0, -1.0]
    names = variable_names("force", all_points((4, 4, 4)))
    scalars = np.array([(0.0, *to_flat(force).ravel())], dtype=[("time", float), *((name, float) for name in names)])
    whole = np.array([(0.0, force)], dtype=[("time", float), ("force", float, force.shape)])
    two, three = by_fmpy(scene, tmp_path, 2, input=scalars), by_fmpy(scene, tmp_path, 3, input=whole)
    assert abs(three[-1] - three[0]).max() > 1e-3
    np.testing.assert_array_equal(three, two)


# ---- what is particular to the standard ----


def test_a_discarded_step_may_be_tried_again(rich):
    """FMI 3.0 has no state for it: the instance is where it was."""
    host, undisturbed = rich.host(), rich.host()
    for each in (host, undisturbed):
        each.begin()
    assert host.put({"stiffness.edge": [1e19]}) == OK
    assert host("DoStep", 0.0, 1.0, True) == DISCARD and host.last.value == 0.0
    assert host.put({"stiffness.edge": [2e3]}) == OK
    for each in (host, undisturbed):
        each.must("DoStep", 0.0, STEP, True)
    assert host.outputs() == undisturbed.outputs()
    host.free()
    undisturbed.free()


def test_a_folder_without_a_separator_calls_about_no_variables_and_an_unknown_log_category_are_taken(rich):
    host = rich.host(resources=rich.resources.rstrip(b"/"))
    for name in (*OTHER_TYPES, "GetFloat64", "SetFloat64", "GetInt64", "SetInt64"):
        host.must(name, None, 0, None, 0)
    assert not host.messages
    assert host("SetDebugLogging", True, 3, (c_char_p * 3)(b"solver", b"weather", b"logStatusPending")) == WARNING
    wanted, passed_over = host.messages[-1][-1].split(b"wanted categories of ")[1].split(b"; passed over ")
    assert set(wanted.split(b", ")) == rich.categories and passed_over == b"weather, logStatusPending"
    host.free()


@pytest.mark.short("mixed", "flat")
@pytest.mark.parametrize("scene", [RICH, MIXED, MIXED.replace({"fmu.names": "flat"})], ids=["rich", "mixed", "flat"])
def test_the_packages_own_host_finds_the_scalars_of_fmi2_in_it(scene, tmp_path):
    found = {}
    for fmi in (2, 3):
        with Component(package_fmu(scene, tmp_path / f"{fmi}.fmu", fmi=fmi)) as component:
            words = [(v.name, v.reference, v.type, v.causality, v.variability, v.unit, v.items) for v in component.by_name.values()]
            starts = [None if v.start is None else float(v.start) for v in component.by_name.values()]
            found[fmi] = words, starts, component.interface.flat
    assert found[2] == found[3]


def test_the_packages_own_host_refuses_another_programs(rich, tmp_path):
    with zipfile.ZipFile(rich.package) as own, zipfile.ZipFile(tmp_path / "other.fmu", "w") as other:
        other.writestr("modelDescription.xml", own.read("modelDescription.xml"))
    with pytest.raises(FmuError, match=r"other\.fmu: wanted an FMI 2\.0 co-simulation FMU, or one of this package for FMI 3\.0"):
        simulate(tmp_path / "other.fmu")


def test_the_command_builds_it_and_counts_its_variables(tmp_path, capsys):
    assert main(["build", "standard", "--fmi", "3", "-o", str(tmp_path / "it.fmu")]) == 0
    description = fmpy.read_model_description(str(tmp_path / "it.fmu"))
    assert description.fmiVersion == "3.0"
    assert f"  {len(description.modelVariables)} variables, " in capsys.readouterr().out
