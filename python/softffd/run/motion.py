"""Velocities of planes and pins from the course of their poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np


def derived_velocities(now: Mapping[str, float], then: Mapping[str, float], step: float) -> dict[str, float]:
    """Velocities that take every pose given in `now` to the one in `then` after `step` [s] and that `now` does not give itself.

    Names are those of the FMU's variables: plane.NAME.point gives .velocity, .normal gives .angular_velocity; pin.NAME.position and
    .orientation likewise. Components that are not given count as zero change for points; rotations need the whole normal or quaternion.
    """
    derived: dict[str, float] = {}
    for pose, (velocity, components, rate) in RATES.items():
        for owner in _owners(now, pose, components):
            given = [f"{owner}.{pose}.{c}" for c in components]
            if any(f"{owner}.{velocity}.{c}" in now for c in "xyz"):
                continue
            if rate is not _difference and not all(name in now for name in given):
                continue
            first = np.array([now.get(name, 0.0) for name in given])
            last = np.array([then[name] if name in now else 0.0 for name in given])
            derived |= {f"{owner}.{velocity}.{c}": float(v) for c, v in zip("xyz", rate(first, last) / step, strict=True)}
    return derived


def _owners(values: Mapping[str, float], pose: str, components: str) -> list[str]:
    endings = tuple(f".{pose}.{c}" for c in components)
    return list(dict.fromkeys(name.rsplit(".", 2)[0] for name in values if name.endswith(endings)))


def _difference(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    return last - first


def _turn_of_normal(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Shortest rotation vector (3,) [rad] from one direction to another."""
    a, b = first / np.linalg.norm(first), last / np.linalg.norm(last)
    axis = np.cross(a, b)
    sine = np.linalg.norm(axis)
    return axis / sine * np.arctan2(sine, a @ b) if sine > 0 else np.zeros(3)


def _turn_of_quaternion(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Shortest rotation vector (3,) [rad], world frame, from one orientation (w, x, y, z) to another."""
    (w1, *v1), (w2, *v2) = first / np.linalg.norm(first), last / np.linalg.norm(last)
    v1, v2 = np.array(v1), np.array(v2)
    w, v = w2 * w1 + v2 @ v1, w1 * v2 - w2 * v1 - np.cross(v2, v1)  # last times the conjugate of first
    sine = np.linalg.norm(v)
    return np.sign(w or 1) * v / sine * 2 * np.arctan2(sine, abs(w)) if sine > 0 else np.zeros(3)


Rate = Callable[[np.ndarray, np.ndarray], np.ndarray]
RATES: dict[str, tuple[str, str, Rate]] = {
    "point": ("velocity", "xyz", _difference),
    "position": ("velocity", "xyz", _difference),
    "normal": ("angular_velocity", "xyz", _turn_of_normal),
    "orientation": ("angular_velocity", "wxyz", _turn_of_quaternion),
}
