"""Stiff undamped bodies come to rest under, on and between free bodies, and take long implicit steps there."""

import numpy as np
import pytest

from readings import points
from scenes import meshed
from softffd import simulate
from textbook import TOLERANCE, beside_short_steps, right, stated
from validation import shapes

G = 9.81
"""m/s2"""


def plate(z: float, mass: float, **keys):
    """A free one of 1.4 m and 0.1 m, whose lower side is at this height."""
    return {
        "name": "plate",
        "motion": "free",
        "size": [1.4, 1.4, 0.1],
        "point": [0.5, 0.5, z + 0.05],
        "mass": mass,
        "friction": 0.4,
        **keys,
    }


STACKS = {
    "plate on the block": (0.0, [plate(1.002, 2.0)]),
    "light plate on the block": (0.0, [plate(1.002, 0.02)]),
    "guided plate on the block": (0.0, [plate(1.002, 2.0, guide=[0, 0, 1])]),
    "block on the plate": (-0.102, [plate(-0.101, 2.0)]),
}
"""Heights of the floor, and the free bodies"""


def stack(folder, name: str, stop_time: float, **keys):
    """A block of 1 m and 1 kg of 1e5 N/m, which falls by some millimetres with what is on it."""
    floor, boxes = STACKS[name]
    return meshed(
        folder, shapes.cube(3, 0.0), points=[3, 3, 3], material={"stiffness": 1e5, "damping": 2.0}, mass={"total": 1.0},
        gravity=[0, 0, -G], plane=[{"name": "floor", "point": [0, 0, floor], "normal": [0, 0, 1], "friction": 0.4}], box=boxes,
        outputs={"solver": True, "energy": True}, stop_time=stop_time, communication_step=0.02, **keys,
    )  # fmt: skip


@pytest.mark.short("plate on the block")
@pytest.mark.parametrize("name", STACKS)
def test_it_rests_by_implicit_steps_and_the_floor_bears_all(name, tmp_path):
    run = simulate(stack(tmp_path, name, 1.0))
    steps, mass = run.outputs["solver.steps"], 1 + STACKS[name][1][0]["mass"]
    assert steps[-1] - steps[-11] < 100  # explicit ones: ten communication steps take 3,000
    assert run.outputs["energy.kinetic"][-1] < 1e-15
    assert np.ptp(points(run)[-11:], axis=0).max() < 1e-10
    assert run.outputs["plane.floor.reaction.z"][-1] == pytest.approx(-mass * G, rel=1e-6)
    assert float(stated(run)[-1]) < 20 * TOLERANCE


@pytest.mark.short("block on the plate", "guided plate on the block")
@pytest.mark.parametrize("name", STACKS)
def test_where_it_rests_is_where_short_steps_bring_it(name, tmp_path):
    error, told = beside_short_steps(stack(tmp_path, name, 0.5), 16)
    assert right(error, told), error


@pytest.mark.full
@pytest.mark.parametrize("interpolation", ["held", "linear"])
def test_a_force_that_grows_sets_the_plate_in_motion_when_friction_gives_way(interpolation, tmp_path):
    """On the block, which the floor holds by more: mu m g = 7.85 N is reached at 1.285 s."""
    scene, growth, mass = stack(tmp_path, "plate on the block", 1.5), 10.0, 2.0
    push = {"inputs": lambda t: {"box.plate.force.x": max(0.0, growth * (t - 0.5))}, "interpolation": interpolation}
    run = simulate(scene, **push)
    way, slips = run.outputs["box.plate.position.x"], 0.5 + 0.4 * mass * G / growth
    assert np.ptp(way[(run.time > 0.5) & (run.time < slips)]) < TOLERANCE
    late = 0.5 * scene.experiment.communication_step if interpolation == "held" else 0.0
    after = run.time[-1] - slips - late
    assert way[-1] - way[run.time < slips][-1] == pytest.approx(growth / mass * after**3 / 6, abs=5 * TOLERANCE)
