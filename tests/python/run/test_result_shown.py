"""A result's picture, page, notebook form and tables."""

import base64
import html
import re
import sys
import tempfile
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from made_up_run import made_up_run
from scenes import LED, box, table_and_press
from softffd import SoftffdError, simulate
from softffd.run import result as results
from softffd.show.stage import stage_of


@pytest.fixture(scope="module")
def result():
    pin = [{"name": "hand", "points": "z-", **LED}]
    return simulate(box(plane=table_and_press(), pin=pin, velocities={"i": [1, 1]}, forces="x+", stop_time=0.05))


def test_plot_gives_the_figure_and_writes_it(tmp_path):
    figure = made_up_run().plot(tmp_path / "run.png")
    assert figure._repr_png_() == (tmp_path / "run.png").read_bytes()
    with Image.open(tmp_path / "run.png") as image:
        assert image.size == tuple((figure.get_size_inches() * figure.dpi).round().astype(int))
    made_up_run().plot(tmp_path / "run.SVG", y="time")
    assert b"<svg" in (tmp_path / "run.SVG").read_bytes()
    for name in ("run.jpg", "run"):
        with pytest.raises(SoftffdError, match=r"ends with \.png, \.svg, \.pdf, did you mean .*run\.png"):
            made_up_run().plot(tmp_path / name, y="time")


@pytest.mark.parametrize(("with_mesh", "shown"), [(True, [False, True, False]), (False, [True, True, False])])
def test_plot_shows_the_lattice_where_there_is_no_mesh_or_as_it_is_asked(monkeypatch, with_mesh, shown):
    drawn = []
    monkeypatch.setattr("softffd.show.picture._draw_images", lambda *_, lattice, **options: drawn.append(lattice))
    monkeypatch.setattr("softffd.show.picture.stage_of", lambda result: replace(stage_of(result), is_cage=not with_mesh))
    for lattice in (None, True, False):
        made_up_run().plot(lattice=lattice)
    assert drawn == shown


def test_plot_draws_outputs_over_another(result, tmp_path):
    figure = result.plot(tmp_path / "force.png", x="position[0,0,3].z", y=["plane.press.reaction", "plane.press.point.z"])
    forces, points = figure.axes
    assert forces.get_xlabel() == "position[0,0,3].z" and (tmp_path / "force.png").read_bytes() == figure._repr_png_()
    assert [text.get_text() for text in forces.get_legend().get_texts()] == [f"plane.press.reaction.{c}" for c in "xyz"]
    np.testing.assert_array_equal(forces.lines[2].get_ydata(), result.outputs["plane.press.reaction.z"])
    np.testing.assert_array_equal(forces.lines[2].get_xdata(), result.positions[:, 0, 0, 3, 2])
    np.testing.assert_array_equal(points.lines[0].get_ydata(), result.inputs["plane.press.point.z"])
    (over_time,) = result.plot(y="plane.press.reaction.z").axes
    assert over_time.get_xlabel() == "time [s]" and over_time.get_ylabel() == "plane.press.reaction.z"


@pytest.mark.parametrize(
    "asked, words",
    [
        ({"y": "plane.pres.reaction.z"}, 'did you mean "plane.press.reaction.z"'),
        ({"x": "plane.press.point", "y": "time"}, r"x: wanted one output or input, got the vector plane\.press\.point; take plane"),
        ({"x": "plane.press.point.z"}, "plot: wanted x with y"),
        ({"y": "time", "colour": "stretch"}, "plot: wanted x with y, and colour and lattice without them"),
        ({"y": "time", "lattice": False}, "plot: wanted x with y, and colour and lattice without them"),
    ],
)
def test_what_cannot_be_plotted_is_refused(result, asked, words):
    with pytest.raises(SoftffdError, match=words):
        result.plot(**asked)


def test_view_writes_the_page_and_opens_it_without_a_path_as_a_temporary_file(tmp_path, monkeypatch, opened):
    page = made_up_run().view(tmp_path / "run.html")
    assert opened == [page.resolve().as_uri()] and "A soft box under a press" in page.read_text()
    assert made_up_run().view(browser=False).read_text() == page.read_text() and len(opened) == 1
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    first, second = made_up_run().view(), made_up_run().view()
    assert first != second and first.is_relative_to(tmp_path) and second.is_file() and len(opened) == 3


def test_without_positions_there_is_nothing_to_see(tmp_path, opened):
    run = made_up_run()
    run.positions[2] = np.nan
    for ask in (run.plot, lambda: run.view(tmp_path / "run.html")):
        with pytest.raises(SoftffdError, match=r'outputs\.positions = "all"'):
            ask()
    assert not opened and not list(tmp_path.iterdir())
    assert run._repr_html_() == f'<pre style="white-space: pre-wrap">{html.escape(repr(run))}</pre>'


def test_a_notebook_shows_words_picture_and_page(monkeypatch):
    run = replace(made_up_run(), summary={"title": "<Box> & co"}, scene=None)
    page = run._repr_html_()
    assert page.startswith(f'<pre style="white-space: pre-wrap">{html.escape(repr(run))}</pre>') and "<Box>" not in page
    with Image.open(BytesIO(base64.b64decode(re.search(r"base64,([^\"]+)\"", page)[1]))) as image:
        assert image.width > 1000
    frame = html.unescape(re.search(r'srcdoc="([^"]+)"', page)[1])
    assert frame.startswith("<!doctype html>") and frame.rstrip().endswith("</html>")
    monkeypatch.setattr(results, "LARGEST_PAGE", len(frame) - 1)
    large = run._repr_html_()
    assert "<iframe" not in large and "view()" in large


def test_a_data_frame_has_every_variable_over_time(result):
    pytest.importorskip("pandas")
    frame = result.to_dataframe()
    assert frame.index.name == "time" and list(frame.index) == list(result.time)
    np.testing.assert_array_equal(frame["position[3,2,1].z"], result.positions[:, 3, 2, 1, 2])
    np.testing.assert_array_equal(frame["plane.press.reaction.z"], result.outputs["plane.press.reaction.z"])
    again = simulate(result.scene, inputs=frame[["plane.press.point.z"]])
    np.testing.assert_array_equal(again.inputs["plane.press.point.z"], frame["plane.press.point.z"])


def test_a_dataset_has_vectors_and_fields_with_their_units(result):
    pytest.importorskip("xarray")
    data = result.to_xarray()
    np.testing.assert_array_equal(data["position"], result.positions)
    assert data["velocity"].dims == data["position"].dims == ("time", "i", "j", "k", "axis")
    np.testing.assert_array_equal(data["velocity"][:, 1, 2, 3, 0], result.outputs["velocity[1,2,3].x"])
    assert np.isnan(data["velocity"][:, 0]).all() and np.isnan(data["force"][:, 0]).all() and not np.isnan(data["force"][:, 3]).any()
    force = data["plane.press.reaction"].sel(axis="z", time=0.03, method=None)
    assert force == result.outputs["plane.press.reaction.z"][3] and data["plane.press.reaction"].attrs == {"units": "N"}
    assert data["pin.hand.orientation.w"].dims == ("time",) and data["plane.press.contacts"].dtype == np.int64
    assert data.attrs["title"] == result.title and data.attrs["mass"] == 1


@pytest.mark.parametrize("method, package, extra", [("to_dataframe", "pandas", "dataframes"), ("to_xarray", "xarray", "datasets")])
def test_a_missing_package_is_named_with_its_extra(result, monkeypatch, method, package, extra):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(SoftffdError, match=rf"{method} needs {package}, .* pip install 'softffd\[{extra}\]'"):
        getattr(result, method)()
