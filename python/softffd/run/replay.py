"""A coupled run, seen again: what one component was given goes into a run of that component alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.interface import ScalarVariable
from softffd.run.inputs import Inputs
from softffd.run.result import Result
from softffd.run.simulate import simulate
from softffd.run.simulation import Simulation
from softffd.run.tables import is_data_frame, read_csv, structured_array, table_of

if TYPE_CHECKING:
    import pandas as pd

    from softffd.scene.scene import Scene

Rows = Union[np.ndarray, "pd.DataFrame", str, Path]


def replay(scene_or_fmu: Scene | str | Path, rows: Rows, component: str, **options: Any) -> Result:
    """What a component did in a coupled run: all its outputs, to plot and to look at.

        rows = simulate_ssp("pressed.ssp", stop_time=4.0, step_size=1e-3)
        softffd.replay("box.toml", rows, "box").view()

    scene_or_fmu: the scene, its path or name, or the path of the FMU that the component was made of. It starts from connected inputs of
        0, as in fmpy.
    rows: what fmpy's simulate_ssp returned: a structured array, or a DataFrame or CSV file of it, with a column `time` [s] and one for each
        connector, COMPONENT.VARIABLE. A row has the begin of a step and the inputs of the step after it; those of the first step are 0.
    component: its name in the system.
    options: of `simulate`: the start values of the coupled run, `output`.
    Raises FmuError where the rows hold no inputs of that component or are not of equal steps.
    """
    table = read_csv(Path(rows)) if isinstance(rows, str | Path) else table_of(rows) if is_data_frame(rows) else rows
    with Simulation(scene_or_fmu) as opened:
        variables = opened.variables
    inputs, times = _inputs(table, component, variables)
    begin, then, end = map(float, (times[0], times[1], times[-1]))
    return simulate(scene_or_fmu, start_time=begin, stop_time=end, step=then - begin, inputs=inputs, **options)


def _inputs(table: Any, component: str, variables: dict[str, ScalarVariable]) -> tuple[np.ndarray, np.ndarray]:
    """Inputs as `simulate` takes them, and the communication points."""
    columns = getattr(getattr(table, "dtype", None), "names", None) or ()
    if "time" not in columns or len(table) < 2:
        raise FmuError("rows: wanted what fmpy's simulate_ssp returns, a structured array with a field `time` and at least two rows")
    given = [name for name in variables if f"{component}.{name}" in columns and variables[name].causality == "input"]
    if not given:
        others = sorted({each.partition(".")[0] for each in columns} - {"time"})
        raise FmuError(f"rows: wanted columns {component}.VARIABLE of its inputs, got none; there are columns of {', '.join(others)}")
    begin, steps = float(table["time"][0]), np.diff(table["time"])
    if not np.allclose(steps, steps[0], rtol=1e-6, atol=0) or steps[0] <= 0:
        raise FmuError(f"rows: wanted equal steps of time, got some of {min(steps):g} s and some of {max(steps):g} s")
    times = begin + steps.mean() * np.arange(len(table) + 1)
    held = {"time": times} | {name: np.append(0.0, table[f"{component}.{name}"]) for name in given}
    for name in Inputs(structured_array(held), begin).derived_names:  # nobody gave them: they keep what they start from
        if name in variables and variables[name].causality == "input":
            held[name] = np.full(len(times), float(variables[name].start or 0))
    return structured_array(held), times
