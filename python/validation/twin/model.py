"""An implementation of the soft object in numpy, against which the component is checked: a resolved scene in motion.

The module imports numpy alone because it is copied into the twin's FMU. Variables have the FMU's names and SI units. Rates of
inputs and energies are not implemented.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import Any

import numpy as np

from softffd.rotation import turned

from ..mechanics import AXES, Body, outside_force, start
from .fixtures import TOUCHING, Fixture, HalfSpace, Obstacle, Pin, Surroundings, TwinError
from .methods import METHODS, TWO_PLANES, CentralDifference, Motion, quotient

MATERIAL = ("mass", "damping", "stiffness.edge", "stiffness.face", "stiffness.body", "youngs_modulus")


class Model:
    """A resolved scene in motion. The scene is the dictionary that validation.twin.resolved_scene returns."""

    def __init__(self, scene: Mapping[str, Any]):
        self.scene, self.rest = scene, np.array(scene["rest"])
        self._material: list[float | None] | None = None

    def initialize(self, values: Mapping[str, float], time: float) -> None:
        """Sets the state at the start time [s]. Points behind a plane are moved onto the plane."""
        self.motion = Motion(time, *start(self.scene, rotation=_rotation(values)))
        self.start_time, self.elapsed, self._material = time, 1.0, None
        self._take(values)
        self._place_pins(book=False)
        self._clear_jumps(values)

    def advance(self, values: Mapping[str, float], length: float) -> None:
        """Makes one communication step of this length [s] with constant variables. Raises TwinError if the result is not finite."""
        self._take(values)
        self._place_pins(book=True)
        self._clear_jumps(values)
        h, steps = self._division(values["solver.step"], length)
        method = self._method(values)
        with np.errstate(over="ignore", invalid="ignore"):  # reported below
            method(self.body, self.around, h).run(self.motion, steps)
        self.elapsed = length
        if not np.isfinite(self.motion.x).all():
            raise TwinError("the result is not finite: solver.step is too long, it is taken as it is given")

    def outputs(self) -> dict[str, float]:
        """Returns the values of all outputs by name."""
        found: dict[str, float] = {}
        scene = self.scene
        for what, rows in (("position", self.motion.x), ("velocity", self.motion.v)):
            for name, p in scene[what].items():
                found |= _vector(name, rows[p])
        for name, (points, weights) in scene["probes"].items():
            found |= _vector(f"probe.{name}", np.array(weights) @ self.motion.x[points])
        if scene["reactions"]:
            for plane, obstacle in zip(scene["planes"], self.around.obstacles, strict=True):
                name, plane = f"plane.{plane['name']}", obstacle.at(self.motion.time)
                on = plane.gap(self.motion.x) <= TOUCHING * self.around.largest_side
                found |= self._reactions(name, obstacle) | {f"{name}.contacts": int(on.sum())}
                found |= _vector(f"{name}.centre", obstacle.centre(plane))
            for pin, held in zip(scene["pins"], self.around.pins, strict=True):
                found |= self._reactions(f"pin.{pin['name']}", held)
        return found

    def _reactions(self, name: str, fixture: Fixture) -> dict[str, float]:
        force = _vector(f"{name}.reaction", fixture.impulse / self.elapsed)
        return force | _vector(f"{name}.torque", fixture.moment / self.elapsed)

    def _take(self, values: Mapping[str, float]) -> None:
        """Updates body, obstacles, pins and forces from the values of the variables."""
        material = [values.get(name) for name in MATERIAL]
        if material != self._material:
            self._material, self.body, self.motion.previous_step = material, self._make_body(values), 0.0
        obstacles = [self._obstacle(plane, values) for plane in self.scene["planes"]]
        pins = [self._pin(pin, values) for pin in self.scene["pins"]]
        gravity = _read(values, "gravity") if "gravity.x" in values else np.zeros(3)
        force = self.body.weight[:, None] * gravity + outside_force(self.scene, values)
        self.around = Surroundings(obstacles, pins, force, max(self.scene["size"]))

    def _make_body(self, values: Mapping[str, float]) -> Body:
        modulus = values.get("youngs_modulus")
        stiffness = None if modulus is not None else [values[f"stiffness.{kind}"] for kind in ("edge", "face", "body")]
        return Body.of(self.scene, total=values["mass"], stiffness=stiffness, youngs_modulus=modulus, damping=values.get("damping", 0.0))

    def _obstacle(self, plane: Mapping[str, Any], values: Mapping[str, float]) -> Obstacle:
        name = f"plane.{plane['name']}"
        what = ("point", "normal", "velocity", "angular_velocity")
        point, normal, velocity, spin = (_read(values, f"{name}.{each}") for each in what)
        if not np.any(normal):
            raise TwinError(f"{name}.normal: wanted any vector but zero")
        since = self.motion.time if plane["motion"] == "input" else self.start_time
        start = HalfSpace(point, normal / np.linalg.norm(normal), velocity, spin)
        return Obstacle(start=start, friction=values[f"{name}.friction"], since=since)

    def _pin(self, pin: Mapping[str, Any], values: Mapping[str, float]) -> Pin:
        points, name = np.array(pin["points"]), f"pin.{pin['name']}"
        origin = np.array(pin["origin"])
        arms, velocity, spin = self.rest[points] - origin, np.zeros(3), np.zeros(3)
        if pin["motion"] == "input":
            w, *axis = (values[f"{name}.orientation.{each}"] for each in "wxyz")
            if not (w or any(axis)):
                raise TwinError(f"{name}.orientation: wanted any quaternion but zero")
            angle = 2 * np.arctan2(np.linalg.norm(axis), w)
            arms = turned(arms, angle * quotient(np.array(axis), np.linalg.norm(axis)))
            origin, velocity, spin = (_read(values, f"{name}.{each}") for each in ("position", "velocity", "angular_velocity"))
        elif (turn := _rotation(values)).any():
            centre = np.array(self.scene["origin"]) + np.array(self.scene["size"]) / 2
            arms, origin = turned(arms, turn), centre + turned(origin - centre, turn)
        return Pin(points=points, arms=arms, origin=origin, velocity=velocity, spin=spin, since=self.motion.time)

    def _place_pins(self, *, book: bool) -> None:
        """Sets pinned points to the position and velocity of their frame. If `book`, a change of velocity is added as an impulse."""
        motion = self.motion
        for pin in self.around.pins:
            p = pin.points
            here, velocity, arms = pin.at(motion.time)
            if book:
                pin.receive(self.body.mass[p, None] * (velocity - motion.v[p]), arms)
            motion.x[p], motion.v[p] = here, velocity

    def _method(self, values: Mapping[str, float]) -> type:
        name = self.scene["methods"][str(int(values["solver.method"]))]
        if name not in METHODS:
            raise TwinError(f"solver.method: the twin has {', '.join(METHODS)}, got {name}")
        return METHODS[name]

    def _clear_jumps(self, values: Mapping[str, float]) -> None:
        """Moves points behind a plane that has jumped onto the plane and keeps their velocity. The published method does not do this."""
        if not self.around.obstacles or self._method(values) is CentralDifference:
            return
        planes = [obstacle.at(self.motion.time) for obstacle in self.around.obstacles]
        behind = self.around.gaps(planes, self.motion.x) < 0
        for plane, points in zip(planes, behind, strict=True):
            self.motion.x[points] = plane.snapped(self.motion.x[points])
        others = behind.any(axis=0) & ~behind
        after = self.around.gaps(planes, self.motion.x) < 0
        if np.any(behind.sum(axis=0) > 1) or np.any(others & after):
            raise TwinError(TWO_PLANES)

    def _division(self, step: float, length: float) -> tuple[float, int]:
        """Returns the internal step [s] and the number of steps: `step` if it divides the length, else the next shorter step that does."""
        whole = round(length / step) if step > 0 else 0
        if whole and abs(length - whole * step) <= 1e-9 * length:
            return step, whole
        limit = step if step > 0 else 0.9 * self.body.stable_step()
        steps = max(1, ceil(length / limit * (1 - 1e-12)))
        return length / steps, steps


def _read(values: Mapping[str, float], name: str) -> np.ndarray:
    return np.array([values[f"{name}.{axis}"] for axis in AXES])


def _rotation(values: Mapping[str, float]) -> np.ndarray:
    """Returns the rotation vector of the body at the start (3,) [rad]."""
    return _read(values, "initial.rotation") if "initial.rotation.x" in values else np.zeros(3)


def _vector(name: str, numbers: np.ndarray) -> dict[str, float]:
    return {f"{name}.{axis}": float(number) for axis, number in zip(AXES, numbers, strict=True)}
