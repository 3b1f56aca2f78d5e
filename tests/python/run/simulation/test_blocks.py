"""Blocks of variables with kept buffers, and derivatives of inputs."""

import numpy as np
import pytest

from host_scenes import BOX, STEP, scene, step
from softffd import FmuError, Simulation


def test_blocks_keep_their_buffers(sim):
    moved = sim.block(["plane.plate.point.z", "plane.plate.velocity.z"])
    pressed = sim.block(["plane.plate.reaction"])
    buffer = pressed.values
    assert pressed.names == tuple(f"plane.plate.reaction.{c}" for c in "xyz") and buffer.shape == (3,)
    for n in range(15):
        moved.set([1.2 - 2.0 * n * STEP, -2.0])
        step(sim)
        assert pressed.get() is buffer
    assert buffer[2] == sim["plane.plate.reaction.z"] > 0
    counts = sim.block(["plane.ground.contacts", "solver.steps"])
    assert counts.get().dtype == np.int32 and counts.values[1] == sim["solver.steps"]
    with pytest.raises(FmuError, match="one type"):
        sim.block(["solver.steps", "mass"])


def test_derivatives_of_inputs_act_inside_the_next_step():
    """A load that grows from nought gives half the momentum of its end value held, a sixth of it by its second derivative."""
    free = {"material": {"damping": 0.0}, "load": BOX["load"], "outputs": {"velocities": "all"}, "solver": {"method": "dop853"}}

    def momentum(rates) -> float:
        with Simulation(scene(free)) as sim:
            sim.set_rates(rates)
            step(sim)
            return sim.velocities[..., 1].sum() / 64

    linear = momentum({"load.push": (0, 10.0 / STEP, 0)})
    assert linear == pytest.approx(10.0 * STEP / 2, rel=1e-9)
    assert momentum({"load.push.y": 10.0 / STEP}) == linear
    bent = momentum({"load.push": [(0, 0, 0), (0, 10.0 / STEP**2, 0)]})
    assert bent == pytest.approx(10.0 * STEP / 6, rel=1e-9)
    assert momentum({"load.push.y": [0.0, 10.0 / STEP**2]}) == bent


def test_derivatives_want_the_shape_of_their_input(sim):
    for wrong in ((1.0, 2.0), 1.0, [(1.0, 2.0)] * 3):
        with pytest.raises(FmuError, match=r"load\.push: wanted derivatives of 3 components"):
            sim.set_rates({"load.push": wrong})
