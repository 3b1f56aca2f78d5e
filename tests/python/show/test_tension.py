"""Colours of stress and stretch: the values of the cells, a scale that says what they are, and none where they are not asked for."""

import numpy as np
import pytest
from matplotlib import colormaps

from scenes import box
from softffd import SoftffdError, simulate
from softffd.show.stage import stage_of
from softffd.show.tension import FOLDED, at_places, tension_of

MODULUS, STRAIN = 1e5, 1e-4


@pytest.fixture(scope="module")
def pulled():
    scene = box(material={"youngs_modulus": MODULUS}, stretch=[1 + STRAIN, 1.0, 1.0], stop_time=0.01)
    return simulate(scene)


@pytest.mark.parametrize(
    "colour, high, unit, words",
    [("von_mises", 0.8 * MODULUS * STRAIN, "Pa", "von Mises stress"), ("stretch", 1 + STRAIN, "", "largest principal stretch")],
)
def test_a_homogeneous_strain_has_the_value_of_the_solid_everywhere(pulled, colour, high, unit, words):
    cells, tints = tension_of(pulled, stage_of(pulled), [0], colour)
    assert cells.ends[1] == pytest.approx(high, rel=1e-3 if colour == "von_mises" else 1e-12)
    assert cells.unit == unit and cells.words == f"{words} at the cells' centres"
    brightest = colormaps["viridis"](1.0)[:3]
    assert tints[0] == pytest.approx(np.tile(brightest, (len(tints[0]), 1)), abs=0.02)


def test_between_the_centres_of_cells_it_is_linear_and_beyond_them_that_of_the_nearest(pulled):
    stage = stage_of(pulled)
    values = np.broadcast_to(np.array([1.0, 2.0, 5.0])[:, None, None], (3, 3, 3))
    x = stage.vertices[:, 0]
    places = (stage.vertices - stage.origin) / stage.size
    assert at_places(values, places) == pytest.approx(np.interp(x, [1 / 6, 1 / 2, 5 / 6], [1.0, 2.0, 5.0]), abs=1e-12)


def test_cells_turned_inside_out_are_grey():
    result = simulate(box(material={"youngs_modulus": MODULUS}, stop_time=0.01))
    result.positions[0, 1, :, :, 0] = 0.9
    folded = tension_of(result, stage_of(result), [0], "von_mises")[1][0] == FOLDED
    assert folded.all(axis=1).any() and not folded.all()


def test_the_picture_changes_only_where_a_colour_is_asked_for(pulled):
    images = [np.asarray(pulled.plot(colour=colour)._repr_png_()) for colour in (None, "stretch", "von_mises")]
    assert images[0] == np.asarray(pulled.plot()._repr_png_()) and len(set(map(bytes, images))) == 3


def test_a_colour_that_is_not_there_is_refused_with_the_nearest(pulled):
    with pytest.raises(SoftffdError, match='colour von_misses: there is no such colour, did you mean "von_mises"'):
        pulled.plot(colour="von_misses")
