"""Implicit steps of lattices that are too wide for a factor keep what those of narrow ones promise."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from scenes import GRAVITY, box
from softffd import simulate

TOLERANCE = 1e-4
"""The default, of a box of 1 m"""
WIDE = {"points": [9, 9, 9], "outputs": {"solver": True}}


def pulled(method, **keys):
    """A stiff cube that is pulled apart slowly in its fall."""
    loads = [{"name": "left", "points": "x-"}, {"name": "right", "points": "x+"}]
    scene = box(
        **WIDE, stiffness=1e6, damping=0.05, gravity=GRAVITY, method=method, load=loads, stop_time=0.3, communication_step=0.1, **keys
    )

    def force(t):
        f = 20 * (0.5 - 0.5 * np.cos(np.pi * t / 0.3))
        return {"load.left.x": -f, "load.right.x": f}

    return simulate(scene, inputs=force)


@pytest.mark.short("True")
@pytest.mark.parametrize("pinned", [False, True])
def test_slow_motion_of_a_stiff_cube_is_within_the_tolerance_in_a_few_steps(pinned):
    keys = {"pin": [{"name": "wall", "points": "y-"}]} if pinned else {}
    exact = pulled("leapfrog", **keys)
    assert exact.outputs["solver.steps"][-1] > 3000
    for method in ("ros34pw2", "auto"):
        result = pulled(method, **keys)
        assert result.outputs["solver.steps"][-1] < 1000
        assert np.abs(result.positions - exact.positions).max() < TOLERANCE


@pytest.mark.short("100000000.0-*")
@pytest.mark.parametrize("method", ["auto", "backward_euler"])
@pytest.mark.parametrize("stiffness", [1e5, 1e8])
def test_a_stiff_cube_slides_down_as_friction_lets_it(method, stiffness):
    downhill, friction, damping, seconds, step = 4.0, 0.3, 1e-3, 0.2, 0.02
    scene = box(
        **WIDE, stiffness=stiffness, damping=damping, gravity=[downhill, 0.0, -9.81], method=method,
        plane=[{"name": "ground", "friction": friction}], stop_time=seconds, communication_step=step,
    )  # fmt: skip
    result = simulate(scene)
    pull, drag = downhill - friction * 9.81, damping * 9**3  # of a kilogram
    speed = pull / drag * (1 - np.exp(-drag * seconds))
    way = (pull * seconds - speed) / drag
    found = (result.positions[-1] - result.positions[0]).reshape(-1, 3)[:, 0].mean()
    assert abs(found - way) < (10 * TOLERANCE if method == "auto" else 0.55 * step * speed)  # of first order: half a step ahead
    assert result.outputs["solver.steps"][-1] < 1000
    assert result.positions[..., 2].min() > -1e-15


PULLED_AND_SLID = """
from softffd import simulate
from softffd.scene.scene import scene_from

for method, material in (("ros34pw2", 1e6), ("backward_euler", 1e7)):
    simulated = simulate(scene_from({
        "lattice": {"points": [10, 9, 13]},
        "material": {"stiffness": material, "damping": 0.01},
        "environment": {"gravity": [3.0, 0.0, -9.81]},
        "solver": {"method": method},
        "experiment": {"stop_time": 0.05, "communication_step": 0.01},
        **({"plane": [{"name": "ground", "friction": 0.3}]} if method == "backward_euler" else {"pin": [{"name": "wall", "points": "x-"}]}),
    }))
    print(simulated.positions[-1].tobytes().hex())
"""


@pytest.mark.full
def test_the_same_bits_with_every_instruction_set():
    def digest(instructions):
        environment = os.environ | {"SOFTFFD_INSTRUCTIONS": instructions}
        done = subprocess.run([sys.executable, "-c", PULLED_AND_SLID], env=environment, capture_output=True, text=True, check=True)
        assert len(set(done.stdout.split())) == 2
        return hashlib.sha256(done.stdout.encode()).hexdigest()

    assert digest("baseline") == digest("avx2") == digest("")
