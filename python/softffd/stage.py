"""What there is to see of a run: the object's surface, its lattice over time, the obstacles, and which way is up."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from softffd.deform import Embedding
from softffd.errors import SoftffdError
from softffd.surface import cage_surface


@dataclass(frozen=True, eq=False)
class PlaneTrack:
    """An obstacle plane over time: `points` (T, 3) [m], unit `normals` (T, 3) and, in the plane, unit `tangents` (T, 3)."""

    name: str
    points: np.ndarray
    normals: np.ndarray
    tangents: np.ndarray


@dataclass(frozen=True, eq=False)
class Stage:
    """A run as pictures see it.

    `time` (T,) [s]; `positions` (T, nx, ny, nz, 3) [m], all finite; `origin`, `size` (3,) [m] of the box in which the surface
    is embedded; `vertices` (V, 3) [m] and `faces` (F, 3) of the surface at rest; `is_cage`: the surface is the boundary of the
    volume itself; `pinned` flat indices of attached control points; `up` (3,) unit; `centre` and `half` (3,) [m]:
    middle and half the sides of the box of all that the lattice ever covers.
    """

    title: str
    time: np.ndarray
    positions: np.ndarray
    origin: np.ndarray
    size: np.ndarray
    vertices: np.ndarray
    faces: np.ndarray
    is_cage: bool
    planes: tuple[PlaneTrack, ...]
    pinned: np.ndarray
    up: np.ndarray
    centre: np.ndarray
    half: np.ndarray

    @property
    def counts(self):
        return self.positions.shape[1:4]

    @property
    def radius(self):
        """Half the diagonal of the box of all that the lattice ever covers, m."""
        return float(np.linalg.norm(self.half))

    @cached_property
    def rest(self):
        """The undeformed lattice, (nx, ny, nz, 3) [m]."""
        axes = [np.linspace(0.0, 1.0, n) for n in self.counts]
        return self.origin + self.size * np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    @cached_property
    def edges(self):
        """Neighbours along the axes, (E, 2) flat indices: the lines of the lattice."""
        nx, ny, nz = self.counts
        index = np.arange(nx * ny * nz).reshape(nz, ny, nx)
        pairs = [(index[:, :, :-1], index[:, :, 1:]), (index[:, :-1], index[:, 1:]), (index[:-1], index[1:])]
        return np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in pairs])

    @cached_property
    def _embedding(self):
        return Embedding(self.vertices, self.origin, self.size, self.counts)

    def deformed(self, positions):
        """The surface's vertices (V, 3) [m] for control points (nx, ny, nz, 3) [m]."""
        return self._embedding.deform(positions)


def stage_of(result, *, mesh=None, origin=None, size=None):
    """The stage of a `Result`; `mesh`, `origin`, `size` as in `softffd.deform.deform`, without a mesh the volume's boundary.

    The box is, in this order: the one given, the scene's, the mesh's bounds, the bounds of the first frame.
    Raises SoftffdError when positions of control points were not recorded.
    """
    positions = _recorded(result)
    origin, size = _box(result, mesh, origin, size)
    vertices, faces = (mesh.vertices, mesh.faces) if mesh is not None else cage_surface(origin, size)
    low, high = positions.min(axis=(0, 1, 2, 3)), positions.max(axis=(0, 1, 2, 3))
    return Stage(
        title=result.scene.title if result.scene is not None else result.summary.get("title", ""),
        time=np.asarray(result.time, dtype=float), positions=positions, origin=origin, size=size,
        vertices=np.asarray(vertices, dtype=float), faces=np.asarray(faces, dtype=np.int64), is_cage=mesh is None,
        planes=tuple(_track(name, *result.plane(name)) for name in result.plane_names()),
        pinned=_pinned(result.scene), up=_up(result.scene),
        centre=(low + high) / 2, half=(high - low) / 2,
    )  # fmt: skip


def _recorded(result):
    positions = np.asarray(result.positions, dtype=float)
    missing = np.isnan(positions).any(axis=(0, 4)) if len(positions) else np.ones(positions.shape[1:4], dtype=bool)
    if missing.any():
        raise SoftffdError(
            f"The run cannot be shown: the positions of {missing.sum()} of its {missing.size} control points were not "
            'recorded. Wanted: a scene with outputs.positions = "all".'
        )
    return positions


def _box(result, mesh, origin, size):
    scene = result.scene
    if scene is not None:
        low, extent = scene.lattice.origin, scene.lattice.size
    elif mesh is not None:
        low, extent = mesh.bounds[0], mesh.bounds[1] - mesh.bounds[0]
    else:
        low = result.positions[0].min(axis=(0, 1, 2))
        extent = result.positions[0].max(axis=(0, 1, 2)) - low
    return np.array(low if origin is None else origin, float), np.array(extent if size is None else size, float)


def _track(name, points, normals):
    """The tangents follow one world axis through the run, the one that the normal comes least close to."""
    normals = _unit(normals)
    axis, spare = np.eye(3)[np.abs(normals).max(axis=0).argsort()[:2]]
    axes = np.where(np.abs(normals @ axis)[:, None] < 0.999, axis, spare)
    tangents = axes - normals * np.einsum("ta,ta->t", normals, axes)[:, None]
    return PlaneTrack(name, np.asarray(points, dtype=float), normals, _unit(tangents))


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _pinned(scene):
    if scene is None or not scene.pin:
        return np.zeros(0, dtype=np.int64)
    return np.unique(np.concatenate([scene.select(pin.points) for pin in scene.pin]))


def _up(scene):
    gravity = None if scene is None else scene.environment.gravity
    pull = 0.0 if gravity is None else np.linalg.norm(gravity)
    return np.array([0.0, 0.0, 1.0]) if pull == 0 else -np.asarray(gravity, float) / pull


def round_length(length):
    """The largest of 1, 2, 5, 10, ... [m] not above `length`: a spacing for grids."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(f * power for f in (1, 2, 5) if f * power <= length * (1 + 1e-9)))
