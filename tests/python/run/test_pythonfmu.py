"""FMUs made with pythonfmu, one of a user's own and the driver plate.fmu, in everything that runs an FMU."""

import csv
import os
import signal

import numpy as np
import pytest

from softffd import Simulation, simulate, sweep
from softffd.cli.command import main
from softffd.drivers import build_driver
from softffd.errors import Interrupted
from softffd.run import drive

pytest.importorskip("pythonfmu")
from pythonfmu.builder import FmuBuilder

SOURCE = '''
from pythonfmu import Boolean, DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real


class Tank(Fmi2Slave):
    """Water that flows in and leaks out."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.default_experiment = DefaultExperiment(stop_time=1.0, step_size=0.125)
        self.inflow, self.leak, self.level, self.steps, self.full = 1.0, 0, 0.0, 0, False
        self.register_variable(Real("inflow", causality=Fmi2Causality.input, start=1.0))
        self.register_variable(Integer("leak", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable, start=0))
        self.register_variable(Real("level", causality=Fmi2Causality.output))
        self.register_variable(Integer("steps", causality=Fmi2Causality.output))
        self.register_variable(Boolean("full", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.level += step_size * (self.inflow - self.leak)
        self.steps, self.full = self.steps + 1, self.level >= 0.5
        return True
'''


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tank")
    (folder / "tank.py").write_text(SOURCE)
    return FmuBuilder.build_FMU(folder / "tank.py", dest=folder)


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    return build_driver("plate", tmp_path_factory.mktemp("plate"))


def test_a_simulation_steps_reads_and_sets_it(tank, plate):
    with Simulation(tank) as sim:
        sim["inflow"] = 2.0
        sim.step()
        assert (sim["level"], sim["steps"], sim["full"]) == (0.25, 1, False)
    with Simulation(plate, start_values={"mass": 2.0, "initial.point": (0, 0, 1)}) as sim:
        sim["reaction"] = (0.0, 0.0, 2 * 9.81)
        before = sim.save()
        sim.step(0.5)
        falls = sim["point"]
        sim.restore(before)
        sim.step(0.5)
        np.testing.assert_array_equal(sim["point"], falls)


def test_simulate_has_its_outputs_over_time(tank, plate):
    result = simulate(tank, inputs=lambda t: {"inflow": 1.0 + (t >= 0.5)})
    np.testing.assert_array_equal(result.outputs["level"], [0, 0.125, 0.25, 0.375, 0.5, 0.75, 1.0, 1.25, 1.5])
    assert result.outputs["full"].tolist() == 4 * [0] + 5 * [1] and result.outputs["steps"][-1] == 8
    result = simulate(plate, stop_time=0.5, step=0.01, start_values={"delay": 0, "initial.velocity": (1.0, 0, 0)})
    np.testing.assert_allclose(result.outputs["point.z"], -0.5 * 9.81 * result.time**2, atol=1e-12)
    np.testing.assert_allclose(result.outputs["point.x"], result.time, atol=1e-12)


@pytest.mark.usefixtures("ctrl_c_is_heard")
def test_an_interrupted_run_has_outputs_of_all_kinds_of_its_last_step(tank, monkeypatch):
    def interrupted(*names):
        return lambda many, until: (steps(*names)(many, until), until == 5 and os.kill(os.getpid(), signal.SIGINT))[0]

    steps = drive.library_function
    monkeypatch.setattr(drive, "library_function", interrupted)
    with pytest.raises(Interrupted) as stop:
        simulate(tank)
    outputs = stop.value.result.outputs
    assert outputs["level"][-1] == 0.625 and outputs["full"].tolist() == [0, 0, 0, 0, 1, 1]


def test_a_sweep_varies_its_parameters_and_inputs(tank, plate):
    table = sweep(tank, {"leak": [0, 1], "inflow": [1.0, 3.0]}, outputs=["level", "max(full)"])
    np.testing.assert_array_equal(table.outputs["level"], [[1, 3], [0, 2]])
    assert table.outputs["max(full)"].tolist() == [[1, 1], [0, 1]]
    table = sweep(plate, {"mass": [1.0, 2.0]}, outputs="momentum.z", start_values={"delay": 0}, stop_time=0.5, step=0.01)
    np.testing.assert_allclose(table.outputs["momentum.z"], [-0.5 * 9.81, -9.81])


def test_the_command_runs_it(tank, plate, tmp_path, capsys):
    assert main(["run", str(tank), "--set", "leak=1", "--set", "inflow=3", "-o", str(tmp_path / "tank")]) == 0, capsys.readouterr().err
    assert main(["run", str(plate), "--stop-time", "0.5", "--step", "0.1", "-o", str(tmp_path / "plate")]) == 0, capsys.readouterr().err
    for given, missing in ((["--stop-time", "0.5"], "--step"), (["--step", "0.1"], "--stop-time")):
        assert main(["run", str(plate), *given]) == 1 and f"the FMU has no default: give {missing} " in capsys.readouterr().err
    with open(tmp_path / "tank" / "result.csv", encoding="utf-8", newline="") as stream:
        assert list(csv.DictReader(stream))[-1] == {"time": "1", "level": "2", "steps": "8", "full": "1"}
    assert main(["info", str(plate)]) == 0 and "initial.point" in capsys.readouterr().out
