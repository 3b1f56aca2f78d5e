"""Published cases: they run, by their references, and the page says what comes out."""

import csv
from pathlib import Path

import numpy as np
import pytest

from softffd import SoftffdError
from validation.published import runs, spheres, vibration
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


@pytest.mark.full
def test_a_beam_of_a_solid_vibrates_as_timoshenkos():
    found = errors(list(case("Frequencies of a clamped beam").rows(solid(0.0, 31, 4, 4))))
    assert list(found) == [f"{name} frequency [Hz]" for name in ("first", "second", "third")]
    assert found == pytest.approx(dict.fromkeys(found, 0), abs=0.1)  # 0.05 of it goes with more points across


@pytest.mark.full
def test_a_wide_plate_vibrates_as_timoshenkos_strip_in_plane_strain():
    (row,) = case("plane strain").rows(solid(0.25, 13, 31, 4))
    strip = vibration.timoshenko((0.2, 0.5, 0.02), 2e6 / (1 - 0.25**2), 1000.0, 0.25 / 0.75)[0]
    assert row.reference == pytest.approx(0.2681, abs=5e-5)  # s, as the source has it
    assert row.found == pytest.approx(1 / strip, rel=2e-3)  # what its free sides add


@pytest.mark.full
def test_a_sphere_is_pressed_into_a_solid_with_the_force_of_hertz_the_nearer_the_finer():
    coarse, fine = ([abs(row.error) for row in case("Sphere pressed").rows(solid(0.25, n, n, n))] for n in (13, 19))
    assert max(fine) < max(coarse) / 3
    assert max(fine) < 0.035  # of cells of 2.2 mm in a contact of 3.2 to 6.3 mm


@pytest.mark.full
def test_a_beam_of_a_solid_rolls_up_to_a_circle():
    found = errors(list(case("rolled up").rows(solid(0.0, 25, 4, 4))))
    assert found["deflection / L at half a turn"] == pytest.approx(0, abs=1.5)  # (h / L)2 of 1/400, some times
    assert found["shortening / L at half a turn"] == pytest.approx(0, abs=1.5)
    assert found["shortening / L at a whole turn"] == pytest.approx(0, abs=6)


def test_hertzs_impact_on_a_half_space_takes_the_published_time(monkeypatch):
    monkeypatch.setattr(spheres, "GIVES", 0.0)
    period, force = spheres.impact(0.25)
    mass, speed, modulus = spheres.MASS, spheres.SPEED, spheres.MODULUS / (1 - 0.25**2)
    assert period == pytest.approx(2.87 * (mass**2 / (spheres.RADIUS * modulus**2 * speed)) ** 0.2, rel=1e-3)  # 2.868
    deepest = (force / spheres.hertz(0.25, 1.0)) ** (2 / 3)
    assert 2 / 5 * force * deepest == pytest.approx(mass * speed**2 / 2, rel=1e-9)


@pytest.mark.full
def test_a_sphere_hits_a_block_as_hertz_says():
    found = errors(list(case("hits a block").rows(solid(0.25, 13, 13, 13))))
    assert found["contact time [s]"] == pytest.approx(0, abs=1.5)
    assert found["largest force [N]"] == pytest.approx(0, abs=1.5)
    assert -3 < found["rebound / speed"] < 0


def test_timoshenkos_beam_is_euler_and_bernoullis_if_it_is_thin():
    thin = vibration.timoshenko((0.2, 0.02, 5e-4), 1e6, 1100.0, 0.25)[:3]
    of_bending = np.array(list(vibration.CLAMPED.values())) ** 2 / 0.2**2 * 5e-4 * np.sqrt(1e6 / 1100 / 12) / (2 * np.pi)
    assert thin == pytest.approx(of_bending, rel=1e-4)


def test_timoshenkos_beam_is_lower_by_shear_and_the_inertia_of_turning():
    # after the expansion in (r k)2 of an infinite beam, r2 = h2 / 12: 1 - (r k)2 (1 + E / (K G)) / 2, here of a short wave
    found, slim = (vibration.timoshenko((0.2, 0.02, h), 1e6, 1100.0, 0.25, terms=24) for h in (0.002, 0.0002))
    wave = 9.5 * np.pi / 0.2
    shear_factor = 12.5 / 14.75
    assert found[9] / (10 * slim[9]) - 1 == pytest.approx(-(wave**2) * 0.002**2 / 24 * (1 + 2.5 / shear_factor), rel=0.05)


@pytest.mark.parametrize("hertz", [2.0, 2.07])
def test_a_frequency_is_that_of_the_large_part_of_a_vibration(hertz):
    time = 0.01 * np.arange(501)
    values = np.cos(2 * np.pi * hertz * time + 0.3) + 0.01 * np.cos(2 * np.pi * 6.3 * hertz * time) + 0.003
    assert vibration.fine_frequency(values, 0.01) == pytest.approx(hertz, rel=3e-5)
    assert vibration.frequency(values, 0.01) == pytest.approx(hertz, rel=1e-3)


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
