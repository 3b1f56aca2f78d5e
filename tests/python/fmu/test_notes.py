"""What an FMU says of its body before a run: here which points are so light that they make steps short."""

import numpy as np
import pytest

from scenes import box
from softffd import SceneError, Simulation, load_scene
from softffd.fmu.notes import body_notes, light_note, wide_note
from softffd.fmu.package import scene_masses
from softffd.scene.scene import scene_from

CORNER = {"points": [[0, 0, 0]], "mass": 1e-6}


def told(scene):
    return light_note(scene, scene_masses(scene))


def stable_step(scene):
    with Simulation(scene.replace({"outputs.solver": True})) as simulation:
        return simulation["solver.stable_step"]


@pytest.mark.parametrize(("name", "key", "usual"), [("light_bounce", "region[0].mass", 1 / 63), ("light_corner", "region[1].mass", 1 / 64)])
def test_a_light_point_costs_the_steps_that_the_note_says_and_its_key_mends_that(name, key, usual):
    scene = load_scene(name)
    stretched = {"initial.stretch": [1.0, 1.0, 1.0]}
    mended = scene.replace({key: usual})
    times = stable_step(mended.replace(stretched)) / stable_step(scene.replace(stretched))
    text = told(scene)
    assert text.startswith("control point [0, 0, 0] with 1e-06 kg makes explicit steps ")
    assert text.endswith(f"a larger {key} makes them longer")
    assert float(text.split("steps ")[1].split()[0]) == pytest.approx(times, rel=0.1) and times > 50
    assert told(mended) is None and text in body_notes(scene, scene_masses(scene), None)


def test_light_points_of_a_mesh_get_mass_by_the_uniform_share():
    scene = load_scene("car_drop").replace({"mass.inertia": "matched", "mass.uniform_share": 0.01})
    text, mended = told(scene), scene.replace({"mass.uniform_share": 0.1})
    assert "control points with 0." in text and "a larger mass.uniform_share" in text
    assert told(mended) is None and stable_step(mended) > 3 * stable_step(scene)


def test_light_points_of_a_thin_region_get_mass_by_its_density():
    cell = {"points": {"i": [0, 1], "j": [0, 1], "k": [0, 1]}, "density": 1e-3}
    scene = box(mass={"distribution": "box", "total": 1.0}, stiffness=1e3, region=[{**cell, "density": 500.0}, cell])
    assert "a larger region[1].density" in told(scene)


@pytest.mark.parametrize("name", ["standard", "car_drop", "stiff_layer", "pad", "beam"])
def test_no_note_where_points_have_about_the_same_mass(name):
    assert told(load_scene(name)) is None


def test_no_note_of_points_that_a_pin_holds_or_that_nothing_pulls_at():
    held = box(stiffness=1e3, region=[{**CORNER, "points": "x-"}], pin=[{"name": "wall", "points": "x-"}])
    assert told(held) is None and np.isfinite(stable_step(held))
    assert told(box(stiffness=0.0, region=[CORNER])) is None


@pytest.mark.parametrize(("size", "text"), [([0.1, 0.1, 0.1], "484 points across"), ([0.1, 0.1, 0.05], None)])
def test_a_solid_too_wide_for_implicit_steps_says_so(size, text):
    material = {"model": "solid", "youngs_modulus": 1e6, "poissons_ratio": 0.45, "density": 1e3, "internal_damping": 1e-3}
    document = {"lattice": {"size": size, "cells": 21}, "material": material}
    told = wide_note(scene_from(document))
    assert told is None if text is None else told.startswith(text)
    implicit = {**document, "solver": {"method": "sdirk2"}}
    if text:
        assert told in body_notes(scene_from(document), scene_masses(scene_from(document)), None)
        with pytest.raises(SceneError, match="at most 400 points across"):
            scene_from(implicit)
    else:
        assert wide_note(scene_from(implicit)) is None
