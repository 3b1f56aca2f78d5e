"""The soft object once more, in numpy, to check the component against: Xia & Wang 2009 with a plain list of springs.

Imports numpy alone, for it travels inside the twin's FMU. Control points are in flat order, p = i + nx (j + ny k); arrays of them are (n, 3);
SI units. Values of variables are given and taken by the FMU's names.

Both methods take their contact from the essays of the component, fmu_src/core/contact.hpp and central_difference.hpp, but handle all points
that meet a plane at once. Absent: pins, rates of inputs, and points that are held by two planes at a time, which are refused.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from math import ceil, comb

import numpy as np

TOUCHING = 1e-12
"""A gap below this share of the box's largest side is contact."""
AXES = "xyz"


class TwinError(Exception):
    """What the twin does not do, or could not do."""


def rest_positions(counts, origin, size) -> np.ndarray:
    """Control points at rest (n, 3) [m]."""
    k, j, i = np.indices(counts[::-1]).reshape(3, -1)
    return np.array(origin) + np.array(size) * np.stack([i, j, k], axis=1) / (np.array(counts) - 1)


def spring_list(counts, topology: str) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of control points (s, 2) and how many axes each crosses (s,): 1 edge, 2 face diagonal, 3 body diagonal (figure 1).

    topology "paper" makes edge springs face by face: those on the edges of the box come twice.
    """
    place = np.arange(np.prod(counts)).reshape(counts[::-1]).T  # place[i, j, k] = p
    pairs, kinds = [], []
    for way in product((-1, 0, 1), repeat=3):
        if way <= (0, 0, 0):
            continue  # the opposite way makes the same springs
        here = tuple(slice(max(0, -d), n - max(0, d)) for d, n in zip(way, counts, strict=True))
        there = tuple(slice(max(0, d), n + min(0, d)) for d, n in zip(way, counts, strict=True))
        found = np.stack([place[here], place[there]], axis=-1).reshape(-1, 2)
        if topology == "paper" and np.abs(way).sum() == 1:
            found = np.repeat(found, 1 + _on_box_edge(found, counts), axis=0)
        pairs.append(found)
        kinds.append(np.full(len(found), np.abs(way).sum()))
    return np.concatenate(pairs), np.concatenate(kinds)


def _on_box_edge(pairs: np.ndarray, counts) -> np.ndarray:
    """1 for the edge springs (s, 2) that lie on one of the twelve edges of the box."""
    ends = np.stack(np.unravel_index(pairs, counts, order="F"), axis=-1)  # (s, 2, axis)
    outside = (ends == 0) | (ends == np.array(counts) - 1)
    along = ends[:, 0] != ends[:, 1]
    return ((outside.all(axis=1) & ~along).sum(axis=1) == 2).astype(int)


def bernstein(t: float, count: int) -> np.ndarray:
    """Eq. (2) for `count` control points, at t: (count,)."""
    degree = count - 1
    return np.array([comb(degree, i) * t**i * (1 - t) ** (degree - i) for i in range(count)])


@dataclass(frozen=True, eq=False)
class Body:
    """What eq. (3) and (6) know of the object: springs between pairs (s, 2), and mass [kg] and damping [N s/m] of the points (n,)."""

    pairs: np.ndarray
    stiffness: np.ndarray  # (s,) N/m
    length: np.ndarray  # (s,) m
    mass: np.ndarray
    damping: np.ndarray

    def spring_force(self, x: np.ndarray) -> np.ndarray:
        """Forces on the points (n, 3) [N], eq. (6), pulling stretched pairs together; a spring of no length pulls nowhere."""
        a, b = self.pairs.T
        d = x[b] - x[a]
        r = np.linalg.norm(d, axis=1)
        pull = (self.stiffness * (1 - np.divide(self.length, r, out=np.ones_like(r), where=r > 0)))[:, None] * d
        return np.stack([np.bincount(a, f, len(x)) - np.bincount(b, f, len(x)) for f in pull.T], axis=1)

    def stable_step(self) -> float:
        """A step [s] that is stable in any configuration: 2 / omega, with omega bounded as in fmu_src/core/stability.hpp."""
        square = np.zeros(len(self.mass))
        for here, there in (self.pairs.T, self.pairs.T[::-1]):
            share = 1 + np.sqrt(self.mass[here] / self.mass[there])
            square += np.bincount(here, self.stiffness * share, len(square))
        most = (square / self.mass).max()
        return 2 / np.sqrt(most) if most > 0 else np.inf


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """An obstacle at one moment: solid behind the plane. Vectors (3,), SI units."""

    point: np.ndarray
    normal: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Distance of points (n, 3) from the plane, negative behind it (n,) [m]."""
        return (x - self.point) @ self.normal

    def surface(self, x: np.ndarray) -> np.ndarray:
        """Velocity of the obstacle's material at points (n, 3) [m/s]."""
        return self.velocity + np.cross(self.spin, x - self.point)

    def snapped(self, x: np.ndarray) -> np.ndarray:
        """The points' feet on the plane (n, 3) [m]."""
        return x - self.gap(x)[:, None] * self.normal

    def along(self, v: np.ndarray) -> np.ndarray:
        """The tangential part of vectors (n, 3)."""
        return v - (v @ self.normal)[:, None] * self.normal


@dataclass(eq=False)
class Obstacle:
    """A plane in uniform rigid motion since a time, and what it received during the communication step."""

    start: HalfSpace
    friction: float
    since: float
    impulse: np.ndarray = field(default_factory=lambda: np.zeros(3))  # N s
    moment: np.ndarray = field(default_factory=lambda: np.zeros(3))  # N m s about the point

    def at(self, time: float) -> HalfSpace:
        """The half-space at a time [s]: the point moves on, the normal turns."""
        age, s = time - self.since, self.start
        return HalfSpace(s.point + age * s.velocity, rotated(s.normal, age * s.spin), s.velocity, s.spin)

    def receive(self, on_points: np.ndarray, arms: np.ndarray) -> None:
        """Books the reaction to impulses on points (m, 3) [N s] at arms (m, 3) [m] from the plane's point."""
        self.impulse = self.impulse - on_points.sum(axis=0)
        self.moment = self.moment - np.cross(arms, on_points).sum(axis=0)


def rotated(v: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """v (3,) turned by a rotation vector (3,) [rad] (Rodrigues)."""
    angle = np.linalg.norm(turn)
    if angle == 0:
        return v
    axis = turn / angle
    return np.cos(angle) * v + np.sin(angle) * np.cross(axis, v) + (1 - np.cos(angle)) * (axis @ v) * axis


@dataclass(eq=False)
class Motion:
    """Positions [m] and velocities [m/s] (n, 3) at a time [s]; x one step back, and that step, for the published recurrence."""

    time: float
    x: np.ndarray
    v: np.ndarray
    previous: np.ndarray | None = None
    previous_step: float = 0.0


def size_of(vectors: np.ndarray) -> np.ndarray:
    """Lengths (m, 1) of vectors (m, 3)."""
    return np.linalg.norm(vectors, axis=1, keepdims=True)


def quotient(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a / b, and 0 where b is 0."""
    a, b = np.broadcast_arrays(a, b)
    return np.divide(a, b, out=np.zeros(b.shape), where=b > 0)


def coulomb(limit: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """The slip (m, 3) that friction leaves of `after`: none if it can hold, else shortened by `limit` (m, 1) against the mean slip."""
    mean = before + after
    mean = np.where(size_of(mean) > 0, mean, after)
    return np.where(size_of(after) <= limit, 0.0, after - limit * quotient(mean, size_of(mean)))


class Leapfrog:
    """Half kick, drift, half kick; contact by local restart, no point behind a plane after a step."""

    def __init__(self, body: Body, obstacles: list[Obstacle], force: np.ndarray, h: float, largest_side: float):
        self.body, self.obstacles, self.force, self.h = body, obstacles, force, h
        self.touching = TOUCHING * largest_side
        mass, damping, half = body.mass[:, None], body.damping[:, None], h / 2
        g = damping * half / mass
        e = 1 / (1 + g + g**2 / 2)  # for strong damping: the half kicks decay and end at the terminal velocity f / d
        strong, by_drag = g > 1, quotient(1 - e, damping)
        self.open_a, self.open_b = np.where(strong, e, 1 - g), np.where(strong, by_drag, half / mass)
        self.close_a, self.close_b = np.where(strong, e, 1 / (1 + g)), np.where(strong, by_drag, half / mass / (1 + g))

    def run(self, motion: Motion, steps: int) -> None:
        """`steps` internal steps."""
        begin, force = motion.time, self.body.spring_force(motion.x) + self.force
        for n in range(steps):
            t0, t1 = begin + n * self.h, begin + (n + 1) * self.h
            v = self.open_a * motion.v + self.open_b * force
            x = motion.x + self.h * v
            ends = [obstacle.at(t1) for obstacle in self.obstacles]
            touched = np.flatnonzero(np.any([end.gap(x) < 0 for end in ends], axis=0)) if ends else np.array([], int)
            if len(touched):
                self._drift_onto(ends, touched, t0, motion, force, x, v)
            force = self.body.spring_force(x) + self.force
            kicked = self.close_a * v + self.close_b * force
            if len(touched):
                self._close_on(ends, touched, x, v, kicked)
            motion.x, motion.v, motion.time = x, kicked, t1

    def _drift_onto(self, ends, touched, t0, motion, force, x, v) -> None:
        """Each touched point meets the plane that it would be deepest behind; corrects x and v."""
        deepest = np.argmin([end.gap(x[touched]) for end in ends], axis=0)
        for q, (obstacle, end) in enumerate(zip(self.obstacles, ends, strict=True)):
            points = touched[deepest == q]
            begin, middle = obstacle.at(t0), obstacle.at(t0 + self.h / 2)
            landing = begin.gap(motion.x[points]) > self.touching
            for meet, chosen in ((self._land, points[landing]), (self._stay, points[~landing])):
                if len(chosen):
                    x0, free = motion.x[chosen], v[chosen]
                    wall = free @ end.normal - (end.gap(x[chosen]) - begin.gap(x0)) / self.h
                    surface = end.along(middle.surface(x0 + self.h / 2 * free))
                    x[chosen], v[chosen], gained = meet(chosen, begin, end, obstacle.friction, motion, force, free, wall[:, None], surface)
                    obstacle.receive(self.h / 2 / self.open_b[chosen] * gained, x[chosen] - end.point)
            if any(np.any(other.gap(x[points]) < 0) for other in ends if other is not end):
                raise TwinError(f"at time {t0 + self.h:.9g} s two planes hold one control point: the twin has one plane per point")

    def _land(self, points, begin, end, friction, motion, force, free, wall, surface):
        """An impact at the share theta of the step: x1, v at the middle of the step, and the velocity that the plane gave."""
        n, x0, h = end.normal, motion.x[points], self.h
        gap0, gap1 = begin.gap(x0)[:, None], end.gap(x0 + h * free)[:, None]
        theta = gap0 / (gap0 - gap1)
        acceleration = (force[points] - self.body.damping[points, None] * free) / self.body.mass[points, None]
        ahead = (theta - 0.5) * h * acceleration  # from the middle of the step to the impact
        arriving = free + ahead
        normal = (arriving @ n)[:, None]
        reaction = np.maximum(0.0, wall - normal)
        slip = end.along(arriving) - surface
        slip = slip * np.maximum(0.0, 1 - friction * quotient(reaction, size_of(slip)))
        leaving = np.maximum(wall, normal) * n + surface + slip
        x1 = x0 + theta * h * free + (1 - theta) * h * (surface + slip)
        return end.snapped(x1), leaving - ahead, leaving - arriving

    def _stay(self, points, begin, end, friction, motion, force, free, wall, surface):
        """A point that was on the plane stays on it. Returns as _land."""
        reaction = np.maximum(0.0, wall - (free @ end.normal)[:, None])
        slip = end.along(free) - surface
        left = coulomb(friction * reaction, end.along(motion.v[points]) - surface, slip)
        v = free + reaction * end.normal + left - slip
        return end.snapped(motion.x[points] + self.h * v), v, v - free

    def _close_on(self, ends, touched, x, v, kicked) -> None:
        """The closing half kick leaves touched points on their planes; corrects `kicked`."""
        on = np.array([end.gap(x[touched]) <= self.touching for end in ends])
        if np.any(on.sum(axis=0) > 1):
            raise TwinError("two planes hold one control point: the twin has one plane per point")
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
    """The recurrence (13) in positions, started by (11), with the collision rule (14) to (17), its sign corrected."""

    def __init__(self, body: Body, obstacles: list[Obstacle], force: np.ndarray, h: float, largest_side: float):
        self.body, self.obstacles, self.force, self.h = body, obstacles, force, h
        self.inertia, self.drag = body.mass[:, None] / h**2, body.damping[:, None] / (2 * h)

    def run(self, motion: Motion, steps: int) -> None:
        """`steps` internal steps, and one looked ahead for the velocity, eq. (10)."""
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
        following = (2 * self.inertia * x - (self.inertia - self.drag) * previous + force) / (self.inertia + self.drag)
        for obstacle in self.obstacles:
            now = obstacle.at(time)
            surface = now.surface(x)
            pushed = ((previous - following + 2 * self.h * surface) @ now.normal)[:, None]  # contact acceleration times h^2
            hit = np.flatnonzero((now.gap(x) < 0) & (pushed[:, 0] > 0))
            if not len(hit):
                continue
            slip = now.along(following[hit] - x[hit] - self.h * surface[hit])
            held = np.minimum(1.0, quotient(obstacle.friction * pushed[hit], size_of(slip)))
            change = pushed[hit] * now.normal - held * slip
            following[hit] += change
            if book:
                obstacle.receive((self.inertia + self.drag)[hit] * self.h * change, x[hit] - now.point)
        return following


METHODS = {"auto": Leapfrog, "leapfrog": Leapfrog, "central_difference": CentralDifference}


class Model:
    """A resolved scene (the dictionary that softffd.twin.resolved_scene makes) in motion."""

    def __init__(self, scene: dict):
        self.scene = scene
        self.rest = rest_positions(scene["counts"], scene["origin"], scene["size"])
        self.pairs, self.kinds = spring_list(scene["counts"], scene["topology"])
        self.length = np.linalg.norm(self.rest[self.pairs[:, 0]] - self.rest[self.pairs[:, 1]], axis=1)
        self.probes = {name: self._weights(at) for name, at in scene["probes"].items()}

    def initialize(self, values: Mapping[str, float], time: float) -> None:
        """The state at the start; points behind a plane are moved onto it."""
        scene, initial = self.scene, {key: np.array(value) for key, value in self.scene["initial"].items()}
        origin = np.array(scene["origin"])
        x = origin + initial["stretch"] * (self.rest - origin) + initial["offset"]
        centre = origin + initial["stretch"] * np.array(scene["size"]) / 2 + initial["offset"]
        self.motion = Motion(time, x, initial["velocity"] + np.cross(initial["angular_velocity"], x - centre))
        self.start_time, self.elapsed, self._material = time, 1.0, None
        self._take(values)
        self._clear_jumps(values)

    def advance(self, values: Mapping[str, float], length: float) -> None:
        """One communication step of this length [s] with the variables' values, held."""
        self._take(values)
        self._clear_jumps(values)
        h, steps = self._division(values["solver.step"], length)
        method = METHODS[self.scene["methods"][str(int(values["solver.method"]))]]
        method(self.body, self.obstacles, self.force, h, max(self.scene["size"])).run(self.motion, steps)
        self.elapsed = length
        if not np.isfinite(self.motion.x).all():
            raise TwinError("the result is not finite: solver.step is too long, it is taken as it is given")

    def outputs(self) -> dict[str, float]:
        """Values of all outputs by name."""
        found, scene = {}, self.scene
        for what, rows in (("position", self.motion.x), ("velocity", self.motion.v)):
            for p in scene[what]:
                found |= _vector(f"{what}[{','.join(map(str, np.unravel_index(p, scene['counts'], order='F')))}]", rows[p])
        for name, weights in self.probes.items():
            found |= _vector(f"probe.{name}", weights @ self.motion.x)
        for plane, obstacle in zip(scene["planes"] if scene["reactions"] else [], self.obstacles, strict=False):
            on = obstacle.at(self.motion.time).gap(self.motion.x) <= TOUCHING * max(scene["size"])
            found |= _vector(f"plane.{plane['name']}.reaction", obstacle.impulse / self.elapsed)
            found |= _vector(f"plane.{plane['name']}.torque", obstacle.moment / self.elapsed)
            found[f"plane.{plane['name']}.contacts"] = int(on.sum())
        return found

    def _take(self, values: Mapping[str, float]) -> None:
        """Body, obstacles and forces as the variables have them now."""
        material = [values.get(name) for name in ("mass", "damping", "stiffness.edge", "stiffness.face", "stiffness.body")]
        if material != self._material:
            self._material, self.body, self.motion.previous_step = material, self._make_body(values), 0.0
        self.obstacles = [self._obstacle(plane, values) for plane in self.scene["planes"]]
        self.force = self.body.mass[:, None] * _read(values, "gravity") if "gravity.x" in values else np.zeros_like(self.rest)
        for p in self.scene["forces"]:
            self.force[p] += _read(values, f"force[{','.join(map(str, np.unravel_index(p, self.scene['counts'], order='F')))}]")
        for name, points in self.scene["loads"].items():
            self.force[points] += _read(values, f"load.{name}") / len(points)

    def _make_body(self, values: Mapping[str, float]) -> Body:
        mass = np.array(self.scene["mass"])
        stiffness = np.array([values[f"stiffness.{kind}"] for kind in ("edge", "face", "body")])[self.kinds - 1]
        damping = np.full(len(mass), values.get("damping", 0.0))
        for region in self.scene["regions"]:
            inside = np.isin(self.pairs, region["points"]).all(axis=1)
            if region["stiffness"] is not None:
                stiffness = np.where(inside, region["stiffness"], stiffness)
            if region["damping"] is not None:
                damping[region["points"]] = region["damping"]
        return Body(self.pairs, stiffness, self.length, mass * (values["mass"] / mass.sum()), damping)

    def _obstacle(self, plane: dict, values: Mapping[str, float]) -> Obstacle:
        point, normal, velocity, spin = (
            _read(values, f"plane.{plane['name']}.{what}") for what in ("point", "normal", "velocity", "angular_velocity")
        )
        if not np.any(normal):
            raise TwinError(f"plane.{plane['name']}.normal: wanted any vector but zero")
        since = self.motion.time if plane["motion"] == "input" else self.start_time
        start = HalfSpace(point, normal / np.linalg.norm(normal), velocity, spin)
        return Obstacle(start, values[f"plane.{plane['name']}.friction"], since)

    def _clear_jumps(self, values: Mapping[str, float]) -> None:
        """A plane that has jumped moves points and leaves their velocity; the published rule knows no such thing."""
        if self.scene["methods"][str(int(values["solver.method"]))] == "central_difference":
            return
        planes = [obstacle.at(self.motion.time) for obstacle in self.obstacles]
        behind = np.array([plane.gap(self.motion.x) < 0 for plane in planes])
        for plane, points in zip(planes, behind, strict=True):
            self.motion.x[points] = plane.snapped(self.motion.x[points])
        moved = np.flatnonzero(behind.any(axis=0)) if planes else []
        for plane, own in zip(planes, behind, strict=True):
            if np.any(plane.gap(self.motion.x)[moved][~own[moved]] < 0) or np.any(behind.sum(axis=0) > 1):
                raise TwinError("two planes hold one control point: the twin has one plane per point")

    def _division(self, step: float, length: float) -> tuple[float, int]:
        """Internal step [s] and number of them: `step` where it divides the length, else the next shorter one that does."""
        if step > 0 and round(length / step) >= 1 and abs(length - round(length / step) * step) <= 1e-9 * length:
            return step, round(length / step)
        limit = step if step > 0 else 0.9 * self.body.stable_step()
        steps = max(1, ceil(length / limit * (1 - 1e-12)))
        return length / steps, steps

    def _weights(self, at) -> np.ndarray:
        """Weights (n,) of the control points at a place of the rest shape, eq. (1)."""
        shares = (np.array(at) - self.scene["origin"]) / self.scene["size"]
        u, v, w = (bernstein(t, count) for t, count in zip(shares, self.scene["counts"], strict=True))
        return np.einsum("k,j,i->kji", w, v, u).ravel()


def _read(values: Mapping[str, float], name: str) -> np.ndarray:
    return np.array([values[f"{name}.{axis}"] for axis in AXES])


def _vector(name: str, numbers: np.ndarray) -> dict[str, float]:
    return {f"{name}.{axis}": float(number) for axis, number in zip(AXES, numbers, strict=True)}
