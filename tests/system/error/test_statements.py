"""What a run in contact states of its error: not what drag takes again, nor many times what the sum of its stretches is."""

import numpy as np
import pytest

from readings import points
from scenes import box, meshed
from softffd import simulate
from textbook import stated
from validation import shapes

TOLERANCE = 7.6e-6
DRAG = {"stiffness": 1.6e4, "damping": 4.1, "internal_damping": 2.2e-4}
"""Of 27 points with 0.17 kg each: velocities of the whole body last 42 ms [N/m, N s/m, s]"""
ALONG = {"gravity": [1.67, -1.5, -9.55], "plane": [{"name": "floor", "friction": 0.05}], "outputs": {"solver": True}}
RUN = {"tolerance": TOLERANCE, "stop_time": 0.9, "communication_step": 1e-3}


def slides(folder):
    return box(points=[3, 3, 3], mass={"total": 4.5}, material=DRAG, **ALONG, **RUN)


def slides_on_its_surface(folder):
    return meshed(folder, shapes.cube(4, 0.0), mass={"total": 4.5}, material=DRAG | {"internal_damping": 0.0}, **ALONG, **RUN)


@pytest.mark.parametrize("scene", [slides, slides_on_its_surface])
def test_a_difference_of_velocities_lasts_no_longer_than_drag_lets_it(tmp_path, scene):
    body = scene(tmp_path)
    run = simulate(body)
    step = run.outputs["solver.stable_step"].min() / 30
    exact = simulate(body, start_values={"solver.method": "leapfrog", "solver.step": step})
    error = np.linalg.norm(points(run)[-1] - points(exact)[-1], axis=1).max()
    assert error <= TOLERANCE
    assert stated(run)[-1] == 0


def test_a_stiff_box_that_bounces_states_what_its_vibrations_are_off_by_and_no_more():
    """On a slope, thrown back again and again by its own ringing, which was once taken to land off by a share of the tolerance."""
    material = {"stiffness": {"edge": 1.1e6, "face": 5.4e6, "body": 2.5e6}, "damping": 0.0}
    slope = {"name": "slope", "point": [0.2, 0.62, -0.16], "normal": [0.4, -0.16, 0.9], "friction": 0.25}
    body = box(
        points=[5, 3, 5], mass={"total": 0.67}, material=material, plane=[slope], gravity=[0.0, 0.0, -9.81], tolerance=2.6e-3,
        communication_step=0.034, stop_time=0.442, outputs={"solver": True},
    )  # fmt: skip
    run = simulate(body)
    step = run.outputs["solver.stable_step"].min() / 30
    exact = simulate(body, start_values={"solver.method": "leapfrog", "solver.step": step})
    assert np.linalg.norm(points(run)[-1] - points(exact)[-1], axis=1).max() < 10 * 2.6e-3
    assert stated(run)[-1] < 10 * 2.6e-3
