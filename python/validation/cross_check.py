"""Writes the files that the FMI Cross-Check (version 4.1, section 9.1.4) requires of an exporting tool, for every shipped scene:

    python3 python/run.py cross-check FOLDER

writes fmus/2.0/cs/PLATFORM/softffd/VERSION/NAME with NAME.fmu, NAME_ref.opt, NAME_ref.csv and, if the scene has inputs over time,
NAME_in.csv into the folder. The FMUs have flat names, which no reader of CSV files splits.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

import fmpy
import numpy as np

from softffd import __version__
from softffd.files import write_text
from softffd.fmu.package import package_fmu
from softffd.names import parse_name, structured, variable_names
from softffd.run.inputs import Inputs, Source
from softffd.run.result import Result
from softffd.run.simulate import simulate
from softffd.scene.document import shipped_scenes
from softffd.scene.scene import Scene, load_scene

PLACE = Path("fmus", "2.0", "cs", fmpy.platform, "softffd", __version__)
MOST = 10  # most variables in a reference file, by the rules
LEFT_OUT = re.compile("solver_|p.*_torque|plane_centre")
LEAST = 1e-6  # a component whose range is below this fraction of its vector's largest is rounding, by which no importer should be judged


def inputs_over_time(scene: str) -> Source | None:
    """Returns the inputs of a shipped scene; for the scene "standard", a force that sets the component in motion."""
    if scene == "standard":
        return lambda time: {"force[3,3,3].z": 5.0 * math.sin(10.0 * time)}
    return load_scene(scene).default_inputs


def write_cross_check(folder: Path, names: Iterable[str] | None = None) -> list[Path]:
    """Writes the files of the named shipped scenes (all by default) and returns the paths of the files."""
    return [file for name in names or shipped_scenes() for file in _write(folder / name, name)]


def _write(folder: Path, name: str) -> list[Path]:
    scene = load_scene(name).replace({"fmu.names": "flat"})
    inputs = inputs_over_time(name)
    result = simulate(scene, inputs=inputs)
    texts = {"ref.opt": _options(scene), "ref.csv": _csv(result.time, _reference(result))}
    if inputs is not None:
        driven = Inputs(inputs)
        given = {key for key in result.inputs if structured(key) in {*driven.names, *driven.derived_names}}
        texts["in.csv"] = _csv(result.time, {key: values for key, values in result.inputs.items() if key in given})
    files = [package_fmu(scene, folder / f"{name}.fmu")]
    for end, text in texts.items():
        files.append(folder / f"{name}_{end}")
        write_text(files[-1], text)
    return files


def _options(scene: Scene) -> str:
    experiment = scene.experiment
    values = {
        "StartTime": 0.0,
        "StopTime": experiment.stop_time,
        "StepSize": experiment.communication_step,
        "RelTol": scene.solver.tolerance,
    }
    return "".join(f"{key}, {value!r}\n" for key, value in values.items())


def _reference(result: Result) -> dict[str, np.ndarray]:
    """Returns the reference variables that change: first probes and opposite corners of the lattice, then reactions and energies."""
    corners = [(0, 0, 0), tuple(count - 1 for count in result.positions.shape[1:4])]
    columns = {key: values for key, values in result.outputs.items() if (found := parse_name(key)) and not LEFT_OUT.match(found.family)}
    for corner in corners:
        columns |= dict(zip(variable_names("position", [corner], flat=True), result.positions[:, *corner].T, strict=True))
    moved: dict[str, float] = {}
    for key, values in columns.items():
        least = 1.0 if _vector(key).endswith(".orientation") else 0.0  # without rotation its changes are noise
        moved[_vector(key)] = max(moved.get(_vector(key), least), np.ptp(values))
    chosen = [key for key in columns if np.ptp(columns[key]) > LEAST * moved[_vector(key)]]
    chosen.sort(key=lambda key: not key.startswith(("probe", "position")))
    return {key: columns[key] for key in chosen[:MOST]}


def _vector(name: str) -> str:
    return structured(name).rpartition(".")[0]


def _csv(time: np.ndarray, columns: Mapping[str, np.ndarray]) -> str:
    table = np.column_stack([time, *columns.values()])
    lines = [",".join(f'"{name}"' for name in ("time", *columns)), *(",".join(map(repr, row)) for row in table.tolist())]
    return "\n".join(lines) + "\n"
