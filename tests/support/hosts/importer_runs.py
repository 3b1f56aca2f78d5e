"""Every shipped scene in every importer, against the package's own run, and the table of it: python importer_runs.py docs/importers.md

With names of scenes or importers after the file it prints those cells alone.
"""

import atexit
import shutil
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import fmpy
import numpy as np

import importers
from importers import Missing, Run, Tool, drive
from softffd import load_scene, package_fmu, simulate
from softffd.files import write_text
from softffd.names import OBSTACLES, parse_name
from softffd.run.inputs import Inputs
from softffd.scene.document import shipped_scenes
from validation.cross_check import inputs_over_time

STEP, STEPS = 0.01, 100
"""Communication step [s] and number of steps of every run"""
START = {"solver.step": 5e-6}
STIFF_START = {"solver.step": 1e-6}
"""s; below what any shipped scene needs. With it a run does not depend on the last bits of a host's clock."""


@dataclass(frozen=True)
class Importer:
    """A tool that runs FMUs, and how it prints: the form of harmless lines."""

    tool: Callable[[], Tool]
    version: str
    link: str
    notices: str
    changes: dict[str, object] = field(default_factory=dict)
    """Keys that scenes need for it"""
    remark: str = ""


REALS_ALONE = (
    "reads every output as a Real: scenes get `outputs.reactions = false`,\n  which leaves out the Integer `plane.NAME.contacts`. It sets "
    "inputs that nothing drives to 0, unless their starts stand in\n  `initialization` of its configuration"
)
TBB = "it needs `libtbb.so.12`, which it does not bring: `libtbb12` of Debian and Ubuntu, or `tbb` of PyPI"
ECOS_NOTICES = (
    r"\[.*\] \[ecos\] \[debug\] "
    r"(Initializing simulation\.\.|Parameterset 'start' applied to 1 instances|Initialized\.|Terminating simulation\.\.|Terminated\.)"
)
IMPORTERS = {
    "libcosim": Importer(importers.libcosim, importers.version("libcosim"), "libcosimpy, PyPI", r"\[.*\] \[info\] .*"),
    "Ecos": Importer(importers.ecos, importers.version("ecos"), "ecospy, PyPI", ECOS_NOTICES, remark=TBB),
    "Maestro": Importer(
        importers.maestro, importers.version("maestro"), "org.into-cps.maestro:maestro, Maven Central",
        r"[\d:.]+ \[main\] (DEBUG|INFO) (?!.* logStatus\w+ ).*|SLF4J\([WI]\): .*|NOTE: Picked up JDK_JAVA_OPTIONS: .*",
        remark="interprets a MaBL specification of one instance",
    ),
    "CoFMUPy": Importer(
        importers.cofmupy, importers.version("cofmupy"), "cofmupy, PyPI", r"Skipping Fixed Point Initialization",
        {"outputs.reactions": False, "outputs.solver": False}, REALS_ALONE,
    ),
}  # fmt: skip
FMPY = "FMPy"
ABSENT = {
    "OMSimulator": "PyPI has only a source package",
    "PyFMI": "PyPI has only a source package; conda-forge has it built",
    "FMU Compliance Checker (fmuCheck), fmusim of the Reference FMUs": "releases on GitHub alone",
    "fmi-sim of rust-fmi": "crates.io alone",
    "Maestro 4": "3.1.1 is the newest that Maven Central gives out",
}


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
    assert not any(message.status for message in result.log)  # of the component; the run may say that its steps miss peaks of the inputs
    return np.array([column(result, name)[1:] for name in names]).reshape(len(names), STEPS).T


def column(result, name: str) -> np.ndarray:
    found = parse_name(name)
    if found is None or found.family != "position":
        return result.outputs[name]
    i, j, k = found.instance
    return result.positions[:, i, j, k, "xyz".index(found.component)]


def job(fmu: Path, scene: str) -> Run:
    """The scene's run as an importer's."""
    return Run(str(fmu), STEP, STEPS, start_values(fmu), courses(inputs_over_time(scene)), outputs(fmu, "Real"), outputs(fmu, "Integer"))


def run_fmpy(run: Run) -> tuple[list[str], dict[str, np.ndarray]]:
    """fmpy's own simulate_fmu with the inputs of a run: its messages, and rows as `drive` gives them."""
    messages: list[str] = []
    signals = None
    if run.inputs:
        signals = np.zeros(run.steps, dtype=[(name, float) for name in ("time", *run.inputs)])
        signals["time"] = run.step * np.arange(run.steps)
        for name, values in run.inputs.items():
            signals[name] = values
    names = [*run.outputs, *run.counts]
    theirs = fmpy.simulate_fmu(
        run.fmu, stop_time=run.steps * run.step, step_size=run.step, output_interval=run.step, start_values=run.start, input=signals,
        output=names, debug_logging=True,
        logger=lambda _environment, _instance, status, _category, message: status > 0 and messages.append(str(message)),
    )  # fmt: skip
    rows = {key: np.array([theirs[name][1:] for name in some]).T for key, some in (("outputs", run.outputs), ("counts", run.counts))}
    return messages, rows


@cache
def fmu_of(scene: str, changes: tuple[tuple[str, object], ...]) -> Path:
    folder = tempfile.mkdtemp(prefix="softffd-importers-")
    atexit.register(shutil.rmtree, folder)
    return package_fmu(load_scene(scene).replace(dict(changes)) if changes else load_scene(scene), Path(folder) / f"{scene}.fmu")


@cache
def expected(scene: str, changes: tuple[tuple[str, object], ...]) -> np.ndarray:
    """(STEPS, outputs and counts)."""
    fmu = fmu_of(scene, changes)
    return ours(fmu, outputs(fmu, "Real") + outputs(fmu, "Integer"), inputs_over_time(scene))


def outcome(importer: str, scene: str) -> tuple[str, list[str]]:
    """What the table says of a scene in an importer, and what the importer printed. Missing where it cannot be had."""
    changes = tuple(IMPORTERS[importer].changes.items()) if importer != FMPY else ()
    run = job(fmu_of(scene, changes), scene)
    if importer == FMPY:
        printed, rows = run_fmpy(run)
    else:
        with tempfile.TemporaryDirectory() as folder:
            printed, rows = drive(IMPORTERS[importer].tool(), run, Path(folder))
    if len(rows["outputs"]) != STEPS:
        return f"no: {printed[-1] if printed else 'no word'}", printed
    shape = (STEPS, -1)
    theirs = np.hstack([np.reshape(rows["outputs"], shape), np.reshape(rows["counts"], shape) if run.counts else np.empty((STEPS, 0))])
    return compared([*run.outputs, *run.counts], theirs, expected(scene, changes)), printed


def compared(names: list[str], theirs: np.ndarray, wanted: np.ndarray) -> str:
    """ "same bits", or the largest relative difference of what differs."""
    if np.array_equal(theirs, wanted):
        return "same bits"
    different = theirs != wanted
    means = np.array([name.startswith((*(f"{kind}." for kind in OBSTACLES), "pin.")) and ".contacts" not in name for name in names])
    gap = np.abs(theirs - wanted)[different] / np.maximum(np.abs(wanted), np.abs(theirs))[different]
    what = "reactions " if not different[:, ~means].any() else ""
    return f"{what}{gap.max():.0e}"


HEAD = f"""# Other people's importers

This page says which importers of FMI 2.0 run the shipped scenes, and whether they get the same bits as `softffd.simulate`.

- [How it was measured](#how-it-was-measured)
- [Results](#results)
- [ARM and terminals](#arm-and-terminals)
- [Not run](#not-run)

## How it was measured

Every shipped scene ran for {STEPS * STEP:g} s in every importer that a package registry has, with communication steps of {STEP:g} s.
Its own inputs drove it; a force drove `standard`, which has none. Every output was compared at every communication point.

- *Same bits*: all outputs are equal to the last bit.
- *Reactions* and a number: all outputs but the reactions are equal to the last bit. A reaction is an impulse divided by the step's
  length, which is a difference of two times in that host. The number is the largest relative difference.

A given `solver.step` ({START["solver.step"]:g} s, for `stiff_bounce` {STIFF_START["solver.step"]:g} s) makes runs independent of the last
bits of a host's clock. Steps that the component chooses itself may differ with them, within the tolerance. None of the importers passed
on a warning of the component.

`python tests/support/hosts/importer_runs.py docs/importers.md` makes this page; `python3 python/run.py test --full` runs all of it again
and compares it with this page.

## Results
"""


UNSEEN = """## ARM and terminals

Every run was on x86-64. Where importers look for ARM's library was read in their sources: [ARM](platforms.md#arm). The FMUs have
[terminals](coupling.md#terminals); VDMCheck2 checks their file and finds nothing. What the importers make of it was not tried.
"""


def page() -> str:
    columns = [FMPY, *IMPORTERS]
    versions = [fmpy.__version__, *(importer.version for importer in IMPORTERS.values())]
    rows = [[f"`{scene}`", *(outcome(importer, scene)[0] for importer in columns)] for scene in shipped_scenes()]
    heads = ["scene", *(f"{name} {version}" for name, version in zip(columns, versions, strict=True))]
    notes = [f"- {name}: {each.link}{f'; {each.remark}' if each.remark else ''}." for name, each in IMPORTERS.items()]
    fmutool, vdmcheck = importers.version("fmutool"), importers.version("vdmcheck2")
    checkers = (
        "Checkers find nothing in any of the FMUs (`tests/fmi/test_importers.py`): `fmpy validate`, fmutool (fmu-manipulation-toolbox\n"
        f"{fmutool}, PyPI), VDMCheck2 {vdmcheck} (Maven Central), by its model of the standard and by its rules."
    )
    absent = "".join(f"- {name}: {why}.\n" for name, why in ABSENT.items())
    return (
        f"{HEAD}\n{table(heads, rows)}\n" + "\n".join([f"- {FMPY}: fmpy, PyPI; `simulate_fmu`.", *notes])
        + f"\n\n{checkers}\n\n{UNSEEN}\n## Not run\n\n{absent}"
    )  # fmt: skip


def table(heads: list[str], rows: list[list[str]]) -> str:
    return "".join("| " + " | ".join(row) + " |\n" for row in [heads, ["---"] * len(heads), *rows])


def cells(text: str) -> dict[tuple[str, str], str]:
    """What a page says, by importer and scene."""
    lines = [[cell.strip() for cell in line.strip("| ").split("|")] for line in text.splitlines() if line.startswith("| ")]
    heads, *rows = lines
    columns = [head.rpartition(" ")[0] for head in heads]
    rows = [row for row in rows if row[0].startswith("`")]
    return {(columns[n], row[0].strip("`")): row[n] for row in rows for n in range(1, len(row))}


def main() -> None:
    target, *chosen = sys.argv[1:]
    if not chosen:
        write_text(Path(target), page())
        return
    for importer in [FMPY, *IMPORTERS]:
        for scene in shipped_scenes():
            if importer in chosen or scene in chosen:
                said, printed = outcome(importer, scene)
                print(f"{importer} {scene}: {said}", *(printed[-5:] if said.startswith("no") else []), sep="\n  ", flush=True)


if __name__ == "__main__":
    try:
        main()
    except Missing as missing:
        sys.exit(str(missing))
