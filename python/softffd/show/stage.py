"""What there is to see of a run: the object's surface, its lattice over time, the obstacles, and which way is up."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from softffd.embedding.deform import Embedding
from softffd.errors import SoftffdError
from softffd.lattice import index_grid, rest_grid
from softffd.names import vector_names
from softffd.rotation import between_directions, turned
from softffd.scene.sections import PLANE_POSE
from softffd.show.skin import Skin, painted, skinned
from softffd.show.solid import SolidTrack, solid_surface
from softffd.show.surface import cage_surface

FREE, PINNED = (0.90, 0.42, 0.05), (0.10, 0.10, 0.12)
OBSTACLES = ((0.63, 0.67, 0.73), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65), (0.0, 0.62, 0.45), (0.90, 0.62, 0.0))
"""Colours that remain apart for the colour-blind, and from the object's paint: its control points, the planes in turn."""

VIEW = (-1.0, 0.27)
"""From where one looks first, rad: about the up direction, and above the horizon."""


@dataclass(frozen=True, eq=False)
class PlaneTrack:
    """An obstacle plane over time.

    `points` (T, 3) [m], unit `normals` (T, 3) and, in the plane, unit `tangents` (T, 3); `tint` its colour. `is_floor`:
    one could stand on it all the time; it is drawn as a floor without an edge, which hides what is below, and
    every other plane as a plate as large as the scene.
    """

    name: str
    tint: tuple[float, float, float]
    is_floor: bool
    points: np.ndarray
    normals: np.ndarray
    tangents: np.ndarray


@dataclass(frozen=True, eq=False)
class Stage:
    """A run as pictures see it.

    `time` (T,) [s]; `positions` (T, nx, ny, nz, 3) [m], all finite. `origin`, `size` (3,) [m]: the box in which the
    surface is embedded; `basis`: "bezier" or "bspline". `vertices` (V, 3) [m] and `faces` (F, 3): the surface at rest;
    `skin`: its colours. `is_cage`: the surface is the boundary of the volume itself.
    `pinned`: flat indices of attached control points. `up` (3,): unit. `centre`, `half` (3,) [m]: middle and half the
    sides of the box of all that the lattice ever covers.
    """

    title: str
    time: np.ndarray
    positions: np.ndarray
    origin: np.ndarray
    size: np.ndarray
    basis: str
    vertices: np.ndarray
    faces: np.ndarray
    skin: Skin
    is_cage: bool
    planes: tuple[PlaneTrack, ...]
    solids: tuple[SolidTrack, ...]
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
        return rest_grid(self.counts, self.origin, self.size)

    @cached_property
    def edges(self):
        """Neighbours along the axes, (E, 2) flat indices: the lines of the lattice."""
        index = index_grid(self.counts).T
        pairs = [(index[:, :, :-1], index[:, :, 1:]), (index[:, :-1], index[:, 1:]), (index[:-1], index[1:])]
        return np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in pairs])

    @cached_property
    def _embedding(self):
        return Embedding(self.vertices, self.origin, self.size, self.counts, self.basis)

    def deformed(self, positions):
        """The surface's vertices (V, 3) [m] for control points (nx, ny, nz, 3) [m]."""
        return self._embedding.deform(positions)


def stage_of(result, *, mesh=None, origin=None, size=None):
    """The stage of a `Result` with `mesh` as its object, or without one the boundary of the volume.

    origin, size: the box (3,) [m]; by default the lattice's, else the mesh's bounds, else those of the first frame.
    Raises SoftffdError when positions of control points were not recorded.
    """
    positions = _recorded(result)
    origin, size = _box(result, mesh, origin, size)
    if mesh is not None:
        vertices, faces, skin = skinned(mesh)
    else:
        vertices, faces = cage_surface(origin, size, divisions=_divisions(positions))
        skin = painted(vertices, faces)
    up = up_direction(result.scene)
    low, high = positions.min(axis=(0, 1, 2, 3)), positions.max(axis=(0, 1, 2, 3))
    planes, solids = _obstacles(result, up, float(np.linalg.norm(high - low)) / 2)
    return Stage(
        title=result.title,
        time=np.asarray(result.time, dtype=float),
        positions=positions,
        origin=origin,
        size=size,
        basis="bezier" if result.lattice is None else result.lattice.basis,
        vertices=np.asarray(vertices, dtype=float),
        faces=np.asarray(faces, dtype=np.int64),
        skin=skin,
        is_cage=mesh is None,
        planes=planes,
        solids=solids,
        pinned=_pinned(result.scene),
        up=up,
        centre=(low + high) / 2,
        half=(high - low) / 2,
    )


def _obstacles(result, up, radius):
    """Tracks of planes and of solids; without its scene a run tells of planes alone. radius: of the scene [m]."""
    known = {} if result.scene is None else {solid.name: solid for solid in result.scene.solids}
    planes, solids = [], []
    for number, name in enumerate(result.plane_names()):
        tint, pose = OBSTACLES[number % len(OBSTACLES)], _pose(*result.plane(name))
        if name in known:
            kind, keys = type(known[name]).__name__.lower(), known[name].model_dump()
            if kind == "box":
                pose = *pose[:2], _first_axes(result, known[name], pose[1])
            solids.append(SolidTrack(name, tint, kind, keys, *solid_surface(kind, keys, radius), *pose))
        else:
            planes.append(PlaneTrack(name, tint, bool((pose[1] @ up > 0.7).all()), *pose))
    return tuple(planes), tuple(solids)


def up_direction(scene):
    """Unit vector (3,) against gravity; +z without a scene or without gravity."""
    gravity = None if scene is None else scene.environment.gravity
    pull = 0.0 if gravity is None else np.linalg.norm(gravity)
    return np.array([0.0, 0.0, 1.0]) if pull == 0 else -np.asarray(gravity, float) / pull


def _divisions(positions):
    """Squares along each edge of the drawn box: several to a cell, so that its bends look round."""
    return max(24, 3 * (max(positions.shape[1:4]) - 1))


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
    if result.lattice is not None:
        low, extent = result.lattice.origin, result.lattice.size
    elif mesh is not None:
        low, extent = mesh.bounds[0], mesh.bounds[1] - mesh.bounds[0]
    else:
        low = result.positions[0].min(axis=(0, 1, 2))
        extent = result.positions[0].max(axis=(0, 1, 2)) - low
    return np.array(low if origin is None else origin, float), np.array(extent if size is None else size, float)


def _first_axes(result, box, normals):
    """Of a box (T, 3): it turns with its angular velocity from the start on, or as its third axis is given."""
    spin = vector_names("plane_angular_velocity", box.name)
    if any(key in result.inputs for what in PLANE_POSE for key in vector_names(f"plane_{what}", box.name)):
        turns = np.stack([between_directions(np.array(box.normal), normal) for normal in normals])
    else:
        turns = np.multiply.outer(result.time - result.time[0], [result.parameters[key] for key in spin])
    return turned(np.broadcast_to(box.across, normals.shape), turns)


def _pose(points, normals):
    """Points [m], unit normals and tangents, (T, 3) each; these follow one world axis through the run, that which the normal comes least
    close to."""
    normals = _unit(normals)
    axis, spare = np.eye(3)[np.abs(normals).max(axis=0).argsort()[:2]]
    axes = np.where(np.abs(normals @ axis)[:, None] < 0.999, axis, spare)
    tangents = axes - normals * np.einsum("ta,ta->t", normals, axes)[:, None]
    return np.asarray(points, dtype=float), normals, _unit(tangents)


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _pinned(scene):
    if scene is None or not scene.pin:
        return np.zeros(0, dtype=np.int64)
    return np.unique(np.concatenate([scene.select(pin.points) for pin in scene.pin]))


def round_length(length):
    """The largest of 1, 2, 5, 10, ... [m] not above `length`: a spacing for grids."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(f * power for f in (1, 2, 5) if f * power <= length * (1 + 1e-9)))
