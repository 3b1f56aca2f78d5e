"""The time integration of the twin: leapfrog with contact by local restart, and the published central difference method.

Contact follows the comments of the component (in fmu_src/core: contact/contact.hpp, body/kick.hpp, methods/central_difference.hpp).
All points that meet a plane are handled simultaneously. The twin refuses a point that two planes hold at the same time and a
pinned point behind a plane.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..mechanics import Body
from .fixtures import TOUCHING, HalfSpace, Pin, Surroundings, TwinError

TWO_PLANES = "two planes hold one control point: the twin has one plane per point"


@dataclass(eq=False)
class Motion:
    """Positions [m] and velocities [m/s] (n, 3) at a time [s]. For the recurrence, `previous` holds x one step earlier."""

    time: float
    x: np.ndarray
    v: np.ndarray
    previous: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))
    previous_step: float = 0.0


def size_of(vectors: np.ndarray) -> np.ndarray:
    """Returns the lengths (m, 1) of vectors (m, 3)."""
    return np.linalg.norm(vectors, axis=1, keepdims=True)


def quotient(a: ArrayLike, b: ArrayLike) -> np.ndarray:
    """Returns a / b, or 0 where b is 0."""
    a, b = np.broadcast_arrays(a, b)
    return np.divide(a, b, out=np.zeros(b.shape), where=b > 0)


def coulomb(limit: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Returns the slip velocity (m, 3) after friction: zero if friction can stop the slip, else `after` reduced by `limit` (m, 1) along the
    mean of `before` and `after`."""
    mean = before + after
    mean = np.where(size_of(mean) > 0, mean, after)
    return np.where(size_of(after) <= limit, 0.0, after - limit * quotient(mean, size_of(mean)))


@dataclass(frozen=True, eq=False)
class Meeting:
    """Points (m,) that the free drift of a step moves behind a plane. Vectors are (m, 3)."""

    points: np.ndarray
    begin: HalfSpace
    end: HalfSpace
    friction: float
    x0: np.ndarray  # m, at the start of the step
    before: np.ndarray  # m/s, at the start of the step
    free: np.ndarray  # m/s, after the opening half kick
    wall: np.ndarray  # m/s (m, 1), normal velocity of the plane at the point
    surface: np.ndarray  # m/s, tangential velocity of the obstacle's material at mid-step


class Leapfrog:
    """Half kick, drift, half kick, with contact by local restart. After a step no point lies behind a plane."""

    def __init__(self, body: Body, around: Surroundings, h: float):
        self.body, self.obstacles, self.pins, self.force, self.h = body, around.obstacles, around.pins, around.force, h
        self.around, self.touching = around, TOUCHING * around.largest_side
        mass, damping, half = body.mass[:, None], body.damping[:, None], h / 2
        g = damping * half / mass
        e = 1 / (1 + g + g**2 / 2)  # with strong damping both half kicks decay towards the terminal velocity f / d
        strong, by_drag = g > 1, quotient(1 - e, damping)
        self.open_a, self.open_b = np.where(strong, e, 1 - g), np.where(strong, by_drag, half / mass)
        self.close_a, self.close_b = (np.where(strong, e, 1 / (1 + g)), np.where(strong, by_drag, half / mass / (1 + g)))

    def run(self, motion: Motion, steps: int) -> None:
        """Advances the motion by `steps` internal steps."""
        begin, force = motion.time, self.body.spring_force(motion.x) + self.force
        for n in range(steps):
            t0, t1 = begin + n * self.h, begin + (n + 1) * self.h
            v = self.open_a * motion.v + self.open_b * force
            x = motion.x + self.h * v
            for pin in self.pins:
                here, (_, _, arms) = pin.at(t1)[0], pin.at(t0)
                speed = (here - motion.x[pin.points]) / self.h
                self._hold(pin, motion.v, speed, force, motion.v[pin.points], arms)
                x[pin.points], v[pin.points] = here, speed
            ends = [obstacle.at(t1) for obstacle in self.obstacles]
            gaps = self.around.gaps(ends, x)
            touched = np.flatnonzero((gaps < 0).any(axis=0))
            if len(touched):
                self._drift_onto(ends, touched, gaps[:, touched].argmin(axis=0), t0, motion, force, x, v)
            force = self.body.spring_force(x) + self.force
            kicked = self.close_a * v + self.close_b * force
            for pin in self.pins:
                _, speed, arms = pin.at(t1)
                self._hold(pin, v, speed, force, speed, arms)
                kicked[pin.points] = speed
            if len(touched):
                self._close_on(ends, touched, x, v, kicked)
            motion.x, motion.v, motion.time = x, kicked, t1

    def _hold(self, pin: Pin, old: np.ndarray, new: np.ndarray, force: np.ndarray, damped: np.ndarray, arms: np.ndarray) -> None:
        """Adds to the pin the impulses of the velocity change from old (n, 3) to new (m, 3), less those of the forces of half a step."""
        p = pin.points
        explained = self.h / 2 * (force[p] - self.body.damping[p, None] * damped)
        pin.receive(self.body.mass[p, None] * (new - old[p]) - explained, arms)

    def _drift_onto(
        self, ends: list[HalfSpace], touched: np.ndarray, deepest: np.ndarray, t0: float, motion: Motion, force: np.ndarray, x: np.ndarray,
        v: np.ndarray,
    ) -> None:  # fmt: skip
        """Corrects x and v of the touched points. Each point meets the plane behind which the point would lie deepest."""
        for q, (obstacle, end) in enumerate(zip(self.obstacles, ends, strict=True)):
            points = touched[deepest == q]
            begin, middle = obstacle.at(t0), obstacle.at(t0 + self.h / 2)
            landing = begin.gap(motion.x[points]) > self.touching
            for correct, chosen in ((self._land, points[landing]), (self._stay, points[~landing])):
                if not len(chosen):
                    continue
                x0, free = motion.x[chosen], v[chosen]
                wall = free @ end.normal - (end.gap(x[chosen]) - begin.gap(x0)) / self.h
                surface = end.along(middle.surface(x0 + self.h / 2 * free))
                meeting = Meeting(chosen, begin, end, obstacle.friction, x0, motion.v[chosen], free, wall[:, None], surface)
                x[chosen], v[chosen], gained = correct(meeting, force[chosen])
                obstacle.receive(self.h / 2 / self.open_b[chosen] * gained, x[chosen] - end.point)
            if any(np.any(other.gap(x[points]) < 0) for other in ends if other is not end):
                raise TwinError(TWO_PLANES)

    def _land(self, meeting: Meeting, force: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Handles impacts at the fraction theta of the step. Returns x1 [m], v at mid-step [m/s] and the velocity gained [m/s]."""
        m, n, h = meeting, meeting.end.normal, self.h
        gap0, gap1 = m.begin.gap(m.x0)[:, None], m.end.gap(m.x0 + h * m.free)[:, None]
        theta = gap0 / (gap0 - gap1)
        acceleration = (force - self.body.damping[m.points, None] * m.free) / self.body.mass[m.points, None]
        ahead = (theta - 0.5) * h * acceleration  # from mid-step to the impact
        arriving = m.free + ahead
        normal = (arriving @ n)[:, None]
        reaction = np.maximum(0.0, m.wall - normal)
        slip = m.end.along(arriving) - m.surface
        slip = slip * np.maximum(0.0, 1 - m.friction * quotient(reaction, size_of(slip)))
        leaving = np.maximum(m.wall, normal) * n + m.surface + slip
        x1 = m.x0 + theta * h * m.free + (1 - theta) * h * (m.surface + slip)
        return m.end.snapped(x1), leaving - ahead, leaving - arriving

    def _stay(self, meeting: Meeting, _force: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Keeps points on the plane that were on the plane before. Returns the same as _land."""
        m, n = meeting, meeting.end.normal
        reaction = np.maximum(0.0, m.wall - (m.free @ n)[:, None])
        slip = m.end.along(m.free) - m.surface
        left = coulomb(m.friction * reaction, m.end.along(m.before) - m.surface, slip)
        v = m.free + reaction * n + left - slip
        return m.end.snapped(m.x0 + self.h * v), v, v - m.free

    def _close_on(self, ends: list[HalfSpace], touched: np.ndarray, x: np.ndarray, v: np.ndarray, kicked: np.ndarray) -> None:
        """Corrects the velocities `kicked` after the closing half kick so that no touched point moves into its plane."""
        on = np.array([end.gap(x[touched]) <= self.touching for end in ends])
        if np.any(on.sum(axis=0) > 1):
            raise TwinError(TWO_PLANES)
        for obstacle, end, here in zip(self.obstacles, ends, on, strict=True):
            points = touched[here]
            if not len(points):
                continue
            surface, free = end.surface(x[points]), kicked[points]
            reaction = np.maximum(0.0, (surface - free) @ end.normal)[:, None]
            slip = end.along(free - surface)
            left = coulomb(obstacle.friction * reaction, end.along(v[points] - surface), slip)
            gained = reaction * end.normal + left - slip
            kicked[points] = free + gained
            obstacle.receive(self.h / 2 / self.close_b[points] * gained, x[points] - end.point)


class CentralDifference:
    """The recurrence (13) in positions, started by eq. (11). Collisions follow eq. (14) to (17) with the sign corrected."""

    def __init__(self, body: Body, around: Surroundings, h: float):
        self.body, self.obstacles, self.pins, self.force, self.h = body, around.obstacles, around.pins, around.force, h
        self.free = around.free
        inertia, drag = body.mass[:, None] / h**2, body.damping[:, None] / (2 * h)
        self.ahead, self.now, self.back = inertia + drag, 2 * inertia, inertia - drag

    def run(self, motion: Motion, steps: int) -> None:
        """Advances the motion by `steps` internal steps. A further step, not kept, gives the velocity by eq. (10)."""
        h, begin = self.h, motion.time
        if motion.previous_step != h:
            force = self.body.spring_force(motion.x) + self.force - self.body.damping[:, None] * motion.v
            motion.previous = motion.x - h * motion.v + h**2 / 2 * force / self.body.mass[:, None]
            motion.previous_step = h
        for n in range(steps):
            following = self._following(motion, begin + n * h, book=True)
            motion.previous, motion.x = motion.x, following
        motion.time = begin + steps * h
        motion.v = (self._following(motion, motion.time, book=False) - motion.previous) / (2 * h)

    def _following(self, motion: Motion, time: float, *, book: bool) -> np.ndarray:
        x, previous = motion.x, motion.previous
        force = self.body.spring_force(x) + self.force
        following = (self.now * x - self.back * previous + force) / self.ahead
        for obstacle in self.obstacles:
            now = obstacle.at(time)
            surface = now.surface(x)
            pushed = (previous - following + 2 * self.h * surface) @ now.normal  # contact acceleration times h^2
            hit = np.flatnonzero((now.gap(x) < 0) & (pushed > 0) & self.free)
            if not len(hit):
                continue
            slip = now.along(following[hit] - x[hit] - self.h * surface[hit])
            push = pushed[hit, None]
            held = np.minimum(1.0, quotient(obstacle.friction * push, size_of(slip)))
            change = push * now.normal - held * slip
            following[hit] += change
            if book:
                obstacle.receive(self.ahead[hit] * self.h * change, x[hit] - now.point)
        for pin in self.pins:
            here, _, arms = pin.at(time + self.h)
            if book:
                pin.receive(self.ahead[pin.points] * self.h * (here - following[pin.points]), arms)
            following[pin.points] = here
        return following


METHODS = {"auto": Leapfrog, "leapfrog": Leapfrog, "central_difference": CentralDifference}
