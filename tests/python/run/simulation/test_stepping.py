"""Steps add up to the time, and give the bits of `simulate`."""

from decimal import Decimal

import numpy as np
import pytest

from host_scenes import STEP, scene, step
from softffd import FmuError, Simulation, package_fmu, simulate


def test_steps_add_up_to_the_time(sim):
    assert sim.time == 0.0
    sim.step(0.25 * STEP)
    assert sim.time == 0.25 * STEP
    sim.step()  # the scene's communication step
    assert sim.time == 1.25 * STEP
    sim.step(STEP, end=2.25 * STEP)
    assert sim.time == 2.25 * STEP
    sim.step(end=4 * STEP)
    state = sim.save()
    sim.step(STEP)
    reached = sim.positions
    sim.restore(state)
    sim.step(Decimal(repr(STEP)))
    assert type(sim.time) is float and np.array_equal(sim.positions, reached)
    for _ in range(40):
        sim.step(np.float32(STEP))
    assert type(sim.time) is float


@pytest.mark.parametrize(
    "given, words",
    [
        *[({"length": length}, "step: wanted a length > 0 s") for length in (0.0, -STEP, float("nan"), float("inf"))],
        *[({"length": STEP, "end": end}, "wanted an end at") for end in (5.0, float("nan"))],
        ({"end": -1.0}, "wanted a length > 0 s"),
        ({"end": "x"}, "wanted one number"),
    ],
)
def test_a_length_or_an_end_that_is_none_is_refused_and_stepping_goes_on(sim, given, words):
    with pytest.raises(FmuError, match=words):
        sim.step(**given)
    assert sim.time == 0.0
    step(sim)
    assert sim.time == STEP


def test_stepping_gives_the_bits_of_simulate(sim):
    result = simulate(scene())
    for row, time in enumerate(result.time[1:].tolist()):
        sim.step(STEP, end=time)
        np.testing.assert_array_equal(sim.positions, result.positions[row + 1])
        assert sim["plane.ground.reaction.z"] == result.outputs["plane.ground.reaction.z"][row + 1]


def test_a_scene_and_its_fmu_give_the_same_bits_and_take_each_other_s_states(sim, tmp_path):
    with Simulation(package_fmu(scene(), tmp_path / "box.fmu")) as packed:
        for each in (sim, packed):
            each.plane["plate"].point = (0, 0, 1.1)
            step(each, 3)
        np.testing.assert_array_equal(packed.positions, sim.positions)
        state = sim.save()
        step(sim, 2)
        packed.restore(state)
        step(packed, 2)
        np.testing.assert_array_equal(packed.positions, sim.positions)
        assert packed.variables == sim.variables or [*packed.variables] == [*sim.variables]


def test_a_start_time_moves_the_clock_a_stop_time_ends_it_and_a_step_too_short_for_the_time_is_refused():
    with Simulation(scene(), start_time=3.0, stop_time=3.0 + 2 * STEP) as late:
        assert late.time == 3.0
        step(late, 2)
        with pytest.raises(FmuError, match="stop time"):
            step(late)
        assert late.time == pytest.approx(3.0 + 2 * STEP)
    with Simulation(scene(), start_time=1e15) as late, pytest.raises(FmuError, match=r"a length that changes the time 1e\+15 s"):
        late.step(STEP)


def test_tolerance_and_method_are_those_asked_for():
    with Simulation(scene(), tolerance=1e-7, method="bm4") as exact, Simulation(scene(), method="leapfrog", tolerance=1e-2) as coarse:
        assert exact["solver.method"] == "bm4" and coarse["solver.method"] == "leapfrog"
        assert exact["solver.tolerance"] == 1e-7
        for each in (exact, coarse):
            step(each, 5)
        assert exact["solver.steps"] > coarse["solver.steps"]
