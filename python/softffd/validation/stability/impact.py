"""An impact on a plane by numpy alone: what the centre of a body does that falls, is thrown off again and flies on.

Before the touch an unstressed, undamped body without spin falls as one, and after the last touch its centre flies freely and its angular
momentum stays; in between leapfrog with the contact rule of the twin runs with steps far below the limit. Contact lasts a fraction of the
lowest vibration, so that this takes some thousand steps at any stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from softffd.scene.scene import scene_from
from softffd.validation.mechanics import Body, start
from softffd.validation.resolved import resolved
from softffd.validation.twin.fixtures import HalfSpace, Obstacle, Surroundings
from softffd.validation.twin.methods import Leapfrog, Motion

SHARE = 1 / 8
"""Of the stable step: the place after a rebound is then right to some 1e-5 of the box."""
LOOK, QUIET = 24.0, 240.0
"""In stable steps: a stretch between two looks, and the time without a touch after which there will be none; some five of the lowest
vibrations of 4 x 4 x 4 points."""


@dataclass(frozen=True, eq=False)
class Flight:
    """The body in free flight after an impact, at a time; vectors (3,)."""

    centre: np.ndarray
    """m"""
    velocity: np.ndarray
    """Of the centre [m/s]"""
    angular_momentum: np.ndarray
    """About the centre [kg m2/s]"""
    impulse: np.ndarray
    """On the plane [N s]"""
    touched: float
    """First touch [s]"""


def after_impact(document: Mapping[str, Any], duration: float, *, share: float = SHARE) -> Flight:
    """Of a scene with one fixed plane, gravity, no damping and no spin, at a time [s] before it falls onto the plane again."""
    scene = scene_from(document)
    content, (plane,) = resolved(scene), scene.plane
    body, gravity = Body.of(content), np.array(scene.environment.gravity)
    normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
    still = HalfSpace(np.array(plane.point), normal, np.zeros(3), np.zeros(3))
    obstacle = Obstacle(since=0.0, start=still, friction=plane.friction)
    x, v = start(content)
    fall = _touch(still.gap(x).min(), float(v[0] @ normal), float(gravity @ normal))
    motion = Motion(fall, x + fall * v + fall**2 / 2 * gravity, v + fall * gravity)
    around = Surroundings([obstacle], [], body.weight[:, None] * gravity, max(scene.lattice_box.size))
    stable = body.stable_step()
    rule, steps = Leapfrog(body, around, share * stable), round(LOOK / share)
    touched = fall
    while motion.time < min(duration, touched + QUIET * stable):
        before = obstacle.impulse
        rule.run(motion, steps)
        touched = motion.time if np.any(obstacle.impulse != before) else touched
    left, weights = duration - motion.time, body.mass / body.mass.sum()
    centre, velocity = weights @ motion.x, weights @ motion.v
    turning = body.mass @ np.cross(motion.x - centre, motion.v - velocity)
    return Flight(centre + left * velocity + left**2 / 2 * gravity, velocity + left * gravity, turning, obstacle.impulse, fall)


def _touch(gap: float, speed: float, pull: float) -> float:
    """When a gap [m] closes that grows with a speed [m/s], under a pull < 0 [m/s2]."""
    return (speed + math.sqrt(speed**2 - 2 * pull * gap)) / -pull
