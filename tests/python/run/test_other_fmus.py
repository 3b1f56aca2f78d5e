"""FMUs of other programs, with variables of every type, in all that runs or lists an FMU."""

import csv
import sys

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from other_fmu import COMPILER, build_other_fmu
from softffd import FmuError, Simulation, simulate, sweep
from softffd.cli.command import main

R = 'Größe "r", m'
pytestmark = pytest.mark.skipif(sys.platform != "linux" or not COMPILER, reason="wants Linux and a C compiler named cc")


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    return build_other_fmu(tmp_path_factory.mktemp("other") / "other.FMU")


def test_each_type_has_its_own_calls(other):
    with Simulation(other) as sim:
        sim["u"], sim["on"], sim["said"] = 1.0, True, "good"
        sim.step(0.01)
        assert (sim[R], sim["count"], sim["level"]) == (1.0, 42, "high")
        assert sim["open"] is True and sim["on"] is True and sim["word"] == "good"
        with pytest.raises(FmuError, match="word: wanted a number, got a String"):
            sim.number("word")


def test_a_run_has_all_numbers_and_no_positions(other):
    result = simulate(other, start_values={"on": "true", "u": 2.0})
    assert result.positions.shape == (11, 0, 0, 0, 3) and set(result.outputs) == {R, "level", "open"}
    assert result.outputs[R][-1] == 2 and result.outputs["open"].tolist() == [0] + 5 * [1] + 5 * [0]
    assert result.inputs["on"].all() and result.parameters == {"count": 42}
    assert "positions" not in repr(result)


@pytest.mark.parametrize("kind", ["table", "function"])
def test_booleans_are_driven_and_held_between_rows(other, kind):
    table = np.array([(0, 0, 1.0), (0.05, 1, 3.0)], dtype=[("time", float), ("on", float), ("u", float)])
    source = table if kind == "table" else lambda t: {"on": t > 0.049, "u": 1 + 40 * min(t, 0.05)}
    result = simulate(other, inputs=source)
    np.testing.assert_allclose(result.outputs[R][1:], [-1, -1.4, -1.8, -2.2, -2.6, 3, 3, 3, 3, 3])


def test_a_sweep_varies_booleans_and_reads_them(other):
    table = sweep(other, {"on": ["false", 1], "u": [2.0]}, outputs=[R, "open", "max(open)"])
    assert table.outputs[R].ravel().tolist() == [-2, 2] and not table.outputs["open"].any() and table.outputs["max(open)"].all()


@pytest.mark.parametrize(
    "given, message",
    [
        ({"start_values": {"count": 2.7}}, "count: wanted an integer, got 2.7"),
        ({"start_values": {"on": "yes"}}, "on: wanted true, false, 1 or 0, got 'yes'"),
        ({"start_values": {"said": 3}}, "said: wanted text, got 3"),
        ({"inputs": {"on": 0.5}}, "on: wanted 0 or 1, got 0.5"),
        ({"output": ["word"]}, "output: word: wanted an output of the FMU that is a number, got a String"),
    ],
)
def test_what_is_no_value_of_a_type_is_refused(other, given, message):
    with pytest.raises(FmuError, match=message):
        simulate(other, **given)


def test_it_runs_from_the_command_line_with_names_of_any_letters(other, tmp_path, capsys):
    assert main(["run", str(other), "--set", "on=true", "--set", "u=2", "-o", str(tmp_path)]) == 0, capsys.readouterr().err
    with open(tmp_path / "result.csv", encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert list(rows[0]) == ["time", R, "level", "open"] and rows[-1][R] == "2"


def test_info_runs_nothing_of_an_fmu(other, monkeypatch, capsys):
    monkeypatch.setattr(FMU2Slave, "__init__", lambda *_given, **_named: pytest.fail("its library was loaded"))
    assert main(["info", str(other)]) == 0
    assert "open" in capsys.readouterr().out
