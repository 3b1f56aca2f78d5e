"""Stiff and extreme scenes: the oracles see what is wrong, hangs and crashes are verdicts, and the command keeps its files."""

import csv
import json
import math
import os
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from softffd.cli.command import exit_status
from softffd.errors import SoftffdError, UnknownName
from validation import guard
from validation.guard import Lost, guarded
from validation.stability import cases_impact
from validation.stability import survey as survey_module
from validation.stability.cases import CASES, run_named
from validation.stability.cell import Cell, Judged, Panel, omega, settings
from validation.stability.drive import DOWN, Drive, Refused, box, plane
from validation.stability.map import borders, document, run_cells, unit_sag
from validation.stability.survey import Survey, planned, run
from validation.stability.verdict import VERDICTS, Case, Check, Findings, Outcome, behind, outcome_of, run_case
from validation.tools import run_tool

RIGHT_NOW = ("static stretch", "free fall, steps of 1 s", "all points at one place", "plane jumps", "force 1e12 N", "plane reversed")
OF_IMPACTS = ("A1, H = 0.001 s", "corners pass a plane, H = 0.01 s", "creep 10 deg, k = 1e+09, H = 0.01 s", "rest 2 x 2 x 3, k = 1e+09")
OF_SURFACES = ("surface: rest, 4^3, k = 100000", "surface: incline 25 deg, k = 1e+06", "surface: corner, k = 1000, friction 0.5",
               "surface: press, k = 1000")  # fmt: skip
"""Of the short run."""
REFUSED_NOW = ("opposite planes meet", "force not a number", "force 1e308 N")


def at_once(jobs) -> Iterator[str]:
    """One result per job: itself, a hang, a crash, a fault."""
    with tempfile.TemporaryDirectory():  # which a process that is ended does not remove
        for job in jobs:
            yield result_of(job)


def result_of(job) -> str:
    if job == "hang":
        time.sleep(60)
    if job == "crash":
        os._exit(3)
    if job == "fault":
        raise ValueError("a fault")
    return job


def test_hang_crash_and_fault_are_results_and_the_next_jobs_run():
    jobs = ["one", "hang", "two", "crash", "fault", "three"]
    given, results = zip(*guarded(at_once, jobs, lambda job: 1.0), strict=True)
    assert list(given) == jobs
    assert [result for result in results if isinstance(result, str)] == ["one", "two", "three"]
    assert [results[1].how, results[3].how, results[4].how] == ["hang", "crash", "fault"]
    assert "status 3" in results[3].words
    assert "a fault" in results[4].words


def test_nothing_is_left_of_the_temporary_files_of_processes(monkeypatch, tmp_path):
    there = SimpleNamespace(TemporaryDirectory=partial(tempfile.TemporaryDirectory, dir=tmp_path), gettempdir=tempfile.gettempdir)
    monkeypatch.setattr(guard, "tempfile", there)
    seen = [len(list(tmp_path.glob("*/*"))) for _ in guarded(at_once, ["one", "crash", "two"], lambda job: 1.0)]
    assert seen[0] == 1 and not list(tmp_path.iterdir())


def test_batches_run_abreast_and_each_keeps_its_order():
    jobs = ["one", "two", "hang", "three", "crash", "four", "five"]
    found = [(job, result.how if isinstance(result, Lost) else result) for job, result in guarded(at_once, jobs, lambda job: 1.0, 2, 2)]
    assert sorted(found) == sorted((job, job) for job in jobs)
    assert all(found.index((jobs[n],) * 2) < found.index((jobs[n + 1],) * 2) for n in (0, 2, 4))


def test_lost_case_is_slow_or_wrong():
    assert outcome_of(Lost("hang", ""), 2.0).verdict == "slow"
    assert outcome_of(Lost("crash", "the process ended"), 2.0).verdict == "WRONG"


@pytest.mark.parametrize(
    "measured, bound, verdict",
    [(0.9, None, "right"), (1.1, 2.0, "bounded"), *[(each, 2.0, "WRONG") for each in (2.1, math.nan, math.inf)], (1.1, None, "WRONG")],
)
def test_verdict_of_a_check(measured, bound, verdict):
    assert Check("error", measured, 1.0, bound).verdict == verdict


def test_verdict_of_a_case_is_that_of_its_worst_check():
    def run(findings: Findings) -> None:
        findings.check("small", 0.5, 1.0)
        findings.at_most("growing", 0.5, 1.0, bound=3.0)
        findings.at_most("growing", 2.0, 1.0, bound=3.0)
        findings.at_most("growing", 1.0, 1.0, bound=3.0)

    outcome = run_case(Case("made up", "", "", run))
    assert (outcome.verdict, outcome.worst.what, outcome.worst.measured) == ("bounded", "growing", 2.0)


def test_answer_where_a_refusal_is_wanted_is_wrong_and_so_is_a_refusal_for_another_reason():
    def answers(findings: Findings) -> None:
        findings.check("nothing", 0.0, 1.0)

    def refuses(findings: Findings) -> None:
        raise Refused("no feasible position")

    assert run_case(Case("made up", "", "", answers, refusal="no feasible")).verdict == "WRONG"
    assert run_case(Case("made up", "", "", refuses, refusal="no feasible")).verdict == "refused"
    assert run_case(Case("made up", "", "", refuses, refusal="not finite")).verdict == "WRONG"
    assert run_case(Case("made up", "", "", refuses)).verdict == "refused"


def test_oracles_see_a_penetration_and_an_energy_that_comes_from_nowhere():
    with Drive(box(1e3, plane=[plane(point=(0, 0, -0.5))], environment=DOWN)) as drive:
        assert behind(drive, (0, 0, 0.25), (0, 0, 2)) == pytest.approx(0.25)
        assert behind(drive, (0, 0, -0.1), (0, 0, 1)) == 0
        drive.step(0.1)
        assert abs(drive.balance()) < 1e-12
        drive.start_energy -= 1.0
        assert drive.balance() == pytest.approx(1.0)


def test_own_mechanics_agree_with_the_outputs_of_the_fmu():
    region = [{"points": "x-", "stiffness": 4e3, "mass": 0.3}]
    sections = {"region": region, "initial": {"stretch": [1.1, 0.9, 1.0], "angular_velocity": [1.0, 0.0, 2.0]}, "environment": DOWN}
    with Drive(box(1e3, points=(3, 2, 4), **sections)) as drive:
        drive.run(0.03, 0.01)
        told = sum(drive.value(f"energy.{part}") for part in ("kinetic", "elastic", "gravity"))
        assert drive.energy() == pytest.approx(told, rel=1e-12)
        assert drive.balance() == pytest.approx(0, abs=1e-3 * drive.start_energy)


def test_border_of_the_raw_scheme_lies_on_the_theoretical_line():
    for border in borders([1e-3, 1e9], rounds=9):
        assert border.raw == pytest.approx(2 / omega(border.stiffness), rel=5e-3)  # resolution 4^(2^-9) - 1 = 0.3 %
        assert border.divided <= border.raw * 1.003
        assert border.bound <= border.theory * (1 + 1e-12)


def test_breathing_box_is_an_exact_solution():
    with Drive(document("vibration"), settings(Panel("vibration", "dop853"), 1.0, 0.0) | {"solver.tolerance": 1e-11}) as drive:
        drive.run(2.0, 0.25)
        size = np.ptp(drive.x[:, 0])
        assert size == pytest.approx(1 + 0.01 * math.cos(omega(1.0) * 2.0), abs=1e-9)


def test_unit_sag_is_the_static_one():
    """k = 1 N/m and g = 0.02 m/s2: strongly damped, the box comes to rest where the linear theory says, to second order in the sag."""
    with Drive(box(1.0, 0.5, points=(2, 2, 2), plane=[plane()], environment={"gravity": [0.0, 0.0, -0.02]})) as drive:
        drive.run(60.0, 1.0)
        assert 0.5 - drive.centre[2] == pytest.approx(0.02 * unit_sag(), rel=5e-3)


def test_cells_are_judged_by_their_exact_solutions():
    given = Panel("vibration", "leapfrog", True)
    cells = [Cell(given, 1e3, 1e-5), Cell(given, 1e3, 0.9 * 2 / omega(1e3)), Cell(given, 1e3, 0.1)]
    fine, coarse, divided = run_cells(cells)
    assert (fine.kind, fine.error < 1e-8) == ("accurate", True)
    assert coarse.kind in ("bounded", "unstated")
    assert coarse.error > 1e-3
    assert divided.kind in ("divided", "unstated")
    assert divided.internal_steps > divided.steps


def test_cells_of_several_panels_run_each_in_its_own_scene():
    """Whoever runs them takes some at a time, wherever a panel ends."""
    panels = [Panel(scene, "auto") for scene in ("vibration", "damping", "rotation", "contact")]
    ratios = [0.0, 30.0, 0.0, 0.0]
    together = run_cells([Cell(panel, 1e3, 1e-2, ratio) for panel, ratio in zip(panels, ratios, strict=True)])
    alone = [next(run_cells([Cell(panel, 1e3, 1e-2, ratio)])) for panel, ratio in zip(panels, ratios, strict=True)]
    one, other = ([(judged.kind, judged.error, judged.internal_steps) for judged in each] for each in (together, alone))
    assert one == other
    assert len({judged.error for judged in alone}) == 4 and all(judged.kind == "accurate" for judged in alone)


def test_a_name_that_the_survey_gets_wrong_is_no_refusal():
    with Drive(document("vibration")) as drive, pytest.raises(UnknownName):
        drive.restart({"internal_damping": 1.0})


@pytest.mark.parametrize("scene", ["vibration", "rotation", "contact"])
def test_soft_cells_of_every_scene_are_accurate(scene):
    (judged,) = run_cells([Cell(Panel(scene, "auto"), 1.0, 1e-3)])
    assert judged.kind == "accurate", judged


@pytest.mark.short("0.01-[!rs]*", "2.0-*", "1000.0-[!d]*")
@pytest.mark.parametrize("method", ["auto", "leapfrog", "dop853", "ros34pw2", "backward_euler", "sdirk2"])
@pytest.mark.parametrize("ratio", [0.01, 2.0, 1000.0])
def test_cells_with_internal_damping_are_accurate(method, ratio):
    (judged,) = run_cells([Cell(Panel("damping", method), 1e3, 1e-2, ratio)])
    assert judged.kind == "accurate" or (method, ratio, judged.kind) == ("dop853", 1000.0, "slow"), judged


@pytest.mark.short(*RIGHT_NOW, *OF_IMPACTS, *OF_SURFACES)
@pytest.mark.parametrize(
    "name", [*RIGHT_NOW, *(case.name for case in cases_impact.cases()), *(n for n in CASES if n.startswith("surface"))]
)
def test_case_is_right(name):
    outcome = run_case(CASES[name])
    assert outcome.verdict == "right", [str(check) for check in outcome.checks]


@pytest.mark.parametrize("name", REFUSED_NOW)
def test_case_is_refused_with_its_reason(name):
    assert run_case(CASES[name]).verdict == "refused"


def test_names_are_chosen_by_parts_and_unknown_ones_refused():
    assert planned(["S7 crush to 40"]).names == ["S7 crush to 40%", "S7 crush to 40%, volume", "S7 crush to 40%, very stiff"]
    assert planned(["plane jumps"]).panels == []
    assert planned(["map"]).names == []
    assert (planned(["cases"]).names, planned(["cases"]).panels) == (list(CASES), [])
    assert {name for name in CASES if CASES[name].quick} == set(planned(quick=True).names)
    with pytest.raises(SoftffdError, match=r"plane jmps.*plane jumps"):
        planned(["plane jmps"])


@pytest.fixture
def small(monkeypatch):
    """Makes the survey that is planned a small one."""
    panels = [Panel("vibration", "leapfrog", True)]
    monkeypatch.setattr(
        "validation.stability.results.planned",
        lambda only, quick: Survey(panels, [1e0, 1e3], [1e-3, 1e-2, 1e-1], ["plane jumps", "force not a number"]),
    )


def test_command_keeps_table_and_map(small, tmp_path, capsys):
    folder = tmp_path / "kept"
    assert exit_status(lambda: run_tool(["stability", "--quick", "-o", str(folder)])) == 0
    rows = list(csv.DictReader((folder / "stability.csv").open()))
    assert [row["part"] for row in rows] == ["map"] * 6 + ["case"] * 2
    assert [row["verdict"] for row in rows[6:]] == ["right", "refused"]
    document = json.loads((folder / "stability.json").read_text())
    assert document["missing"] == document["wrong"] == []
    assert {check["what"] for check in document["cases"][0]["checks"]} >= {"penetration / box", "speed at once, m/s"}
    assert (folder / "map_vibration_given_step.png").read_bytes().startswith(b"\x89PNG")
    assert "plane jumps: right" in capsys.readouterr().out


def test_wrong_answer_is_exit_status_1_and_is_kept(small, tmp_path, monkeypatch, capsys):
    def wrong(work, jobs, *rest):
        if work is not run_named:
            return guarded(work, jobs, *rest)
        return ((name, Outcome("WRONG", (Check("energy out of nothing", 2.0, 1.0),))) for name in jobs)

    monkeypatch.setattr(survey_module, "guarded", wrong)
    assert exit_status(lambda: run_tool(["stability", "-o", str(tmp_path)])) == 1
    assert "plane jumps: energy out of nothing 2 (limit 1)" in capsys.readouterr().err
    assert len(json.loads((tmp_path / "stability.json").read_text())["wrong"]) == 2


def test_interrupt_keeps_what_is_done(small, tmp_path, monkeypatch, capsys):
    def interrupted(work, jobs, *rest):
        yield jobs[0], Judged("accurate", 0.0, 0.0, 1, 1, 0.0)
        raise KeyboardInterrupt

    monkeypatch.setattr(survey_module, "guarded", interrupted)
    assert exit_status(lambda: run_tool(["stability", "-o", str(tmp_path)])) == 130
    document = json.loads((tmp_path / "stability.json").read_text())
    assert len(document["map"]) == 1
    assert document["missing"] == ["vibration, leapfrog, solver.step = H", "plane jumps", "force not a number"]
    assert "what is done is kept in" in capsys.readouterr().err


def test_cases_get_the_time_that_each_may_take(monkeypatch):
    given = {}

    def noted(work, jobs, patience, processes):
        given.update({name: patience(name) for name in jobs})
        return ((job, Lost("hang", "")) for job in jobs)

    monkeypatch.setattr(survey_module, "guarded", noted)
    list(run(planned(["S1", "1e7 steps"]), lambda text: None))
    assert given == {name: CASES[name].patience for name in ("S1 free vibration", "spin, 1e7 steps")}


def test_lost_cells_do_not_end_the_survey(monkeypatch):
    lost = {1e-3: Lost("hang", ""), 1e-2: Lost("crash", "")}
    monkeypatch.setattr(survey_module, "guarded", lambda work, jobs, *rest: ((job, lost[job.step]) for job in jobs))
    survey = Survey([Panel("vibration", "auto")], [1.0], list(lost), [])
    list(run(survey, lambda text: None))
    assert [judged.kind for judged in survey.cells.values()] == ["slow", "WRONG"]


def test_every_case_says_what_it_is_and_by_what_it_is_judged():
    assert len(CASES) > 60
    assert all(case.what and case.oracle and case.patience > 0 for case in CASES.values())
    assert set(VERDICTS) == {"right", "bounded", "refused", "slow", "WRONG"}
