"""Reference answers by numpy alone: the sag of a soft box, and the flight of a body that has fallen onto a plane and rebounded."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from softffd.scene.scene import scene_from
from validation.mechanics import Body, start
from validation.resolved import resolved
from validation.stability.drive import Drive
from validation.twin.fixtures import HalfSpace, Obstacle, Surroundings
from validation.twin.methods import Leapfrog, Motion


def static_sag(drive: Drive, *, held: bool = False) -> float:
    """Returns the static sag of the centre [m] of a box with equal springs, for a gravity of 1 m/s2 and a stiffness of 1 N/m.

    held: the lower face cannot widen; otherwise it can.
    """
    a, b = drive.body.pairs.T
    along = drive.rest[b] - drive.rest[a]
    along /= np.linalg.norm(along, axis=1)[:, None]
    rows = np.zeros((len(a), 3 * len(drive.rest)))
    for axis in range(3):
        rows[np.arange(len(a)), 3 * a + axis] -= along[:, axis]
        rows[np.arange(len(a)), 3 * b + axis] += along[:, axis]
    weight = np.tile([0.0, 0.0, -1.0], (len(drive.rest), 1)) * drive.mass[:, None]
    free = np.repeat(drive.rest[:, 2] > 0, 3) | ((np.arange(rows.shape[1]) % 3 != 2) & (not held))
    moved = np.zeros(rows.shape[1])
    moved[free] = np.linalg.lstsq((rows.T @ rows)[np.ix_(free, free)], weight.ravel()[free], rcond=1e-10)[0]
    return float(-drive.mass @ moved.reshape(-1, 3)[:, 2] / drive.mass.sum())


SHARE = 1 / 8  # step by the stable step; the position after a rebound is then accurate to about 1e-5 of the box
LOOK, QUIET = 24.0, 240.0
"""Time between two checks for contact, and time without contact after which no further contact follows, both in stable steps. The latter
is about five periods of the lowest vibration of 4 x 4 x 4 points."""


@dataclass(frozen=True, eq=False)
class Flight:
    """State of the body in free flight after an impact. Vectors are (3,)."""

    centre: np.ndarray  # m
    velocity: np.ndarray  # of the centre [m/s]
    angular_momentum: np.ndarray  # about the centre [kg m2/s]
    impulse: np.ndarray  # on the plane [N s]
    touched: float  # first touch [s]


def after_impact(document: Mapping[str, Any], duration: float, *, share: float = SHARE) -> Flight:
    """Returns the flight of a body at the time `duration` [s], which must be before its next fall onto the plane.

    The scene has one fixed plane, gravity, no damping and no spin. share: step by the stable step."""
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
    """Returns the time [s] at which a gap [m] closes. The gap grows with a speed [m/s] under a pull < 0 [m/s2]."""
    return (speed + math.sqrt(speed**2 - 2 * pull * gap)) / -pull
