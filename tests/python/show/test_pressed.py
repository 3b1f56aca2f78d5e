"""Contact pressure in pictures and on the page: colours where taxels are, maps of the sensors, their scale."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from matplotlib import colormaps

from browser import showing
from pages import decoded, run_of
from softffd import Result, simulate
from softffd.show.live.described import Described
from softffd.show.live.page import live_page
from softffd.show.live.scene import live_scene
from softffd.show.stage import stage_of
from softffd.show.taxels import pressed_moments
from softffd.show.tension import tension_of
from softffd.show.view import write_view, write_views
from solids import solid

FOOT = {"name": "foot", "on": "z-", "taxels": [3, 2]}
BACK = {"name": "back", "on": "x-", "taxels": [2, 5]}
CORNER = {"name": "corner", "on": {"box": [[0, 0, 0], [0.001, 0.001, 0.001]]}, "taxels": [1, 1]}


@pytest.fixture(scope="module")
def felt() -> Result:
    """A block that lands on the ground, tilted a little, on its foot."""
    keys = {"gravity": [0.0, 0.0, -9.81], "plane": [{"name": "ground", "normal": [0.05, 0.0, 1.0]}], "sensor": [FOOT, BACK]}
    return simulate(
        solid(modulus=1e5, density=1000.0, size=[0.1] * 3, internal_damping=5e-3, stop_time=0.2, communication_step=0.02, **keys)
    )


def test_colours_follow_the_pressure_and_begin_at_nothing(felt):
    stage = stage_of(felt)
    cells, tints = tension_of(felt, stage, [0, 10], "contact_pressure")
    assert (cells.unit, cells.ends[0]) == ("Pa", 0.0)
    assert cells.ends[1] == pytest.approx(felt.taxel_pressure("foot")[[0, 10]].max())
    pressure = felt.contact_pressure(10)
    assert tints[10] == pytest.approx(colormaps["viridis"](pressure / cells.ends[1])[:, :3])
    assert (tints[0] == colormaps["viridis"](0.0)[:3]).all()


def test_the_picture_of_taxels_has_a_map_for_each_moment(felt):
    pressure = felt.taxel_pressure("foot")
    moments = pressed_moments(felt.taxels[0], pressure)
    figure = felt.plot_taxels("foot")
    maps = [axes.images[0].get_array() for axes in figure.axes if axes.images]
    assert len(maps) == len(moments) and list(moments)[-1] == len(felt.time) - 1
    for frame, drawn in zip(moments, maps, strict=True):
        assert np.array_equal(drawn, pressure[frame].T)
    said = " and ".join(moments.values())
    assert said.count("largest pressure") == said.count("half of the largest force") == said.count("end") == 1


@pytest.mark.parametrize("share", [0.03, 0.1, 0.3, 1.0])
def test_labels_of_a_narrow_map_do_not_overlap(felt, share):
    grid = felt.taxels[0]
    narrow = replace(grid, upper=(grid.lower[0] + share * (grid.upper[1] - grid.lower[1]), grid.upper[1]))
    figure = replace(felt, taxels=(narrow, *felt.taxels[1:])).plot_taxels("foot")
    figure.draw_without_rendering()
    axes = figure.axes[0]
    ends = axes.get_xlim()
    shown = [tick for tick in axes.xaxis.get_major_ticks() if ends[0] <= tick.get_loc() <= ends[1]]
    places = [tick.label1.get_window_extent() for tick in shown]
    assert places and all(one.x1 < other.x0 for one, other in pairwise(places))


def test_the_picture_of_a_run_that_touched_nothing_says_so(felt):
    assert pressed_moments(felt.taxels[1], 0 * felt.taxel_pressure("back")) == {len(felt.time) - 1: "end"}
    assert felt.plot_taxels("back").axes


def test_a_patch_of_one_place_has_a_picture_and_a_page(felt, tmp_path):
    one = simulate(felt.scene.replace({"sensor": [CORNER]}), stop_time=0.1)
    pressure = one.taxel_pressure("corner")
    assert pressure.shape == (len(one.time), 1, 1) and pressure.max() > 0
    left, right = one.plot_taxels("corner").axes[0].get_xlim()
    assert right > left and run_of(write_view(one, tmp_path / "view.html"))["rows"][-1]["taxels"]["aspect"] == 1


def test_the_page_holds_the_taxels_of_every_frame(felt, tmp_path):
    run = run_of(write_view(felt, tmp_path / "view.html"))
    (cells,) = [each for each in run["cells"] if each["name"] == "contact_pressure"]
    most = max(felt.taxel_pressure(name).max() for name in ("foot", "back"))
    assert cells["ends"] == pytest.approx([0.0, most]) and cells["unit"] == "Pa"
    rows = {row["label"]: row for row in run["rows"] if "taxels" in row}
    assert list(rows) == ["foot", "back"]
    for name, row in rows.items():
        pressure, (n, m) = felt.taxel_pressure(name), row["taxels"]["counts"]
        found = decoded(row["taxels"]["shares"], "u1", n * m).reshape(-1, m, n).transpose(0, 2, 1) / 255 * most
        assert np.abs(found - pressure).max() <= 0.51 / 255 * most
        assert decoded(row["values"], "<f4", 1)[:, 0] == pytest.approx(pressure.max(axis=(1, 2)), rel=1e-6)
    (size,) = [size for size, each in zip(run["sizes"], run["cells"], strict=True) if each is cells]
    atlas = decoded(cells["values"], "u1", 2).reshape(-1, *reversed(size), 2)[..., 0]
    assert atlas[-1, 0, :2, :3].T / 255 * most == pytest.approx(felt.taxel_pressure("foot")[-1], abs=0.51 / 255 * most)


def test_runs_with_and_without_taxels_share_a_page(felt, tmp_path):
    plain = simulate("press", stop_time=0.1)
    page = write_views({"felt": felt, "plain": plain}, tmp_path / "two.html").read_text("utf-8")
    assert '"shares":' in page and '"name":"contact_pressure"' not in page


def test_the_live_page_lists_what_sensors_feel(felt):
    rows = {(row["label"], row["kind"]): row for row in Described(live_scene(felt.scene), stage_of(felt)).rows()}
    for sensor in ("foot", "back"):
        assert rows[sensor, "force"]["unit"] == "N" and len(rows[sensor, "force"]["at"]) == 3
        assert rows[sensor, "pressure"]["unit"] == rows[sensor, "peak pressure"]["unit"] == "Pa"
    assert '"kind":"peak pressure"' in live_page(felt.scene, felt, b"no library")


def test_the_page_draws_the_pressure_and_the_maps(felt, tmp_path):
    with showing(write_view(felt, tmp_path / "view.html"), hash="#t=0.2&colour=contact_pressure") as browser:
        maps = "[...document.querySelectorAll('.row canvas')]"
        assert browser.ask(f"{maps}.map(map => [map.width, map.height])") == [[3, 2], [2, 5]]
        pixels = np.array(browser.ask(f"{maps}.map(map => [...map.getContext('2d').getImageData(0, 0, map.width, map.height).data])")[0])
        ramp = np.array(browser.ask("run.ramp")).reshape(-1, 3)
        shares = felt.taxel_pressure("foot")[-1] / browser.ask("run.cells.find(each => each.name === 'contact_pressure').ends[1]")
        drawn = pixels.reshape(2, 3, 4)[::-1, :, :3].transpose(1, 0, 2)
        one_step = np.abs(np.diff(ramp, axis=0)).max()  # shares are rounded, and then colours
        assert np.abs(drawn - ramp[np.round(shares * (len(ramp) - 1)).astype(int)]).max() <= one_step
        assert browser.ask("element('largest').textContent").endswith("Pa")
