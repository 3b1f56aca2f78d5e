"""A solid on rigid frames: what they hold follows them exactly, force and torque on them balance."""

import numpy as np
import pytest

from readings import vector
from scenes import LED
from softffd import simulate
from softffd.lattice import to_flat
from softffd.rotation import turned
from solids import braked, node_masses, node_velocities, nodes, solid

PLACED = {"origin": [0.2, -0.3, 0.4], "size": [0.6, 0.9, 1.2]}
CENTRE = np.array([0.2, 0.15, 1.0])
"""Of the face that the hand holds [m]"""
SPIN = np.array([0.5, -1.0, 2.0])
HAND = {"name": "hand", "points": "x-", **LED}
METHODS = ["leapfrog", "auto", "bm4", "dop853"]


def place(time: float) -> np.ndarray:
    return CENTRE + np.array([0.3 * np.sin(4 * time), 0.2 * time, 0.1 * (1 - np.cos(5 * time))])


def course(time: float) -> dict[str, float]:
    """Moves on, and turns evenly."""
    half = 0.5 * np.linalg.norm(SPIN) * time
    quaternion = [np.cos(half), *(np.sin(half) * SPIN / np.linalg.norm(SPIN))]
    pose = {f"pin.hand.position.{axis}": value for axis, value in zip("xyz", place(time), strict=True)}
    pose |= {f"pin.hand.orientation.{axis}": value for axis, value in zip("wxyz", quaternion, strict=True)}
    return pose | {f"pin.hand.angular_velocity.{axis}": value for axis, value in zip("xyz", SPIN, strict=True)}


def held(**keys):
    return solid([4, 7, 7], modulus=1e4, ratio=0.4, density=100.0, lattice=PLACED, velocities="all", **keys)


@pytest.mark.parametrize("method", METHODS)
def test_a_held_face_follows_its_frame(method):
    scene = held(pin=[HAND], method=method, stop_time=0.3, communication_step=0.02)
    result = simulate(scene, inputs=course, interpolation="linear")
    face = result.positions[:, 0]
    arms = face[0] - CENTRE
    for row, time in enumerate(result.time):
        assert face[row] == pytest.approx(place(time) + turned(arms, SPIN * time), abs=1e-12)


def test_a_hanging_solid_pulls_with_its_weight_and_its_torque():
    """Held at one end, bent by its weight: the torque is that of the weight at the centre of mass where it has gone."""
    gravity = np.array([1.0, -2.0, -9.81])
    scene = held(pin=[{"name": "wall", "points": "x-"}], gravity=gravity.tolist(), region=braked([4, 7, 7], 20.0, 64.8), method="leapfrog")
    result = simulate(scene, stop_time=5.0, step=0.5)
    mass = node_masses(scene)
    centre = mass @ nodes(result)[-1] / mass.sum()
    assert centre[2] < 0.97
    assert vector(result, "pin.wall.reaction")[-1] == pytest.approx(mass.sum() * gravity, rel=1e-6)
    assert vector(result, "pin.wall.torque")[-1] == pytest.approx(np.cross(centre - CENTRE, mass.sum() * gravity), rel=1e-6)


def test_what_frames_give_is_what_the_solid_gains():
    """Momentum and angular momentum, about the origin of a frame that turns at its place, in every communication step; to rounding."""
    turning = {name: (lambda time, name=name: course(time)[name]) for name in course(0.0) if "position" not in name}
    scene = held(pin=[HAND], method="leapfrog", stop_time=0.4, communication_step=0.01)
    result = simulate(scene, inputs=lambda time: {name: value(time) for name, value in turning.items()})
    mass, x, v = node_masses(scene)[:, None], nodes(result), node_velocities(result)
    momentum, spin = (mass * v).sum(axis=1), (mass * np.cross(x - CENTRE, v)).sum(axis=1)
    given, torque = (-0.01 * vector(result, f"pin.hand.{what}")[1:] for what in ("reaction", "torque"))
    assert np.diff(momentum, axis=0) == pytest.approx(given, abs=1e-12 * np.abs(momentum).max())
    assert np.diff(spin, axis=0) == pytest.approx(torque, abs=1e-12 * np.abs(spin).max())


def test_a_twisted_solid_twists_both_ends_alike():
    """Turned by half a radian about its axis, it is at rest: forces and torques of both frames are opposite, about one point."""
    far = {"name": "hand", "points": "z+", **LED}
    scene = solid(4, ratio=0.3, pin=[{"name": "wall", "points": "z-"}, far], region=braked(4, 1.5), method="leapfrog")

    def twist(time: float) -> dict[str, float]:
        angle = 0.05 * min(time, 10.0)
        rate = 0.05 if time < 10 - 1e-9 else 0.0
        return {
            "pin.hand.orientation.w": np.cos(angle / 2),
            "pin.hand.orientation.z": np.sin(angle / 2),
            "pin.hand.angular_velocity.z": rate,
        }

    result = simulate(scene, inputs=twist, stop_time=40.0, step=0.5)
    wall, hand = (vector(result, f"pin.{name}.torque")[-1] for name in ("wall", "hand"))
    force = vector(result, "pin.hand.reaction")[-1]
    assert vector(result, "pin.wall.reaction")[-1] == pytest.approx(-force, abs=1e-6)
    assert wall == pytest.approx(-(hand + np.cross([0.0, 0.0, 1.0], force)), abs=1e-6)
    assert hand[2] < -0.02
    assert to_flat(result.positions)[-1].mean(axis=0) == pytest.approx([0.5, 0.5, 0.5], abs=1e-6)
