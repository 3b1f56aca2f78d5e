"""What a simulation says: messages, methods, and why it refuses a step."""

import numpy as np
import pytest

from host_scenes import scene, step
from softffd import FmuError, Simulation


def test_the_log_has_status_category_and_text_and_is_told_at_once():
    heard = []
    with Simulation(scene(), log=heard.append, start_values={"plane.ground.point.z": 0.01}) as low:
        step(low)
        assert heard == low.log and heard
        assert {message.category for message in heard} == {"solver", "logStatusWarning"}
        warning = next(message for message in heard if message.status == 1)
        assert "start behind plane ground" in warning.text == str(warning) and low.warnings == [warning.text]


def test_methods_tells_which_took_over_and_why(sim):
    assert sim.methods() == []
    step(sim)
    assert sim.methods() == [("leapfrog", "an obstacle is near")]


def test_a_discarded_step_leaves_time_and_state_and_a_saved_moment_continues(sim):
    step(sim)
    before, now, time = sim.save(), sim.positions, sim.time
    sim["stiffness.edge"] = 1e18
    with pytest.raises(FmuError, match="discarded the step"):
        sim.step(0.25)
    assert sim.time == time
    np.testing.assert_array_equal(sim.positions, now)
    sim.restore(before)
    assert sim["stiffness.edge"] == 1e3
    step(sim)
