"""Other people's tools on every shipped scene: checkers find nothing, importers get our numbers unwarned."""

import math
import re
import sys
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import Parameter, ParameterSet

from importer_runs import ECOS_NOTICES, FMPY, IMPORTERS, START, STEP, STEPS, cells, compared, ours, outcome
from importers import Missing, Run, Tool, drive, ecos, fmutool, vdmcheck
from softffd import load_scene, package_fmu
from softffd.scene.document import shipped_scenes

pytestmark = pytest.mark.usefixtures("as_shipped")

PAGE = Path(__file__).resolve().parents[2] / "docs" / "importers.md"


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
    r"|Checking (modelDescription|terminalsAndIcons/terminalsAndIcons)\.xml"
    r"|NOTE: Picked up JDK_JAVA_OPTIONS: .*"
)
CHECKERS = {
    "fmpy": Manners(lambda: Tool((sys.executable, "-m", "fmpy", "validate")), ("No problems found.",), ""),
    "fmutool": Manners(
        fmutool,
        ("INFO     | This FMU seems to be compliant with FMI-2.0.", "INFO     | No semantic error against the FMI-2 standard."),
        r"INFO     \| .*",
    ),
    "vdmcheck_static": Manners(lambda: vdmcheck("VDMCheck"), ("No errors found.",), VDM_NOTICES),
    "vdmcheck_rules": Manners(lambda: vdmcheck("VDMCheckPlus"), ("No errors found.",), VDM_NOTICES),
}


@pytest.fixture(scope="session", params=CHECKERS)
def checker(request) -> tuple[str, Tool]:
    return request.param, present(CHECKERS[request.param].tool)


@pytest.fixture(params=IMPORTERS)
def importer(request) -> str:
    """Its name, where it can be had."""
    present(IMPORTERS[request.param].tool)
    return request.param


def present(tool: Callable[[], Tool]) -> Tool:
    try:
        return tool()
    except Missing as reason:
        pytest.skip(str(reason))


class Shipped(dict[str, Path]):
    """The FMUs of shipped scenes, each made when it is first asked for."""

    def __init__(self, folder: Path):
        self.folder = folder

    def __missing__(self, name: str) -> Path:
        self[name] = package_fmu(load_scene(name), self.folder / f"{name}.fmu")
        return self[name]


@pytest.fixture(scope="session")
def fmus(tmp_path_factory) -> Shipped:
    return Shipped(tmp_path_factory.mktemp("shipped"))


def check(name: str, tool: Tool, fmu: Path) -> list[str]:
    arguments = ("-input", fmu, "-check") if name == "fmutool" else (fmu,)
    return CHECKERS[name].complaints(tool.run(*arguments))


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


@pytest.mark.short("fmpy-press")
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
def test_importers_do_what_their_page_says_without_a_warning(importer, scene):
    said, printed = outcome(importer, scene)
    assert said == cells(PAGE.read_text())[importer, scene]
    assert not said.startswith("no")
    assert complaints(importer, printed) == []


def complaints(importer: str, printed: list[str]) -> list[str]:
    return [line for line in printed if not re.fullmatch(IMPORTERS[importer].notices, line)]


def test_the_page_says_of_every_importer_and_scene_that_the_bits_are_ours():
    """But for reactions: impulses over the step's length, which may be a difference of two times."""
    said = cells(PAGE.read_text())
    assert set(said) == {(name, scene) for name in (FMPY, *IMPORTERS) for scene in shipped_scenes()}
    others = {cell for cell in said.values() if cell != "same bits"}
    assert all(cell.startswith("reactions ") and float(cell.removeprefix("reactions ")) <= STEPS * 2.0**-52 for cell in others)


@pytest.mark.full
def test_importers_show_what_the_fmu_refuses(importer, fmus, tmp_path):
    foreign = with_description(fmus["spin"], tmp_path / "foreign.fmu", r'guid="\{[^}]*\}', 'guid="{no}')
    printed, _ = drive(IMPORTERS[importer].tool(), Run(str(foreign), STEP, 1, {}, {}, ["mass"], []), tmp_path)
    assert any("fmuGUID: wanted {" in line for line in complaints(importer, printed)), printed


@pytest.mark.full
@pytest.mark.parametrize("scene", shipped_scenes())
def test_a_checker_finds_nothing_in_fmi3(scene, tmp_path):
    fmu = package_fmu(load_scene(scene), tmp_path / "it.fmu", fmi=3)
    verdicts = ("INFO     | This FMU seems to be compliant with FMI-3.0.", "INFO     | No semantic error against the FMI-3 standard.")
    manners = Manners(fmutool, verdicts, r"INFO     \| .*")
    assert manners.complaints(present(fmutool).run("-input", fmu, "-check")) == []


@pytest.mark.full
@pytest.mark.parametrize("scene", ["spin", "free_vibration"])
def test_a_master_gets_our_numbers_from_fmi3(fmus, scene, tmp_path):
    """Ecos knows scalars only: energies."""
    manners = Manners(ecos, ("Loading FMI version 3...",), rf'{ECOS_NOTICES}|Function "fmi3GetVersion" is not provided by this FMU\.')
    tool, watched = present(ecos), load_scene(scene).replace({"outputs.energy": True})
    names = [f"energy.{kind}" for kind in ("kinetic", "elastic", "work")]
    fmu, same = (package_fmu(watched, tmp_path / f"{fmi}.fmu", fmi=fmi) for fmi in (3, 2))
    printed, rows = drive(tool, Run(str(fmu), STEP, STEPS, START, {}, names, []), tmp_path)
    assert manners.complaints(printed) == []
    expected = ours(same, names)
    assert np.ptp(expected[:, 0]) > 0
    np.testing.assert_array_equal(rows["outputs"], expected)


@pytest.mark.short("standard")
@pytest.mark.parametrize("scene", shipped_scenes())
def test_fmpy_does_what_the_page_says_without_a_warning(scene):
    said, messages = outcome(FMPY, scene)
    assert said == cells(PAGE.read_text())[FMPY, scene]
    assert messages == []


def test_a_difference_is_told_and_whether_it_is_of_reactions_alone():
    names, wanted = ["probe.a.x", "plane.p.reaction.z"], np.array([[1.0, 2.0], [3.0, 4.0]])
    assert compared(names, wanted.copy(), wanted) == "same bits"
    assert compared(names, wanted + np.array([[0, 0], [0, 4e-6]]), wanted) == "reactions 1e-06"
    assert compared(names, wanted + np.array([[0, 0], [3e-3, 0]]), wanted) == "1e-03"


def push(time: float) -> float:
    return 5.0 * math.sin(10.0 * time)


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
