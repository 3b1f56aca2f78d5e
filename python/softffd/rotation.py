"""Rotations: right-handed rotation vectors along the axis [rad], and rotations from one direction or orientation to another."""

import numpy as np


def turned(vectors: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Returns vectors (..., 3) rotated by rotation vectors (..., 3) [rad] (Rodrigues)."""
    angle = np.linalg.norm(turns, axis=-1, keepdims=True)
    axis = np.divide(turns, angle, out=np.zeros_like(turns), where=angle > 0)
    along = (axis * vectors).sum(axis=-1, keepdims=True) * axis
    return along + np.cos(angle) * (vectors - along) + np.sin(angle) * np.cross(axis, vectors)


def quaternion(turn: np.ndarray) -> np.ndarray:
    """Returns the unit quaternion (w, x, y, z) of a rotation vector (3,) [rad]."""
    angle = np.linalg.norm(turn)
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) / angle * turn)]) if angle > 0 else np.array([1.0, 0.0, 0.0, 0.0])


def quaternions(turns: np.ndarray) -> np.ndarray:
    """Returns the unit quaternions (T, 4) (w, x, y, z) of rotation matrices (T, 3, 3), each of the sign that is nearer to the last."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = turns.reshape(-1, 9).T
    rows = [
        [xx + yy + zz, zy - yz, xz - zx, yx - xy],
        [zy - yz, xx - yy - zz, xy + yx, xz + zx],
        [xz - zx, xy + yx, yy - xx - zz, yz + zy],
        [yx - xy, xz + zx, yz + zy, zz - xx - yy],
    ]
    found = np.linalg.eigh(np.array(rows).transpose(2, 0, 1))[1][..., -1]  # q q^T, but for the identity (Bar-Itzhack 2000)
    signs = np.where((found[1:] * found[:-1]).sum(axis=1) < 0, -1.0, 1.0)
    return found * np.cumprod(np.append(np.where(found[0, 0] < 0, -1.0, 1.0), signs))[:, None]


def nearer(orientation: np.ndarray, to: np.ndarray) -> np.ndarray:
    """Returns, of the quaternions q and -q (..., 4) of one orientation, the one that is nearer to the quaternion `to`."""
    return np.where((orientation * to).sum(axis=-1, keepdims=True) < 0, -orientation, orientation)


def _unit(vector: np.ndarray) -> np.ndarray:
    """Returns the vector with the length 1; zeros stay zeros, and the component refuses them."""
    return vector / (np.linalg.norm(vector) or 1.0)


def between_directions(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Returns the shortest rotation vector (3,) [rad] from one direction (3,) of any length to another; zero for opposite directions."""
    a, b = _unit(first), _unit(last)
    axis = np.cross(a, b)
    sine = np.linalg.norm(axis)
    return axis / sine * np.arctan2(sine, a @ b) if sine > 0 else np.zeros(3)


def between_orientations(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Returns the shortest rotation vector (3,) [rad], world frame, from one orientation (w, x, y, z) of any length to another."""
    first, last = _unit(first), _unit(last)
    w1, v1, w2, v2 = first[0], first[1:], last[0], last[1:]
    w, v = w2 * w1 + v2 @ v1, w1 * v2 - w2 * v1 - np.cross(v2, v1)  # last times the conjugate of first
    sine = np.linalg.norm(v)
    return np.sign(w or 1) * v / sine * 2 * np.arctan2(sine, abs(w)) if sine > 0 else np.zeros(3)


def matrix_of(orientation: np.ndarray) -> np.ndarray:
    """Returns the rotation matrix (3, 3) of a quaternion (w, x, y, z) of any length."""
    return turned(np.eye(3), between_orientations(np.eye(4)[0], orientation)).T


def matrices(orientations: np.ndarray) -> np.ndarray:
    """Returns the rotation matrices (T, 3, 3) of unit quaternions (T, 4) (w, x, y, z)."""
    scalar, vector = orientations[:, None, :1], orientations[:, None, 1:]
    axes = np.eye(3) + 2 * np.cross(vector, np.cross(vector, np.eye(3)) + scalar * np.eye(3))
    return axes.swapaxes(1, 2)


def vector_of(matrix: np.ndarray) -> np.ndarray:
    """Returns the shortest rotation vector (3,) [rad] of a rotation matrix (3, 3)."""
    return between_orientations(np.eye(4)[0], quaternions(matrix[None])[0])
