"""Sweeps: the numbers are those of single runs, failures and interrupts cost nothing of the rest, wrong questions are refused."""

import csv
import multiprocessing
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

import deadly_runs
import softffd
from scenes import box, table_and_press
from softffd import FmuError, SoftffdError, Sweep, load_scene, simulate, sweep
from softffd.cli.command import main
from softffd.run import sweep_runs as sweeping
from softffd.run.drive import Drive

SCENE = box(
    plane=table_and_press(friction=0.3), gravity=[0.0, 0.0, -9.81], reactions=True, energy=True, solver={"tolerance": 1e-3},
    outputs={"solver": True}, stop_time=0.05, communication_step=0.01, title="Pressed box",
)  # fmt: skip
VARY = {"stiffness.edge": [400.0, 900.0], "plane.press.point.z": [1.0, 0.9, 0.95]}
FORCE, STEPS = "plane.table.reaction.z", "solver.steps"
COURSE = np.array([(0.0, 1.0), (0.05, 0.9)], dtype=[("time", float), ("plane.press.point.z", float)])


@pytest.fixture(scope="module")
def table() -> Sweep:
    return sweep(SCENE, VARY, outputs=[FORCE, f"max({FORCE})", "min(energy.kinetic)", "mean(energy.kinetic)", STEPS])


def test_a_sweep_has_the_numbers_of_single_runs_whatever_ran_before(table):
    for i, edge in enumerate(VARY["stiffness.edge"]):
        for j, height in enumerate(VARY["plane.press.point.z"]):
            found = simulate(SCENE, start_values={"stiffness.edge": edge, "plane.press.point.z": height}).outputs
            assert table.outputs[FORCE][i, j] == found[FORCE][-1]
            assert table.outputs[f"max({FORCE})"][i, j] == found[FORCE].max()
            assert table.outputs["min(energy.kinetic)"][i, j] == found["energy.kinetic"].min()
            assert table.outputs["mean(energy.kinetic)"][i, j] == pytest.approx(found["energy.kinetic"].mean(), rel=1e-14)
            assert table.outputs[STEPS][i, j] == found[STEPS][-1]
    assert len(np.unique(table.outputs[FORCE])) == 6


def test_inputs_drive_every_run():
    table = sweep(SCENE, {"mass": [1, 2]}, outputs=[FORCE], inputs=COURSE)
    alone = [simulate(SCENE, start_values={"mass": mass}, inputs=COURSE).outputs[FORCE][-1] for mass in (1, 2)]
    assert table.outputs[FORCE].tolist() == alone


def test_processes_make_the_same_table(table):
    several = sweep(SCENE, VARY, outputs=list(table.outputs), jobs=2)
    for name, column in table.outputs.items():
        assert np.array_equal(several.outputs[name], column)


def test_by_default_all_outputs_but_those_at_control_points_are_read_and_a_vector_means_its_components():
    names = list(sweep(SCENE, {"mass": [1]}, stop_time=0.01).outputs)
    assert FORCE in names and STEPS in names and not any("[" in name for name in names)
    table = sweep(SCENE, {"mass": [1]}, outputs=["max(plane.table.reaction)", "position[0,0,0]"], stop_time=0.01)
    assert list(table.outputs) == [*(f"max(plane.table.reaction.{c})" for c in "xyz"), *(f"position[0,0,0].{c}" for c in "xyz")]


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_failed_run_keeps_its_words_and_the_rest_goes_on(jobs):
    table = sweep(SCENE, {"stiffness.edge": [400.0, -5.0, 900.0]}, outputs=[FORCE], jobs=jobs)
    assert np.isnan(table.outputs[FORCE]).tolist() == [False, True, False]
    ((values, words),) = table.failures
    assert values == {"stiffness.edge": -5.0} and "wanted >= 0 N/m, got -5" in words
    assert table.outputs[FORCE][2] == sweep(SCENE, {"stiffness.edge": [900.0]}, outputs=[FORCE]).outputs[FORCE][0]


def test_a_run_that_is_refused_on_its_way_says_when(monkeypatch):
    go_on = Drive.go_on

    def refused(drive, until):
        go_on(drive, min(until, 3))
        if until > 3:
            raise FmuError("no more")

    monkeypatch.setattr(Drive, "go_on", refused)
    ((_, words),) = sweep(SCENE, {"mass": [1]}, outputs=[FORCE]).failures
    assert words == "at 0.03 s: no more"


def test_a_run_that_takes_its_process_down_is_a_failed_run(monkeypatch):
    monkeypatch.setattr(sweeping, "run_list", deadly_runs.run_list)
    table = sweep(SCENE, {"mass": [1, 2, 3]}, outputs=[FORCE], jobs=2)
    assert table.failures == [({"mass": 2}, "the worker process ended, each time that it was tried")]
    assert np.isnan(table.outputs[FORCE]).tolist() == [False, True, False]


def test_runs_that_a_chunk_has_no_time_for_are_made_in_later_ones(table, monkeypatch):
    monkeypatch.setattr(sweeping, "CHUNKS", 1)
    monkeypatch.setattr(sweeping, "CHUNK_TIME", 0.0)
    chunks, told = [], []
    run = sweeping.run_list
    monkeypatch.setattr(sweeping, "run_list", lambda plan, runs: chunks.append(len(runs)) or run(plan, runs))
    with ThreadPoolExecutor(1) as executor:
        made = sweep(SCENE, VARY, outputs=list(table.outputs), executor=executor, progress=lambda done, _total: told.append(done))
    assert chunks == [6, 5, 4, 3, 2, 1] and told == [1, 2, 3, 4, 5, 6]
    assert all(np.array_equal(made.outputs[name], column) for name, column in table.outputs.items())


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_interrupted_sweep_goes_on_where_it_was(table, tmp_path, monkeypatch, jobs):
    file, wanted = tmp_path / "kept.npz", list(table.outputs)

    def stop(done, total):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"4 of 6 runs are kept in .*kept.npz"):
        sweep(SCENE, VARY, outputs=wanted, file=file, jobs=jobs, progress=stop)
    kept = Sweep.load(file)
    assert kept.done.sum() == 4 and np.isnan(kept.outputs[FORCE]).sum() == 2
    told = []
    whole = sweep(SCENE, VARY, outputs=wanted, file=file, jobs=jobs, progress=lambda done, total: told.append((done, total)))
    assert told == [(5, 6), (6, 6)]
    assert all(np.array_equal(whole.outputs[name], table.outputs[name]) for name in wanted)
    assert [path.name for path in tmp_path.iterdir()] == ["kept.npz"]


def test_variables_may_have_any_name(tmp_path):
    names = ("file", "allow_pickle", "a/b", "args")
    about = {"values": ["file"], "outputs": names[1:], "units": dict.fromkeys(names, ""), "title": "Names"}
    table = Sweep({"file": np.arange(2.0)}, {name: np.ones(2) for name in names[1:]}, np.array(["", "x"], object), np.ones(2, bool), about)
    loaded = Sweep.load(table.save(tmp_path / "kept.npz"))
    assert loaded.values["file"].tolist() == [0, 1] and list(loaded.outputs) == list(names[1:]) and loaded.failures == table.failures


def test_a_file_of_another_sweep_or_of_another_build_of_the_library_is_refused(tmp_path, monkeypatch):
    file, asked = tmp_path / "kept.npz", {"stop_time": 0.01, "file": tmp_path / "kept.npz"}
    sweep(SCENE, {"mass": [1]}, outputs=[FORCE], **asked)
    with pytest.raises(SoftffdError, match="holds another sweep: other values, outputs;"):
        sweep(SCENE, {"mass": [2]}, outputs=[STEPS], **asked)
    with pytest.raises(SoftffdError, match="other fmu, inputs;"):
        sweep(SCENE.replace({"material.damping": 0.3}), {"mass": [1]}, outputs=[FORCE], inputs=COURSE, **asked)
    monkeypatch.setattr("softffd.fmu.component.Component.library_hash", lambda _component: "another")
    with pytest.raises(SoftffdError, match="holds another sweep: other library;"):
        sweep(SCENE, {"mass": [1]}, outputs=[FORCE], **asked)
    file.write_text("nothing")
    with pytest.raises(SoftffdError, match="damaged, or no sweep that softffd wrote"):
        sweep(SCENE, {"mass": [1]}, file=file)


@pytest.mark.parametrize(
    "vary, options, words",
    [
        ({"stifness.edge": [1]}, {}, r'stifness.edge: cannot be varied: .* did you mean "stiffness.edge"\?; those that can: .*mass'),
        ({"lattice.points": [3]}, {}, "lattice.points: cannot be varied: the FMU has no such parameter or input.*those that can: .*mass"),
        ({FORCE: [3]}, {}, "cannot be varied: it is an output; those that can"),
        ({"plane.press.velocity.z": [1]}, {"inputs": COURSE}, r"velocity.z: cannot be varied: inputs gives it \(or its velocity\)"),
        ({}, {}, "vary: wanted values by name"),
        ({"mass": 2.0}, {}, "mass: wanted a list of values"),
        ({"mass": [1, float("nan")]}, {}, "mass: wanted finite numbers"),
        ({"solver.method": ["bm5"]}, {}, 'did you mean "bm4"'),
        ({"mass": range(1, 10_001), "damping": range(10_000)}, {}, "wanted at most 1e.07 values"),
        ({"mass": [1]}, {"outputs": ["max(plane.tabel.reaction.z)"]}, 'did you mean "plane.table.reaction.z"'),
        ({"mass": [1]}, {"outputs": [f"mx({FORCE})"]}, 'did you mean "max"'),
        ({"mass": [1]}, {"outputs": ["damping"]}, "wanted an output, got the FMU's parameter"),
        ({"mass": [1]}, {"outputs": []}, "outputs: wanted at least one"),
        ({"mass": [1]}, {"start_values": {"dampin": 1}}, 'did you mean "damping"'),
        ({"mass": [1]}, {"executor": 7}, r"executor: wanted one of concurrent\.futures, such as client\.get_executor\(\), got int"),
        ({"mass": [1]}, {"executor": SimpleNamespace(submit=print)}, r"client\.get_executor\(\), got SimpleNamespace"),
        *[({"mass": [1]}, {"jobs": wrong}, "jobs: wanted a whole number of at least 1") for wrong in (0, "2", 1.5)],
        ({"mass": [1]}, {"file": "kept.csv"}, r'wanted a file name ending in \.npz, did you mean "kept\.csv\.npz"'),
        ({"mass": [1]}, {"outputs": 5}, "5: wanted an output of the FMU"),
        ({"mass": [1, 2]}, {"start_values": {"mass": 3}}, "mass: is varied, so that its start value would be lost"),
        ({"solver.method": [1.5, 2.5]}, {}, r"solver\.method: wanted an integer, got 1\.5"),
    ],
)
def test_wrong_questions_are_refused_before_the_first_run(vary, options, words):
    with pytest.raises(SoftffdError, match=words):
        sweep(SCENE, vary, **options)


def test_a_table_goes_through_its_file_and_to_csv(table, tmp_path):
    loaded = Sweep.load(table.save(tmp_path / "table.npz"))
    assert repr(loaded) == repr(table) and "stiffness.edge (2) x plane.press.point.z (3); 6 runs, 0 failed" in repr(table)
    assert loaded.differences(table) == []
    rows = list(csv.DictReader(table.to_csv(tmp_path / "table.csv").open()))
    assert [(float(row["stiffness.edge"]), float(row["plane.press.point.z"])) for row in rows[:4]] == [
        (400, 1.0), (400, 0.9), (400, 0.95), (900, 1.0),
    ]  # fmt: skip
    assert [float(row[FORCE]) for row in rows] == loaded.outputs[FORCE].ravel().tolist()


def test_a_table_as_a_data_set(table):
    pytest.importorskip("xarray")
    data = table.to_xarray()
    assert float(data[FORCE].sel({"stiffness.edge": 900.0, "plane.press.point.z": 0.9})) == table.outputs[FORCE][1, 1]
    assert data[f"max({FORCE})"].attrs["units"] == "N"


def test_without_xarray_its_name_is_told(table, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(SoftffdError, match=r"pip install 'softffd\[datasets\]'"):
        table.to_xarray()


def made_up(title="Made up", **values) -> Sweep:
    """A table without runs; its last one has failed."""
    shape = tuple(map(len, values.values()))
    messages = np.full(shape, "", dtype=object)
    messages[(-1,) * len(shape)] = "no"
    about = {"title": title, "units": {**dict.fromkeys(values, "N/m"), FORCE: "N"}}
    output = np.random.default_rng(0).random(shape)
    return Sweep({name: np.array(given) for name, given in values.items()}, {FORCE: output}, messages, np.ones(shape, bool), about)


def test_one_variable_is_a_line_and_two_are_a_line_for_each_value_or_a_map(table, tmp_path):
    line = sweep(SCENE, {"solver.method": ["leapfrog", "bm4"]}, outputs=[FORCE], stop_time=0.01)
    (panel,) = line.plot().axes
    assert panel.lines[0].get_ydata().tolist() == line.outputs[FORCE].tolist()
    assert [text.get_text() for text in panel.get_xticklabels()] == ["leapfrog", "bm4"]
    figure = table.plot(tmp_path / "lines.png", outputs=FORCE)
    assert [text.get_text() for text in figure.axes[0].get_xticklabels()] == ["1", "0.9", "0.95"]
    (panel,), (legend,) = figure.axes, figure.legends
    drawn = [line.get_ydata().tolist() for line in panel.lines[:2]]
    assert drawn == table.outputs[FORCE][:, [1, 2, 0]].tolist()  # heights in their order
    assert [text.get_text() for text in legend.get_texts()] == ["400", "900"] and legend.get_title().get_text() == "stiffness.edge [N/m]"
    assert (tmp_path / "lines.png").read_bytes().startswith(b"\x89PNG") and panel.get_ylabel() == f"{FORCE} [N]"
    many = made_up(one=np.arange(9.0), other=np.arange(10.0)[::-1])
    panel, bar = many.plot().axes
    assert panel.collections[0].get_array().tolist() == many.outputs[FORCE][:, ::-1].tolist() and bar.get_ylabel() == f"{FORCE} [N]"


def test_values_that_grow_by_a_factor_have_a_logarithmic_scale_and_names_are_ticks():
    scales = {"few": [0.1, 0.25, 0.3], "factor": np.geomspace(500, 2000, 4), "decades": np.geomspace(1e-9, 1e9, 40), "one": [3.0]}
    drawn = {name: made_up(k=values).plot().axes[0].get_xscale() for name, values in scales.items()}
    assert drawn == {"few": "linear", "factor": "log", "decades": "log", "one": "linear"}
    names = ["leapfrog", "central_difference"] * 6
    over_names = made_up(k=names, other=np.geomspace(1, 1e9, 10)).plot()
    over_names.canvas.draw()
    axes = over_names.axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == names and axes.get_xticklabels()[0].get_rotation() == 60
    assert axes.get_yscale() == "log"


def test_ticks_are_the_values_and_have_words_where_there_is_room():
    ticks = {}
    for name, values in {"few": [0.3, 0.1, 0.25], "close": [1, 1.01, 1.5, 2], "alike": [1e6, 1e6 + 0.5]}.items():
        axes = made_up(k=values).plot().axes[0]
        assert axes.get_xticks().tolist() == values and not len(axes.get_xticks(minor=True))
        ticks[name] = [label.get_text() for label in axes.get_xticklabels()]
    assert ticks == {"few": ["0.3", "0.1", "0.25"], "close": ["1", "", "1.5", "2"], "alike": ["1000000", "1000000.5"]}
    many = made_up(k=np.geomspace(500, 2000, 60)).plot().axes[0]
    words = [label.get_text() for label in many.get_xticklabels()]
    assert len(words) == 60 and 8 < len([*filter(None, words)]) < 16 and (words[0], words[-1]) == ("500", "2000")


def test_words_of_the_user_are_drawn_as_they_are():
    title = r"from $5 to $10, $ $, {1}, 100 % \alpha"
    figure = made_up(title, **{"k$_2$": ["$a$", "$ $", "{}"], "other": ["_one", "$x^2$"]}).plot()
    figure.canvas.draw()
    (legend,) = figure.legends
    words = [figure._suptitle, figure.axes[0].xaxis.label, *figure.axes[0].get_xticklabels(), *legend.get_texts(), legend.get_title()]
    assert not any(text.get_parse_math() for text in words) and words[0].get_text() == title
    assert [text.get_text() for text in legend.get_texts()] == ["_one", "$x^2$"]


def test_a_picture_of_three_variables_is_refused():
    table = sweep(SCENE, {"mass": [1], "damping": [0.1], "stiffness.edge": [500]}, outputs=[FORCE], stop_time=0.01)
    with pytest.raises(SoftffdError, match="wanted one or two varied variables, got 3"):
        table.plot()


def test_the_command_keeps_table_and_picture_and_goes_on(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    arguments = ["sweep", "press", "--vary", "stiffness.edge=400:1600:3:log", "--vary", "solver.method=auto", "--stop-time", "0.02"]
    arguments += ["--measure", f"max({FORCE})", "-j", "1", "-o", "kept"]
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert "3 runs, 0 failed" in said and f"max({FORCE}): " in said
    assert sorted(path.name for path in (tmp_path / "kept").iterdir()) == ["sweep.csv", "sweep.npz", "sweep.png"]
    assert Sweep.load("kept/sweep.npz").values["stiffness.edge"] == pytest.approx([400, 800, 1600])
    monkeypatch.setattr(sweeping.Opened, "run", lambda opened, plan, index: pytest.fail("again"))
    assert main(arguments) == 0


@pytest.mark.parametrize(
    "vary, words",
    [
        ("mass", "wanted NAME=FROM:TO:COUNT"),
        ("mass=1:2", "wanted NAME=FROM:TO:COUNT"),
        ("mass=1:2:3:lin", "wanted NAME=FROM:TO:COUNT"),
        ("mass=1_0:20:3", "wanted NAME=FROM:TO:COUNT"),
        ("mass=1:2:2.5", "whole count"),
        ("mass=1:2:0", "a whole count of 1 to 1000000"),
        ("mass=0:2:3:log", "wanted ends > 0"),
        ("mass=heavy", "mass: wanted a number"),
        ("plane.press.point.z=1,2", "press.csv gives it"),
    ],
)
def test_the_command_refuses_wrong_values(vary, words, tmp_path, capsys):
    assert main(["sweep", "press", "--vary", vary, "-o", str(tmp_path / "kept")]) == 1
    assert words in capsys.readouterr().err
    assert not (tmp_path / "kept").exists()


def test_a_command_whose_runs_all_fail_does_not_succeed(tmp_path, capsys):
    assert main(["sweep", "press", "--vary", "stiffness.edge=-1,-2", "--stop-time", "0.02", "-j", "1", "-o", str(tmp_path / "kept")]) == 1
    said = capsys.readouterr()
    assert "2 that failed, the first with: " in said.err and "got -1" in said.err and "2 runs, 2 failed" in said.out


@pytest.mark.short("longer path than a socket may have")
@pytest.mark.parametrize("folder", ["t", "t" * 100], ids=["short path", "longer path than a socket may have"])
def test_a_script_needs_no_guard_against_its_own_processes_wherever_temporary_files_are(tmp_path, folder):
    (tmp_path / folder).mkdir()
    (tmp_path / "script.py").write_text(
        "import softffd\nprint('begun')\n"
        "table = softffd.sweep('press', {'mass': [1, 2]}, outputs=['energy.work'], stop_time=0.01, jobs=2)\n"
        "print(table.done.sum(), len(table.failures))\n"
    )
    environment = os.environ | {"TMPDIR": str(tmp_path / folder)}
    done = subprocess.run([sys.executable, tmp_path / "script.py"], env=environment, capture_output=True, text=True, timeout=100)
    assert done.stdout.split() == ["begun", "2", "0"], done.stderr


def test_an_fmu_is_swept_as_its_scene_is(table, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    softffd.package_fmu(SCENE, "pressed.fmu")
    packed = sweep("pressed.fmu", VARY, outputs=[FORCE], jobs=2)
    assert np.array_equal(packed.outputs[FORCE], table.outputs[FORCE])


def test_tolerance_and_method_are_those_of_simulate():
    swinging, tight = box(stretch=[1.2, 1.0, 1.0], stop_time=0.1), {"tolerance": 1e-2, "method": "leapfrog"}
    table = sweep(swinging, {"mass": [1.0, 2.0]}, outputs=["position[1,1,1].x"], **tight)
    single = [simulate(swinging, start_values={"mass": mass}, **tight).positions[-1, 1, 1, 1, 0] for mass in (1.0, 2.0)]
    assert table.outputs["position[1,1,1].x"].tolist() == single
    assert "tolerance" in table.differences(sweep(swinging, {"mass": [1.0, 2.0]}, outputs=["position[1,1,1].x"]))


def test_processes_that_a_daemonic_one_cannot_start_are_refused(monkeypatch):
    monkeypatch.setitem(multiprocessing.current_process()._config, "daemon", True)
    with pytest.raises(SoftffdError, match=r"a daemonic process, .* wanted jobs=1, got 2"):
        sweep(load_scene("press"), {"mass": [1, 2]}, jobs=2)
