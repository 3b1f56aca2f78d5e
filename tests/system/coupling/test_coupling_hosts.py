"""The plate on the body as a system structure, in other people's masters."""

import json
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp

import importers
from coupled_parts import PLANE, body_fmu, run_explicitly
from scenes import box
from softffd import SoftffdError, package_fmu
from softffd.drivers import build_driver
from softffd.drivers.coupled import write_ssp

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
    simulation.init()
    for _ in range(steps):
        simulation.step()
        rows.append([simulation.get_real(f"{p}::{name}") for p, name in wanted])
    simulation.terminate()
json.dump(rows, open(result, "w"))
"""


@pytest.fixture(scope="module")
def ssp(drivers) -> Path:
    return write_ssp(drivers / "coupled.ssp")


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


def in_master(name: str, script: str, ssp: Path, wanted, result: Path) -> np.ndarray:
    """(STEPS, len(wanted)): what is wanted of the parts after every step in a master that may be missing."""
    try:
        tool = getattr(importers, name)()
    except importers.Missing as missing:
        pytest.skip(str(missing))
    master = importers.Tool((tool.command[0], "-I", "-c", script), tool.environment)
    printed = master.run(ssp, str(STEP), str(STEPS), json.dumps(wanted), result)
    assert result.is_file(), "\n".join(printed)
    return np.array(json.loads(result.read_text()))


def test_a_plane_that_is_none_of_the_scenes_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match=r'wanted one with motion = "input" \(plate\), got ground'):
        write_ssp(tmp_path / "x.ssp", plane="ground")
    with pytest.raises(SoftffdError, match="there is none"):
        write_ssp(tmp_path / "x.ssp", "free_vibration")


SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0" name="scaled">
  <ssd:System name="scaled">
    <ssd:Elements>
      <ssd:Component name="actuator" type="application/x-fmu-sharedlibrary" source="resources/actuator.fmu">
        <ssd:Connectors><ssd:Connector name="position.z" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>
      </ssd:Component>
      <ssd:Component name="body" type="application/x-fmu-sharedlibrary" source="resources/body.fmu">
        <ssd:Connectors><ssd:Connector name="plane.plate.point.z" kind="input"><ssc:Real/></ssd:Connector></ssd:Connectors>
      </ssd:Component>
    </ssd:Elements>
    <ssd:Connections>{connection}</ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment startTime="0.0" stopTime="1.0"/>
</ssd:SystemStructureDescription>
"""


LID = {"name": "plate", "point": [0, 0, 1.2], "normal": [0, 0, -1], "motion": "input"}


@pytest.mark.full
@pytest.mark.parametrize("name, script, late", [("libcosim", LIBCOSIM, 1), ("ecos", ECOS, 0)])
def test_a_connection_of_the_document_takes_another_unit(name, script, late, tmp_path):
    """The connection of docs/coupling.md: travel in millimetres downwards is the plate's height in metres.
    late: whether the master hands values over at the begin of the next step, after they are read here."""
    document = Path(__file__).resolve().parents[3] / "docs" / "coupling.md"
    connection = re.search(r"```xml\n(.*?)```", document.read_text(), re.DOTALL)[1]
    start = {"travel": (0.0, 0.0, 100.0), "duration": 1.0}
    files = {
        "actuator": build_driver("actuator", tmp_path, start_values=start),
        "body": package_fmu(
            box(plane=[{"name": "plate", "point": [0, 0, 1.2], "normal": [0, 0, -1], "motion": "input"}]), tmp_path / "b.fmu"
        ),
    }
    with zipfile.ZipFile(tmp_path / "scaled.ssp", "w") as archive:
        archive.writestr("SystemStructure.ssd", SYSTEM.format(connection=connection))
        for part, file in files.items():
            archive.write(file, f"resources/{part}.fmu")
    wanted = [("actuator", "position.z"), ("body", "plane.plate.point.z")]
    travel, height = in_master(name, script, tmp_path / "scaled.ssp", wanted, tmp_path / "rows.json").T
    assert np.ptp(travel) > 50
    np.testing.assert_allclose(height[late:], 1.2 - 0.001 * travel[: STEPS - late], rtol=1e-12)
