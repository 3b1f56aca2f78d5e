"""What exported files must have, and readers of them that know nothing of how they were written: places of vertices over time."""

import json
import struct
from pathlib import Path

import numpy as np

from softffd import Result
from softffd.show.stage import stage_of


def surface(result: Result, row: int) -> np.ndarray:
    """Vertices of what is exported (V, 3) [m] at a row."""
    return result.deformed(result.loaded_mesh or stage_of(result).vertices, row=row)


def solids(result: Result, row: int) -> dict[str, np.ndarray]:
    """Places of the vertices of solid obstacles by name, as the result has their poses."""
    return {solid.name: solid.surface(row)[0] for solid in stage_of(result).solids}


def planes(result: Result, row: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Point and normal of planes by name."""
    poses = {part.name: result.plane(part.name) for part in result.obstacle_parts() if part.kind == "plane"}
    return {name: (points[row], normals[row] / np.linalg.norm(normals[row])) for name, (points, normals) in poses.items()}


def single(places: np.ndarray) -> float:
    """What single precision leaves of places [m]."""
    return 2e-7 * np.abs(places).max()


def read_pc2(path: Path) -> tuple[np.ndarray, float, float]:
    """Places (R, V, 3) [m], first frame, frames to a sample."""
    data = path.read_bytes()
    mark, version, vertices, start, rate, samples = struct.unpack("<12siiffi", data[:32])
    assert (mark, version) == (b"POINTCACHE2\0", 1) and len(data) == 32 + 12 * vertices * samples
    return np.frombuffer(data, "<f4", offset=32).reshape(samples, vertices, 3), start, rate


class Glb:
    """A GLB file, evaluated as the standard of glTF 2.0 says: nodes, their animation, morph targets."""

    def __init__(self, path: Path):
        data = path.read_bytes()
        mark, version, length, size, kind = struct.unpack("<4sIII4s", data[:20])
        assert (mark, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
        self.tree = json.loads(data[20 : 20 + size])
        length, kind = struct.unpack("<I4s", data[20 + size : 28 + size])
        self.data = data[28 + size :]
        assert kind == b"BIN\0" and length == len(self.data) == self.tree["buffers"][0]["byteLength"]
        (animation,) = self.tree["animations"]
        samplers = [(self.array(s["input"]), self.array(s["output"]), s["interpolation"]) for s in animation["samplers"]]
        channels = [(channel["target"]["node"], channel["target"]["path"], channel["sampler"]) for channel in animation["channels"]]
        assert len({each[:2] for each in channels}) == len(channels)
        self.curves = {(node, what): samplers[number] for node, what, number in channels}
        self.time = max((times for times, _, _ in samplers), key=len)

    def array(self, number: int) -> np.ndarray:
        """Of an accessor, as its bounds have it where it has some."""
        accessor = self.tree["accessors"][number]
        view = self.tree["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4", 5123: "<u2", 5121: "u1"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        values = np.frombuffer(self.data, kind, accessor["count"] * width, start).reshape(-1, width)
        assert values.nbytes <= view["byteLength"] and start % 4 == 0
        for name, found in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
            assert name not in accessor or np.allclose(accessor[name], found, rtol=1e-6)
        return values if width > 1 else values[:, 0]

    def at(self, time: float) -> dict[str, np.ndarray]:
        """Places (V, 3) [m], z up, of all that is shown, by the name of its node, of windows of "object"."""
        return dict(self._below(self.tree["scenes"][0]["nodes"][0], np.eye(4), time, ""))

    def _below(self, number: int, above: np.ndarray, time: float, name: str):
        node = self.tree["nodes"][number]
        here = above @ self._matrix(number, time)
        name = name or (node["name"] if number else "")
        if "mesh" in node and np.linalg.det(here[:3, :3]) > 0.5:
            shape = self._shape(number, time)
            yield name, (here[:3, :3] @ shape.T + here[:3, 3:]).T[:, [0, 2, 1]] * [1, -1, 1]
        for child in node.get("children", []):
            yield from self._below(child, here, time, name)

    def _matrix(self, number: int, time: float) -> np.ndarray:
        moved, turn, scale = (self._value(number, what, time) for what in ("translation", "rotation", "scale"))
        x, y, z, w = [0, 0, 0, 1] if turn is None else turn / np.linalg.norm(turn)
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        matrix = np.eye(4)
        matrix[:3, :3] = (np.eye(3) + 2 * w * cross + 2 * cross @ cross) * (1 if scale is None else scale)
        matrix[:3, 3] = 0 if moved is None else moved
        return matrix

    def _shape(self, number: int, time: float) -> np.ndarray:
        primitives = self.tree["meshes"][self.tree["nodes"][number]["mesh"]]["primitives"]
        weights, shapes = self._value(number, "weights", time), []
        for primitive in primitives:
            shape = self.array(primitive["attributes"]["POSITION"]).astype(float)
            targets = [self.array(target["POSITION"]) for target in primitive.get("targets", [])]
            assert weights is None or (weights.min() >= 0 and weights.max() <= 1)  # outside of that Blender takes the nearer end
            assert len(targets) <= 8 and len(targets) == (0 if weights is None else len(weights))
            shapes.append(shape + (np.tensordot(weights, targets, 1) if targets else 0.0))
        return np.concatenate(shapes)

    def _value(self, number: int, what: str, time: float) -> np.ndarray | None:
        if (number, what) not in self.curves:
            value = self.tree["nodes"][number].get(what)
            return None if value is None else np.array(value)
        times, values, way = self.curves[number, what]
        values = values.reshape(len(times), -1).astype(float)
        assert (np.diff(times) > 0).all() and way in ("LINEAR", "STEP")
        if way == "STEP":
            return values[max(0, np.searchsorted(times, time, side="right") - 1)]
        return np.array([np.interp(time, times, column) for column in values.T])
