"""Contact of bodies with internal damping, and of bodies that pins hold: what obstacles and pins receive, and energies."""

import numpy as np
import pytest

from readings import imbalance, points, vector, velocities
from scenes import GRAVITY, LED, MOVED
from softffd import simulate
from softffd.fmu.package import scene_masses
from validation import shapes as bodies

SOFT = {"youngs_modulus": 6e3}
GROUND = {"name": "ground", "friction": 0.4}


def test_a_damped_body_rests_with_its_weight_and_does_not_creep(rubber):
    tilt = np.radians(15.0)
    gravity = [9.81 * np.sin(tilt), 0.0, -9.81 * np.cos(tilt)]
    scene = rubber(bodies.cube(4, 0.0), plane=[GROUND], gravity=gravity, material=SOFT | {"internal_damping": 5e-3}, stop_time=12.0)
    result = simulate(scene)
    assert vector(result, "plane.ground.reaction")[-1] == pytest.approx(scene_masses(scene).mass.sum() * np.array(gravity), abs=1e-9)
    places = points(result).mean(axis=1)
    assert np.abs(places[-1] - places[400]).max() < 1e-9


@pytest.mark.parametrize("tau", [0.0, 5e-4])
def test_what_obstacles_and_pins_receive_is_what_the_body_loses(rubber, tau):
    """A sphere hangs on its top, which is led aside, while a plate presses from below: samples weigh pinned points too."""
    keys = {"pin": [{"name": "top", "points": "z+", **LED}], "plane": [{"name": "plate", "friction": 0.3, **MOVED}]}
    scene = rubber(bodies.sphere(2), material=SOFT | {"internal_damping": tau}, velocities="all", energy=True, stop_time=1.0, **keys)
    top = scene.rest_positions()[-16:].mean(axis=0)[0]
    led = {"plane.plate.velocity.z": 0.2, "pin.top.velocity.x": 0.1}
    result = simulate(scene, inputs=lambda time: led | {"plane.plate.point.z": 0.2 * time, "pin.top.position.x": top + 0.1 * time})
    mass = scene_masses(scene).mass
    momentum = np.einsum("p,tpc->tc", mass, velocities(result))
    received = (vector(result, "plane.plate.reaction") + vector(result, "pin.top.reaction")) * 0.02
    gained = np.diff(momentum, axis=0) - 0.02 * mass.sum() * np.array(GRAVITY)
    assert np.abs(vector(result, "plane.plate.reaction")).max() > 1
    assert np.abs(gained + received[1:]).max() < 1e-12
    assert result.outputs["energy.work"][-1] > 30 and np.abs(imbalance(result)).max() < 0.01


@pytest.mark.parametrize("of", ["surface", "lattice"])
def test_the_energy_balance_of_a_damped_landing_closes(rubber, of):
    landing = {"offset": [0.0, 0.0, 0.05], "velocity": [0.5, 0.0, 0.0], "step": 2.5e-4, "stop_time": 1.0}
    result = simulate(rubber(bodies.cube(4, 0.0), plane=[GROUND], contact={"of": of}, energy=True, **landing))
    assert result.outputs["energy.dissipated"][-1] > 0.5
    assert np.abs(imbalance(result)).max() < 1e-3


UNDER = {"sphere": {"radius": 2.0, "point": [0.5, 0.5, -2.2]}, "box": {"size": [3.0, 3.0, 1.0], "point": [0.5, 0.5, -0.7]}}


@pytest.mark.parametrize("kind", UNDER)
def test_a_damped_body_falls_on_a_solid(rubber, kind):
    """While no sample is within reach there is no half-space at all."""
    result = simulate(rubber(bodies.cube(3, 0.0), stop_time=0.4, **{kind: [{"name": "under", **UNDER[kind]}]}))
    fall = vector(result, f"{kind}.under.reaction")[:, 2]
    assert (fall[:10] == 0).all()
    assert fall.min() < -9.81
