"""Shapes of solid obstacles, in pictures too."""

from dataclasses import replace

import numpy as np
import pytest

from made_up_run import ORIGIN, SIZE, made_up_run, with_solids
from softffd.scene.rigid import Box, Cylinder, Sphere
from softffd.scene.section import Rotation
from softffd.show.panel import Panels
from softffd.show.raster_plane import draw_plane
from softffd.show.solid import form_of
from softffd.show.stage import BESIDE, FREE, OBSTACLES, stage_of
from softffd.show.touch import touch_of

BALL = Sphere(name="ball", radius=0.5, point=(1.3, 0.0, 0.7))
POST = Cylinder(name="post", radius=0.3, length=2.0, point=(1.3, 0.0, 0.7))
CRATE = Box(name="crate", size=(0.4, 0.6, 1.0), point=(1.3, 0.0, 0.7))
SOLIDS = pytest.mark.parametrize("solid", [BALL, POST, CRATE], ids=lambda solid: solid.name)
VOLUMES = {"ball": np.pi / 6, "post": 0.18 * np.pi, "crate": 0.24}


@SOLIDS
def test_the_triangles_enclose_the_volume_and_look_outwards(solid):
    form = form_of(solid.shape(), 1.0)
    a, b, c = np.moveaxis(form.vertices[form.faces], 1, 0)
    areas = np.cross(b - a, c - a)
    way = np.sign(np.einsum("fa,fka->f", areas, form.normals[form.faces]))
    volume = np.einsum("fa,fa->f", a, areas) @ way / 6
    assert volume == pytest.approx(VOLUMES[solid.name], rel=5e-3)  # chords of 64 sides
    assert np.abs(form.gap(form.vertices)).max() < 1e-12
    assert form.gap(form.vertices + 0.1 * form.normals) == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize("radius", [0.1, 1.0, 100.0, 1e4])
def test_a_sphere_is_round_near_its_pole_however_large(radius):
    """By how much triangles cut through it within half of the scene's size."""
    form = form_of(Sphere(name="ball", radius=radius).shape(), 1.0)
    middles = form.vertices[form.faces].mean(axis=1)
    near = np.linalg.norm(middles - [0.0, 0.0, radius], axis=1) < 0.5
    assert -form.gap(middles[near]).min() < 2e-3


def test_distances_are_those_from_faces_edges_and_corners():
    places = np.array([[0.0, 0.0, 1.5], [0.6, 0.0, 1.4], [0.0, 0.0, 0.9], [0.2, 0.0, 0.0]])
    assert form_of(POST.shape(), 1.0).gap(places) == pytest.approx([0.5, 0.5, -0.1, -0.1])
    assert form_of(CRATE.shape(), 1.0).gap(np.array([[0.4, 0.5, 0.6], [0.0, 0.6, 0.0], [0.1, 0.0, 0.0]])) == pytest.approx([0.3, 0.3, -0.1])


def beside(*solids):
    """The made-up run without its planes, beside solids."""
    return with_solids(replace(made_up_run(), inputs={}, parameters={}), *solids)


def panel(result):
    """The image of the end, 300 x 240 pixels."""
    stage = stage_of(result)
    last = len(stage.time) - 1
    return Panels(stage, [last], 300, 240).image(last)


def tinted(image, tint):
    """How many pixels have the hue of a colour in some light."""
    light = image / image.max(axis=-1, keepdims=True)
    return (np.abs(light - np.array(tint) / max(tint)).max(axis=-1) < 0.06).sum()


@SOLIDS
def test_a_picture_shows_a_solid_in_its_colour(solid):
    coloured = [tinted(panel(beside(*solids)), OBSTACLES[0]) for solids in ((), (solid,))]
    assert coloured[1] > coloured[0] + 500


def test_a_solid_is_drawn_where_it_has_moved_to():
    """The run takes 2 s."""
    moved = BALL.model_copy(update={"point": (0.3, 0.0, 0.7), "velocity": (0.5, 0.0, 0.0)})
    there, away = BALL, BALL.model_copy(update={"point": (1.3, 0.0, 0.5)})
    images = [panel(beside(solid)) for solid in (there, moved, away)]
    assert np.array_equal(images[0], images[1]) and not np.array_equal(images[0], images[2])


def test_the_axes_of_a_box_turn_with_it():
    turned = CRATE.model_copy(update={"rotation": Rotation(axis=(1.0, 0.0, 0.0), degrees=90.0), "angular_velocity": (0.0, 0.0, np.pi / 4)})
    axes = stage_of(beside(turned)).solids[0].axes
    assert axes[0] == pytest.approx(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), abs=1e-12)
    assert axes[-1] == pytest.approx(np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]), abs=1e-12)


@pytest.mark.parametrize(
    "solid",
    [
        Sphere(name="ball", radius=50.0, point=(0.0, 0.0, -49.8)),
        Cylinder(name="drum", radius=50.0, length=200.0, normal=(0.3, 1.0, 0.0), point=(0.0, 0.0, -49.8)),
        Box(name="slab", size=(100.0, 100.0, 1.0), point=(0.0, 0.0, -0.3)),
    ],
    ids=lambda solid: solid.name,
)
def test_a_large_solid_is_ground_and_the_object_stays_large(solid):
    grown = stage_of(beside(solid)).half - stage_of(beside()).half
    assert (grown <= 2 * BESIDE * stage_of(beside()).radius + 1e-9).all()
    bare, image = panel(beside()), panel(beside(solid))
    balls = [(np.abs(each - FREE).max(axis=-1) < 0.12).sum() for each in (bare, image)]
    assert balls[1] > 0.4 * balls[0]
    low = image[-60:]  # where it goes on behind the eye
    assert tinted(low, OBSTACLES[0]) > 0.8 * low[..., 0].size


def test_a_solid_far_away_is_not_in_view():
    far = beside(BALL.model_copy(update={"point": (100.0, 0.0, 0.0)}))
    assert np.array_equal(stage_of(far).half, stage_of(beside()).half)


def test_vertices_on_a_solid_touch_and_arrows_begin_at_the_centre_of_pressure():
    """A block on whose upper face the object lies in the end."""
    block = Box(name="block", size=(4.0, 4.0, 1.0), point=(0.0, 0.0, ORIGIN[2] - 0.5))
    result = beside(block)
    force = {f"box.block.reaction.{c}": np.full(len(result.time), -float(c == "z")) for c in "xyz"}
    centre = {f"box.block.centre.{c}": np.full(len(result.time), v) for c, v in zip("xyz", (0.1, 0.2, ORIGIN[2]), strict=True)}
    result = replace(result, outputs=force | centre)
    touch = touch_of(result, stage_of(result))
    assert len(touch.places(40)[0]) == 16 and len(touch.places(0)[0]) == 0
    ((start, end),) = touch.arrows(40)
    assert start == pytest.approx([0.1, 0.2, ORIGIN[2]], abs=1e-6) and end[2] < start[2] - 0.1 * np.linalg.norm(SIZE)


@SOLIDS
def test_a_solid_casts_a_shadow_on_the_ground_of_a_picture(solid, monkeypatch):
    """It alone: the solid itself is not drawn."""
    stage = stage_of(with_solids(made_up_run(), solid.model_copy(update={"point": (-1.6, -0.4, 1.4)})))
    panels = Panels(replace(stage, planes=stage.planes[:1]), [0], 150, 100)
    monkeypatch.setattr("softffd.show.panel.draw_solid", lambda *_, **__: None)
    shaded = panels.image(0)
    monkeypatch.setattr("softffd.show.panel.draw_plane", lambda canvas, patch, surfaces: draw_plane(canvas, patch, surfaces=surfaces[:1]))
    darker = (panels.image(0) - shaded).mean(axis=-1)
    assert (darker > 0.02).sum() > 40 and darker.min() > -1e-3
