"""What tests read from a run: points in flat order, vectors, velocities, gaps to the obstacles."""

from __future__ import annotations

import numpy as np

from softffd import Result
from softffd.lattice import all_points, to_flat
from softffd.names import variable_names, vector_names
from softffd.rotation import turned


def points(result: Result) -> np.ndarray:
    """Positions (T, n, 3) [m] in flat order, p = i + nx (j + ny k)."""
    return to_flat(result.positions)


def velocities(result: Result) -> np.ndarray:
    """Velocities (T, n, 3) [m/s] in flat order; the scene has outputs.velocities = "all"."""
    columns = [result.outputs[name] for name in variable_names("velocity", all_points(result.scene.lattice.points))]
    return np.stack(columns, axis=1).reshape(len(result.time), -1, 3)


def vector(result: Result, name: str) -> np.ndarray:
    """The components .x .y .z of an output (T, 3)."""
    return np.stack([result.outputs[f"{name}.{axis}"] for axis in "xyz"], axis=1)


def centre(values: np.ndarray) -> np.ndarray:
    """The mean over points of equal mass: (T, n, 3) to (T, 3)."""
    return values.mean(axis=1)


def plane_poses(result: Result, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Points (T, 3) [m] and unit normals (T, 3) of an obstacle where its motion has taken it at each communication point.

    An input plane is where the motion given one step before has taken it: an input set at a communication point acts afterwards.
    """

    def given(what: str, row: int) -> np.ndarray:
        names = vector_names(f"plane_{what}", name)
        return np.array([result.inputs[key][row] if key in result.inputs else result.parameters[key] for key in names])

    fixed = f"plane.{name}.point.x" in result.parameters
    places, normals = [], []
    for row, time in enumerate(result.time):
        base = 0 if fixed else max(row - 1, 0)
        age = time - result.time[base]
        normal = given("normal", base)
        places.append(given("point", base) + age * given("velocity", base))
        normals.append(turned(normal, age * given("angular_velocity", base)) / np.linalg.norm(normal))
    return np.array(places), np.array(normals)


def gaps(result: Result, name: str) -> np.ndarray:
    """Distances (T, n) [m] of the control points from an obstacle plane; negative: behind it."""
    places, normals = plane_poses(result, name)
    return np.einsum("tnc,tc->tn", points(result) - places[:, None], normals)


def assert_nothing_is_behind(result: Result) -> None:
    """No control point is behind any plane at any communication point.

    1e-12 of the box and of the distances at hand: some rounding errors of a gap that is computed anew.
    """
    reach = max(np.abs(points(result)).max(), max(result.scene.lattice.size))
    assert result.plane_names(), "wanted a run with obstacles"
    for name in result.plane_names():
        worst = gaps(result, name).min()
        assert worst >= -1e-12 * reach, f"a control point is {-worst:.3g} m behind plane {name}"
