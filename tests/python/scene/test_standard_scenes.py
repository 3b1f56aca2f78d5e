"""The standard set is what it says."""

import numpy as np
import pytest

from softffd import load_scene
from softffd.accuracy.rig import Rig, Setting
from softffd.run.inputs import read_csv
from validation.mechanics import Body
from validation.resolved import resolved


@pytest.mark.parametrize(
    "name, largest", [("stiff_pull", {"load.right_0.x": 4e5, "load.left_3.x": -8e5}), ("stiff_layer", {"load.top.z": 80.0})]
)
def test_slow_loads_grow_as_the_smooth_step(name, largest):
    scene = load_scene(name)
    course = read_csv(scene.default_inputs)
    u = np.clip(course["time"] / 0.5, 0, 1)
    for variable, force in largest.items():
        np.testing.assert_allclose(course[variable], force * (6 * u**5 - 15 * u**4 + 10 * u**3), rtol=1e-9, atol=1e-9)
    assert set(course.dtype.names) == {"time", *(f"load.{load.name}.{'z' if name == 'stiff_layer' else 'x'}" for load in scene.load)}
    assert np.all(np.diff(course["time"]) > 0) and course["time"][-1] >= scene.experiment.stop_time


@pytest.mark.parametrize(
    "name, stored, setting, allowed",
    [
        ("free_vibration", "S1", Setting("rkn12", tolerance=1e-12), 1e-11),
        ("stiff_pull", "S2", Setting("leapfrog", step=1e-5), 5e-7),  # the load is linear over each 0.1 s here, smooth there
    ],
)
def test_scenes_are_those_of_the_stored_references(name, stored, setting, allowed, golden):
    with Rig(load_scene(name)) as rig:
        positions = rig.run(setting).positions
    assert np.abs(positions[1:] - golden(stored)["x"]).max() < allowed


@pytest.mark.parametrize(
    ("name", "duration", "centre", "allowed"),
    [("stiff_bounce", 0.45, {"y": 0.5708908, "z": 0.568079}, 3e-5), ("light_bounce", 0.6, {"x": 0.4890417, "z": 0.5193556}, 1e-5)],
)
def test_bounces_end_where_an_independent_program_says(name, duration, centre, allowed):
    """Centres of mass [m] by explicit steps that another program took."""
    scene = load_scene(name).replace({"experiment.stop_time": duration})
    mass = Body.of(resolved(scene)).mass
    with Rig(scene) as rig:
        end = rig.run(Setting("auto", tolerance=1e-4)).positions[-1]
    found = mass @ end / mass.sum()
    assert {axis: found["xyz".index(axis)] for axis in centre} == pytest.approx(centre, abs=allowed)
