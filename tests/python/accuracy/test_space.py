"""Error over lattices: orders and limits of made-up courses, lattices of a scene, what belongs to one, a clamped cube, the files."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from scenes import box
from softffd import SceneError, load_scene
from softffd.accuracy import space
from softffd.accuracy.picture import space_picture
from softffd.accuracy.records import Record, Records
from softffd.accuracy.rig import Setting
from softffd.accuracy.space import Measured, continuum, judge_all, lattices, measure_space, on_lattice
from softffd.cli.command import main

CUBE = """
title = "A clamped cube bends under a small weight"
[lattice]
points = [4, 4, 4]
[mass]
density = 1000.0
[material]
{material}
youngs_modulus = 1e5
internal_damping = 0.02
[environment]
gravity = [0.0, 0.0, -0.01]
[[pin]]
name = "wall"
points = "x-"
[experiment]
stop_time = 0.6
communication_step = 0.1
"""
SOLID, SPRINGS = 'model = "solid"\npoissons_ratio = 0.25', 'model = "springs"'


@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
@pytest.mark.parametrize("count", [3, 4])
def test_lattices_of_one_power_tell_it_and_their_limit(order, count):
    limit, error = np.sin(np.linspace(0.0, 1.0, 5))[:, None] * [1.0, 2.0], np.linspace(0.0, 0.1, 5)[:, None] * [1.0, -1.0]
    found = continuum([limit + error * k**-order for k in range(1, count + 1)])
    assert found.order == pytest.approx(order, abs=1e-6) and found.course == pytest.approx(limit, abs=1e-9)
    assert found.error(limit + 0.02) == pytest.approx(0.02 / found.change)


def test_lattices_that_tend_to_nothing_have_no_order():
    courses = [np.array([[0.0], [height]]) for height in (1.0, 1.1, 1.3)]
    found = continuum(courses)
    assert math.isnan(found.order) and found.course is courses[-1] and found.uncertainty == pytest.approx(0.2 / 1.3)
    assert continuum(courses[:2]).uncertainty == pytest.approx(0.1 / 1.1)


def test_lattices_have_whole_patches_in_the_proportions_of_the_scene():
    def of(points):
        return lattices(box(points=points, material={"youngs_modulus": 1e5}, size=[float(n - 1) for n in points]))

    assert of([5, 3, 3]) == [(7, 4, 4), (13, 7, 7), (19, 10, 10), (25, 13, 13)]
    assert of([11, 3, 3]) == [(16, 4, 4), (31, 7, 7)]
    with pytest.raises(SceneError, match="common divisor"):
        of([12, 5, 4])


def test_what_belongs_to_one_lattice_is_named():
    force = {"name": "push", "points": [[0, 0, 0]]}
    with pytest.raises(SceneError) as refused:
        lattices(box(stiffness=1e3, load=[force], region=[{"points": "x-", "mass": 1.0}], forces=[[1, 1, 1]]))
    assert [line.split(":")[0] for line in refused.value.problems] == ["material.stiffness", "load.push.points", "inputs.forces", "region"]


def test_drag_has_the_same_sum_on_every_lattice():
    scene = box(material={"youngs_modulus": 1e5, "damping": 0.7})
    assert on_lattice(scene, (7, 7, 7)).material.damping * 7**3 == pytest.approx(0.7 * 4**3)


def measured_cube(folder, name, material):
    file = folder / f"{name}.toml"
    file.write_text(CUBE.format(material=material))
    return measure_space(load_scene(file), quick=True)


def errors(measured):
    """By points along an axis, at the last tolerance."""
    return {run.lattice[0]: run.error for run in measured.records.runs}


@pytest.mark.full
def test_springs_and_solids_tend_to_the_same_displacement_at_a_quarter(tmp_path):
    """Of places and reactions of a clamped cube under small strain, within the uncertainties of both; solids of 7 points are three times as
    near to it as springs of 7."""
    solid, springs = both = [measured_cube(tmp_path, name, material) for name, material in {"solid": SOLID, "springs": SPRINGS}.items()]
    for kind, own in springs.own.items():
        assert solid.own[kind].error(own.course) < solid.own[kind].uncertainty + own.uncertainty < 0.03
    for each in both:
        assert list(each.own) == ["places", "reactions"] and len(each.records.good()) == 12
    assert errors(solid)[7] < errors(springs)[7] / 3
    alone = errors(springs)
    judge_all(both)
    assert [each.against for each in both] == ["solid", "solid"] and 0 < abs(errors(springs)[7] - alone[7]) < 0.03
    assert springs.apart["solid"]["places"] < 0.03 and springs.records.reference.uncertainty == solid.uncertainty < springs.uncertainty


def made_up(name, answer, *, outputs=("probe.a.z",), exact=False):
    """Lattices whose one output tends to `answer` at its end with an error of 0.1 / k^2, or has it exactly."""
    courses = [np.array([[0.0], [answer + 0.1 * k**-2.0 * (not exact)]]) for k in (1, 2, 3)]
    runs = [Record(Setting("auto", tolerance=1e-4), cpu_time=10.0**k, lattice=(3 * k + 1,) * 3) for k in (1, 2, 3)]
    records = Records(name, name, 1.0, 1.0, np.array([0.0, 1.0]), 64, 1e-4, runs=runs)
    measured = Measured(records, list(outputs), [{"places": course} for course in courses], {"places": continuum(courses)})
    measured.judge(measured)
    return measured


def test_scenes_with_the_same_answer_are_measured_against_the_one_known_best():
    """That of `near` differs from that of `exact` by less than it is uncertain, that of `far` by more; `other` has other outputs."""
    near, exact, far = made_up("near", 1.005), made_up("exact", 1.0, exact=True), made_up("far", 1.1)
    other = made_up("other", 1.0, outputs=["probe.b.z"])
    judge_all([near, exact, far, other])
    assert [each.against for each in (near, exact, far, other)] == ["exact", "exact", "far", "other"]
    assert near.records.runs[0].error == pytest.approx(0.105) and far.records.runs[0].error == pytest.approx(0.1 / far.own["places"].change)
    assert far.apart["exact"]["places"] == pytest.approx(0.1) and exact.apart.keys() == {"near", "far"} and not other.apart


def test_scenes_are_drawn_whatever_their_errors():
    """Also where there is none, where all are large, and with names that are formulas elsewhere."""
    for scenes in ([made_up("exact", 1.0, exact=True)], [made_up("$large$", 0.01), made_up("near", 1.0)]):
        assert space_picture([each.records for each in scenes]).startswith(b"\x89PNG")


def test_the_command_keeps_table_document_picture_and_page(folder, capsys, monkeypatch):
    monkeypatch.setattr(space, "MOST_LATTICES", 3)
    for name, material in {"cube": SOLID, "springs": SPRINGS}.items():
        Path(f"{name}.toml").write_text(CUBE.format(material=material).replace("stop_time = 0.6", "stop_time = 0.1"))
    assert main(["accuracy", "cube.toml", "springs.toml", "--space", "--quick", "-o", "out"]) == 0
    said = capsys.readouterr().out
    assert "places: order" in said and "error 1e-1: " in said and "points, tolerance" in said
    assert said.count("the continuum's answer differs from that of") == 2
    scene, springs = json.loads(Path("out/accuracy.json").read_text())["scenes"]
    assert scene["continuum"]["places"]["uncertainty"] > 0 and {run["points_x"] for run in scene["runs"]} == {4, 7, 10}
    assert springs["errors_against"] in ("cube", "springs") and springs["apart"]["cube"]["places"] > 0
    page = Path("out/report.html").read_text()
    assert "points = [4, 4, 4]" in page or "points = [7, 7, 7]" in page
    assert page.count("data:image/png;base64,") == 1 and "{{" not in page
    assert Path("out/accuracy.png").read_bytes().startswith(b"\x89PNG")
    assert len(Path("out/accuracy.csv").read_text().splitlines()) == 1 + len(scene["runs"] + springs["runs"])


STILL = """
[material]
model = "springs"
youngs_modulus = 1e5
[[pin]]
name = "w"
points = "x-"
[experiment]
stop_time = 0.1
"""


@pytest.mark.short("solid-far away-over lattices", "springs-at the origin-methods")
@pytest.mark.parametrize("options", [["--space"], []], ids=["over lattices", "methods"])
@pytest.mark.parametrize("origin", [0.0, -30.0], ids=["at the origin", "far away"])
@pytest.mark.parametrize("material", ["springs", "solid"])
def test_a_scene_in_which_nothing_moves_is_refused(folder, monkeypatch, capsys, material, origin, options):
    """Rounding changes its places by 1e-14 of the largest coordinate, and its reactions: no change to compare with."""
    monkeypatch.setattr(space, "MOST_LATTICES", 3)
    Path("still.toml").write_text(STILL.replace("springs", material) + f"[lattice]\norigin = [{origin}, 0.0, 0.0]\n")
    assert main(["accuracy", "still.toml", "--quick", *options]) == 1
    said = capsys.readouterr().err
    assert "still: nothing moves; wanted a load, gravity," in said and "Traceback" not in said


def test_kinds_that_change_by_rounding_are_left_out(tmp_path):
    """Without weight and load a moving body keeps its energies."""
    file = tmp_path / "flight.toml"
    thrown = "[initial]\nvelocity = [1.0, 0.0, 0.0]\n[outputs]\nenergy = true\n"
    file.write_text(STILL.replace("springs", "solid").split("[[pin]]")[0] + thrown + "[experiment]\nstop_time = 0.02\n")
    measured = measure_space(load_scene(file), quick=True)
    assert list(measured.own) == ["places"] and all(run.errors.shape == (1,) for run in measured.records.runs)


def test_the_standard_set_is_not_compared_over_lattices(capsys):
    assert main(["accuracy", "--space"]) == 1
    assert "wanted a SCENE" in capsys.readouterr().err
