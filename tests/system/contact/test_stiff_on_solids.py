"""A stiff undamped body beside solids: it flies by its modes and rests by implicit steps, so that its steps are those of its impacts."""

import numpy as np
import pytest

from readings import points
from scenes import meshed
from softffd import simulate
from textbook import TOLERANCE, beside_short_steps, right, stated
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


@pytest.mark.short("0.05-free ball", "0.05-edge of a box")
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


@pytest.mark.full
def test_what_is_stated_of_drops_is_near_what_is_true(tmp_path):
    """The second motion of landings tells it; what single impacts make of errors, multiplied, states far more."""
    times = []
    for on in sorted(set(SOLIDS) - {"free ball"}):
        for stiffness in (1e6, 1e7):
            for speed, spin in ((-0.3, 0.1), (-0.8, 2.0), (-0.5, 0.0)):
                scene = falling(tmp_path, on, stiffness, 0.02).replace(
                    {"initial.velocity": [0.05, 0.02, speed], "initial.angular_velocity": [spin, 0.2, 0.1], "experiment.stop_time": 0.2}
                )
                error, told = beside_short_steps(scene, 128)  # by fewer they are off by several tolerances themselves
                assert right(error, told), (on, stiffness, speed, error, told)
                times += [told / error] if told > 0 else []
    assert np.median(times) < 10


@pytest.mark.parametrize("on", SOLIDS)
def test_its_steps_do_not_depend_on_the_stiffness(on, tmp_path):
    few, many = (simulate(falling(tmp_path, on, stiffness, 0.1)).outputs["solver.steps"][-1] for stiffness in (1e7, 1e10))
    assert many < 4 * few


def _cylinder(name: str, x: float):
    return {"name": name, "radius": 0.3, "length": 3.0, "normal": [0, 1, 0], "point": [x, 0.5, -0.31], "friction": 0.1}


RESTS = {
    "rails": {"cylinder": [_cylinder("left", 0.25), _cylinder("right", 0.75)]},
    "three balls": {
        "sphere": [{"name": name, "radius": 0.2, "point": [x, y, -0.21], "friction": 0.4} for name, x, y in
                   (("a", 0.2, 0.2), ("b", 0.8, 0.2), ("c", 0.5, 0.8))]
    },
    "top of a ball": {"sphere": [{"name": "ball", "radius": 3.0, "point": [0.5, 0.5, -3.01], "friction": 0.8}]},
}  # fmt: skip


def lying(folder, on: str, stop_time: float):
    """A cube of 1 m and 1 kg of 1e6 N/m that falls by a centimetre and comes to rest."""
    return meshed(
        folder, shapes.cube(6, 0.0), points=[4, 4, 4], material={"stiffness": 1e6, "damping": 0.5}, mass={"total": 1.0},
        gravity=[0, 0, -9.81], outputs={"solver": True, "energy": True}, stop_time=stop_time, communication_step=0.01, **RESTS[on],
    )  # fmt: skip


@pytest.mark.parametrize("on", RESTS)
def test_it_comes_to_rest_there_and_takes_implicit_steps_then(on, tmp_path):
    run = simulate(lying(tmp_path, on, 1.0))
    steps = run.outputs["solver.steps"]
    assert steps[-1] - steps[-31] < 150  # explicit ones: 30 communication steps take some 5,000
    assert run.outputs["energy.kinetic"][-1] < 1e-20
    assert np.ptp(points(run)[-31:], axis=0).max() < 1e-12


@pytest.mark.short("top of a ball")
@pytest.mark.parametrize("on", RESTS)
def test_where_it_rests_is_where_short_steps_bring_it(on, tmp_path):
    error, told = beside_short_steps(lying(tmp_path, on, 0.4), 16)
    assert right(error, told), error


def test_explicit_steps_end_where_rows_that_depend_on_each_other_differ_by_rounding(tmp_path):
    rails = {"cylinder": [each | {"point": [each["point"][0], 0.5, -0.301]} for each in RESTS["rails"]["cylinder"]]}
    scene = meshed(
        tmp_path, shapes.cube(5, 0.0), points=[4, 4, 4], material={"stiffness": 1e6, "damping": 0.2}, mass={"total": 1.0},
        gravity=[0, 0, -9.81], velocity=[0.2, 0, 0], method="leapfrog", outputs={"solver": True}, stop_time=0.5, communication_step=0.01,
        **rails,
    )  # fmt: skip
    h = float(simulate(scene, stop_time=0.01).outputs["solver.stable_step"][-1])
    run = simulate(scene, start_values={"solver.step": h})  # was refused at 0.49 s
    assert run.time[-1] == pytest.approx(0.5)
