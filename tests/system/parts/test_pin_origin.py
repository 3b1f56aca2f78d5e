"""The origin of a pin's frame is a choice of words: what happens to the body is the same, told about another point."""

import numpy as np
import pytest

from readings import points, vector
from scenes import GRAVITY, LED, box
from softffd import Simulation, simulate
from softffd.rotation import turned

FLANGE = np.array([-0.5, 0.25, 1.5])
CENTROID = np.array([0.0, 0.5, 0.5])
TURN = np.array([0.0, 0.0, 0.6])
POSE = {f"pin.hand.orientation.{c}": value for c, value in zip("wxyz", [np.cos(0.3), 0.0, 0.0, np.sin(0.3)], strict=True)}


def held(origin=None, **keys):
    hand = {"name": "hand", "points": "x-", **LED, **({} if origin is None else {"origin": list(origin)})}
    return box(stiffness=500.0, damping=0.3, gravity=GRAVITY, pin=[hand], method="leapfrog", step=1e-3, stop_time=0.2, **keys)


def led(origin):
    """The frame, turned about its axis, goes along a path; its position is that of the origin."""
    arm = turned(np.asarray(origin) - CENTROID, TURN)

    def at(time):
        place = CENTROID + np.array([0.2 * time, 0.3 * np.sin(3 * time), 0.0]) + arm
        return {f"pin.hand.position.{axis}": value for axis, value in zip("xyz", place, strict=True)}

    return at


def close(got, wanted, share):
    """To this share of the largest value: what rounding leaves of another order of the same sums."""
    np.testing.assert_allclose(got, wanted, rtol=0, atol=share * np.abs(wanted).max())


def test_another_origin_moves_the_body_the_same_and_shifts_the_torque():
    one, other = (simulate(held(origin), start_values=POSE, inputs=led(at)) for origin, at in ((None, CENTROID), (FLANGE, FLANGE)))
    close(points(other), points(one), 1e-12)
    force, torque = vector(one, "pin.hand.reaction"), vector(one, "pin.hand.torque")
    close(vector(other, "pin.hand.reaction"), force, 1e-9)
    shift = np.cross(turned(CENTROID - FLANGE, TURN), force)
    assert np.abs(shift).max() > np.abs(torque).max()
    close(vector(other, "pin.hand.torque"), torque + shift, 1e-9)


def test_the_frame_starts_at_its_origin_and_the_default_is_the_centroid():
    for origin, wanted in ((None, CENTROID), (FLANGE, FLANGE)):
        with Simulation(held(origin)) as sim:
            assert [sim[f"pin.hand.position.{axis}"] for axis in "xyz"] == pytest.approx(wanted, rel=1e-15)
            (told,) = sim.component.resources.pins()
            assert told.origin == pytest.approx(wanted, rel=1e-15)
        close(points(simulate(held(origin), stop_time=0.01))[0], held().rest_positions(), 1e-15)


def test_a_fixed_pin_tells_its_torque_about_its_origin():
    def at_rest(**keys):
        scene = box(gravity=GRAVITY, damping=1.0, pin=[{"name": "wall", "points": "x-", **keys}], method="leapfrog", stop_time=0.1)
        result = simulate(scene)
        return vector(result, "pin.wall.torque")[-1], vector(result, "pin.wall.reaction")[-1]

    (centred, force), (shifted, same) = at_rest(), at_rest(origin=list(FLANGE))
    close(same, force, 1e-12)
    close(shifted, centred + np.cross(CENTROID - FLANGE, force), 1e-9)
