"""Rotations: as vectors [rad] along their axis, right-handed, and from one direction or orientation to another."""

import numpy as np


def turned(vectors: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """vectors (..., 3) turned by rotation vectors (..., 3) [rad] (Rodrigues)."""
    angle = np.linalg.norm(turns, axis=-1, keepdims=True)
    axis = np.divide(turns, angle, out=np.zeros_like(turns), where=angle > 0)
    along = (axis * vectors).sum(axis=-1, keepdims=True) * axis
    return along + np.cos(angle) * (vectors - along) + np.sin(angle) * np.cross(axis, vectors)


def quaternion(turn: np.ndarray) -> np.ndarray:
    """The unit quaternion (w, x, y, z) of a rotation vector (3,) [rad]."""
    angle = np.linalg.norm(turn)
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) / angle * turn)]) if angle > 0 else np.array([1.0, 0.0, 0.0, 0.0])


def nearer(orientation: np.ndarray, to: np.ndarray) -> np.ndarray:
    """Of the two quaternions (..., 4) that mean an orientation, q and -q, the one nearer to another quaternion."""
    return np.where((orientation * to).sum(axis=-1, keepdims=True) < 0, -orientation, orientation)


def between_directions(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Shortest rotation vector (3,) [rad] from one direction (3,) of any length to another; zero for opposite ones."""
    a, b = first / np.linalg.norm(first), last / np.linalg.norm(last)
    axis = np.cross(a, b)
    sine = np.linalg.norm(axis)
    return axis / sine * np.arctan2(sine, a @ b) if sine > 0 else np.zeros(3)


def between_orientations(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Shortest rotation vector (3,) [rad], world frame, from one orientation (w, x, y, z) of any length to another."""
    (w1, *v1), (w2, *v2) = first / np.linalg.norm(first), last / np.linalg.norm(last)
    v1, v2 = np.array(v1), np.array(v2)
    w, v = w2 * w1 + v2 @ v1, w1 * v2 - w2 * v1 - np.cross(v2, v1)  # last times the conjugate of first
    sine = np.linalg.norm(v)
    return np.sign(w or 1) * v / sine * 2 * np.arctan2(sine, abs(w)) if sine > 0 else np.zeros(3)
