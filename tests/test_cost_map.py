"""`benchmarks/cost_map.py`: its cells count internal steps, which are the same on every machine; and its table."""

import importlib
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from statistics import median

import pytest

PROGRAM = Path(__file__).resolve().parents[1] / "benchmarks" / "cost_map.py"
LEFT_BEHIND = ("cost_map", "boxes", "measured", "rows_steps")
FEW_STEPS = [  # stiffness [N/m], internal damping [s], steps at most
    ("pinned face, a layer of 1e8", 1e3, 1e-4, 200),  # 13,585, 1,664, 10,978 and 2,742 in explicit steps alone
    ("rests, points", 1e5, 1e-4, 1000),
    ("rests, points", 1e7, 1e-4, 100),
    ("drops 1 cm, points", 1e7, 1e-4, 2000),
    ("rests, surface", 1e3, 0.0, 3000),  # 94,494 and 14,557 if steps get shorter wherever two runs differ
    ("drops 2 mm on a box, surface", 1e3, 0.0, 3000),
    ("drops 1 cm, surface", 1e7, 1e-4, 1500),
    ("drops 2 mm on a box, surface", 1e7, 1e-4, 1800),
]


@pytest.fixture
def cost_map(monkeypatch):
    monkeypatch.syspath_prepend(str(PROGRAM.parent))
    yield importlib.import_module("cost_map")
    for name in LEFT_BEHIND:
        sys.modules.pop(name, None)


def run(folder: Path, *words: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, PROGRAM, *words], cwd=folder, capture_output=True, text=True, timeout=300)


@pytest.mark.short("*-1000.0-*", "*-10000000.0-*", "rests, points-*")
@pytest.mark.parametrize(("name", "stiffness", "tau", "most"), FEW_STEPS)
def test_cells_take_few_steps(cost_map, name, stiffness, tau, most):
    cell = cost_map.measured(cost_map.KINDS[name], stiffness, tau)
    assert cell.finished and not cell.warned and 0 < cell.steps <= most


@pytest.mark.full
@pytest.mark.parametrize(("stiffness", "most"), [(1e3, 2000), (1e5, 3500)])
def test_a_drop_whose_steps_go_by_roundings_takes_few_in_the_median(cost_map, stiffness, most):
    """700 to 3,700 and 1,900 to 3,000 by the angle; medians of 2,400 and 4,400 before differences of what rattles were taken to scatter."""
    kind, steps = cost_map.KINDS["drops 2 mm on a box, surface"], []
    for degrees in (scale * times for scale in (1e-2, 1e-5, 1e-8, 1e-11) for times in (1, 2, 4)):
        initial = {**kind.sections["initial"], "rotation": {"axis": [1.0, 0.37, 0.0], "degrees": degrees}}
        cell = cost_map.measured(replace(kind, sections={**kind.sections, "initial": initial}), stiffness, 1e-4)
        assert cell.finished
        steps.append(cell.steps)
    assert 0 < median(steps) <= most


def test_every_kind_is_a_scene(cost_map):
    for kind in cost_map.KINDS.values():
        scene = cost_map.scene_of(kind, 1e5, 1e-4)
        assert bool(scene.mesh) == kind.surface and scene.lattice.points == (kind.points,) * 3
        assert max(scene.lattice_box.size) == pytest.approx(0.1) and min(scene.lattice_box.origin) == pytest.approx(0.0)


def test_a_cell_tells_speed_steps_and_warnings_and_slow_ones_are_bold(cost_map):
    assert str(cost_map.Cell(0.01, 1200, warned=True, finished=True)) == "5 (1,200!)"
    assert str(cost_map.Cell(0.1, 7, warned=False, finished=True)) == "**0.5 (7)**"
    assert str(cost_map.Cell(26.0, 7, warned=False, finished=False)) == "**> 25 s**"
    assert str(cost_map.Cell(3.0, 7, warned=False, finished=False, refused=True)) == "**refused**"


def test_a_refused_step_ends_a_cell_and_not_the_map(cost_map, monkeypatch):
    def refuse(_simulation, _length):
        raise cost_map.FmuError("too much work")

    monkeypatch.setattr(cost_map.Simulation, "step", refuse)
    cell = cost_map.measured(cost_map.KINDS["pinned face"], 1e3, 0.0)
    assert cell.refused and not cell.finished and cell.times_real_time == 0


def test_a_cell_that_takes_more_than_ten_times_its_neighbour_is_named(cost_map):
    columns = [(1e3, 0.0), (1e3, 1e-4), (1e5, 0.0), (1e5, 1e-4)]
    cells = [cost_map.Cell(seconds, 1, warned=False, finished=True) for seconds in (0.1, 0.1, 0.1, 1.1)]
    said = list(cost_map.beside_neighbours({"rests": cells}, columns))
    assert said == [f"rests: 1e5, tau 1e-4 takes 11 times as long as {beside}" for beside in ("1e3, tau 1e-4", "1e5")]


def test_the_table_is_printed_and_put_in_the_place_of_the_one_in_a_page(tmp_path):
    page, words = tmp_path / "page.md", ("--only", "pinned face", "--stiffness", "1e7", "--tau", "1e-4", "--page", "page.md")
    head = "| k [N/m] | 1e7, tau 1e-4 |\n"
    page.write_text(f"before\n\n{head}|---|---|\n| gone | 1 |\n\nafter\n")
    done = run(tmp_path, *words)
    assert done.returncode == 0 and "bare explicit step: " in done.stdout and "(4^3)" in done.stdout, done.stderr
    text = page.read_text()
    assert text.startswith(f"before\n\n{head}|---|---|\n| pinned face | ") and text.endswith(" |\n\nafter\n") and "gone" not in text
    assert all(line in done.stdout for line in text.splitlines()[2:-2])


def test_a_page_without_a_table_is_refused(cost_map, tmp_path):
    (tmp_path / "page.md").write_text("nothing\n")
    with pytest.raises(SystemExit, match=r"page\.md: wanted a table that begins with \| k"):
        cost_map.write(tmp_path / "page.md", cost_map.head([(1e7, 1e-4)]))
