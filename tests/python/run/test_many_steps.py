"""Runs whose inputs are held or tabulated go many communication steps at a time; what they give is what single steps give."""

import os
import signal

import numpy as np
import pytest

from scenes import box, table_and_press
from softffd import FmuError, simulate
from softffd.errors import Interrupted
from softffd.run.drive import Drive
from softffd.run.inputs import Inputs

PUSHED = box(load=[{"name": "push", "points": "x+"}], gravity=[0, 0, -9.81], energy=True, stop_time=2.0, communication_step=1e-3)
COLUMNS = [("time", float), ("load.push.x", float), ("load.push.y", float)]
TABLE = np.array([(0.0, 1.0, 0.0), (0.1, 2.0, 3.0), (0.1, -1.0, 3.0), (1.5, 0.5, 0.25)], COLUMNS)


@pytest.fixture
def calls(monkeypatch):
    """How many steps each call of the library is asked for."""
    lengths, go_on = [], Drive.go_on

    def counted(many, until):
        lengths.append(until - many.done)
        go_on(many, until)

    monkeypatch.setattr(Drive, "go_on", counted)
    return lengths


def assert_same(one, other):
    np.testing.assert_array_equal(one.positions, other.positions)
    for name, column in {**one.outputs, **one.inputs}.items():
        np.testing.assert_array_equal(column, {**other.outputs, **other.inputs}[name], err_msg=name)
    assert one.summary["methods"] == other.summary["methods"] and one.log == other.log


@pytest.mark.parametrize("inputs", [None, {"load.push": [1.0, 0.0, 2.0]}, TABLE], ids=["none", "constants", "table"])
def test_few_calls_give_the_bits_of_single_steps(inputs, calls):
    result = simulate(PUSHED, inputs=inputs)
    assert sum(calls) == 2000 and len(calls) < 200
    calls.clear()
    source = Inputs(inputs)

    def function(time):
        return dict(zip(source.names, source.values(time, time), strict=True))

    by_function = simulate(PUSHED, inputs=None if inputs is None else function)
    assert inputs is None or calls == [1] * 2000
    assert_same(result, by_function)


def test_a_table_is_read_at_many_times_as_at_each():
    source, times = Inputs(TABLE), np.append(np.arange(0, 2, 0.01), [2.0, 2.0])
    single = [source.values(time, time) for time in times[:-1]]
    np.testing.assert_array_equal(source.rows(times), single)


def test_a_step_that_fails_on_the_way_is_told_as_by_itself(calls):
    crushed = box(plane=table_and_press(), stop_time=1.0, communication_step=1e-3)
    course = np.array([(0.0, 1.0), (0.5, 0.9), (0.501, -1.0)], [("time", float), ("plane.press.point.z", float)])
    with pytest.raises(FmuError, match=r"the component reported an error: fmi2DoStep: at time 0\.5 s") as refusal:
        simulate(crushed, inputs=course)
    with pytest.raises(FmuError) as single:
        simulate(crushed, inputs=lambda time: {"plane.press.point.z": float(Inputs(course).values(time, time)[0])})
    assert str(single.value) == str(refusal.value)


@pytest.mark.filterwarnings("error")
@pytest.mark.usefixtures("ctrl_c_is_heard")
@pytest.mark.parametrize("inputs", [{"load.push.x": 1.0}, lambda time: {"load.push.x": 1.0}], ids=["many", "single"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_while_the_component_speaks_ends_the_run(number, inputs, request):
    """A KeyboardInterrupt raised in a callback of the library would be printed and lost."""
    said = []

    def interrupt(message):
        if not said:
            os.kill(os.getpid(), number)
        said.append(message)

    def listen(simulation, _inputs):
        simulation.component.listener = interrupt

    before = signal.signal(number, signal.default_int_handler)
    request.addfinalizer(lambda: signal.signal(number, before))
    restless = PUSHED.replace({"experiment.stop_time": 200.0})
    with pytest.raises(Interrupted) as stop:
        simulate(restless, begun=listen, inputs=inputs)
    assert said and len(stop.value.result.time) < 200_000


def test_progress_is_told_at_every_two_hundredth(calls):
    told = []
    simulate(PUSHED, progress=lambda share, time: told.append((share, time)))
    assert [share for share, _ in told] == [n / 200 for n in range(1, 201)]
    np.testing.assert_allclose([time for _, time in told], np.arange(1, 201) * 0.01)
