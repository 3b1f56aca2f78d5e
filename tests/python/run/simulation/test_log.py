"""What a simulation says: messages, methods, and why it refuses a step."""

import os
import signal
import threading
import time

import numpy as np
import pytest

from host_scenes import STEP, scene, step
from softffd import FmuError, Simulation


def test_the_log_has_status_category_and_text_and_is_told_at_once():
    heard = []
    with Simulation(scene(), log=heard.append, start_values={"plane.ground.point.z": 0.01}) as low:
        step(low)
        assert heard == low.log and heard
        assert {message.category for message in heard} == {"solver", "logStatusWarning"}
        warning = next(message for message in heard if message.status == 1)
        assert "start behind plane ground" in warning.text == str(warning) and low.warnings == [warning.text]


@pytest.mark.filterwarnings("error")
@pytest.mark.usefixtures("ctrl_c_is_heard")
def test_ctrl_c_while_the_component_computes_comes_after_the_step_and_no_message_is_lost():
    """Python hears of the signal when the component speaks the next time, at the end of the step."""
    with Simulation("press", start_values={"plane.press.point.z": 0.95}) as sim:
        sim.initialize()
        assert len(sim.log) == 1
        threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            sim.step(0.1)
            time.sleep(2.0)
        assert sim.time == 0.1 and len(sim.log) == 2
        sim.step(1e-4)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("fault", [ValueError, FmuError, KeyboardInterrupt])
def test_what_the_log_function_raises_comes_out_of_the_call_which_is_done(fault):
    def refuse(message):
        raise fault(message.text)

    with Simulation(scene(), log=refuse, start_values={"plane.ground.point.z": 0.01}) as low:
        with pytest.raises(fault, match="start behind plane ground"):
            low.initialize()
        with pytest.raises(fault, match="an obstacle is near"):
            step(low)
        assert low.time == STEP and len(low.log) == 2
        start = low.save()
        with pytest.raises(fault, match=r"^stiffness.edge: wanted >= 0"):
            low["stiffness.edge"] = -1.0
        low.restore(start)
        step(low)


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
