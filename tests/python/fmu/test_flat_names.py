"""fmu.names = "flat": the same component under names of letters, digits and underscores, and runs that take either form."""

import csv
import re

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv

from scenes import box
from softffd import FmuError, SceneError, Simulation, package_fmu, simulate
from softffd.cli.command import main

PARTS = {
    "plane": [{"name": "position_0_0_0"}, {"name": "lid", "point": [0, 0, 3], "normal": [0, 0, -1], "motion": "input"}],
    "pin": [{"name": "x", "points": [[0, 0, 0]], "motion": "input"}],
    "load": [{"name": "force_1_1_1", "points": "x+"}],
    "probe": [{"name": "_0_0_0", "at": [0.5, 0.5, 0.5]}],
}
STEP, STOP = 0.01, 0.1
FORCE, PLAIN_FORCE = "force[2,1,0].y", "force_2_1_0_y"


def scene(names="flat", **keys):
    return box(points=[3, 3, 3], forces="all", velocities="all", fmu={"names": names}, **PARTS, **keys)


@pytest.fixture(scope="module")
def descriptions(tmp_path_factory):
    folder = tmp_path_factory.mktemp("names")
    paths = {names: package_fmu(scene(names), folder / f"{names}.fmu") for names in ("structured", "flat")}
    return {names: (path, fmpy.read_model_description(str(path))) for names, path in paths.items()}


def test_flat_names_are_identifiers_and_stand_for_the_same_references(descriptions):
    structured, flat = ({v.valueReference: v.name for v in description.modelVariables} for _, description in descriptions.values())
    assert all(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) for name in flat.values())
    assert len(set(flat.values())) == len(flat)
    assert flat == {reference: re.sub(r"[.\[,]", "_", name).replace("]", "") for reference, name in structured.items()}
    assert any("[" in name for name in structured.values())
    assert [description.variableNamingConvention for _, description in descriptions.values()] == ["structured", "flat"]


def test_fmpys_reader_of_csv_files_drives_flat_names(descriptions, tmp_path):
    """Its own reader splits quoted names at their commas and loses the input without a word."""
    path, _ = descriptions["flat"]
    (tmp_path / "in.csv").write_text(f"time,{PLAIN_FORCE}\n0,5\n1,5\n")
    start = {"solver_step": 1e-4}  # a run does not depend on the last bits of a host's clock
    theirs = fmpy.simulate_fmu(
        str(path), stop_time=STOP, step_size=STEP, output_interval=STEP, start_values=start, input=read_csv(tmp_path / "in.csv"),
        output=["velocity_2_1_0_y"],
    )  # fmt: skip
    ours = simulate(path, stop_time=STOP, step=STEP, start_values=start, inputs=lambda t: {FORCE: 5.0})
    np.testing.assert_array_equal(theirs["velocity_2_1_0_y"], ours.outputs["velocity_2_1_0_y"])
    assert theirs["velocity_2_1_0_y"][-1] > 0.1


@pytest.mark.parametrize("names", ["structured", "flat"])
@pytest.mark.parametrize("header", [f'"{FORCE}"', PLAIN_FORCE])
def test_files_of_either_form_drive_either_fmu(descriptions, tmp_path, names, header):
    (tmp_path / "in.csv").write_text(f"time,{header},plane.lid.point.z\n0,5,3\n0.1,2,2.9\n")
    result = simulate(descriptions[names][0], stop_time=STOP, step=STEP, inputs=tmp_path / "in.csv", interpolation="cubic")
    rows = np.array([(0.0, 5.0, 3.0), (0.1, 2.0, 2.9)], dtype=[(name, float) for name in ("time", FORCE, "plane.lid.point.z")])
    expected = simulate(scene("structured"), stop_time=STOP, step=STEP, inputs=rows, interpolation="cubic")
    np.testing.assert_array_equal(result.positions, expected.positions)
    follows = "plane.lid.velocity.z"
    np.testing.assert_array_equal(result.inputs[follows], expected.inputs[follows])
    assert result.inputs[follows].min() < -0.5
    assert np.ptp(result.outputs["velocity[2,1,0].y"]) > 0.1
    assert list(result.inputs["force_2_1_0_y"]) == list(result.inputs[FORCE]) != [0.0] * 11


def test_one_variable_under_both_names_is_refused(tmp_path):
    (tmp_path / "in.csv").write_text(f'time,{PLAIN_FORCE},"{FORCE}"\n0,5,5\n')
    with pytest.raises(FmuError, match=r"force\[2,1,0\].y: wanted each variable once, got force_2_1_0_y too"):
        simulate(scene(), stop_time=STOP, inputs=tmp_path / "in.csv")


def test_parts_whose_flat_names_mean_another_are_refused():
    clash = 'wanted another name beside fmu.names = "flat", got "a_angular": its plane.a_angular.velocity.x would be '
    with pytest.raises(SceneError, match=re.escape(clash + "plane_a_angular_velocity_x, which is plane.a.angular_velocity.x")):
        box(plane=[{"name": "a_angular"}], fmu={"names": "flat"})
    box(plane=[{"name": "a_angular"}])


def test_a_running_component_answers_to_either_form():
    with Simulation(scene(), start_values={FORCE: 1.0}) as simulation:
        assert simulation[PLAIN_FORCE] == simulation[FORCE] == simulation.force[2, 1, 0][1] == 1.0
        simulation.force[2, 1, 0] = (0.0, 4.0, 0.0)
        simulation[PLAIN_FORCE] = 5.0
        simulation.step(STEP)
        assert simulation.forces[2, 1, 0, 1] == 5.0 and simulation.forces.sum() == 5.0
        simulation["plane_lid_point"] = (0.0, 0.0, 2.9)
        assert list(simulation["plane.lid.point"]) == list(simulation.obstacle["lid"].point) == [0.0, 0.0, 2.9]
        assert simulation["velocity_2_1_0_y"] == simulation["velocity[2,1,0]"][1] == simulation.velocities[2, 1, 0, 1] > 0
        with pytest.raises(FmuError, match=re.escape("position_0_0_0_x: wanted an input or a parameter")):
            simulation["position[0,0,0].x"] = 1.0
        reference = simulation.variables["position_1_2_0_x"].reference
        block = simulation.block(["mass"])
        block.references[0] = reference
        with pytest.raises(FmuError, match=re.escape("position_1_2_0_x: cannot be set (it is an output)")):
            block.set([1.0])  # the library's own words


def test_files_of_a_run_have_the_names_of_its_fmu(tmp_path):
    result = simulate(scene(), stop_time=STOP)
    result.save(tmp_path)
    with (tmp_path / "result.csv").open() as stream:
        header = stream.readline().strip()
    assert '"' not in header and header.split(",") == next(csv.reader([header]))
    assert {"position_2_2_2_z", "velocity_0_1_2_x"} <= set(header.split(","))
    assert "velocity_0_1_2_x" in np.load(tmp_path / "result.npz")


def test_many_variables_are_warned_of_with_the_keys_that_make_them(tmp_path, capsys):
    text = "[lattice]\npoints = [16, 16, 16]\n[outputs]\npositions = {}\nvelocities = {}\n"
    for name, selections in {"many": ('"all"', '"all"'), "few": ('"all"', '"none"')}.items():
        (tmp_path / f"{name}.toml").write_text(text.format(*selections))
        assert main(["build", str(tmp_path / f"{name}.toml"), "-o", str(tmp_path / f"{name}.fmu")]) == 0
        warned = "24584 variables, of which outputs.velocities makes 12288, outputs.positions makes 12288" in capsys.readouterr().out
        assert warned == (name == "many")
