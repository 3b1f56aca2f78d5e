"""What a run in contact states of its error: not what drag takes again, nor many times what the sum of its stretches is."""

import numpy as np
import pytest

from readings import points
from scenes import GRAVITY, box, meshed
from softffd import Simulation, simulate
from solids import nodes
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


@pytest.mark.parametrize("step", [0.002, 0.005])
def test_a_tower_that_has_rocked_on_its_edges_lands_with_the_error_that_this_left(step):
    """It errs by a tolerance before it leaves the floor after 0.14 s. Its landings then make that twenty times as large."""
    floor = {"name": "floor", "friction": 0.72}
    body = box(
        points=[5, 5, 5], lattice={"size": [0.1, 0.13, 0.2]}, mass={"total": 0.2}, material={"stiffness": 4e4, "damping": 0.0},
        gravity=[0.5, 0.0, -9.81], plane=[floor], initial={"velocity": [0.0, 0.5, 0.0]}, tolerance=1e-4, communication_step=step,
        stop_time=0.2,
    )  # fmt: skip
    run, exact = simulate(body), simulate(body, start_values={"solver.method": "leapfrog", "solver.step": 1e-5})
    error = np.linalg.norm(points(run)[-1] - points(exact)[-1], axis=1).max() / (1e-4 * 0.2)
    assert error > 10
    assert error / 10 < stated(run)[-1] / (1e-4 * 0.2) < 10 * error


@pytest.mark.parametrize(("speed", "spin", "drop"), [(1e3, 0.0, 0.0), (20.0, 0.0, 0.05), (20.0, 0.05, 0.05), (200.0, 0.0, 0.05)])
def test_a_difference_along_a_plane_lasts_no_longer_than_the_run(speed, spin, drop):
    """Friction would stop the damped box after 5 to 250 s. The box comes down flat, and then slides until 0.3 s."""
    thrown = {"velocity": [speed, 0.0, 0.0], "angular_velocity": [0.0, spin, 0.0]}
    floor = {"name": "floor", "point": [0.0, 0.0, -drop], "friction": 0.4}
    material = {"stiffness": 1e4, "damping": 0.0, "internal_damping": 1e-3}
    body = box(material=material, gravity=GRAVITY, plane=[floor], initial=thrown, stop_time=0.3, communication_step=0.01)
    run = simulate(body, output=["position"])
    assert not run.summary["warnings"]
    fallen = np.array([0.5 + 0.3 * speed - 0.4 * (9.81 * 0.3**2 / 2 - drop), 0.5, 0.5 - drop])
    sinks = 9.81 / 1e4  # [m], some of it, and friction at 0.4 of what presses
    assert np.abs(points(run)[-1].mean(axis=0) - fallen)[:2].max() < sinks


@pytest.mark.parametrize(("tolerance", "distance"), [(1e-6, 0.0), (1e-6, 3e5), (1e-6, 5e6), (1e-7, 1e4)])
def test_rounding_of_places_far_from_the_origin_is_no_error_of_steps(tolerance, distance):
    """A damped box that rests on a plane and begins to lean: some hundred steps wherever that is."""
    ground = {"name": "ground", "point": [distance] * 3, "friction": 0.4}
    material = {"stiffness": 1e5, "damping": 0.0, "internal_damping": 1e-3}
    where = {"origin": [distance] * 3, "plane": [ground], "gravity": [1.0, 0.0, -9.81]}
    body = box(material=material, **where, tolerance=tolerance, stop_time=0.3, outputs={"solver": True})
    with Simulation(body) as run:
        run.step(0.01)
        assert run["solver.steps"] < 1000
        assert not run.warnings


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_vertices_that_skip_along_a_drum_do_not_land(tmp_path, friction):
    """A damped cube is laid on a rotating drum, beside its top. A vertex that slides leaves the drum by the square of its way in a step."""
    size, tolerance = 0.2, 1e-4
    vertices, faces = shapes.cube(3, 0.0)
    drum = {"name": "drum", "radius": 0.5, "length": 1.0, "normal": [0, 1, 0], "point": [0.12, 0.1, -0.5], "angular_velocity": [0, 5, 0]}
    body = meshed(
        tmp_path, (size * vertices, faces), lattice={"size": [size] * 3, "origin": [0.0] * 3}, mass={"total": 1.0},
        material={"youngs_modulus": 1e6, "internal_damping": 1e-3}, gravity=[0.0, 0.0, -9.81],
        cylinder=[drum | {"friction": friction}], tolerance=tolerance, communication_step=0.01, stop_time=0.1,
    )  # fmt: skip
    run = simulate(body)
    exact = simulate(body, start_values={"solver.method": "leapfrog"}, tolerance=tolerance / 10)
    assert np.linalg.norm(points(run)[-1] - points(exact)[-1], axis=1).max() < tolerance * size
    assert stated(run)[-1] == 0


def test_the_error_of_a_block_that_slides_off_a_drum_is_followed_while_vertices_come_and_go(tmp_path):
    """A lightly damped block of finite elements is laid on a fixed drum, slides on it and falls off. On the drum an early error grows by a
    factor of a thousand, without another landing."""
    size, tolerance = 2e-3, 1e-4
    vertices, faces = shapes.cube(5, 0.0)
    drum = {"name": "drum", "radius": 1.4e-3, "length": 0.02, "normal": [0, 1, 0], "point": [0.9e-3, 1e-3, -1.414e-3], "friction": 0.3}
    body = meshed(
        tmp_path, (size * vertices, faces), lattice={"size": [size] * 3, "origin": [0.0] * 3}, points=[4, 4, 4],
        material={"model": "solid", "youngs_modulus": 2.7e4, "poissons_ratio": 0.45, "density": 42.7, "internal_damping": 4e-6},
        gravity=[-4.41, 1.0, -9.81], cylinder=[drum], tolerance=tolerance, communication_step=0.005, stop_time=0.025,
        outputs={"solver": True},
    )  # fmt: skip
    run = simulate(body)
    step = run.outputs["solver.stable_step"].min() / 10
    exact = simulate(body, start_values={"solver.method": "leapfrog", "solver.step": step})
    error = np.linalg.norm(nodes(run)[-1] - nodes(exact)[-1], axis=1).max()
    assert error > 10 * tolerance * size
    assert stated(run)[-1] > error / 10
