"""What tests read from a run: points in flat order, vectors, velocities, energies, gaps to the obstacles; and from errors their order."""

from __future__ import annotations

import numpy as np

from softffd import Result
from softffd.lattice import all_points, to_flat
from softffd.names import variable_names, vector_names
from softffd.rotation import turned
from validation.shapes import gap


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


def imbalance(result: Result) -> np.ndarray:
    """What the energies have gained out of nothing since the start (T,) [J]; the scene has outputs.energy."""
    kept = [name for name in ("kinetic", "elastic", "gravity", "dissipated") if f"energy.{name}" in result.outputs]
    total = sum(result.outputs[f"energy.{name}"] for name in kept) - result.outputs["energy.work"]
    return total - total[0]


def orders(errors) -> np.ndarray:
    """Observed between neighbours of a row of errors, each at half the step of the one before."""
    return np.log2(np.array(errors[:-1]) / errors[1:])


def plane_poses(result: Result, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Points (T, 3) [m] and unit normals (T, 3) of an obstacle where its motion has taken it at each communication point.

    An input plane is where the motion given one step before has taken it: an input set at a communication point acts afterwards.
    """

    fixed = f"plane.{name}.point.x" in result.parameters
    rows = np.zeros(len(result.time), int) if fixed else np.maximum(np.arange(len(result.time)) - 1, 0)
    age = (result.time - result.time[rows])[:, None]

    def given(what: str) -> np.ndarray:
        columns = [result.inputs.get(key, result.parameters.get(key)) for key in vector_names(f"plane_{what}", name)]
        return np.stack([np.broadcast_to(column, len(rows))[rows] for column in columns], axis=1)

    normals = given("normal")
    places = given("point") + age * given("velocity")
    return places, turned(normals, age * given("angular_velocity")) / np.linalg.norm(normals, axis=1, keepdims=True)


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


def deepest(result: Result, name: str) -> float:
    """How far a vertex of the mesh is ever behind a plane or inside a solid [m]; below 0: how near it comes."""
    kind = next(part.kind for part in result.obstacle_parts() if part.name == name)
    keys = next(each for each in getattr(result.scene, kind) if each.name == name).model_dump()
    points, axes = result.plane(name)
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    across = result.edges(name)[..., 0] if kind == "box" else axes
    return -min(gap(kind, keys, *each).min() for each in zip(result.deformed(row=slice(None)), points, axes, across, strict=True))
