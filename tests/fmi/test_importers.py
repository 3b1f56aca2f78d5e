"""Other people's tools on every shipped scene: checkers find nothing, masters get our numbers unwarned."""

import math
import re
import sys
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import Parameter, ParameterSet

from importers import Missing, Run, Tool, drive, ecos, fmutool, libcosim, vdmcheck
from softffd import load_scene, package_fmu, simulate
from softffd.names import parse_name
from softffd.run.inputs import Inputs
from softffd.scene.scene import shipped_scenes

STEP, STEPS = 0.01, 100
START = {"solver.step": 5e-6}
STIFF_START = {"solver.step": 1e-6}
"""s; below what any shipped scene needs. With it a run does not depend on the last bits of a host's clock."""


@dataclass(frozen=True)
class Manners:
    """What a tool prints about a sound FMU: lines that must be there, and the form of harmless others."""

    tool: Callable[[], Tool]
    verdicts: tuple[str, ...]
    notices: str

    def complaints(self, printed: list[str]) -> list[str]:
        others = [line for line in printed if line not in self.verdicts]
        unexpected = [line for line in others if not re.fullmatch(self.notices, line)]
        return unexpected + [f"not said: {verdict}" for verdict in self.verdicts if verdict not in printed]


# FMI 2.0, section 2.3: terminalsAndIcons.xml and buildDescription.xml are optional; it notes their absence.
VDM_NOTICES = (
    r"FMU has no (terminalsAndIcons/terminalsAndIcons|sources/buildDescription)\.xml"
    r"|Checking modelDescription\.xml"
    r"|NOTE: Picked up JDK_JAVA_OPTIONS: .*"
)
CHECKERS = {
    "fmpy": Manners(lambda: Tool((sys.executable, "-m", "fmpy", "validate")), ("No problems found.",), ""),
    "fmutool": Manners(
        fmutool,
        (
            "INFO     | This FMU seems to be compliant with FMI-2.0.",
            "INFO     | No semantic error against the FMI-2 standard.",
        ),
        r"INFO     \| .*",
    ),
    "vdmcheck_static": Manners(lambda: vdmcheck("VDMCheck"), ("No errors found.",), VDM_NOTICES),
    "vdmcheck_rules": Manners(lambda: vdmcheck("VDMCheckPlus"), ("No errors found.",), VDM_NOTICES),
}
LIBCOSIM_NOTICES = r"\[.*\] \[info\] .*"
ECOS_NOTICES = (
    r"\[.*\] \[ecos\] \[debug\] "
    r"(Initializing simulation\.\.|Parameterset 'start' applied to 1 instances|Initialized\."
    r"|Terminating simulation\.\.|Terminated\.)"
)
MASTERS = {"libcosim": Manners(libcosim, (), LIBCOSIM_NOTICES), "ecos": Manners(ecos, (), ECOS_NOTICES)}


@pytest.fixture(scope="session", params=CHECKERS)
def checker(request) -> tuple[str, Tool]:
    return request.param, present(CHECKERS[request.param])


@pytest.fixture(scope="session", params=MASTERS)
def master(request) -> tuple[str, Tool]:
    return request.param, present(MASTERS[request.param])


def present(manners: Manners) -> Tool:
    try:
        return manners.tool()
    except Missing as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="session")
def fmus(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("shipped")
    return {name: package_fmu(load_scene(name), folder / f"{name}.fmu") for name in shipped_scenes()}


def check(name: str, tool: Tool, fmu: Path) -> list[str]:
    arguments = ("-input", fmu, "-check") if name == "fmutool" else (fmu,)
    return CHECKERS[name].complaints(tool.run(*arguments))


def driving(scene: str) -> Callable[[float], dict[str, float]] | Path | None:
    """The inputs over time that a scene is run with: its own, or what sets the plain component going."""
    if scene == "standard":
        return lambda time: {"force[3,3,3].z": push(time)}
    course = load_scene(scene).path.with_suffix(".csv")
    return course if course.is_file() else None


def push(time: float) -> float:
    return 5.0 * math.sin(10.0 * time)


def courses(source) -> dict[str, list[float]]:
    """The values of driven inputs at each communication point."""
    inputs = Inputs(source)
    rows = np.array([inputs.values(step * STEP, (step + 1) * STEP) for step in range(STEPS)])
    names = [*inputs.names, *inputs.derived_names]
    return {name: rows[:, number].tolist() for number, name in enumerate(names)}


def outputs(fmu: Path, kind: str) -> list[str]:
    variables = fmpy.read_model_description(str(fmu), validate=False).modelVariables
    return [v.name for v in variables if v.causality == "output" and v.type == kind]


def start_values(fmu: Path) -> dict[str, float]:
    """An internal step that every part of the run takes as it is."""
    return STIFF_START if fmu.stem == "stiff_bounce" else START


def ours(fmu: Path, names: list[str], inputs=None) -> np.ndarray:
    """(STEPS, len(names)): outputs after each step, as softffd.simulate gives them."""
    result = simulate(fmu, stop_time=STEPS * STEP, step=STEP, start_values=start_values(fmu), inputs=inputs)
    assert result.summary["warnings"] == []
    return np.array([column(result, name)[1:] for name in names]).reshape(len(names), STEPS).T


def column(result, name: str) -> np.ndarray:
    found = parse_name(name)
    if found is None or found.family != "position":
        return result.outputs[name]
    i, j, k = found.instance
    return result.positions[:, i, j, k, "xyz".index(found.component)]


def agree(names: list[str], theirs, expected: np.ndarray) -> None:
    """Bitwise, but for reactions: impulses over the step's length, which may be a difference of two times."""
    means = np.array([bool(re.search(r"\.(reaction|torque)\.", name)) for name in names], dtype=bool)
    theirs = np.reshape(theirs, expected.shape)
    np.testing.assert_array_equal(theirs[:, ~means], expected[:, ~means])
    np.testing.assert_allclose(theirs[:, means], expected[:, means], rtol=STEPS * 2.0**-52, atol=0.0)


def with_description(fmu: Path, path: Path, pattern: str, replacement: str) -> Path:
    """A copy of an FMU in whose modelDescription.xml the first match of the pattern is replaced."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(path, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                content, count = re.subn(pattern.encode(), replacement.encode(), content, count=1)
                assert count == 1
            copy.writestr(name, content)
    return path


@pytest.mark.short("fmpy-standard", "fmpy-press")
@pytest.mark.parametrize("scene", shipped_scenes())
def test_checkers_find_nothing(checker, fmus, scene):
    assert check(*checker, fmus[scene]) == []


@pytest.mark.short("fmpy")
def test_checkers_find_a_missing_start_value(checker, fmus, tmp_path):
    start_of_mass = r'(name="mass"[^>]*>\s*<Real[^>]*) start="[^"]*"'
    damaged = with_description(fmus["spin"], tmp_path / "damaged.fmu", start_of_mass, r"\1")
    assert any("mass" in line for line in check(*checker, damaged))


@pytest.mark.full
@pytest.mark.parametrize("scene", shipped_scenes())
def test_masters_get_our_numbers_without_a_warning(master, fmus, scene, tmp_path):
    name, tool = master
    fmu, source = fmus[scene], driving(scene)
    run = Run(str(fmu), STEP, STEPS, start_values(fmu), courses(source), outputs(fmu, "Real"), outputs(fmu, "Integer"))
    printed, rows = drive(tool, run, tmp_path)
    assert MASTERS[name].complaints(printed) == []
    agree(run.outputs, rows["outputs"], ours(fmu, run.outputs, source))
    agree(run.counts, rows["counts"], ours(fmu, run.counts, source))


@pytest.mark.full
def test_masters_show_what_the_fmu_refuses(master, fmus, tmp_path):
    name, tool = master
    foreign = with_description(fmus["spin"], tmp_path / "foreign.fmu", r'guid="\{[^}]*\}', 'guid="{no}')
    printed, _ = drive(tool, Run(str(foreign), STEP, 1, {}, {}, [], []), tmp_path)
    assert any("fmuGUID: wanted {" in line for line in MASTERS[name].complaints(printed))


@pytest.mark.full
@pytest.mark.parametrize("scene", shipped_scenes())
def test_a_checker_finds_nothing_in_fmi3(scene, tmp_path):
    fmu = package_fmu(load_scene(scene), tmp_path / "it.fmu", fmi=3)
    verdicts = ("INFO     | This FMU seems to be compliant with FMI-3.0.", "INFO     | No semantic error against the FMI-3 standard.")
    manners = Manners(fmutool, verdicts, r"INFO     \| .*")
    assert manners.complaints(present(manners).run("-input", fmu, "-check")) == []


@pytest.mark.full
@pytest.mark.parametrize("scene", ["spin", "free_vibration"])
def test_a_master_gets_our_numbers_from_fmi3(fmus, scene, tmp_path):
    """Ecos knows scalars only: energies."""
    manners = Manners(ecos, ("Loading FMI version 3...",), rf'{ECOS_NOTICES}|Function "fmi3GetVersion" is not provided by this FMU\.')
    tool, watched = present(manners), load_scene(scene).replace({"outputs.energy": True})
    names = [f"energy.{kind}" for kind in ("kinetic", "elastic", "work")]
    fmu, same = (package_fmu(watched, tmp_path / f"{fmi}.fmu", fmi=fmi) for fmi in (3, 2))
    printed, rows = drive(tool, Run(str(fmu), STEP, STEPS, START, {}, names, []), tmp_path)
    assert manners.complaints(printed) == []
    expected = ours(same, names)
    assert np.ptp(expected[:, 0]) > 0
    agree(names, rows["outputs"], expected)


@pytest.mark.short("standard", "press", "spin")
@pytest.mark.parametrize("scene", shipped_scenes())
def test_fmpy_gets_our_numbers_without_a_warning(fmus, scene):
    fmu, names, messages = fmus[scene], outputs(fmus[scene], "Real"), []
    theirs = fmpy.simulate_fmu(
        str(fmu),
        stop_time=STEPS * STEP,
        step_size=STEP,
        output_interval=STEP,
        start_values=start_values(fmu),
        output=names,
        debug_logging=True,
        logger=lambda _environment, _instance, status, _category, message: messages.append((status, message)),
    )
    assert [message for status, message in messages if status > 0] == []
    agree(names, np.array([theirs[name][1:] for name in names]).T, ours(fmu, names))


SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0" name="one">
  <ssd:System name="one">
    <ssd:Connectors>
      <ssd:Connector name="push" kind="input"><ssc:Real unit="N"/></ssd:Connector>
      <ssd:Connector name="corner" kind="output"><ssc:Real unit="m"/></ssd:Connector>
    </ssd:Connectors>
    <ssd:Elements>
      <ssd:Component name="body" type="application/x-fmu-sharedlibrary" source="resources/standard.fmu">
        <ssd:Connectors>
          <ssd:Connector name="force[3,3,3].z" kind="input"><ssc:Real unit="N"/></ssd:Connector>
          <ssd:Connector name="position[3,3,3].z" kind="output"><ssc:Real unit="m"/></ssd:Connector>
          <ssd:Connector name="plane.upper.contacts" kind="output"><ssc:Integer/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startConnector="push" endElement="body" endConnector="force[3,3,3].z"/>
      <ssd:Connection startElement="body" startConnector="position[3,3,3].z" endConnector="corner"/>
    </ssd:Connections>
  </ssd:System>
</ssd:SystemStructureDescription>
"""


def test_an_ssp_of_one_component_gets_our_numbers_without_a_word(fmus, tmp_path, capfd):
    with zipfile.ZipFile(tmp_path / "one.ssp", "w") as archive:
        archive.writestr("SystemStructure.ssd", SYSTEM)
        archive.write(fmus["standard"], "resources/standard.fmu")
    start = [Parameter(name=f"body.{name}", value=value) for name, value in START.items()]
    theirs = simulate_ssp(
        str(tmp_path / "one.ssp"),
        stop_time=(STEPS - 0.5) * STEP,  # its clock is a sum of steps and misses multiples of STEP
        step_size=STEP,
        parameter_set=ParameterSet(parameters=start),
        input={"push": push},
    )
    assert capfd.readouterr() == ("", "")
    delayed = [0.0, *map(push, theirs["time"][:-1])]  # fmpy.ssp hands a connection's value on after the step

    def inputs(time: float) -> dict[str, float]:
        return {"force[3,3,3].z": delayed[min(round(time / STEP), STEPS - 1)]}

    expected = ours(fmus["standard"], ["position[3,3,3].z"], inputs)[:, 0]
    np.testing.assert_array_equal(theirs["body.position[3,3,3].z"], expected)
    assert np.ptp(expected) > 1e-3
