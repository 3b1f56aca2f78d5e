"""Fits find the parameters that made a curve, say how well, and say what a curve cannot tell."""

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from scenes import box, table_and_press
from softffd import FmuError, Simulation, SoftffdError, fit, load_scene, package_fmu, simulate
from softffd.cli.command import main

FORCE, WAY = "plane.press.reaction.z", "plane.press.point.z"
COURSE = np.array([(0.0, 1.0), (0.15, 0.85), (0.3, 1.0)], dtype=[("time", float), (WAY, float)])
TRUTH = {"stiffness.edge": 1500.0, "damping": 3.0}
NOISE = 3.0
"""Of the force, whose largest value is 1750 N [N]"""


def pressed(**keys):
    """A box that a press crushes by 15 % and lets go."""
    press = {"plane": table_and_press(friction=0.3), "reactions": True, "gravity": [0.0, 0.0, -9.81]}
    body = {"lattice": {"points": [3, 3, 3]}, "stiffness": 1000.0, "damping": 2.0}
    return box(**press, **body, stop_time=0.3, communication_step=0.005, title="Pressed box", **keys)


SCENE = pressed()


@pytest.fixture(scope="module")
def curve() -> dict[str, np.ndarray]:
    """What a run with the true parameters gives, in the middles of its steps, and the way of the press there."""
    result = simulate(SCENE, start_values=TRUTH, inputs=COURSE)
    middles = (result.time[1:] + result.time[:-1]) / 2
    return {"time": middles, FORCE: result.outputs[FORCE][1:], WAY: np.interp(middles, COURSE["time"], COURSE[WAY])}


def noisy(curve, seed: int, noise: float = NOISE) -> dict[str, np.ndarray]:
    force = curve[FORCE] + np.random.default_rng(seed).normal(0.0, noise, len(curve[FORCE]))
    return {"time": curve["time"], FORCE: force}


def within(found, errors: float = 4.0) -> None:
    """The truth is within so many standard errors: 4 of them miss it once in 16,000 times."""
    for name, value in TRUTH.items():
        assert abs(found.values[name] - value) < errors * found.errors[name], found


def test_the_parameters_that_made_a_curve_are_found(curve):
    found = fit(SCENE, noisy(curve, 1), FORCE, TRUTH.keys(), inputs=COURSE)
    within(found)
    assert found.deviation == pytest.approx(NOISE, rel=0.3) and not found.warnings
    assert 0 < found.errors["stiffness.edge"] < 5 and 0 < found.errors["damping"] < 0.2
    assert found.correlations.shape == (2, 2) and np.allclose(np.diag(found.correlations), 1)
    exact = fit(SCENE, noisy(curve, 1, 0.0), FORCE, TRUTH.keys(), inputs=COURSE)
    assert [exact.values[name] for name in TRUTH] == pytest.approx(list(TRUTH.values()), rel=1e-4)


@pytest.mark.full
def test_95_of_100_noisy_curves_hold_the_truth_within_two_standard_errors(curve):
    """Of independent trials of 0.954 each, 100 have 90 to 100 hits in 98.6 % of all cases."""
    hits = dict.fromkeys(TRUTH, 0)
    for seed in range(100):
        found = fit(SCENE, noisy(curve, 1000 + seed), FORCE, TRUTH.keys(), inputs=COURSE)
        for name, value in TRUTH.items():
            hits[name] += abs(found.values[name] - value) < 2 * found.errors[name]
    print(hits)
    assert all(hit >= 90 for hit in hits.values()) and min(hits.values()) < 100, hits


def test_over_a_displacement_each_way_is_its_own_curve(curve):
    data = {name: column for name, column in {**noisy(curve, 2), WAY: curve[WAY]}.items() if name != "time"}
    found = fit(SCENE, data, FORCE, TRUTH.keys(), inputs=COURSE, against=WAY)
    within(found)
    assert found.curves[0].against == WAY and found.curves[0].units[WAY] == "m"
    probed = pressed(probe=[{"name": "top", "at": [0.5, 0.5, 1.0]}])
    result = simulate(probed, start_values=TRUTH, inputs=COURSE)
    top = result.outputs["probe.top.z"]
    data = {"probe.top.z": (top[1:] + top[:-1])[:30] / 2, FORCE: result.outputs[FORCE][1:31]}
    over_output = fit(probed, data, FORCE, ["stiffness.edge"], against="probe.top.z", inputs=COURSE, start_values={"damping": 3.0})
    assert over_output.values["stiffness.edge"] == pytest.approx(1500, rel=1e-3)


@pytest.mark.parametrize("recorded", [True, False])
def test_a_run_s_own_table_is_of_means_that_end_at_its_times(recorded):
    result = simulate(SCENE, start_values=TRUTH, inputs=COURSE)
    found = fit(SCENE, {"time": result.time, FORCE: result.outputs[FORCE]}, FORCE, TRUTH.keys(), inputs=COURSE, recorded=recorded)
    assert (found.values["damping"] == pytest.approx(3.0, rel=1e-4)) == recorded


@pytest.mark.full
def test_a_curve_of_zeros_tells_nothing():
    data = {"time": np.linspace(0, 0.1, 11), FORCE: np.zeros(11)}
    found = fit(SCENE, data, FORCE, TRUTH.keys(), inputs={WAY: 2.0})
    assert np.isinf(list(found.errors.values())).all() and found.deviation == 0


def bonded_pad(step: float):
    """A pad between two plates, of one patch, and the smooth course that presses it, of rows `step` s apart."""
    pad = load_scene("flat_pad").replace({"lattice.points": [4, 4, 4], "solver.tolerance": 1e-3})
    times = np.arange(101) * step
    return pad, {"time": times, PLATE: 0.02 - 4e-4 * np.sin(np.pi * times / times[-1]) ** 2}


PLATE, PUSHED = "pin.plate.position.z", "pin.plate.reaction.z"


def test_a_force_measured_at_its_time_is_no_half_step_late():
    """The truth is made with steps a tenth as long. Damping makes a force come earlier by its time, half a step is half of it here."""
    pad, course = bonded_pad(5e-4)
    inputs = np.rec.fromarrays(list(course.values()), names=list(course))
    fine = simulate(pad, start_values={"internal_damping": 2.5e-3}, inputs=inputs, stop_time=0.05, step=5e-4)
    force = np.append(0.0, (fine.outputs[PUSHED][1:-1] + fine.outputs[PUSHED][2:]) / 2)
    data = {name: column[:-1] for name, column in course.items()} | {PUSHED: force}
    found = fit(pad, data, PUSHED, {"youngs_modulus": None, "internal_damping": 1e-3}, step=2.5e-3, tolerance=1e-4)
    assert found.values["internal_damping"] == pytest.approx(2.5e-3, rel=0.03)
    assert found.values["youngs_modulus"] == pytest.approx(2e6, rel=0.01)


@pytest.mark.full
def test_tests_share_their_parameters_and_noise_weighs_them(curve):
    found = fit([SCENE, SCENE], [noisy(curve, 3), noisy(curve, 4, 30.0)], FORCE, TRUTH.keys(), inputs=COURSE, noise=[3.0, 30.0])
    within(found)
    assert len(found.curves) == 2 and found.rows == 120 and found.deviation == pytest.approx(3.0, rel=0.3)


def test_two_tests_of_one_file_are_two_runs(curve, tmp_path):
    file = package_fmu(SCENE, tmp_path / "pressed.fmu").absolute()
    short = {name: column[:30] for name, column in noisy(curve, 5).items()}
    found = fit([file, file], [short, noisy(curve, 6)], FORCE, TRUTH.keys(), inputs=COURSE)
    within(found)
    assert [len(each.measured) for each in found.curves] == [30, 60]


def test_what_a_curve_cannot_tell_is_named():
    table = "plane.table.reaction.z"
    result = simulate(SCENE, inputs={}, start_values={"mass": 2.0})
    force = result.outputs[table][1:]
    data = {"time": result.time[1:] - 0.0025, table: force + np.random.default_rng(5).normal(0.0, 0.5, len(force))}
    found = fit(SCENE, data, table, {"mass": 1.5, "plane.table.friction": None}, inputs={})
    assert found.undetermined == (("plane.table.friction",),) and np.isinf(found.errors["plane.table.friction"])
    assert abs(found.values["mass"] - 2.0) < 4 * found.errors["mass"] < 0.1
    assert "plane.table.friction cannot be told from these data" in found.warnings[0]
    assert json.dumps(found._as_json()).count("null") == 4  # an error, and correlations with it


def test_parameters_that_only_their_ratio_tells_are_named_together():
    """The frequency of a free vibration is that of the root of modulus over mass."""
    body = {"lattice": {"points": [2, 2, 2]}, "material": {"youngs_modulus": 1e4}, "stretch": [1.1, 1.0, 1.0]}
    swinging, place = box(**body, stop_time=0.5, communication_step=0.01), "position[1,1,1].x"
    result = simulate(swinging)
    places = result.outputs[place] if place in result.outputs else result.positions[:, 1, 1, 1, 0]
    data = {"time": result.time, place: places + np.random.default_rng(6).normal(0.0, 1e-3, len(result.time))}
    found = fit(swinging, data, place, {"youngs_modulus": 1.2e4, "mass": 1.1})
    assert found.undetermined == (("youngs_modulus", "mass"),)
    assert found.values["youngs_modulus"] / found.values["mass"] == pytest.approx(1e4, rel=0.02)
    assert "youngs_modulus and mass cannot be told apart from these data" in found.warnings[0]


def test_what_follows_itself_is_no_noise(curve):
    data = noisy(curve, 1)
    data[FORCE] = data[FORCE] + 40 * np.sin(data["time"] * 30)
    assert any("the model does not follow the data" in words for words in fit(SCENE, data, FORCE, TRUTH.keys(), inputs=COURSE).warnings)


def test_one_component_makes_all_runs(curve, monkeypatch):
    opened, begin = [], Simulation.__init__
    monkeypatch.setattr(Simulation, "__init__", lambda self, *args, **keys: (opened.append(args), begin(self, *args, **keys))[1])
    told = []
    found = fit(SCENE, noisy(curve, 1), FORCE, TRUTH.keys(), inputs=COURSE, progress=lambda runs, residual: told.append((runs, residual)))
    assert len(opened) == 2  # one looks at the question before
    assert found.runs == told[-1][0] > 10
    assert told[-1][1] < told[0][1] / 10


@pytest.mark.full
def test_workers_of_an_executor_find_the_same(curve):
    here = fit(SCENE, noisy(curve, 1), FORCE, TRUTH.keys(), inputs=COURSE)
    with ThreadPoolExecutor(2) as executor:
        there = fit(SCENE, noisy(curve, 1), FORCE, TRUTH.keys(), inputs=COURSE, executor=executor)
    in_processes = fit(SCENE, noisy(curve, 1), FORCE, TRUTH.keys(), inputs=COURSE, jobs=2)
    assert there.values == here.values == in_processes.values and there.errors == here.errors


def test_an_interrupt_tells_the_best_so_far(curve):
    def stop(runs: int, _residual: float) -> None:
        if runs > 8:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"after \d+ runs; best so far: stiffness.edge = 1\d+\S* N/m, damping = "):
        fit(SCENE, noisy(curve, 1), FORCE, TRUTH.keys(), inputs=COURSE, progress=stop)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"match": "plane.press.reacton.z"}, 'match: plane.press.reacton.z: wanted an output .*did you mean "plane.press.reaction.z"'),
        ({"match": WAY}, f"match: {WAY}: wanted an output of the FMU that is a number, got its input of that name"),
        ({"match": "plane.table.reaction.z"}, "wanted a column plane.table.reaction.z, got time, plane.press.reaction.z, did you mean"),
        (
            {"vary": ["stifness.edge"]},
            'vary: stifness.edge: cannot be fitted: the FMU has no such parameter, did you mean "stiffness.edge"',
        ),
        (
            {"vary": [WAY]},
            f"vary: {WAY}: cannot be fitted: wanted a fixed or tunable parameter that is a Real, got an input; those that can",
        ),
        ({"vary": ["solver.method"]}, "vary: solver.method: cannot be fitted: wanted a Real"),
        ({"vary": {"damping": -1.0}}, "vary: damping: wanted a start > 0, for it is positive, got -1"),
        ({"vary": []}, "vary: wanted at least one parameter"),
        ({"against": "plane.press.point.q"}, "against: plane.press.point.q: the FMU has no such variable"),
        ({"stop_time": 0.2}, "data: time: wanted rows up to the run's end, 0.2 s, got one at 0.2025 s"),
        ({"start_values": {"damping": 1.0}}, "damping: is varied, so that its start value would be lost"),
        ({"noise": [0.0]}, "noise: wanted a number > 0 for each of 1 tests"),
        ({"noise": 0.0}, r"noise: wanted a number > 0 for each of 1 tests, got \[0.0\]"),
        ({"jobs": 0}, "jobs: wanted a whole number of at least 1, got 0"),
        ({"data": [1, 2]}, "data: wanted one for each scene or FMU, got 2 for 1"),
    ],
)
def test_bad_questions_are_refused(curve, change, words):
    asked = {"data": noisy(curve, 1), "match": FORCE, "vary": ["damping"], "inputs": COURSE} | change
    with pytest.raises(SoftffdError, match=words):
        fit(SCENE, asked.pop("data"), asked.pop("match"), asked.pop("vary"), **asked)


def test_data_must_be_more_than_parameters_and_begin_with_the_run(curve):
    few = {name: column[:2] for name, column in noisy(curve, 1).items()}
    with pytest.raises(FmuError, match="data: wanted more rows than the 2 parameters, got 2"):
        fit(SCENE, few, FORCE, TRUTH.keys(), inputs=COURSE)
    with pytest.raises(FmuError, match="data: wanted times >= 0 s"):
        fit(SCENE, noisy(curve, 1) | {"time": curve["time"] - 1}, FORCE, TRUTH.keys(), inputs=COURSE)


def test_flat_names_mean_the_same(curve):
    data = {name.replace(".", "_"): column for name, column in {**noisy(curve, 2), WAY: curve[WAY]}.items() if name != "time"}
    flat = pressed(fmu={"names": "flat"})
    asked = {"inputs": COURSE, "against": "plane_press_point_z"}
    found = fit(flat, data, "plane_press_reaction_z", ["stiffness_edge", "damping"], **asked)
    wanted = fit(SCENE, noisy(curve, 2) | {WAY: curve[WAY]}, FORCE, TRUTH.keys(), inputs=COURSE, against=WAY)
    assert list(found.values.values()) == pytest.approx(list(wanted.values.values()), rel=1e-6)


def test_inputs_come_from_the_data_or_from_elsewhere(curve):
    data = noisy(curve, 1) | {WAY: curve[WAY], "plane.press.velocity.z": curve[WAY]}
    with pytest.raises(FmuError, match=r"has columns of inputs, plane.press.point.z, plane.press.velocity.z, and `inputs` drives"):
        fit(SCENE, data, FORCE, ["damping"], inputs=COURSE)


def test_columns_that_nothing_is_done_with_are_told(curve):
    data = noisy(curve, 1) | {"plane.pres.point.z": curve[WAY]}
    words = fit(SCENE, data, FORCE, ["stiffness.edge"], inputs=COURSE).warnings
    assert any('not used: plane.pres.point.z, did you mean "plane.press.point.z"?' in each for each in words)


@pytest.mark.full
def test_poissons_ratio_stays_in_its_range():
    """A bonded pad, whose force says how little its volume changes."""
    pad, _ = bonded_pad(5e-4)
    course = np.array([(0.0, 0.02), (0.05, 0.0196)], dtype=[("time", float), (PLATE, float)])
    asked = {"inputs": course, "stop_time": 0.05, "step": 0.005}
    result = simulate(pad, start_values={"poissons_ratio": 0.4}, **asked)
    data = {"time": result.time[1:] - 0.0025, PUSHED: result.outputs[PUSHED][1:]}
    found = fit(pad, data, PUSHED, ["poissons_ratio"], **asked)
    assert found.values["poissons_ratio"] == pytest.approx(0.4, abs=1e-3) and not any("range" in each for each in found.warnings)
    with pytest.raises(FmuError, match=r"vary: poissons_ratio: wanted a start from 0 to 0.495, got 0.6"):
        fit(pad, data, PUSHED, {"poissons_ratio": 0.6}, **asked)


def test_the_command_keeps_numbers_data_and_picture(curve, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    package_fmu(SCENE, "pressed.fmu")
    data = noisy(curve, 1) | {WAY: curve[WAY]}
    rows = [",".join(f"{value:.9g}" for value in row) for row in zip(*data.values(), strict=True)]
    (tmp_path / "measured.csv").write_text("\n".join([",".join(data), *rows]))
    words = ["fit", "pressed.fmu", "--data", "measured.csv", "--match", FORCE, "--vary", "stiffness.edge=1200", "--vary", "damping"]
    assert main([*words, "-j", "1"]) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"Fit of 2 parameters to {FORCE}, ") and "kept in softffd-fit-pressed: fit.json, fit.csv, fit.png" in said
    kept = json.loads((tmp_path / "softffd-fit-pressed" / "fit.json").read_text())
    assert kept["parameters"]["stiffness.edge"]["unit"] == "N/m" and kept["parameters"]["stiffness.edge"]["start"] == 1200
    assert (tmp_path / "softffd-fit-pressed" / "fit.csv").read_text().startswith("test,time,measured,fitted,residual\n1,")
    assert (tmp_path / "softffd-fit-pressed" / "fit.png").read_bytes().startswith(b"\x89PNG")
    assert main(words) == 1 and "there already" in capsys.readouterr().err
    assert main([*words, "--vary", "damping=a"]) == 1 and "wanted NAME or NAME=START" in capsys.readouterr().err


def test_an_fmu_of_others_is_fitted(tmp_path):
    """The plate of the drivers, of FMI 2 by pythonfmu: a force tells its mass."""
    pytest.importorskip("pythonfmu")
    from softffd.drivers import build_driver

    plate = build_driver("plate", tmp_path)
    asked = {"stop_time": 0.5, "step": 0.05, "inputs": {"force.z": 30.0}}
    result = simulate(plate, start_values={"mass": 2.5, "delay": 0}, **asked)
    data = {"time": result.time, "velocity.z": result.outputs["velocity.z"]}
    found = fit(plate, data, "velocity.z", ["mass"], start_values={"delay": 0}, **asked)
    assert found.values["mass"] == pytest.approx(2.5, rel=1e-4)


def test_without_scipy_the_command_that_installs_it_is_told(curve, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "scipy.optimize", None)
    with pytest.raises(SoftffdError, match=r"fit needs scipy.optimize, which is not installed here: pip install 'softffd\[fit\]'"):
        fit(SCENE, noisy(curve, 1), FORCE, ["damping"])
