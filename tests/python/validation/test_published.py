"""Published cases: they run, by their references, and the page says what comes out."""

import csv
from pathlib import Path

import pytest

from softffd import SoftffdError
from validation.published import runs
from validation.published.cases import Row
from validation.published.catalogue import CASES, solid, springs
from validation.published.report import COLUMNS, report_published

DOCS = Path(__file__).resolve().parents[3] / "docs"


def case(words: str):
    return next(each for each in CASES if words in each.title)


def errors(rows: list[Row]) -> dict[str, float]:
    return {row.quantity: 100 * row.error for row in rows}


def test_a_hanging_bar_of_a_solid_has_the_elongation_and_the_stress_of_one_dimension():
    found = errors(list(case("Bar under its own weight").rows(solid(0.0, 16, 4, 4))))
    assert found == pytest.approx({"elongation [m]": 0, "stress at the top [Pa]": 0}, abs=1e-3)


def test_springs_hang_shorter_by_what_their_clamp_holds():
    found = errors(list(case("Bar under its own weight").rows(springs(31, 4, 4))))
    assert -2 < found["elongation [m]"] < -0.2
    assert found["stress at the top [Pa]"] == pytest.approx(0, abs=1e-3)


def test_a_bar_of_a_solid_strikes_a_wall_as_its_wave_says(tmp_path):
    rows = report_published(tmp_path, ["strikes"])
    found = errors([row for row in rows if row.body.model == "solid"])
    assert found["contact time [s]"] == pytest.approx(0, abs=2)  # a look
    assert found["force [N]"] == pytest.approx(0, abs=0.5)
    assert -3 < found["rebound / speed"] < 0
    kept = list(csv.DictReader((tmp_path / "benchmarks.csv").open()))
    assert [float(row["found"]) for row in kept] == [row.found for row in rows]
    page = (tmp_path / "benchmarks.md").read_text()
    assert "### Bar that strikes a wall" in page and page.count("\n| [Bar that") == len(rows)


def test_a_word_that_no_case_has_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match=r"--only strkes: wanted .*Bar that strikes a wall"):
        report_published(tmp_path, ["strkes"])


@pytest.mark.parametrize("of_solid", [False, True])
def test_shares_of_a_mean_are_those_of_a_straight_line(of_solid):
    found = runs.shares(7, of_solid)
    assert found.sum() == pytest.approx(1)
    assert found == pytest.approx(found[::-1])


def kept_rows() -> list[dict[str, str]]:
    return list(csv.DictReader((DOCS / "benchmarks.csv").open()))


def test_the_page_has_every_case():
    page, rows = (DOCS / "benchmarks.md").read_text(), kept_rows()
    assert list(dict.fromkeys(row["case"] for row in rows)) == [each.title for each in CASES]
    assert all(f"### {each.title}\n" in page for each in CASES)
    assert tuple(rows[0]) == COLUMNS


@pytest.mark.full
def test_the_page_says_what_comes_out(tmp_path):
    rows = report_published(tmp_path)
    assert len(rows) == len(kept_rows())
    for row, kept in zip(rows, kept_rows(), strict=True):
        assert (str(row.body), row.quantity) == (kept["body"], kept["quantity"])
        assert row.found == pytest.approx(float(kept["found"]), rel=1e-3), row
