"""Reference results of a scene as files of its FMU, with which an importer can check that it gets the same results. Folder and manifest
are those of the layered standard FMI-LS-REF (https://github.com/modelica/fmi-ls-ref, 1.0.0-alpha.1).

    inputs.csv     time [s] and the inputs that drive the run at each communication point; absent where nothing drives it
    results.csv    time [s] and outputs at each communication point
    errors.csv     unit of each output, and its largest difference from a run with a tenth of the tolerance
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from xml.etree import ElementTree as Xml

import numpy as np

from softffd.files import table_text
from softffd.fmu.model_description import xml_text
from softffd.names import structured, unit_of, variable_names
from softffd.run.inputs import Inputs
from softffd.run.result import Result
from softffd.run.simulate import simulate
from softffd.scene.scene import Scene, scene_of

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
LAYERED = "http://fmi-standard.org/fmi-ls-manifest"
ABOUT = {
    "fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    "fmi-ls-version": "1.0.0-alpha.1",
    "fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
}
ROLES = {
    "inputs.csv": ("testcase", "Inputs at each communication point, held until the next one"),
    "results.csv": ("result", "Outputs at each communication point of a run with these inputs"),
    "errors.csv": ("report", "Largest difference of each output from a run with a tenth of the tolerance"),
}
LEFT_OUT = ("velocity[", "solver.")  # outputs that no comparison uses: velocities of control points, and counts of steps
FINER = 0.1  # tolerance of the run that gives the error, as a fraction of the scene's


def reference_files(scene: Scene | str | Path, *, progress: Callable[[float, float], None] | None = None) -> dict[str, bytes]:
    """Returns the files by their names in the FMU, from two runs of the scene with its own inputs, communication step and stop time.

    scene: a scene, the path of its file, or the name of a shipped one. progress: as for `simulate`, for the two runs together.
    """
    scene = scene_of(scene, "reference_files")

    def half(first: float) -> Callable[[float, float], None] | None:
        return progress and (lambda share, time: progress(first + share / 2, time))

    result = simulate(scene, progress=half(0.0))
    finer = simulate(scene, tolerance=FINER * scene.solver.tolerance, progress=half(0.5))
    outputs, others = _outputs(result), _outputs(finer)
    errors = {name: float(np.abs(column - others[name]).max()) for name, column in outputs.items()}
    rows = [(name, unit_of(name), f"{error:.3g}") for name, error in errors.items()]
    texts = {"results.csv": _csv(result.time, outputs), "errors.csv": table_text(["name", "unit", "largest_difference"], rows)}
    source = Inputs(scene.default_inputs)  # the scene's own file; velocities that follow from it count too
    given = {*source.names, *source.derived_names}
    if inputs := {name: column for name, column in result.inputs.items() if structured(name) in given}:
        texts["inputs.csv"] = _csv(result.time, inputs)
    about = _about(scene, errors)
    files = {f"{FOLDER}/{name}": text.encode() for name, text in sorted(texts.items())}
    return files | {f"{FOLDER}/fmi-ls-manifest.xml": _manifest(sorted(texts)).encode(), "documentation/fmi-ls-ref.txt": about.encode()}


def _outputs(result: Result) -> dict[str, np.ndarray]:
    """Returns the outputs without diagnostics; of those at control points only the positions of two opposite corners."""
    last = tuple(count - 1 for count in result.positions.shape[1:4])
    columns = {name: column for name, column in result.outputs.items() if not structured(name).startswith(LEFT_OUT)}
    for corner in dict.fromkeys([(0, 0, 0), last]):
        if min(last) >= 0 and np.isfinite(result.positions[:, *corner]).all():
            columns |= dict(zip(variable_names("position", [corner], flat=result.flat_names), result.positions[:, *corner].T, strict=True))
    return columns


def _csv(time: np.ndarray, columns: Mapping[str, np.ndarray]) -> str:
    return table_text(["time", *columns], np.column_stack([time, *columns.values()]).tolist())


def _manifest(names: list[str]) -> str:
    Xml.register_namespace("fmi-ls", LAYERED)
    root = Xml.Element("fmiReferences", {f"{{{LAYERED}}}{key}": text for key, text in ABOUT.items()})
    for name in names:
        role, about = ROLES[name]
        Xml.SubElement(root, "Related", type="text/csv", source=name, role=role, description=about)
    return xml_text(root)


def _about(scene: Scene, errors: Mapping[str, float]) -> str:
    experiment = scene.experiment
    lines = [
        f"{scene.title}: reference inputs and results in {FOLDER}",
        f"From 0 to {experiment.stop_time:g} s in communication steps of {experiment.communication_step:g} s; inputs are held over a step.",
        "Times are in s, other columns in the units of modelDescription.xml. Names are those of FMI 2.0, of single numbers.",
        f"The tolerance is {scene.solver.tolerance:g}. How far a run with a tenth of it differs at most:",
        *(f"  {name}: {error:.3g} {unit_of(name)}".rstrip() for name, error in errors.items()),
    ]
    return "\n".join(lines) + "\n"
