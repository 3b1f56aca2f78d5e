"""Springs of a given modulus, and solids: the deflections and the force that the documents promise, by `benchmarks/solid.py`."""

import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def solid(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module("solid")


def table(page: str, head: str) -> dict[str, list[float]]:
    """The numbers of a page's table by what its lines begin with."""
    found = re.search(rf"^\| {head} \|.*\n(\|.*\n)+", (ROOT / page).read_text(), re.MULTILINE)
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in found[0].splitlines()]
    return {line[0]: [float(cell.split()[0]) for cell in line[1:]] for line in lines if not line[0].startswith("---")}


@pytest.mark.short("*-4")
@pytest.mark.parametrize("n", [4, 7, 13])
@pytest.mark.parametrize("load", ["end pull", "own weight along", "end shear", "own weight across"])
def test_a_clamped_cube_deflects_as_the_table_says(solid, load, n):
    expected = table("docs/materials.md", "load")
    error = expected[load][expected["load"].index(n)]
    assert 100 * solid.error(n, load) == pytest.approx(error, rel=0.1)


@pytest.mark.short("*-4", "end shear-0.49-7")
@pytest.mark.parametrize("n", [4, 7, 10])
@pytest.mark.parametrize("ratio", [0.25, 0.45, 0.49])
@pytest.mark.parametrize("load", ["end pull", "own weight along", "end shear", "own weight across"])
def test_a_clamped_solid_deflects_as_the_table_says(solid, load, ratio, n):
    expected = table("docs/materials.md", "load, Poisson's ratio")
    error = expected[f"{load}, {ratio:g}"][expected["load, Poisson's ratio"].index(n)]
    assert 100 * solid.solid_error(n, load, ratio) == pytest.approx(error, abs=0.051 if abs(error) >= 1 else 0.0051)


@pytest.mark.short("4-7")
@pytest.mark.parametrize("coarse, fine, most", [(4, 7, 0.05), (7, 10, 0.05), (10, 13, 0.01)], ids=["4-7", "7-10", "10-13"])
def test_the_force_of_a_pressed_pad_falls_with_the_lattice_and_settles(solid, coarse, fine, most):
    forces = table("docs/materials.md", "points a side")
    shown = dict(zip(forces["points a side"], forces["force"], strict=True))
    force = {n: solid.pad_force(n) for n in (coarse, fine)}
    assert 1 < force[coarse] / force[fine] < 1 + most
    assert force == pytest.approx({n: shown[n] for n in force}, abs=0.005)  # N, as printed
    assert list(shown.values()) == sorted(shown.values(), reverse=True)
