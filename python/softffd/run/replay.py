"""Replays a coupled run: the inputs that one component was given go into a run of that component alone."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Union
from zipfile import ZipFile

import numpy as np

from softffd.errors import FmuError, SoftffdError
from softffd.fmu.archive import require_no_bomb
from softffd.fmu.component import Component
from softffd.fmu.ssp import KEPT, START
from softffd.run.inputs import Inputs
from softffd.run.progress import Note, silent
from softffd.run.result import Result
from softffd.run.simulate import simulate
from softffd.run.simulation import Simulation
from softffd.run.tables import is_data_frame, read_csv, structured_array, table_of
from softffd.scene.kept import KeptScene
from softffd.scene.scene import Scene

if TYPE_CHECKING:
    import pandas as pd


Rows = Union[np.ndarray, "pd.DataFrame", str, Path]


def replay(scene_or_fmu: Scene | str | Path, rows: Rows, component: str, **options: Any) -> Result:
    """Returns what a component did in a coupled run: all its outputs, to plot and to look at.

        rows = simulate_ssp("pressed.ssp", stop_time=4.0, step_size=1e-3)
        softffd.replay("box.toml", rows, "box").view()

    scene_or_fmu: the scene, its path or name, or the path of the FMU that the component was made of. Connected inputs start from 0, as in
        fmpy.
    rows: what fmpy's simulate_ssp returned: a structured array, or a DataFrame or CSV file of it, with a column `time` [s] and one for
        each connector, COMPONENT.VARIABLE. A row has the time at which a step begins and the inputs of the step after that; the inputs of
        the first step are 0.
    component: name of the component in the system.
    options: options of `simulate`: the start values of the coupled run, `output`.
    Raises FmuError if the rows hold no inputs of that component or their steps are not equal.
    """
    table = _table(rows)
    with Simulation(scene_or_fmu) as opened:
        inputs = {name: each for name, each in opened.variables.items() if each.causality == "input"}
    if not _led(table, component, inputs):
        others = sorted({each.partition(".")[0] for each in table.dtype.names or ()} - {"time"})
        raise FmuError(f"rows: wanted columns {component}.VARIABLE of its inputs, got none; there are columns of {', '.join(others)}")
    times = _times(table)
    held = {"time": times}
    held |= {name: np.append(0.0, table[f"{component}.{name}"]) for name in inputs if f"{component}.{name}" in (table.dtype.names or ())}
    for name in Inputs(structured_array(held), float(times[0])).derived_names:  # no component gave these: they keep their start values
        if name in inputs:
            held[name] = np.full(len(times), float(inputs[name].start or 0))
    return _at(times, scene_or_fmu, inputs=structured_array(held), **options)


def _at(times: np.ndarray, scene_or_fmu: Scene | str | Path, **options: Any) -> Result:
    begin, then, end = map(float, (times[0], times[1], times[-1]))
    return simulate(scene_or_fmu, start_time=begin, stop_time=end, step=then - begin, **options)


def replay_system(system: Path, rows: Rows, stage: Note = silent) -> dict[str, Result]:
    """Returns the results of those components of a coupled run that are soft bodies, by name in the system, each as `replay` gives it.

    system: path of the `.ssp` file, whose FMUs and start values are used. A result has the scene that its FMU was made of, if the scene's
        mesh is found.
    rows: as for `replay`, for all components; a component without inputs in them moves by itself.
    stage: called with words for what is being done. Raises SoftffdError if the file is no system or has no soft body.
    """
    table = _table(rows)
    times = _times(table)
    results: dict[str, Result] = {}
    with TemporaryDirectory(prefix="softffd-") as folder:
        for name, (content, starts, kept) in _components_of(system).items():
            fmu = Path(folder) / f"{len(results)}.fmu"
            fmu.write_bytes(content)
            with Component(fmu, running=False) as component:
                if component.lattice is None:
                    continue
                led = _led(table, name, [each.name for each in component.by_name.values() if each.causality == "input"])
            stage(f"simulating {name} again")
            result = replay(fmu, table, name, start_values=starts) if led else _at(times, fmu, inputs={}, start_values=starts)
            scene, why = kept.found(result.lattice, system.absolute().parent) if kept else (None, "")
            results[name] = dataclasses.replace(result, scene=scene, sceneless=why)
    if not results:
        raise SoftffdError(f"{system}: wanted a system with a soft body, an FMU of softffd; got none")
    return results


def _components_of(system: Path) -> dict[str, tuple[bytes, dict[str, Any], KeptScene | None]]:
    """Returns the FMUs of a system, their start values, and the scenes that the system keeps of them, by component."""
    from fmpy.ssp.ssd import read_ssd, read_ssv
    from pydantic import TypeAdapter

    found = {}
    try:
        with ZipFile(system) as archive:
            require_no_bomb(archive, system.stat().st_size)
            there = archive.namelist()
            own = (
                [(*each.name.partition(".")[::2], each.value) for each in read_ssv(str(system), START).parameters] if START in there else []
            )
            for each in read_ssd(str(system)).system.elements:
                scene = KEPT.format(each.name)
                kept = TypeAdapter(KeptScene).validate_json(archive.read(scene)) if scene in there else None
                found[each.name] = archive.read(each.source), {key: value for of, key, value in own if of == each.name}, kept
    except Exception as error:
        raise SoftffdError(f"{system}: cannot be read as a system of FMUs (SSP): {error}") from error
    return found


def _table(rows: Rows) -> np.ndarray:
    table: Any = read_csv(Path(rows)) if isinstance(rows, str | Path) else table_of(rows) if is_data_frame(rows) else rows
    if "time" not in (getattr(getattr(table, "dtype", None), "names", None) or ()) or len(table) < 2:
        raise FmuError("rows: wanted what fmpy's simulate_ssp returns, a structured array with a field `time` and at least two rows")
    return table


def _times(table: np.ndarray) -> np.ndarray:
    """Returns the communication points, from the begin of the first step to the end of the last; FmuError if the steps are not equal."""
    steps = np.diff(table["time"])
    if not np.allclose(steps, steps[0], rtol=1e-6, atol=0) or steps[0] <= 0:
        raise FmuError(f"rows: wanted equal steps of time, got some of {min(steps):g} s and some of {max(steps):g} s")
    return np.asarray(float(table["time"][0]) + steps.mean() * np.arange(len(table) + 1))


def _led(table: np.ndarray, component: str, inputs: Iterable[str]) -> bool:
    return any(f"{component}.{name}" in (table.dtype.names or ()) for name in inputs)
