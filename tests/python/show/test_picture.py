from dataclasses import replace
from io import BytesIO
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from made_up_run import ORIGIN, SIZE, at_rest_about, made_up_run, with_mesh
from mesh_files import two_colours
from softffd.mesh.files import load_mesh
from softffd.show.figure import draw_curves, draw_words, new_figure, png_of
from softffd.show.panel import Panels, _draw_arrow
from softffd.show.picture import first_contact, run_picture, telling_moments
from softffd.show.raster import Camera, Canvas
from softffd.show.sight import view_axes
from softffd.show.stage import FREE, PINNED, stage_of
from softffd.show.touch import MARK


def pixels(figure):
    return np.asarray(Image.open(BytesIO(png_of(figure))).convert("RGB")) / 255.0


def near(image, colour, tolerance=0.12):
    return (np.abs(image - colour).max(axis=-1) < tolerance).sum()


def test_telling_moments_are_start_contact_if_it_comes_later_largest_deformation_and_end():
    result = made_up_run()
    assert telling_moments(result) == {0: "start", 17: "first contact", 24: "largest deformation", 40: "end"}
    assert first_contact(replace(result, outputs={})) is None
    result = made_up_run(frames=201)
    touching = {name: np.where(result.time > 0, 1.0, 0.0) for name in result.outputs if "reaction" in name}
    assert list(telling_moments(replace(result, outputs=touching)).values()) == ["start", "largest deformation", "end"]


def test_picture_of_a_run_shows_four_moments_and_curves():
    image = pixels(run_picture(made_up_run()))
    assert image.shape == (988, 1690, 3)
    upper, lower = image[80:560], image[640:]
    quarters = np.array_split(upper, 4, axis=1)
    assert all(near(q, FREE) > 200 for q in quarters)
    assert not any(np.array_equal(a[:, :400], b[:, :400]) for a, b in pairwise(quarters))
    assert near(lower, (0.0, 0.447, 0.698)) > 300 and near(lower, (0.835, 0.369, 0.0)) > 300


def test_a_picture_marks_what_touches_and_the_forces_on_obstacles():
    result = made_up_run()
    quiet = {name: values for name, values in result.outputs.items() if ".centre." not in name}
    image, plain = (pixels(run_picture(each))[80:545] for each in (result, replace(result, outputs=quiet)))
    yellow, dots = ([near(quarter, MARK, 0.03) for quarter in np.array_split(each, 4, axis=1)] for each in (image, plain))
    assert yellow[0] == dots[0] == 0  # it falls
    assert min(yellow[2:]) > 100 and max(yellow) > 500
    assert min(dots[2:]) > 100 and max(dots) < max(yellow) - 300  # without centres no arrows


def test_a_short_arrow_is_as_short_as_its_force_says():
    def height(length):
        eye, up = np.array([0.0, -8.0, 0.0]), np.array([0.0, 0.0, 1.0])
        canvas = Canvas(Camera(eye, np.zeros(3), up), 400, 400, top=(1, 1, 1), bottom=(1, 1, 1))
        _draw_arrow(canvas, np.zeros(3), length * up, width=4.0, colour=MARK, outline=MARK)
        return np.ptp(np.argwhere((canvas.image() < 0.5).any(axis=-1))[:, 0])

    assert height(0.2) < 0.25 * height(1.0)


def test_without_reactions_and_energies_the_picture_shows_the_height():
    bare = replace(made_up_run(), outputs={}, inputs={}, parameters={}, scene=None)
    image = pixels(run_picture(bare))
    assert near(image[640:], (0.0, 0.447, 0.698)) > 300


def test_every_lattice_is_inside_its_image_and_fills_it():
    stage = stage_of(made_up_run())
    panels = Panels(stage, [0, 24], 120, 90)
    drawn = [(np.abs(panels.image(frame) - FREE).max(axis=-1) < 0.15) for frame in (0, 24)]
    assert not any(d[[0, -1]].any() or d[:, [0, -1]].any() for d in drawn)
    assert any(np.ptp(np.flatnonzero(d.any(axis=0))) > 70 or np.ptp(np.flatnonzero(d.any(axis=1))) > 50 for d in drawn)


def test_pinned_control_points_are_dark():
    plain, pinned = (stage_of(made_up_run(pins=p)) for p in ((), (np.arange(16), np.arange(48, 64))))
    assert pinned.pinned.tolist() == [*range(16), *range(48, 64)]
    dark = [near(Panels(replace(stage, planes=()), [0], 300, 200).image(0), PINNED, 0.1) for stage in (plain, pinned)]
    assert dark[1] > dark[0] + 200


@pytest.mark.parametrize("up", [(0, 0, 1.0), (0, 1.0, 0), (0.6, 0.0, -0.8)])
def test_view_looks_down_a_little_with_up_upwards(up):
    right, above, back = view_axes(np.array(up))
    assert np.allclose(np.stack([right, above, back]) @ np.stack([right, above, back]).T, np.eye(3))
    assert np.allclose(np.cross(right, above), back)
    assert np.isclose(right @ up, 0) and above @ up > 0.9 and back @ up > 0.2


@pytest.mark.parametrize("name", ["kd.obj", "pictures.glb", "vertices.ply", "faces.off"])
def test_a_picture_shows_the_colours_of_the_mesh(name, tmp_path):
    """The red box is below the green one, and nothing is as blue as what has no colour."""
    mesh = load_mesh(two_colours(tmp_path, name))
    image = Panels(replace(stage_of(at_rest_about(mesh)), planes=()), [0], 600, 500).image(0)
    red, green, blue = image[..., 0], image[..., 1], image[..., 2]
    reddish, greenish = np.argwhere(red > 2 * np.maximum(green, blue)), np.argwhere(green > 1.3 * np.maximum(red, blue))
    assert len(reddish) > 3000 and len(greenish) > 3000
    assert np.quantile(greenish[:, 0], 0.95) < np.quantile(reddish[:, 0], 0.05)
    assert not ((blue > red + 0.2) & (blue > green + 0.1)).any()


def test_picture_of_a_real_mesh(real_meshes):
    mesh = load_mesh(real_meshes / "spot.obj", up="y")
    into = SIZE / np.ptp(mesh.bounds, axis=0)
    mesh = replace(mesh, vertices=ORIGIN + (mesh.vertices - mesh.bounds[0]) * into)
    image = Panels(stage_of(with_mesh(made_up_run(), mesh)), [24], 600, 500).image(24)
    assert ((image[..., 2] > image[..., 0] + 0.2).sum()) > 3000


TIMES = np.linspace(0.0, 1.0, 5)
USERS = ["set {1}", "{x}", "{", "}{", "from $5 to $10", "$ $", r"\alpha $x^2$ 100 %"]


def test_words_are_drawn_as_they_are():
    figure = new_figure(4.0, 3.0, dpi=100)
    for words in USERS:
        draw_words(figure, words, (0.5, 0.5), 10)
    png_of(figure)
    assert [text.get_text() for text in figure.texts] == USERS


@pytest.mark.short("set*")
@pytest.mark.parametrize("title", USERS)
def test_a_picture_tells_its_title_and_the_estimated_error(title):
    run = replace(made_up_run(), summary={"title": title, "run_time_s": 1.0, "estimated_error_m": 1e-3}, scene=None)
    assert {title, "run time 1.0 s, estimated error 1.0 mm"} <= {text.get_text() for text in run_picture(run).texts}


@pytest.mark.parametrize(
    "summary, words",
    [
        ({"estimated_error_m": 1e-3}, ["estimated error 1.0 mm"]),
        ({"estimated_error_m": "small", "run_time_s": 1.0}, ["run time 1.0 s"]),
        ({"run_time_s": 1.0}, []),
    ],
)
def test_a_picture_of_an_edited_summary_tells_what_is_left(summary, words):
    run = replace(made_up_run(), summary=summary, scene=None)
    assert [text for each in run_picture(run).texts if (text := each.get_text()).startswith(("run", "estimated"))] == words


def test_names_of_curves_are_drawn_as_they_are():
    names = ["_press", "$a$", "$ $", "{}"]
    figure = new_figure(4.0, 3.0, dpi=100)
    draw_curves(figure, (0.1, 0.2, 0.8, 0.6), "$ $", "N", TIMES, dict.fromkeys(names, TIMES), across=("$x$", "m"))
    png_of(figure)
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.get_legend().get_texts()] == names
    words = [*axes.get_legend().get_texts(), axes.xaxis.label, axes.yaxis.label]
    assert not any(text.get_parse_math() for text in words)
