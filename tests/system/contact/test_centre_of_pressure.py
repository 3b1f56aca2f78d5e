"""Where obstacles are pressed: plane.NAME.centre, of control points and of the object's surface."""

import numpy as np
import pytest

from readings import points, vector
from scenes import GRAVITY, MOVED
from softffd import Simulation, simulate
from softffd.fmu.package import scene_masses
from validation import shapes as bodies

GROUND = {"name": "ground", "friction": 0.5, "point": [0.3, -0.2, 0.0]}
TOUCHING = ["lattice", "surface"]
PUSHED = {"load.push.x": 1.5, "load.push.y": -0.5}
"""N"""


@pytest.fixture
def cube(body):
    """cube(of, keys) is a scene of a cube with samples all over its faces, of which control points or these touch."""
    start = {"gravity": GRAVITY, "plane": [GROUND], "method": "auto", "step": 0.0, "load": [{"name": "push", "points": "x-"}]}
    return lambda of, **keys: body(bodies.cube(4, 0.0), contact={"of": of}, **{**start, **keys})


@pytest.mark.parametrize("of", TOUCHING)
@pytest.mark.parametrize("method", ["leapfrog", "auto"])
def test_a_box_that_is_pushed_presses_where_its_moments_balance(cube, of, method):
    """About the centre of pressure the weight and the push have no moment along the ground."""
    scene = cube(of, method=method, damping=4.0, stop_time=4.0)
    result = simulate(scene, start_values=PUSHED)
    x = points(result)[-1]
    pushed = x[np.isclose(scene.rest_positions()[:, 0], 0.0)].mean(axis=0)
    weight, push = np.array(GRAVITY), np.array([1.5, -0.5, 0.0])
    centre = vector(result, "plane.ground.centre")[-1]
    moment = np.cross(x.mean(axis=0) - centre, weight) + np.cross(pushed - centre, push)
    assert moment[:2] == pytest.approx([0.0, 0.0], abs=1e-6) and centre[2] == pytest.approx(0.0, abs=1e-12)
    assert centre[:2] == pytest.approx([0.5 + 1.5 * 0.5 / 9.81, 0.5 - 0.5 * 0.5 / 9.81], abs=5e-3)  # of the undeformed box


def test_a_sphere_presses_below_its_centre_of_mass(body):
    low = {"offset": [0.0, 0.0, -0.09], "damping": 1.0, "step": 0.0, "stop_time": 8.0, "communication_step": 0.05}
    scene = body(bodies.sphere(3), gravity=GRAVITY, plane=[GROUND], **low)
    result, mass = simulate(scene), scene_masses(scene).mass
    middle = (mass @ points(result)[-1]) / mass.sum()
    assert vector(result, "plane.ground.centre")[-1] == pytest.approx([*middle[:2], 0.0], abs=1e-6)


def test_on_a_ridge_the_centre_is_on_its_line(cube):
    """Of a cylinder that lies under a row of vertices."""
    log = {"name": "log", "radius": 0.5, "length": 3.0, "normal": [0.0, 1.0, 0.0], "point": [1 / 3, 0.5, -0.5]}
    scene = cube("surface", plane=[], cylinder=[log], method="leapfrog", stop_time=0.04)
    assert vector(simulate(scene), "cylinder.log.centre")[-1] == pytest.approx([1 / 3, 0.5, 0.0], abs=1e-3)


@pytest.mark.short("lattice")
@pytest.mark.parametrize("of", TOUCHING)
def test_of_a_thrown_body_the_centre_is_below_it_and_takes_all_torque_but_the_normals(cube, of):
    thrown = {"velocity": [1.5, 0.3, -1.0], "angular_velocity": [2.0, 4.0, 1.0]}
    result = simulate(cube(of, damping=0.1, offset=[0.0, 0.0, 0.3], stop_time=1.5, communication_step=5e-3, **thrown))
    force, torque = vector(result, "plane.ground.reaction"), vector(result, "plane.ground.torque")
    presses = force[:, 2] < 0
    assert 20 < presses.sum() < presses.size - 20
    centre, x = vector(result, "plane.ground.centre"), points(result)
    left = torque - np.cross(centre - GROUND["point"], force)
    assert np.abs(left[:, :2]).max() < 1e-12 and np.abs(left[:, 2]).max() > 1e-3
    assert np.abs(centre[:, 2]).max() < 1e-12
    slack = 0.02  # of one communication step's travel, and of impacts that are booked at the end of an internal step
    low, high = (extreme(x[presses], axis=1)[:, :2] for extreme in (np.min, np.max))
    assert (centre[presses, :2] > low - slack).all() and (centre[presses, :2] < high + slack).all()
    np.testing.assert_array_equal(centre[~presses], np.tile([0.3, -0.2, 0.0], (np.sum(~presses), 1)))


@pytest.mark.parametrize("of", TOUCHING)
def test_on_a_plane_that_moves_the_centre_is_where_the_plane_is_at_the_steps_end(cube, of):
    lift = {"name": "lift", "friction": 0.5, "velocity": [0.1, 0.0, 0.2]}
    result = simulate(cube(of, plane=[lift], damping=1.0, stop_time=1.0))
    centre = vector(result, "plane.lift.centre")
    assert centre[1:, 2] == pytest.approx(0.2 * result.time[1:], abs=1e-12)
    drag = 64 * np.array([0.1, 0.0, 0.2])  # of the damping of all control points, at the middle of the box
    assert centre[-1, 0] == pytest.approx(points(result)[-1].mean(axis=0)[0] - 0.5 * drag[0] / (9.81 + drag[2]), abs=5e-3)


def test_a_plane_that_nothing_presses_has_its_point_for_a_centre(cube):
    away = {"name": "plate", "point": [0.2, 0.1, 3.0], "normal": [0.0, 0.3, -1.0], **MOVED}
    with Simulation(cube("surface", plane=[GROUND, away], stop_time=1.0)) as simulation:
        np.testing.assert_array_equal(simulation.plane["plate"].centre, [0.2, 0.1, 3.0])
        np.testing.assert_array_equal(simulation.plane["ground"].centre, GROUND["point"])
        simulation.plane["plate"].velocity = [0.0, 0.0, -0.5]
        simulation.step()
        assert simulation.plane["plate"].centre == pytest.approx([0.2, 0.1, 3.0 - 0.5 * 0.02], abs=1e-15)
