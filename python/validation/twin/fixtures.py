"""The surroundings of the object: obstacle planes and pins in uniform rigid motion, and the impulses on them.

Vectors are (3,), or (m, 3) for m points, in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from softffd.rotation import turned

TOUCHING = 1e-12  # a gap below this fraction of the box's largest side counts as contact
PIN_SLACK = 1e-9  # a pinned point farther behind a plane (fraction of the box's largest side) is an error


class TwinError(Exception):
    """Raised for a request that the twin does not support or could not carry out."""


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """An obstacle at one moment, solid behind its plane. Vectors are (3,), in SI units."""

    point: np.ndarray
    normal: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Returns the distances (n,) [m] of points x (n, 3) [m] from the plane, negative behind the plane."""
        return (x - self.point) @ self.normal

    def surface(self, x: np.ndarray) -> np.ndarray:
        """Returns the velocity (n, 3) [m/s] of the obstacle's material at points x (n, 3) [m]."""
        return self.velocity + np.cross(self.spin, x - self.point)

    def snapped(self, x: np.ndarray) -> np.ndarray:
        """Returns the orthogonal projections (n, 3) [m] of points x (n, 3) [m] onto the plane."""
        return x - self.gap(x)[:, None] * self.normal

    def along(self, v: np.ndarray) -> np.ndarray:
        """Returns the tangential part of vectors (n, 3)."""
        return v - (v @ self.normal)[:, None] * self.normal


@dataclass(eq=False, kw_only=True)
class Fixture:
    """A body that the object pushes, with the impulse and moment received during the communication step."""

    since: float  # s, time at which the pose holds
    impulse: np.ndarray = field(default_factory=lambda: np.zeros(3))  # N s
    moment: np.ndarray = field(default_factory=lambda: np.zeros(3))  # N m s about the origin of the pose

    def receive(self, on_points: np.ndarray, arms: np.ndarray) -> None:
        """Adds the reaction to the impulses on points (m, 3) [N s], which act at arms (m, 3) [m] from the origin."""
        dyad = arms.T @ on_points
        self.impulse = self.impulse - on_points.sum(axis=0)
        self.moment = self.moment - np.array([dyad[1, 2] - dyad[2, 1], dyad[2, 0] - dyad[0, 2], dyad[0, 1] - dyad[1, 0]])


@dataclass(eq=False, kw_only=True)
class Obstacle(Fixture):
    """A plane in uniform rigid motion."""

    start: HalfSpace
    friction: float

    def at(self, time: float) -> HalfSpace:
        """Returns the half-space at a time [s], with its point moved and its normal rotated."""
        age, s = time - self.since, self.start
        return HalfSpace(s.point + age * s.velocity, turned(s.normal, age * s.spin), s.velocity, s.spin)

    def centre(self, now: HalfSpace) -> np.ndarray:
        """Returns the centre of pressure [m] on the plane `now`, or the point of the plane if there is no contact."""
        pressing = -self.impulse @ now.normal
        return now.point - np.cross(now.normal, self.moment) / pressing if pressing > 0 else now.point


@dataclass(eq=False, kw_only=True)
class Pin(Fixture):
    """Control points (m,) fixed to a frame in uniform rigid motion. `arms` (m, 3) [m] hold at the time of the pose."""

    points: np.ndarray
    arms: np.ndarray
    origin: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Returns positions [m], velocities [m/s] and arms [m] of the points at a time [s], (m, 3) each."""
        age = time - self.since
        arms = turned(self.arms, age * self.spin)
        velocities = self.velocity + np.cross(self.spin, arms)
        return self.origin + age * self.velocity + arms, velocities, arms


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Everything that acts on the points during a communication step."""

    obstacles: list[Obstacle]
    pins: list[Pin]
    force: np.ndarray  # N (n, 3), constant during the step
    largest_side: float  # m, of the box

    @property
    def free(self) -> np.ndarray:
        """Mask (n,) of the points that no pin holds."""
        free = np.full(len(self.force), True)
        for pin in self.pins:
            free[pin.points] = False
        return free

    def gaps(self, planes: list[HalfSpace], x: np.ndarray) -> np.ndarray:
        """Returns the distances from the planes (planes, n) [m], infinite for pinned points because no plane moves them. Raises TwinError
        if a pinned point lies behind a plane."""
        gaps = np.array([plane.gap(x) for plane in planes]).reshape(-1, len(x))
        if np.any(gaps[:, ~self.free] < -PIN_SLACK * self.largest_side):
            raise TwinError("a pin holds a control point behind a plane")
        return np.where(self.free, gaps, np.inf)
