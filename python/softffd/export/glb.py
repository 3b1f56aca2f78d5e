"""GLB: the mesh with its looks, its rigid motion as the animation of a node, the remainder as morph targets (modes.py); the obstacles.

softffd         turns +z, which is up, into glTF's +y
  object        translation and rotation at every row
    window 1    mesh of at most eight targets, weights at every row of the window; while another window is shown, the node's scale
    window 2    is 0, by which glTF hides a node
  NAME          of an obstacle, translation and rotation where it moves
"""

import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from softffd.embedding.deform import Embedding
from softffd.errors import SoftffdError
from softffd.export.modes import Motion, motion_of
from softffd.export.take import CLEAR, Rigid, Take
from softffd.mesh.bodies import quiet_trimesh
from softffd.mesh.gltf import glb_file
from softffd.mesh.looks import Looks, Material, to_light
from softffd.mesh.mesh import Mesh
from softffd.mesh.written import glb_bodies, glb_tree
from softffd.rotation import quaternions
from softffd.show.skin import PAINT

LARGEST = 2e9
"""Largest size of the targets [bytes]; a GLB file has at most twice as many bytes in all"""
BEHIND = 1e-3
"""How far planes are moved back, as a fraction of their side: viewers show coinciding surfaces as noise"""
Z_UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
"""The rotation (x, y, z, w) that turns +z into +y"""


def write(take: Take, path: Path) -> None:
    """Writes the file, and reports the largest error of a vertex at a row. Raises SoftffdError if this error is above the take's
    tolerance, or if the shapes are too large for a file."""
    stage, side = take.stage, float(take.stage.size.max())
    take.note("finding shapes")
    points = stage.positions[take.rows].reshape(len(take.rows), -1, 3)
    motion = motion_of(points, stage.rest.reshape(-1, 3), 0.99 * take.tolerance * side)
    mesh = _dressed(take.mesh)
    windows, counts = len(motion.windows), [len(window.shapes) for window in motion.windows]
    if 12.0 * sum(counts) * len(mesh.vertices) > LARGEST:
        raise SoftffdError(
            f"export to glb: {sum(counts)} shapes of {len(mesh.vertices):,} vertices are more than a file holds; wanted a larger tolerance "
            f"than {take.tolerance:g} (--tolerance), fewer rows (--frames), or vtkhdf or usd, which have no shapes"
        )
    take.note("deforming the mesh by the shapes")
    embedding = Embedding(mesh.vertices, stage.origin, stage.size, stage.counts, stage.basis)
    shapes = [embedding.deform(window.shapes.reshape(-1, *stage.counts, 3)) for window in motion.windows]
    for each in shapes:
        each[0] += mesh.vertices - motion.centre
    shapes = [each.astype(np.float32) for each in shapes]
    error = _error(take, motion, shapes)
    take.require_within("glb", error)
    file = _File(mesh, shapes, take)
    file.animate(take, motion, shapes)
    file.tree["asset"]["extras"] = {
        "largest_error_m": error, "largest_error_of_box": error / side, "tolerance_of_box": take.tolerance, "windows": windows,
        "rows": len(take.rows), "start_time_s": take.time[0], "title": stage.title,
    }  # fmt: skip
    path.write_bytes(file.packed())
    most = max(counts) - 1
    parts = f"{windows} windows of at most {most} shapes" if windows > 1 else f"{most} shape{'s' * (most != 1)}"
    take.say(f"rigid motion and {parts}; largest error {error:.2g} m, {error / side:.2g} of the box, as in asset.extras")


def _dressed(mesh: Mesh) -> Mesh:
    """Returns the mesh in one piece, with a colour if it has none."""
    looks = replace(mesh.looks, groups=(), group_of=None)
    if not looks.materials and looks.colours is None:
        looks = Looks((Material("object", PAINT),), np.zeros(len(mesh.faces), dtype=np.int64))
    return replace(mesh, looks=looks)


def _error(take: Take, motion: Motion, shapes: list[np.ndarray]) -> float:
    """Returns the largest distance [m], over all rows, of a vertex in the file's numbers from its true place. shapes: (1 + K, V, 3)."""
    means, turns = motion.means.astype(np.float32), motion.turns.astype(np.float32).astype(float)
    worst, windows = 0.0, iter(zip(motion.windows, shapes, strict=True))
    window, (base, *targets) = next(windows)
    for number, row in take.told_rows("comparing row"):
        if number > window.last:
            window, (base, *targets) = next(windows)
        weights = window.weights[number - window.first].astype(np.float32).tolist()
        local = base.astype(float) + sum(weight * target for weight, target in zip(weights, targets, strict=True))
        worst = max(worst, float(np.linalg.norm(means[number] + local @ turns[number] - take.deformed(row), axis=1).max()))
    return worst


class _File:
    """The tree of a GLB file and its data: what trimesh writes of the meshes, and what is added to that."""

    def __init__(self, mesh: Mesh, shapes: list[np.ndarray], take: Take):
        with quiet_trimesh():
            windows = [list(glb_bodies(mesh, each[0].astype(float))) for each in shapes]
        bodies = [*map(_body, take.obstacles), *(body for window in windows for _, _, body in window)]
        self.tree, data = glb_tree(bodies)
        self._data, self._length = [data[8:]], len(data) - 8
        meshes = iter(self.tree["meshes"][len(take.obstacles) :])
        self._own = [[(next(meshes)["primitives"][0], used) for _, used, _ in window] for window in windows]
        self.tree["meshes"] = self.tree["meshes"][: len(take.obstacles)]
        self.tree["asset"]["generator"] = "softffd"

    def animate(self, take: Take, motion: Motion, shapes: list[np.ndarray]) -> None:
        """Adds the nodes, with the shapes (1 + K, V, 3) of each window, and their animation."""
        self._time = (take.time - take.time[0]).astype(np.float32)
        self._channels: list[dict[str, Any]] = []
        self._samplers: list[dict[str, Any]] = []
        self._inputs: dict[bytes, int] = {}
        self.tree["nodes"] = [{"name": "softffd", "rotation": Z_UP, "children": []}]
        for number, obstacle in enumerate(take.obstacles):
            node = self._node(0, {"name": obstacle.name, "mesh": number})
            rows = take.rows if obstacle.moves else take.rows[:1]
            self._pose(node, obstacle.points[rows], obstacle.axes[rows])
        whole = self._node(0, {"name": "object"})
        self._pose(whole, motion.means, motion.turns)
        for number, (window, (_, *targets), own) in enumerate(zip(motion.windows, shapes, self._own, strict=True)):
            node = self._node(whole, {"name": f"window {number + 1}", "mesh": len(self.tree["meshes"])})
            primitives = [self._primitive(each, [target[used] for target in targets]) for each, used in own]
            self.tree["meshes"].append({"name": f"window {number + 1}", "primitives": primitives})
            if targets:
                self.tree["nodes"][node]["weights"] = window.weights[0].tolist()
                self._channel(node, "weights", window.weights.reshape(-1), slice(window.first, window.last + 1))
            if len(motion.windows) > 1:
                self._show(node, window.first, window.last)
        if len(take.rows) > 1:
            self.tree["animations"] = [{"name": take.stage.title, "channels": self._channels, "samplers": self._samplers}]
        self.tree["scenes"], self.tree["scene"] = [{"nodes": [0]}], 0

    def _node(self, parent: int, node: dict[str, Any]) -> int:
        self.tree["nodes"].append(node)
        self.tree["nodes"][parent].setdefault("children", []).append(len(self.tree["nodes"]) - 1)
        return len(self.tree["nodes"]) - 1

    def _pose(self, node: int, points: np.ndarray, axes: np.ndarray) -> None:
        """Sets a node's pose, with axes as rows (R, 3, 3), and for several rows the node's animation."""
        turns = np.roll(quaternions(axes.transpose(0, 2, 1)), -1, axis=1)
        self.tree["nodes"][node] |= {"translation": points[0].tolist(), "rotation": turns[0].tolist()}
        if len(points) > 1:
            self._channel(node, "translation", points)
            self._channel(node, "rotation", turns)

    def _show(self, node: int, first: int, last: int) -> None:
        """Shows a window's node from the window's first row until the next window's first row."""
        keys = {0: 0.0} | {first: 1.0} | ({last: 0.0} if last < len(self._time) - 1 else {})
        self.tree["nodes"][node]["scale"] = [keys[0]] * 3
        self._channel(node, "scale", np.array([[key] * 3 for key in keys.values()]), list(keys), "STEP")

    def _channel(self, node: int, what: str, values: np.ndarray, at: Any = slice(None), way: str = "LINEAR") -> None:
        time = self._time[at]
        if time.tobytes() not in self._inputs:
            self._inputs[time.tobytes()] = self._accessor(time)
        sampler = {"input": self._inputs[time.tobytes()], "output": self._accessor(values), "interpolation": way}
        self._channels.append({"sampler": len(self._samplers), "target": {"node": node, "path": what}})
        self._samplers.append(sampler)

    def _primitive(self, own: dict[str, Any], targets: list[np.ndarray]) -> dict[str, Any]:
        return own | ({"targets": [{"POSITION": self._accessor(target)} for target in targets]} if targets else {})

    def _accessor(self, values: np.ndarray) -> int:
        """Adds numbers (N,) or (N, c), in single precision, with their bounds; returns the accessor's number."""
        values = np.ascontiguousarray(values, dtype="<f4")
        self.tree["bufferViews"].append({"buffer": 0, "byteOffset": self._length, "byteLength": values.nbytes})
        self._data.append(values.tobytes())
        self._length += values.nbytes
        kind = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[values.size // len(values)]
        bounds = {name: np.atleast_1d(found).tolist() for name, found in (("min", values.min(axis=0)), ("max", values.max(axis=0)))}
        accessor = {"bufferView": len(self.tree["bufferViews"]) - 1, "componentType": 5126, "count": len(values), "type": kind}
        self.tree["accessors"].append(accessor | bounds)
        return len(self.tree["accessors"]) - 1

    def packed(self) -> bytes:
        self.tree["buffers"] = [{"byteLength": self._length}]
        return glb_file(self.tree, b"".join([struct.pack("<I4s", self._length, b"BIN\0"), *self._data]))


def _body(obstacle: Rigid) -> Any:
    """Returns trimesh's body of an obstacle, along the obstacle's own axes."""
    import trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    clear, flat = obstacle.kind == "plane", obstacle.kind != "solid"
    factor = np.append(to_light(np.array(obstacle.tint)), CLEAR if clear else 1.0)
    mode = "BLEND" if clear else "OPAQUE"
    material = PBRMaterial(obstacle.name, baseColorFactor=factor, alphaMode=mode, doubleSided=clear, metallicFactor=0.0)
    vertices = obstacle.vertices - obstacle.normals * (BEHIND * np.ptp(obstacle.vertices, axis=0).max() if flat else 0.0)
    visual = TextureVisuals(material=material)
    return trimesh.Trimesh(vertices, obstacle.faces, vertex_normals=obstacle.normals, visual=visual, process=False)
