"""Saved moments come back, as bytes in other simulations too; a restart begins again. For other processes: tests/fmi/test_state.py."""

import copy
import pickle

import numpy as np
import pytest

from host_scenes import STEP, scene, step
from softffd import FmuError, Simulation
from softffd.fmu.component import Component


def test_a_saved_moment_comes_back_with_its_time_and_its_bytes_in_another_simulation_and_continue_with_the_same_bits(sim):
    step(sim, 3)
    state, ends = sim.save(), []
    with Simulation(scene()) as other:
        other.restore(bytes(state))
        assert not other.initializing
        for each in (sim, other, sim):
            assert each.time == state.time == pytest.approx(3 * STEP)
            step(each, 4)
            ends.append(each.positions)
            each.restore(bytes(state) if each is other else state)
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_a_state_before_the_first_step_leads_back_to_the_settings(sim):
    state = sim.save()
    step(sim, 2)
    sim.restore(state)
    assert sim.initializing and sim.time == 0.0
    sim["mass"] = 2.0
    step(sim)


def test_damaged_and_foreign_states_are_refused(sim, held):
    step(sim)
    data = bytes(sim.save())
    now = sim.positions
    flipped = bytearray(data)
    flipped[len(data) // 2] ^= 1
    for wrong in (10**13, "x", b"", b"nonsense" * 9, bytes(flipped), data[:-1]):
        with pytest.raises(FmuError):
            sim.restore(wrong)
    with pytest.raises(FmuError, match="another scene"):
        held.restore(data)
    np.testing.assert_array_equal(sim.positions, now)
    step(sim)


def test_states_are_freed_with_their_last_reference_and_with_the_simulation(monkeypatch):
    freed = []
    free = Component.free_state
    monkeypatch.setattr(Component, "free_state", lambda component, handle: (freed.append(handle), free(component, handle)))
    with Simulation(scene()) as opened:
        kept, dropped = opened.save(), opened.save()
        handle = dropped.handle
        del dropped
        assert freed == [handle]
    assert freed == [handle, kept.handle]
    opened.component.free_state(kept.handle)  # which is passed over
    with pytest.raises(FmuError):
        bytes(kept)


def test_restart_begins_again_with_the_settings_given(sim):
    step(sim, 3)
    sim.restart()
    assert sim.time == 0.0 and sim.log == [] and sim.initializing
    step(sim, 3)
    fresh = sim.positions
    sim.restart(start_values={"mass": 3.0}, method="leapfrog", tolerance=1e-3, start_time=1.0)
    assert (sim["mass"], sim["solver.method"], sim["solver.tolerance"], sim.time) == (3.0, "leapfrog", 1e-3, 1.0)
    sim.restart()
    assert sim["mass"] == 1.0
    step(sim, 3)
    np.testing.assert_array_equal(sim.positions, fresh)


@pytest.mark.parametrize("take", [copy.copy, copy.deepcopy, pickle.dumps])
def test_a_simulation_and_its_states_say_what_goes_elsewhere(sim, take):
    for what in (sim, sim.save()):
        with pytest.raises(FmuError, match="bytes"):
            take(what)
