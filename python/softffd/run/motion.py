"""Velocities of obstacles and pins from the course of their poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from softffd.names import Instance, parse_name, vector_names
from softffd.rotation import between_directions, between_orientations, quaternion


def derived_velocities(now: Mapping[str, float], then: Mapping[str, float], step: float) -> dict[str, float]:
    """Velocities that take every pose given in `now` to the one in `then` after `step` [s] and that `now` does not give itself.

    Names are those of the FMU's variables: .point of an obstacle gives .velocity, .normal or .rotation gives .angular_velocity;
    .position and .orientation of a pin likewise. Components that are not given count as zero change for points; rotations need the
    whole normal, rotation vector or quaternion.
    """
    derived: dict[str, float] = {}
    for pose, parts in _parts_with_poses(now).items():
        velocity, rate = RATES[pose]
        for part in parts:
            given, wanted = vector_names(pose, part), vector_names(velocity, part)
            if any(name in now for name in wanted) or (rate is not _difference and not all(name in now for name in given)):
                continue
            first = np.array([now.get(name, 0.0) for name in given])
            last = np.array([then[name] if name in now else 0.0 for name in given])
            derived |= {name: float(v) for name, v in zip(wanted, rate(first, last) / step, strict=True)}
    return derived


def _parts_with_poses(values: Mapping[str, float]) -> dict[str, list[Instance]]:
    """The obstacles and pins of which a component is given, by family."""
    found: dict[str, dict[Instance, None]] = {pose: {} for pose in RATES}
    for name in map(parse_name, values):
        if name is not None and name.family in found:
            found[name.family][name.instance] = None
    return {pose: list(parts) for pose, parts in found.items()}


def _difference(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    return last - first


def _between_rotations(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    return between_orientations(quaternion(first), quaternion(last))


Rate = Callable[[np.ndarray, np.ndarray], np.ndarray]
RATES: dict[str, tuple[str, Rate]] = {
    "plane_point": ("plane_velocity", _difference),
    "pin_position": ("pin_velocity", _difference),
    "plane_normal": ("plane_angular_velocity", between_directions),
    "plane_rotation": ("plane_angular_velocity", _between_rotations),
    "pin_orientation": ("pin_angular_velocity", between_orientations),
}
"""Families of poses: the velocity that follows from each, and how"""
