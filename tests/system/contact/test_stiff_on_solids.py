"""A stiff undamped body that flies between solids: its flights are taken by its modes, so that its steps are those of its impacts."""

import numpy as np
import pytest

from readings import points
from scenes import meshed
from softffd import simulate
from textbook import TOLERANCE, right, stated
from validation import shapes

SOLIDS = {
    "sphere": {"sphere": [{"name": "solid", "radius": 1.0, "point": [0.52, 0.47, -1.02], "friction": 0.3}]},
    "edge of a box": {
        "box": [{"name": "solid", "size": [1.0, 3.0, 1.0], "point": [0.34, 0.5, -0.72], "rotation": {"axis": [0, 1, 0], "degrees": 45.0}}]
    },
    "roller": {
        "cylinder": [{"name": "solid", "radius": 0.4, "length": 3.0, "normal": [0, 1, 0], "point": [0.45, 0.5, -0.42], "friction": 0.3}]
    },
    "free ball": {
        "sphere": [
            {"name": "solid", "radius": 0.4, "point": [0.55, 0.5, -0.45], "motion": "free", "mass": 2.0, "velocity": [0.0, 0.0, 1.0],
             "angular_velocity": [0.0, 3.0, 0.0], "friction": 0.3}
        ]
    },
}  # fmt: skip


def falling(folder, on: str, stiffness: float, step: float):
    """A cube of 1 m and 1 kg that turns as it falls by some centimetres onto the solid, and rises again."""
    return meshed(
        folder, shapes.cube(4, 0.0), points=[4, 4, 4], material={"stiffness": stiffness, "damping": 0.0}, mass={"total": 1.0},
        gravity=[0, 0, -9.81], velocity=[0.05, 0.02, -0.3], angular_velocity=[0.1, 0.2, 0.1], outputs={"solver": True}, stop_time=0.1,
        communication_step=step, **SOLIDS[on],
    )  # fmt: skip


@pytest.mark.short("0.05-*")
@pytest.mark.parametrize("on", SOLIDS)
@pytest.mark.parametrize("step", [0.01, 0.05])
def test_it_comes_to_what_short_steps_come_to(step, on, tmp_path):
    auto = simulate(falling(tmp_path, on, 1e7, step))
    h = float(auto.outputs["solver.stable_step"].min()) / 32
    exact = simulate(falling(tmp_path, on, 1e7, step), start_values={"solver.method": "leapfrog", "solver.step": h})
    assert auto.outputs["solver.contacts_resolved"][-1] > 0
    error = np.linalg.norm(points(auto)[-1] - points(exact)[-1], axis=1).max()
    assert right(error / TOLERANCE, float(stated(auto)[-1]) / TOLERANCE), error
    assert auto.outputs["solver.steps"][-1] < 0.05 * exact.outputs["solver.steps"][-1]


@pytest.mark.parametrize("on", SOLIDS)
def test_its_steps_do_not_depend_on_the_stiffness(on, tmp_path):
    few, many = (simulate(falling(tmp_path, on, stiffness, 0.1)).outputs["solver.steps"][-1] for stiffness in (1e7, 1e10))
    assert many < 4 * few
