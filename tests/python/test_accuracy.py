"""Error against run time: the measurement, its reference, what is concluded from it, and the command's files."""

import csv
import json
import sys
import zipfile
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from softffd import FmuError, accuracy, accuracy_reference, load_scene, package_fmu, simulate
from softffd import accuracy_command as command
from softffd.accuracy import measure, settings_of
from softffd.accuracy_records import Record, Records
from softffd.accuracy_reference import Reference, find_reference
from softffd.accuracy_report import factor_words
from softffd.accuracy_rig import Rig, Run, Setting
from softffd.cli import _print_summary, main
from softffd.findings import findings
from softffd.inputs import Inputs, read_csv
from softffd.picture import draw_run
from softffd.scene_checks import LIMITS

SMALL = """
title = "A small box"
[lattice]
points = [2, 2, 2]
[material]
stiffness = 1e3
damping = 0.0
[initial]
stretch = [1.1, 1.0, 1.0]
[experiment]
stop_time = 0.05
communication_step = 0.01
"""

DRIVEN = """
[lattice]
points = [3, 2, 2]
size = [1.0, 0.5, 0.7]
springs = "paper"
[material]
stiffness = { edge = 1e3, face = 500.0, body = 200.0 }
damping = 0.05
[[region]]
points = "x-"
stiffness = 4e3
mass = 0.3
damping = 0.2
[environment]
gravity = [0.5, 0.0, -9.81]
[[load]]
name = "push"
points = "x+"
[inputs]
forces = [[1, 1, 0]]
[initial]
stretch = [1.1, 0.95, 1.0]
velocity = [0.0, 0.3, 0.0]
angular_velocity = [1.0, 0.0, 2.0]
[experiment]
stop_time = 0.2
communication_step = 0.02
"""
COURSE = 'time,load.push.x,"force[1,1,0].z"\n0,0,0\n0.1,6,-2\n0.14,6,1\n0.2,6,0\n'


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(SMALL)
    Path("driven.toml").write_text(DRIVEN)
    Path("driven.csv").write_text(COURSE)
    return tmp_path


# --- the measurement ---------------------------------------------------------------------------------------------------------------


def test_leapfrog_and_the_published_scheme_show_their_order_against_a_confirmed_reference(folder):
    records = measure(load_scene("small.toml"), methods=["central_difference", "leapfrog"], quick=True, repeats=1)
    assert records.complete and records.reference.confirmed and records.reference.uncertainty < 1e-11
    for method in ("central_difference", "leapfrog"):
        runs = [run for run in records.good(method) if 1e-7 < run.error < 1e-3]
        slope = np.polyfit(np.log([run.steps for run in runs]), np.log([run.error for run in runs]), 1)[0]
        assert len(runs) >= 3 and slope == pytest.approx(-2.0, abs=0.15)
        assert all(run.cpu_time > 0 and run.errors.shape == (6,) and run.errors[0] == 0 for run in runs)


def test_a_tighter_tolerance_gives_a_smaller_error(folder):
    records = measure(load_scene("small.toml"), methods=["dop853"], quick=True, repeats=1)
    runs = records.good("dop853")
    assert len(runs) >= 5 and runs[-1].error < 1e-4 * runs[0].error and runs[-1].steps > runs[0].steps
    assert all(run.error <= 10 * run.setting.tolerance for run in runs)  # what a tolerance promises


def test_settings_go_from_coarse_to_fine():
    with Rig(load_scene("free_vibration")) as rig:
        steps = settings_of("leapfrog", rig)
        found = [next(steps).step for _ in range(6)]
        assert found[1] > rig.stable_step >= found[2] and all(1.3 <= a / b <= 2 for a, b in pairwise(found))
        assert all(rig.communication_step / step == pytest.approx(round(rig.communication_step / step)) for step in found)
        tolerances = [setting.tolerance for setting in settings_of("dop853", rig)]
        assert tolerances[0] == pytest.approx(0.1) and tolerances[-1] == pytest.approx(1e-11) and len(tolerances) == 21


def test_scenes_with_obstacles_leave_out_what_would_be_leapfrog_and_are_unconfirmed(folder):
    Path("touching.toml").write_text(SMALL + '[[plane]]\nname = "ground"\npoint = [0.0, 0.0, -0.01]\n')
    records = measure(load_scene("touching.toml"), quick=True, repeats=1)
    assert set(records.names()) <= {"auto", "central_difference", "leapfrog"} and "bm4" in records.left_out
    assert not records.reference.confirmed and "unconfirmed" in str(records.reference)


def test_rkn12_is_left_out_where_there_is_damping(folder):
    records = measure(load_scene("driven.toml"), methods=["rkn12", "dop853"], quick=True, repeats=1)
    assert records.names() == ["dop853"] and "damping" in records.left_out["rkn12"]


def test_an_unknown_method_is_refused(folder):
    with pytest.raises(FmuError, match=r"leapfrg: wanted one of .*leapfrog"):
        measure(load_scene("small.toml"), methods=["leapfrg"])


def test_a_failing_run_is_a_record_with_its_message_and_the_next_ones_still_count(folder, monkeypatch):
    plain = Rig.run

    def failing(rig, setting, **options):
        if setting.method == "leapfrog" and setting.step > 1e-3:
            raise FmuError("the component reported an error: out of luck")
        return plain(rig, setting, **options)

    monkeypatch.setattr(Rig, "run", failing)
    records = measure(load_scene("small.toml"), methods=["leapfrog"], quick=True, repeats=1)
    assert records.runs[0].failure.endswith("out of luck") and records.good("leapfrog")


def test_a_refused_step_leaves_the_rig_fit_for_the_next_run(folder):
    with Rig(load_scene("small.toml")) as rig:
        with pytest.raises(FmuError, match="internal steps"):
            rig.run(Setting("leapfrog", step=1e-12))
        first, second = (rig.run(Setting("leapfrog", step=1e-4)) for _ in range(2))
        np.testing.assert_array_equal(first.positions, second.positions)


# --- the reference -----------------------------------------------------------------------------------------------------------------


@dataclass
class MadeUpRig:
    """Runs whose errors are known: tolerance + error for adaptive methods, (100 h)^order for the others."""

    methods: tuple[str, ...]
    damped: bool = False
    contact: bool = False
    tightest: float = 0.0
    error: float = 0.0
    side: float = 2.0
    communication_step: float = 0.01
    stable_step: float = 1e-3

    def run(self, setting, **_options):
        if setting.tolerance and setting.tolerance < self.tightest:
            raise FmuError("too tight")
        signs = {"dop853": 1, "rkn12": -1, "bm4": 1, "leapfrog": -1}
        orders = {"bm4": 4, "leapfrog": 2}
        error = (100 * setting.step) ** orders[setting.method] if setting.step else setting.tolerance + self.error
        steps = 1 / setting.step if setting.step else 100
        return Run(np.full((2, 1, 3), 1.0) + signs[setting.method] * error, 1e-4 * steps, 1, int(steps), None)


def test_two_adaptive_methods_confirm_each_other():
    reference = find_reference(MadeUpRig(("leapfrog", "bm4", "rkn12", "dop853")))
    assert reference.confirmed and reference.method.startswith("dop853") and reference.check.startswith("rkn12")
    assert reference.uncertainty == pytest.approx(2e-13 * np.sqrt(3) / 2, rel=1e-2)  # 1e-13 to either side, of a box of 2 m


def test_a_damped_scene_is_confirmed_by_an_extrapolated_splitting_method():
    reference = find_reference(MadeUpRig(("leapfrog", "bm4", "rkn12", "dop853"), damped=True))
    assert reference.confirmed and reference.check.startswith("bm4") and reference.uncertainty < 1e-12


def test_a_method_that_cannot_be_so_tight_is_asked_for_less():
    reference = find_reference(MadeUpRig(("leapfrog", "rkn12", "dop853"), tightest=5e-12))
    assert reference.method == "dop853 at tolerance 1e-11" and reference.confirmed


def test_two_methods_that_disagree_confirm_nothing():
    reference = find_reference(MadeUpRig(("rkn12", "dop853"), error=1e-6))
    assert not reference.confirmed and "rkn12 at tolerance 1e-13 differs by 1.7e-06" in str(reference)


@pytest.mark.parametrize("rig", [MadeUpRig(("leapfrog", "dop853"), contact=True), MadeUpRig(("auto", "leapfrog"))])
def test_one_method_alone_is_unconfirmed_and_its_last_difference_is_the_uncertainty(rig):
    reference = find_reference(rig)
    step = float(reference.method.split()[2])
    assert not reference.confirmed and "unconfirmed" in str(reference)
    assert reference.uncertainty == pytest.approx(3 * (100 * step) ** 2 * np.sqrt(3) / 2, rel=0.1)


# --- what follows ------------------------------------------------------------------------------------------------------------------


def made_up_records(uncertainty: float = 1e-12) -> Records:
    times = np.array([0.0, 0.5, 1.0])
    reference = Reference(np.zeros((3, 8, 3)), uncertainty, "dop853", "rkn12", True)
    records = Records("box", "A box", 0.5, 1.0, times, 8, 1e-4, reference, complete=True)

    def add(method, time, error, **setting):
        records.runs.append(Record(Setting(method, **setting), "softffd", time, 3, 100, None, np.array([0.0, error / 2, error])))

    add("auto", 0.011, 5e-3, tolerance=1e-2)
    add("auto", 0.016, 5e-5, tolerance=1e-4)
    add("central_difference", 0.1, 5e-3, step=1e-3)
    add("central_difference", 1.0, 5e-5, step=1e-4)
    add("rkn12", 0.012, 2e-3, tolerance=1e-2)
    add("rkn12", 0.010, 5e-5, tolerance=1e-4)
    add("rkn12", 0.020, 5e-7, tolerance=1e-6)
    records.runs.append(Record(Setting("rkn12", tolerance=1e-8), failure="too tight"))
    return records


def test_times_factors_and_ratios_are_those_of_the_cheapest_runs():
    records = made_up_records()
    assert records.cheapest("rkn12", 1e-2).cpu_time == 0.010  # the more accurate run happens to be the cheaper one
    assert records.factor(records.cheapest("auto", 1e-4), 1e-4) == (pytest.approx(1.0 / 0.016), False)
    assert records.factor(records.best(1e-6), 1e-6) == (pytest.approx(1.0 / 0.020), True)
    assert factor_words(records.factor(records.best(1e-6), 1e-6)) == "> 50"
    assert records.ratio(1e-2) == pytest.approx(1.1) and records.ratio(1e-4) == pytest.approx(1.6) and records.ratio(1e-6) is None
    assert [run.cpu_time for run in records.front()] == [0.010, 0.020]


def test_auto_is_recommended_where_it_is_close_to_the_best():
    records = made_up_records()
    assert records.recommended(1e-2).name == "auto" and records.recommended(1e-4).name == "rkn12" and records.recommended(1e-8) is None


def test_of_equal_times_the_more_accurate_run_is_recommended():
    records = made_up_records()
    records.runs.append(Record(Setting("auto", tolerance=3e-3), "softffd", 0.0115, 3, 100, None, np.array([0.0, 1e-4, 2e-4])))
    assert records.cheapest("auto", 1e-2).setting.tolerance == 1e-2 and records.recommended(1e-2).setting.tolerance == 3e-3


def test_the_worst_miss_of_a_tolerance_is_found_and_unresolved_errors_are_not_judged():
    records = made_up_records()
    records.runs.append(Record(Setting("auto", tolerance=1e-6), "softffd", 0.03, 3, 100, None, np.array([0.0, 1e-5, 2e-5])))
    assert records.worst_of_tolerance("auto").error == 2e-5  # twenty tolerances; the others stay below one
    assert made_up_records().worst_of_tolerance("central_difference") is None
    assert made_up_records(uncertainty=1e-3).worst_of_tolerance("rkn12") is None


def test_an_error_below_three_uncertainties_is_not_claimed():
    records = made_up_records(uncertainty=1e-6)
    assert records.cheapest("rkn12", 1e-6) is None and records.cheapest("rkn12", 3e-6).error == 5e-7


# --- the command -------------------------------------------------------------------------------------------------------------------


@pytest.fixture(autouse=True)
def hasty(monkeypatch):
    """Sweeps and references end after a tenth of the time that even --quick gives them."""
    monkeypatch.setattr(accuracy, "QUICK_BUDGET", 0.02)
    monkeypatch.setattr(accuracy_reference, "QUICK_PATIENCE", 0.1)


@pytest.fixture
def few(monkeypatch):
    """Two methods and few runs, for tests of what the command does around them."""
    monkeypatch.setattr(
        command, "measure", lambda scene, **options: measure(scene, methods=["central_difference", "bm4"], **options | {"repeats": 1})
    )


def table_rows() -> list[dict[str, str]]:
    return list(csv.DictReader(Path("out/accuracy.csv").read_text().splitlines()))


def test_the_command_keeps_table_document_picture_and_page(folder, few, capsys):
    assert main(["accuracy", "small.toml", "--quick", "-o", "out"]) == 0
    assert "small: A small box" in (said := capsys.readouterr().out) and "confirmed by" in said
    rows = table_rows()
    assert {row["method"] for row in rows} == {"central_difference", "bm4"}
    assert all(float(row["cpu_time_s"]) > 0 and float(row["error"]) > 0 and int(row["internal_steps"]) > 0 for row in rows)
    document = json.loads(Path("out/accuracy.json").read_text())
    (scene,) = document["scenes"]
    assert document["machine"]["cores"] >= 1 and document["versions"]["softffd"] and document["scenes_not_measured"] == {}
    assert scene["reference"]["confirmed"] and scene["complete"] and len(scene["runs"]) == len(rows)
    assert scene["levels"]["1e-4"]["best"] == "bm4" and scene["levels"]["1e-4"]["best_over_published"]["factor"] > 1
    page = Path("out/report.html").read_text()
    assert page.count("data:image/png;base64,") == 2 and "{{" not in page and 'src="http' not in page
    assert 'method = "bm4"' in page and "published / best" in page and "central_difference" in page
    assert Path("out/small.png").read_bytes().startswith(b"\x89PNG")


def test_an_interrupt_keeps_what_is_done_and_names_the_rest(folder, few, monkeypatch, capsys):
    for name in ("second", "third"):
        Path(f"{name}.toml").write_text(SMALL)
    plain = Rig.run

    def stopped(rig, setting, **options):
        if rig.scene.name == "second" and setting.method == "bm4":
            raise KeyboardInterrupt
        return plain(rig, setting, **options)

    monkeypatch.setattr(Rig, "run", stopped)
    assert main(["accuracy", "small.toml", "second.toml", "third.toml", "--quick", "-o", "out"]) == 130
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "second, third" in said and "Traceback" not in said
    document = json.loads(Path("out/accuracy.json").read_text())
    assert [scene["complete"] for scene in document["scenes"]] == [True, False] and document["scenes_not_measured"] == {
        "third": "interrupted"
    }
    assert (
        "Not complete: second (interrupted)" in (page := Path("out/report.html").read_text())
        and "Not measured: third (interrupted)" in page
    )
    assert {row["scene"] for row in table_rows()} == {"small", "second"}
    assert not list(Path("out").glob(".*"))


def test_an_interrupt_before_the_first_run_leaves_an_empty_report(folder, few, monkeypatch, capsys):
    monkeypatch.setattr(Rig, "run", lambda *_arguments, **_options: (_ for _ in ()).throw(KeyboardInterrupt))
    assert main(["accuracy", "small.toml", "--quick", "-o", "out"]) == 130
    assert json.loads(Path("out/accuracy.json").read_text())["scenes_not_measured"] == {"small": "interrupted"}
    assert "small" in capsys.readouterr().err


def test_a_scene_that_cannot_be_measured_leaves_the_others(folder, few, monkeypatch, capsys):
    Path("second.toml").write_text(SMALL)
    plain = Rig.run

    def refusing(rig, setting, **options):
        if rig.scene.name == "small":
            raise FmuError("the component reported an error: out of luck")
        return plain(rig, setting, **options)

    monkeypatch.setattr(Rig, "run", refusing)
    assert main(["accuracy", "small.toml", "second.toml", "--quick", "-o", "out"]) == 1
    assert "small: the component reported an error: out of luck" in capsys.readouterr().err
    document = json.loads(Path("out/accuracy.json").read_text())
    assert [scene["scene"] for scene in document["scenes"]] == ["second"] and "out of luck" in document["scenes_not_measured"]["small"]


def test_an_unknown_scene_is_refused_before_anything_runs(folder, capsys):
    assert main(["accuracy", "small.toml", "spni", "-o", "out"]) == 1
    assert "spin" in capsys.readouterr().err and not Path("out").exists()
    assert main(["accuracy", "small.toml", "--step", "-1", "-o", "out"]) == 1
    assert "communication step: wanted > 0 s" in capsys.readouterr().err
    assert main(["accuracy", "small.toml", "--repeats", "0"]) == 1
    assert "at least 1" in capsys.readouterr().err


def test_the_standard_set_is_shipped():
    scenes = [load_scene(name) for name in command.STANDARD]
    assert len(scenes) == 6 and all(scene.solver.step == 0 for scene in scenes)


# --- outside anchors ---------------------------------------------------------------------------------------------------------------


def test_the_equations_are_the_springs_damping_weight_and_force_point_by_point(folder):
    accuracy_scipy = scipy_part()
    scene = load_scene("driven.toml")
    rng = np.random.default_rng(1)
    x, v, force = scene.rest_positions() + rng.normal(0, 0.05, (12, 3)), rng.normal(0, 1, (12, 3)), rng.normal(0, 1, (12, 3))
    rate = accuracy_scipy.Equations(scene).rate(np.concatenate([x.ravel(), v.ravel()]), force).reshape(2, 12, 3)
    np.testing.assert_array_equal(rate[0], v)
    np.testing.assert_allclose(rate[1], accelerations(scene, x, v, force), rtol=1e-12, atol=1e-10)


def accelerations(scene, x, v, force):
    """Eq. (3) and (6) for every pair of neighbours, from the text of DRIVEN."""
    rest, size = scene.rest_positions(), np.array([0.5, 0.5, 0.7])
    place = np.rint(rest / size).astype(int)
    left = place[:, 0] == 0
    mass, damping = np.where(left, 0.3, 1 / 12), np.where(left, 0.2, 0.05)
    total = force + mass[:, None] * [0.5, 0.0, -9.81] - damping[:, None] * v
    for a in range(12):
        for b in range(12):
            kind = int(np.abs(place[a] - place[b]).sum())
            if a == b or np.abs(place[a] - place[b]).max() > 1:
                continue
            k = 4e3 if left[a] and left[b] else {1: 1e3, 2: 500.0, 3: 200.0}[kind]
            doubled = kind == 1  # with 3 x 2 x 2 points every edge spring lies on an edge of the box, but those across its middle
            if kind == 1 and place[a, 0] == 1 == place[b, 0]:
                doubled = False
            way, length = x[b] - x[a], np.linalg.norm(rest[b] - rest[a])
            total[a] += (2 if doubled else 1) * k * (1 - length / np.linalg.norm(way)) * way
    return total / mass[:, None]


def test_scipy_and_the_fmu_solve_the_same_equations_with_the_same_inputs(folder):
    accuracy_scipy = scipy_part()
    with Rig(load_scene("driven.toml")) as rig:
        ours = rig.run(Setting("dop853", tolerance=1e-11)).positions
        forces = accuracy_scipy.nodal_forces(rig)
        solve_ivp = accuracy_scipy.solver()
        theirs, _ = accuracy_scipy.integrate(
            solve_ivp, accuracy_scipy.Equations(rig.scene), forces, rig, Setting("DOP853", tolerance=1e-11)
        )
    assert np.abs(ours - theirs).max() < 1e-9


def test_the_command_measures_scipy_beside(folder, few):
    scipy_part()
    assert main(["accuracy", "small.toml", "--quick", "--scipy", "-o", "out"]) == 0
    rows = [row for row in table_rows() if row["origin"] == "scipy"]
    assert {row["method"] for row in rows} == {"DOP853", "RK45", "Radau", "LSODA"}
    assert min(float(row["error"]) for row in rows if row["method"] == "DOP853") < 1e-6


def test_without_scipy_the_option_says_what_to_install(folder, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "scipy.integrate", None)
    assert main(["accuracy", "small.toml", "--quick", "--scipy", "-o", "out"]) == 1
    assert "softffd[scipy]" in capsys.readouterr().err and not Path("out").exists()


def scipy_part():
    pytest.importorskip("scipy", reason="the outside anchors need SciPy: pip install softffd[scipy]")
    from softffd import accuracy_scipy

    return accuracy_scipy


# --- inputs that move inside the step ----------------------------------------------------------------------------------------------

FREE = """
[material]
damping = 0.0
[[load]]
name = "push"
points = "all"
[outputs]
velocities = "all"
[experiment]
stop_time = 1.0
communication_step = 0.25
"""


def test_interpolated_inputs_are_exact_where_the_force_is_linear(folder):
    Path("free.toml").write_text(FREE)
    course = np.array([(0.0, 0.0), (1.0, 6.0)], dtype=[("time", float), ("load.push.x", float)])
    linear, held = (
        simulate(load_scene("free.toml"), inputs=course, interpolation=each, start_values={"solver.method": "dop853"})
        for each in ("linear", "held")
    )
    t = linear.time
    np.testing.assert_allclose(linear.outputs["velocity[1,2,3].x"], 3 * t**2, atol=1e-12)  # of 6 t N on 1 kg
    np.testing.assert_allclose(linear.positions.mean(axis=(1, 2, 3))[:, 0] - 0.5, t**3, atol=1e-12)
    assert held.outputs["velocity[1,2,3].x"][-1] == pytest.approx(0.25 * (0 + 1.5 + 3 + 4.5))


def test_cubic_inputs_have_the_order_of_cubics_and_do_not_overshoot():
    def swing(time):
        return {"load.push.x": np.sin(time), "plane.wall.point.x": np.sin(time)}

    def error(step, name):
        source, worst = Inputs(swing), 0.0
        column = source.names.index(name)
        for begin in np.arange(0.2, 1.2, step):
            s = step * np.linspace(0, 1, 9)
            first, second, third = source.bends(begin, step)[:, column]
            worst = max(worst, np.abs(np.sin(begin) + s * (first + s * (second / 2 + s * third / 6)) - np.sin(begin + s)).max())
        return worst

    assert 12 < error(0.1, "load.push.x") / error(0.05, "load.push.x") < 20
    assert 3.5 < error(0.1, "plane.wall.point.x") / error(0.05, "plane.wall.point.x") < 4.5

    jump = Inputs(lambda time: {"load.push.x": 1.0 if time > 0.55 else 0.0})
    for begin in 0.1 * np.arange(10):
        s = 0.1 * np.linspace(0, 1, 101)
        first, second, third = jump.bends(begin, 0.1)[:, 0]
        course = jump.values(begin, 0.1)[0] + s * (first + s * (second / 2 + s * third / 6))
        assert -1e-14 <= course.min() <= course.max() <= 1 + 1e-14


def test_an_fmu_that_does_not_interpolate_says_so(folder):
    Path("free.toml").write_text(FREE)
    package_fmu(load_scene("free.toml"), "free.fmu")
    with zipfile.ZipFile("free.fmu") as whole, zipfile.ZipFile("poor.fmu", "w") as poor:
        for name in whole.namelist():
            poor.writestr(name, whole.read(name).replace(b'canInterpolateInputs="true"', b'canInterpolateInputs="false"'))
    course = np.array([(0.0, 0.0), (1.0, 6.0)], dtype=[("time", float), ("load.push.x", float)])
    with pytest.raises(FmuError, match="does not interpolate"):
        simulate("poor.fmu", inputs=course, interpolation="linear")
    assert simulate("poor.fmu", inputs=course).time[-1] == 1.0


# --- the estimated error of a run --------------------------------------------------------------------------------------------------


def test_error_of_a_built_fmu_needs_the_variable(folder, capsys):
    package_fmu(load_scene("small.toml"), "small.fmu")
    assert main(["run", "small.fmu", "--error", "-o", "out"]) == 1
    assert "error_estimate = true" in capsys.readouterr().err and not Path("out").exists()


def test_an_estimated_error_is_in_the_summary_in_words_and_on_the_picture(tmp_path, capsys):
    plain = simulate(load_scene("free_vibration"), stop_time=0.2)
    estimated = replace(plain, outputs=plain.outputs | {"solver.error_estimate": np.array([0.0, 1e-5, 3.21e-5])})
    results = {"plain": plain, "estimated": replace(estimated, summary=estimated.summary | findings(estimated))}
    assert results["estimated"].summary["estimated_error_m"] == 3.21e-5
    _print_summary(results["estimated"].summary | {"findings": []})
    assert "with an estimated error of 3.2e-05 m" in capsys.readouterr().out
    rows = []
    for name, result in results.items():
        with Image.open(draw_run(result, tmp_path / f"{name}.png")) as image:
            rows.append(np.asarray(image.convert("L"))[: image.height // 15, image.width // 2 :])
    assert rows[0].min() == 255 and rows[1].min() < 150  # words in the upper right corner, beside the title


@pytest.mark.skipif(any(limit.key == "error_estimate" for limit in LIMITS), reason="solver.error_estimate is not available in this version")
def test_run_with_error_estimates_the_error_of_a_scene(folder, capsys):
    Path("small.toml").write_text(SMALL + '[solver]\nmethod = "leapfrog"\nstep = 1e-4\n')
    assert main(["run", "small.toml", "--error", "-o", "out"]) == 0
    assert "estimated error" in capsys.readouterr().out
    estimate = json.loads(Path("out/summary.json").read_text())["estimated_error_m"]
    exact = simulate(load_scene("small.toml"), start_values={"solver.method": "dop853", "solver.step": 0, "solver.tolerance": 1e-12})
    error = np.linalg.norm(np.load("out/result.npz")["positions"][-1] - exact.positions[-1], axis=-1).max()
    assert error / 3 < estimate < 3 * error


# --- the standard set --------------------------------------------------------------------------------------------------------------

GOLDEN = Path(__file__).resolve().parents[2].parent / "shared" / "golden"


@pytest.mark.parametrize(
    "name, largest", [("stiff_pull", {"load.right_0.x": 4e5, "load.left_3.x": -8e5}), ("stiff_layer", {"load.top.z": 80.0})]
)
def test_slow_loads_grow_as_the_smooth_step(name, largest):
    scene = load_scene(name)
    course = read_csv(scene.default_inputs)
    u = np.clip(course["time"] / 0.5, 0, 1)
    for variable, force in largest.items():
        np.testing.assert_allclose(course[variable], force * (6 * u**5 - 15 * u**4 + 10 * u**3), rtol=1e-9, atol=1e-9)
    assert set(course.dtype.names) == {"time", *(f"load.{load.name}.{'z' if name == 'stiff_layer' else 'x'}" for load in scene.load)}
    assert np.all(np.diff(course["time"]) > 0) and course["time"][-1] >= scene.experiment.stop_time


@pytest.mark.parametrize(
    "name, stored, setting, allowed",
    [
        ("free_vibration", "S1", Setting("rkn12", tolerance=1e-12), 1e-11),
        ("stiff_pull", "S2", Setting("leapfrog", step=1e-5), 5e-7),  # the load is linear over each 0.1 s here, smooth there
    ],
)
def test_scenes_are_those_of_the_stored_references(name, stored, setting, allowed):
    if not GOLDEN.is_dir():
        pytest.skip("the reference data are not beside this checkout (folder shared/golden)")
    with Rig(load_scene(name)) as rig:
        positions = rig.run(setting).positions
    assert np.abs(positions[1:] - np.load(GOLDEN / f"{stored}.npz")["x"]).max() < allowed
