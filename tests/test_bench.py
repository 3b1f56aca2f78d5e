"""`python3 python/run.py bench`: the table, what is kept of it, and what a goal that is missed looks like."""

import importlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from softffd.installed import host_library

BENCH = Path(__file__).resolve().parents[1] / "benchmarks" / "bench.py"
NEEDS = ("numba", "mujoco", "scipy")
NUMBA_LOOP = """
import numba, numpy
@numba.njit
def loop(a, b):
    for i in range(len(a)):
        a[i] = a[i] * b[i] + b[i]
loop(numpy.ones(9), numpy.ones(9))
print(*loop.inspect_asm().values())
"""


def bench(folder: Path, *words: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, BENCH, *words], cwd=folder, capture_output=True, text=True, timeout=600)


def kept(folder: Path) -> dict:
    return json.loads((folder / "softffd-bench" / "bench.json").read_text())


def of_bench(name: str):
    """A fixture: a module of the benchmarks, which are no package."""

    @pytest.fixture
    def module(monkeypatch):
        before = set(sys.modules)
        monkeypatch.syspath_prepend(str(BENCH.parent))
        yield importlib.import_module(name)
        for new in sys.modules.keys() - before:
            if Path(getattr(sys.modules[new], "__file__", None) or "/").parent == BENCH.parent:
                sys.modules.pop(new)

    return module


table, column, program = of_bench("table"), of_bench("column"), of_bench("bench")


def test_rows_are_measured_printed_and_kept(tmp_path):
    done = bench(tmp_path, "--quick", "--only", "16 points", "explicit step, 4^3", "import")
    assert done.returncode == 0, done.stderr
    rows = {row["name"]: row for row in kept(tmp_path)["rows"]}
    assert {"an explicit step, 4^3", "16 points resting on a plane", "import softffd"} <= rows.keys()
    resting = next(iter(rows["16 points resting on a plane"]["results"].values()))
    assert resting["ratio"]["median"] == pytest.approx(resting["own"]["median"] / resting["base"]["median"])
    assert 1e-7 < resting["own"]["median"] < 1e-3  # s an internal step
    for name, row in rows.items():
        line = next(line for line in done.stdout.splitlines() if line.startswith(f"  {name} "))
        result = next(iter(row["results"].values()))
        assert (" met" in line) + (" missed" in line) == (row["goal"] is not None and "missing" not in result)
        assert result.get("missing", "is not installed").endswith("is not installed")
    assert kept(tmp_path)["about"]["machine"]["processor"] in done.stdout


@pytest.mark.full
def test_every_row_runs_and_every_baseline_does_the_same(tmp_path):
    assert bench(tmp_path, "--quick", "--picture", "cost.png").returncode == 0
    assert (tmp_path / "cost.png").stat().st_size > 10_000
    for row in kept(tmp_path)["rows"]:
        for result in row["results"].values():
            excused = [f"{name} is not installed" for name in NEEDS] + ["left out by --quick"]
            assert "ratio" in result or result["missing"] in excused, row["name"]


@pytest.mark.parametrize(("column_name", "has", "lacks"), [("avx2", "ymm", "zmm"), ("baseline", "xmm", "ymm")])
def test_numba_has_the_instructions_of_its_column(column, column_name, has, lacks):
    pytest.importorskip("numba")
    if column_name not in column.instruction_sets():
        pytest.skip(f"this processor has no {column_name}")
    done = subprocess.run(
        [sys.executable, "-c", NUMBA_LOOP], env=column.environment(column_name), capture_output=True, text=True, check=True
    )
    assert f"%{has}" in done.stdout and f"%{lacks}" not in done.stdout


@pytest.mark.full
def test_another_library_has_a_column(tmp_path, column):
    other = tmp_path / "other.so"
    other.write_bytes(host_library().read_bytes())
    assert bench(tmp_path, "--quick", "--only", "gravity", "--library", "other.so").returncode == 0
    (row,) = kept(tmp_path)["rows"]
    assert list(row["results"]) == [column.instruction_sets()[0], column.OTHER] and "ratio" in row["results"][column.OTHER]
    assert kept(tmp_path)["about"]["other"].startswith("other.so; ")
    other.write_bytes(b"none")
    done = bench(tmp_path, "--quick", "--only", "gravity", "--library", "other.so")
    assert done.returncode == 1 and "other library" in done.stderr  # that it is this one which is loaded


def test_a_goal_that_is_missed_is_said(table):
    row = {"group": "steps", "name": "a step", "against": "a loop", "goal": 0.35, "goal_seconds": None}

    def line(ratio: float, **goals) -> str:
        spread = {"median": ratio, "quartiles": [ratio, ratio]}
        return table.line(row | goals | {"results": {"avx2": {"own": spread, "base": spread, "ratio": spread}}}, ["avx2"])

    assert " met " in line(0.35) and " missed " in line(0.36)
    assert " met " in line(0.9, goal=None, goal_seconds=1.0) and " missed " in line(1.1, goal=None, goal_seconds=1.0)
    assert " met" not in line(0.3, goal=None) and " missed" not in line(0.3, goal=None)


@pytest.mark.full
def test_a_page_gets_the_new_table_for_the_old_one(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("before\n\nafter\n")
    for rows in (["import"], ["a load"]):
        assert bench(tmp_path, "--quick", "--only", *rows, "--page", "page.md").returncode == 0
    text = page.read_text()
    assert text.startswith("before\n\nafter\n```text\n") and text.count("```") == 2
    assert "a load" in text and "import softffd" not in text


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--only", "import", "--picture", "cost.png"], ["parts of a scene"]),
        (["--only", "gravity", "--library", "none.so"], ["none.so"]),
        (["--only", "no such row"], ["no such row", "import softffd"]),
    ],
)
def test_wrong_requests_are_told_at_once(program, words, told, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["bench.py", *words])
    assert program.main() == 1
    said = capsys.readouterr().err
    assert all(word in said for word in told)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.usefixtures("ctrl_c_is_heard")
def test_an_interrupted_measurement_leaves_no_file(tmp_path):
    process = subprocess.Popen(
        [sys.executable, BENCH, "--only", "16 points", "damping"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    while "parts of a scene" not in process.stdout.readline():
        assert process.poll() is None
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted" in said and "Traceback" not in said
    assert list(tmp_path.iterdir()) == []
