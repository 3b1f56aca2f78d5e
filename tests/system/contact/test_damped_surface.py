"""Contact of the surface of bodies with internal damping, and of bodies that pins hold: what obstacles and pins receive, and energies."""

import numpy as np
import pytest

from readings import points, vector, velocities
from scenes import GRAVITY, LED, MOVED, box
from softffd import Scene, simulate
from softffd.fmu.package import scene_masses
from stepping import require_same_continuation
from validation import shapes as bodies

RUBBER = {"youngs_modulus": 6e3, "internal_damping": 5e-4}
"""The fastest vibrations have their critical damping."""
ENERGIES = ("kinetic", "elastic", "gravity")


@pytest.fixture
def body(tmp_path):
    """body(vertices and faces, keys) is a scene of a body of 1 kg/m3 in the unit box, with contact of its surface."""

    def made(shape, **keys) -> Scene:
        keys = {"contact": {"of": "surface"}, "material": RUBBER, "method": "leapfrog", "step": 1e-3, "communication_step": 0.02, **keys}
        lattice = {"origin": [0.0, 0.0, 0.0], "size": [1.0, 1.0, 1.0]}
        mesh = {"file": bodies.write(tmp_path / "body.obj", shape)}
        return box(mesh=mesh, lattice=lattice, mass={"density": 1.0}, gravity=GRAVITY, **keys)

    return made


def imbalance(result) -> np.ndarray:
    """What the energies have gained out of nothing since the start (T) [J]."""
    out = result.outputs
    total = sum(out[f"energy.{name}"] for name in ENERGIES) + out["energy.dissipated"] - out["energy.work"]
    return total - total[0]


def test_a_damped_body_rests_with_its_weight_and_does_not_creep(body):
    tilt = np.radians(15.0)
    gravity = {"gravity": [9.81 * np.sin(tilt), 0.0, -9.81 * np.cos(tilt)]}
    rubber = RUBBER | {"internal_damping": 5e-3}
    scene = body(bodies.cube(4, 0.0), plane=[{"name": "ground", "friction": 0.4}], environment=gravity, material=rubber, stop_time=12.0)
    result = simulate(scene)
    weight = scene_masses(scene).mass.sum() * np.array(scene.environment.gravity)
    assert vector(result, "plane.ground.reaction")[-1] == pytest.approx(weight, abs=1e-9)
    places = points(result).mean(axis=1)
    assert np.abs(places[-1] - places[400]).max() < 1e-9


@pytest.mark.parametrize("of", ["surface", "lattice"])
def test_the_error_of_a_damped_throw_is_of_second_order(body, of):
    """Dashpots feel a landing from its own moment on, not from the end of its step: that would be of first order."""
    shape, offset, friction = (bodies.sphere(3), 0.0, 0.0) if of == "surface" else (bodies.cube(2, 0.0), 0.35, 0.4)
    scene = body(
        shape, contact={"of": of}, plane=[{"name": "ground", "friction": friction}], rotation={"axis": [1.0, 0.3, 0.0], "degrees": 28.0},
        offset=[0.0, 0.0, offset], velocity=[1.0, 0.0, 0.0], material=RUBBER | {"youngs_modulus": 4e2}, stop_time=0.2,
    )  # fmt: skip
    sizes = [2e-5, 4e-5, 8e-5, 1.6e-4]
    true, *ends = (points(simulate(scene.replace({"solver.step": h})))[-1] for h in [2e-6, *sizes])
    errors = [np.abs(end - true).max() for end in ends]
    assert np.polyfit(np.log(sizes), np.log(errors), 1)[0] > 1.8


@pytest.mark.parametrize("tau", [0.0, 5e-4])
def test_what_obstacles_and_pins_receive_is_what_the_body_loses(body, tau):
    """A sphere hangs on its top, which is led aside, while a plate presses from below: samples weigh pinned points too."""
    keys = {"pin": [{"name": "top", "points": "z+", **LED}], "plane": [{"name": "plate", "friction": 0.3, **MOVED}]}
    scene = body(bodies.sphere(2), material=RUBBER | {"internal_damping": tau}, velocities="all", energy=True, stop_time=1.0, **keys)
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
def test_the_energy_balance_of_a_damped_landing_closes(body, of):
    scene = body(
        bodies.cube(4, 0.0), plane=[{"name": "ground", "friction": 0.4}], contact={"of": of}, offset=[0.0, 0.0, 0.05],
        velocity=[0.5, 0.0, 0.0], energy=True, step=2.5e-4, stop_time=1.0,
    )  # fmt: skip
    result = simulate(scene)
    assert result.outputs["energy.dissipated"][-1] > 0.5
    assert np.abs(imbalance(result)).max() < 1e-3


def test_a_state_of_a_damped_body_continues_with_the_same_bits(body):
    keys = {"angular_velocity": [2.0, 1.0, 0.0], "offset": [0.0, 0.0, -0.05], "step": 0.0}
    scene = body(bodies.sphere(2), plane=[{"name": "ground", "friction": 0.4}], **keys)
    require_same_continuation(scene, lambda simulation: simulation["plane.ground.contacts"] > 0)


UNDER = {"sphere": {"radius": 2.0, "point": [0.5, 0.5, -2.2]}, "box": {"size": [3.0, 3.0, 1.0], "point": [0.5, 0.5, -0.7]}}


@pytest.mark.parametrize("kind", UNDER)
def test_a_damped_body_falls_on_a_solid(body, kind):
    """While no sample is within reach there is no half-space at all."""
    result = simulate(body(bodies.cube(3, 0.0), stop_time=0.4, **{kind: [{"name": "under", **UNDER[kind]}]}))
    fall = vector(result, f"{kind}.under.reaction")[:, 2]
    assert (fall[:10] == 0).all()
    assert fall.min() < -9.81
