"""The plate on the body as a system structure, in other people's masters."""

import io
import json
import re
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv

import importers
from coupled_parts import PLANE, body_fmu, run_explicitly
from scenes import meshed
from softffd import SoftffdError, load_scene, simulate, write_ssp
from softffd.cli.command import main
from softffd.drivers.coupled import write_plate_ssp
from validation import shapes as bodies

READ_BACK = ("plate", "point.z"), ("plate", "velocity.z"), ("body", PLANE + "reaction.z"), ("body", "probe.middle.z")
STEP, STEPS = 1e-3, 200

LIBCOSIM = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
path, step, steps, wanted, result = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), json.loads(sys.argv[4]), sys.argv[5]
execution = CosimExecution.from_ssp_file(path, round(step * 1e9))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
parts = {part: execution.slave_index_from_instance_name(part) for part, _ in wanted}
references = {p: {v.name.decode(): v.reference for v in execution.slave_variables(i)} for p, i in parts.items()}
rows = []
for _ in range(steps):
    assert execution.step()
    rows.append([observer.last_real_values(parts[p], [references[p][name]])[0] for p, name in wanted])
json.dump(rows, open(result, "w"))
"""
ECOS = """
import ctypes, json, sys
from pathlib import Path
for library in Path(sys.prefix).glob("lib*/libtbb.so.12"):
    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
from ecospy import EcosLib, EcosSimulation
path, step, steps, wanted, result = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), json.loads(sys.argv[4]), sys.argv[5]
EcosLib.set_log_level("debug")
rows = []
with EcosSimulation(ssp_path=path, step_size=step) as simulation:
    simulation.init(parameter_set=sys.argv[6] if len(sys.argv) > 6 else None)
    for _ in range(steps):
        simulation.step()
        rows.append([simulation.get_real(f"{p}::{name}") for p, name in wanted])
    simulation.terminate()
json.dump(rows, open(result, "w"))
"""


@pytest.fixture(scope="module")
def ssp(drivers) -> Path:
    return write_plate_ssp(drivers / "coupled.ssp")


@pytest.fixture(scope="module")
def in_fmpy(ssp) -> np.ndarray:
    """The rows of READ_BACK after every step, the probe (which is no connector) left out."""
    rows = simulate_ssp(str(ssp), stop_time=STEPS * STEP - 0.5 * STEP, step_size=STEP)
    return np.stack([rows[f"{part}.{name}"] for part, name in READ_BACK[:3]], axis=1)


def test_the_system_runs_in_fmpy_as_in_our_own_loop(drivers, in_fmpy):
    run = run_explicitly(drivers, body_fmu(drivers), STEP, STEPS)
    np.testing.assert_allclose(in_fmpy[:, 2], run.column(5), rtol=1e-9, atol=1e-9)  # times are summed up there: the last bits differ
    assert in_fmpy[:, 2].max() > 90 and -0.005 < in_fmpy[:, 0].min() < -0.003  # the plate of 49 N swings about its place of rest


@pytest.mark.full
@pytest.mark.parametrize("name, script", [("libcosim", LIBCOSIM), ("ecos", ECOS)])
def test_the_system_runs_elsewhere_as_in_fmpy(name, script, ssp, in_fmpy, tmp_path):
    rows = in_master(name, script, ssp, READ_BACK, tmp_path / "rows.json")
    np.testing.assert_allclose(rows[:, :3], in_fmpy, rtol=1e-9, atol=1e-9)
    assert -0.51 < rows[-1, 3] < -0.5


def in_master(name: str, script: str, ssp: Path, wanted, result: Path, *more: str) -> np.ndarray:
    """(STEPS, len(wanted)): what is wanted of the parts after every step in a master that may be missing."""
    try:
        tool = getattr(importers, name)()
    except importers.Missing as missing:
        pytest.skip(str(missing))
    master = importers.Tool((tool.command[0], "-I", "-c", script), tool.environment)
    printed = master.run(ssp, str(STEP), str(STEPS), json.dumps(wanted), result, *more)
    assert result.is_file(), "\n".join(printed)
    return np.array(json.loads(result.read_text()))


def test_a_plane_that_is_none_of_the_scenes_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match=r'wanted one with motion = "input" \(plate\), got ground'):
        write_plate_ssp(tmp_path / "x.ssp", plane="ground")
    with pytest.raises(SoftffdError, match="there is none"):
        write_plate_ssp(tmp_path / "x.ssp", "free_vibration")


def test_a_solid_moves_with_the_plate(tmp_path):
    ram = {"name": "ram", "size": [1.0, 1.0, 0.2], "point": [0.5, 0.5, 1.2], "motion": "input"}
    path = write_plate_ssp(tmp_path / "ram.ssp", meshed(tmp_path, bodies.sphere(1), reactions=True, box=[ram]), plate={"mass": 2.0})
    with zipfile.ZipFile(path) as system:
        ends = re.findall(r'startConnector="([^"]*)"[^>]*endConnector="([^"]*)"', system.read("SystemStructure.ssd").decode())
        plate = next(name for name in system.namelist() if name.endswith("plate.fmu"))
        with zipfile.ZipFile(io.BytesIO(system.read(plate))) as fmu:
            description = fmu.read("modelDescription.xml").decode()
    assert all(pair in [set(each) for each in ends] for name in ("point.x", "reaction.z") for pair in [{name, f"box.ram.{name}"}])
    assert re.search(r'name="initial.point.z"[^>]*>\s*<Real[^>]*start="1.2"', description)


LOW_BOX = """
[lattice]
origin = [0.0, 0.0, -1.0]
[[plane]]
name = "plate"
normal = [0.0, 0.0, -1.0]
motion = "input"
[[load]]
name = "push"
points = "x+"
[solver]
step = 1e-4
"""


@pytest.mark.full
@pytest.mark.parametrize("name, script, late", [("libcosim", LIBCOSIM, 1), ("ecos", ECOS, 0)])
def test_a_connection_of_the_document_takes_another_unit(name, script, late, drivers, tmp_path, monkeypatch):
    """The connection of docs/coupling.md: travel in millimetres downwards is the plate's height in metres.
    late: whether the master hands values over at the begin of the next step, after they are read here."""
    document = Path(__file__).resolve().parents[3] / "docs" / "coupling.md"
    command = re.search(r"^softffd (ssp box.toml --with actuator.fmu .*)$", document.read_text().replace("\\\n", " "), re.MULTILINE)[1]
    monkeypatch.chdir(tmp_path)
    Path("box.toml").write_text(LOW_BOX)
    shutil.copy(drivers / "actuator.fmu", ".")
    assert main([*command.split(), "--set", "actuator.duration=1"]) == 0
    wanted = [("actuator", "position.z"), ("box", "plane.plate.point.z")]
    travel, height = in_master(name, script, Path("millimetres.ssp").resolve(), wanted, tmp_path / "rows.json", "start").T
    assert np.ptp(travel) > 50
    np.testing.assert_allclose(height[late:], 0.1 - 0.001 * travel[: STEPS - late], rtol=1e-12)


PLATE_POINT = "plane.plate.point.x"
"""Of a plate without friction: where it is in its own plane says nothing to the box, and a host that it was told."""
TIPS = [("one", "position[3,3,3].x"), ("two", "position[3,3,3].x")]


@pytest.fixture
def three(drivers, tmp_path) -> Path:
    """A system of two soft boxes that hear of each other, and an actuator that pushes both; one box has another mass at the start."""
    (tmp_path / "box.toml").write_text(LOW_BOX)
    components = {"one": tmp_path / "box.toml", "two": load_scene(tmp_path / "box.toml"), "actuator": drivers / "actuator.fmu"}
    pushes = [("actuator.force", "one.load.push"), ("two.load.push", "actuator.force")]
    heard = [(f"one.{TIPS[0][1]}", f"two.{PLATE_POINT}"), (f"two.{TIPS[1][1]}", f"one.{PLATE_POINT}")]
    starts = {"two.mass": 4.0, "actuator.load": (40.0, 0.0, 0.0), "actuator.course": 1, "actuator.duration": 0.5}
    return write_ssp(tmp_path / "three.ssp", components, pushes + heard, start_values=starts)


@pytest.mark.parametrize(
    "name, script",
    [("fmpy", ""), pytest.param("libcosim", LIBCOSIM, marks=pytest.mark.full), pytest.param("ecos", ECOS, marks=pytest.mark.full)],
)
def test_a_system_of_three_starts_and_runs_as_its_parts_do_alone(name, script, three, tmp_path):
    wanted = [*TIPS, ("actuator", "force.x"), ("one", PLATE_POINT)]
    if script:
        rows = in_master(name, script, three, wanted, tmp_path / "rows.json", "start")
    else:
        start = read_ssv(str(three), "resources/start.ssv")
        table = simulate_ssp(str(three), stop_time=(STEPS - 0.5) * STEP, step_size=STEP, parameter_set=start)
        rows = np.stack([table[f"{part}.{variable}"] for part, variable in wanted], axis=1)
    forces = [0.0, *rows[:, 2]]  # what a step begins with
    box = load_scene(tmp_path / "box.toml")
    for mass, tip in ((1.0, rows[:, 0]), (4.0, rows[:, 1])):
        alone = simulate(
            box, stop_time=STEPS * STEP, step=STEP, start_values={"mass": mass},
            inputs=lambda time: {"load.push.x": forces[round(time / STEP)]},
        )  # fmt: skip
        np.testing.assert_allclose(tip, alone.positions[1:, 3, 3, 3, 0], rtol=0, atol=1e-7)  # the force of the start is 5e-4 N in two hosts
        assert np.ptp(tip) > 0.01
    assert set(rows[2:, 3]) <= set(rows[:, 1]) and np.ptp(rows[2:, 3]) > 0.01
