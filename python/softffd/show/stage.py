"""What pictures show of a run: the object's surface, its lattice over time, the obstacles, and the up direction."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from softffd.embedding.deform import Embedding
from softffd.embedding.nodes import node_positions
from softffd.errors import SoftffdError
from softffd.lattice import bounding_box, index_grid, rest_grid, to_flat
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import unit
from softffd.names import vector_names
from softffd.obstacles import SolidShape
from softffd.run.result import POSITIONS, Result
from softffd.show.raster import Tint
from softffd.show.skin import Skin, cage_surface, painted, skinned
from softffd.show.solid import Form, form_of

FREE, PINNED = (0.90, 0.42, 0.05), (0.10, 0.10, 0.12)
OBSTACLES = ((0.63, 0.67, 0.73), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65), (0.0, 0.62, 0.45), (0.90, 0.62, 0.0))
"""Colours of control points (FREE, PINNED) and of the obstacles in turn; distinct for the colour-blind, and from the object's paint."""

VIEW = (-1.0, 0.27)  # the usual view [rad]: turn about the up direction, and lift above the horizon
BESIDE, AROUND = 0.15, 1.0  # a solid, or a free body, is in view this far beside the lattice, as a fraction of the diagonal of its box
FARTHEST = 1e15  # m: farther places have no squares in single precision, in which pictures are computed
GLANCES = 50  # number of evenly chosen frames whose solids are to be in view


@dataclass(frozen=True, eq=False)
class Track:
    """An obstacle over time: `points` (T, 3) [m]; `normals` (T, 3), a plane's unit normals or a solid's third axes; `tangents` (T, 3),
    unit vectors across the normals, of a solid its first axes; `tint`, its colour."""

    name: str
    tint: Tint
    points: np.ndarray
    normals: np.ndarray
    tangents: np.ndarray

    @cached_property
    def axes(self) -> np.ndarray:
        """The obstacle's axes, unit vectors as rows (T, 3, 3)."""
        return np.stack([self.tangents, np.cross(self.normals, self.tangents), self.normals], axis=1)


@dataclass(frozen=True, eq=False)
class PlaneTrack(Track):
    """An obstacle plane over time. `is_floor`: one could stand on the plane during the whole run. A floor is drawn without an edge and
    hides what is below it; every other plane is drawn as a plate as large as the scene."""

    is_floor: bool

    def gap(self, frame: int, places: np.ndarray) -> np.ndarray:
        """Returns the distances (N,) [m] of places (N, 3) [m] from the plane in a frame, negative behind the plane."""
        return (places - self.points[frame]) @ self.normals[frame]


@dataclass(frozen=True, eq=False)
class SolidTrack(Track):
    """A solid obstacle over time; `points` are its centres. `in_view`: how far beside the lattice the solid is in view, as a fraction of
    the diagonal of the box that the lattice covers."""

    form: Form
    in_view: float = BESIDE

    def surface(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Returns the vertices (V, 3) [m] and their normals (V, 3) in a frame."""
        return self.points[frame] + self.form.vertices @ self.axes[frame], self.form.normals @ self.axes[frame]

    def gap(self, frame: int, places: np.ndarray) -> np.ndarray:
        """Returns the signed distances (N,) [m] of places (N, 3) [m] from the solid in a frame, negative inside."""
        return self.form.gap((places - self.points[frame]) @ self.axes[frame].T)


@dataclass(frozen=True, eq=False)
class Stage:
    """A run as pictures show it.

    `time` (T,) [s]; `positions` (T, nx, ny, nz, 3) [m], all finite. `origin`, `size` (3,) [m]: the box in which the surface is embedded;
    `basis`: the basis functions of the volume. `vertices` (V, 3) [m] and `faces` (F, 3): the surface at rest; `skin`: its colours.
    `is_cage`: the surface is the boundary of the volume itself. `pinned`: flat indices of pinned control points. `up` (3,): unit vector.
    `centre`, `half` (3,) [m]: middle and half sides of the box around all that the lattice ever covers and around the nearby parts of
    solids.
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
    def obstacles(self) -> tuple[PlaneTrack | SolidTrack, ...]:
        return (*self.planes, *self.solids)

    @property
    def counts(self) -> tuple[int, ...]:
        return self.positions.shape[1:4]

    @property
    def radius(self) -> float:
        """Half the diagonal [m] of the box of all there is to see."""
        return float(np.linalg.norm(self.half))

    @cached_property
    def rest(self) -> np.ndarray:
        """The undeformed lattice, (nx, ny, nz, 3) [m]."""
        return rest_grid(self.counts, self.origin, self.size)

    @cached_property
    def edges(self) -> np.ndarray:
        """The lines of the lattice: pairs of neighbours along the axes, (E, 2) flat indices."""
        index = index_grid(self.counts).T
        pairs = [(index[:, :, :-1], index[:, :, 1:]), (index[:, :-1], index[:, 1:]), (index[:-1], index[1:])]
        return np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in pairs])

    @cached_property
    def _embedding(self) -> Embedding:
        return Embedding(self.vertices, self.origin, self.size, self.counts, self.basis)

    def contact_points(self, positions: np.ndarray) -> np.ndarray:
        """Returns the lattice points (N, 3) [m] that meet obstacles, for control points (nx, ny, nz, 3) [m]: these, or a solid's nodes."""
        return to_flat(node_positions(positions) if self.basis == "patches" else positions)

    def deformed(self, positions: np.ndarray) -> np.ndarray:
        """Returns the surface's vertices (V, 3) [m] for control points (nx, ny, nz, 3) [m]."""
        return self._embedding.deform(positions)


def surface_of(result: Result, stage: Stage | None = None) -> Mesh:
    """Returns the object's surface at rest: the scene's mesh, or the box's boundary as pictures show it. stage: the result's, if known."""
    if result.loaded_mesh is not None:
        return result.loaded_mesh
    stage = stage or stage_of(result)
    return Mesh(stage.vertices, stage.faces, name="box")


def stage_of(result: Result) -> Stage:
    """Returns the stage of a `Result`. The surface is the scene's mesh, or without one the boundary of the volume; the box is the
    lattice's, or else that of the first frame. Raises SoftffdError when positions of control points were not recorded."""
    positions, mesh = _recorded(result), result.loaded_mesh
    origin, size = _box(result)
    if mesh is not None:
        vertices, faces, skin = skinned(mesh)
    else:
        several = max(24, 3 * (max(positions.shape[1:4]) - 1))  # several squares per cell, so that bends of a cell look round
        vertices, faces = cage_surface(origin, size, divisions=several)
        skin = painted(vertices, faces)
    up = up_direction(result)
    covered = np.stack([positions.min(axis=(0, 1, 2, 3)), positions.max(axis=(0, 1, 2, 3))])
    tints = {name: OBSTACLES[number % len(OBSTACLES)] for number, name in enumerate(result.plane_names())}
    shapes = result.obstacles.solids if result.obstacles else ()
    solids = tuple(_solid_track(solid, tints[solid.name], result, covered) for solid in shapes)
    frames = np.unique(np.linspace(0, len(positions) - 1, GLANCES).astype(int))
    seen = np.concatenate([covered, *(beside(covered, solid, frame) for solid in solids for frame in frames)])
    low, high = bounding_box(seen)
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
        planes=tuple(_track(name, tints[name], up, *result.plane(name)) for name in _flat(result)),
        solids=solids,
        pinned=_pinned(result),
        up=up,
        centre=(low + high) / 2,
        half=(high - low) / 2,
    )


def _flat(result: Result) -> list[str]:
    """Returns the names of plane obstacles whose normals are parameters or inputs; in other FMUs, of the parts that could be planes."""
    values = {*result.parameters, *result.inputs}
    return [part.name for part in result.obstacle_parts() if part.kind == "plane" and set(vector_names("plane_normal", part)) <= values]


def beside(covered: np.ndarray, solid: SolidTrack, frame: int) -> np.ndarray:
    """Returns the ends (2, 3) [m] of the box around what is in view of a solid in a frame. covered: the ends (2, 3) [m] of the box that
    the lattice covers, which are returned where the solid is far from that box."""
    margin = solid.in_view * np.linalg.norm(covered[1] - covered[0])
    least, most = covered[0] - margin, covered[1] + margin
    places = solid.surface(frame)[0]
    low, high = bounding_box(places)
    near = (low <= most).all() and (high >= least).all()
    return np.stack([low.clip(least, most), high.clip(least, most)]) if near else covered


def up_direction(result: Result) -> np.ndarray:
    """Returns the unit vector (3,) against gravity; +z without a scene or without gravity."""
    gravity = result.scene.environment.gravity if result.scene else None
    pull = 0.0 if gravity is None else np.linalg.norm(gravity)
    return np.array([0.0, 0.0, 1.0]) if pull == 0 else -np.asarray(gravity, float) / pull


def _recorded(result: Result) -> np.ndarray:
    positions = np.asarray(result.positions, dtype=float)
    if not np.prod(positions.shape[1:4]):
        raise SoftffdError("The run cannot be shown: its FMU has no control points. Wanted: a run of an FMU of softffd.")
    missing = np.isnan(positions).any(axis=(0, 4)) if len(positions) else np.ones(positions.shape[1:4], dtype=bool)
    if missing.any():
        raise SoftffdError(
            f"The run cannot be shown: the positions of {missing.sum()} of its {missing.size} control points were not "
            f"recorded. Wanted: a scene with {POSITIONS}."
        )
    if (farthest := np.abs(positions).max()) > FARTHEST:
        raise SoftffdError(f"The run cannot be shown: its control points go as far as {farthest:g} m. Wanted: {FARTHEST:g} m at most.")
    return positions


def _box(result: Result) -> tuple[np.ndarray, np.ndarray]:
    if result.lattice is not None:
        return np.array(result.lattice.origin, float), np.array(result.lattice.size, float)
    points = result.positions[0].reshape(-1, 3)
    low, high = bounding_box(points)
    return low, high - low


def _track(name: str, tint: Tint, up: np.ndarray, points: np.ndarray, normals: np.ndarray) -> PlaneTrack:
    normals = unit(normals)
    is_floor = bool((normals @ up > 0.7).all())
    return PlaneTrack(name, tint, np.asarray(points, dtype=float), normals, _tangents(normals), is_floor)


def _solid_track(solid: SolidShape, tint: Tint, result: Result, covered: np.ndarray) -> SolidTrack:
    """Returns the track of a solid. A sphere looks the same however it is turned, so its pole is turned towards the lattice's box."""
    form = form_of(solid, float(np.linalg.norm(covered[1] - covered[0])))
    points, normals = result.plane(solid.name)
    in_view = AROUND if result.is_free(solid.name) else BESIDE
    if solid.kind == "box":
        return SolidTrack(solid.name, tint, points, normals, result.edges(solid.name)[..., 0], form, in_view)
    if solid.kind == "sphere":
        way = covered.mean(axis=0) - points
        normals = np.where(np.any(way, axis=1, keepdims=True), way, [0.0, 0.0, 1.0])
    normals = unit(normals)
    return SolidTrack(solid.name, tint, points, normals, _tangents(normals), form, in_view)


def _tangents(normals: np.ndarray) -> np.ndarray:
    """Returns unit vectors (T, 3) across unit normals (T, 3), along one world axis throughout the run: that farthest from the normals."""
    axis, spare = np.eye(3)[np.abs(normals).max(axis=0).argsort()[:2]]
    axes = np.where(np.abs(normals @ axis)[:, None] < 0.999, axis, spare)
    return unit(axes - normals * np.einsum("ta,ta->t", normals, axes)[:, None])


def _pinned(result: Result) -> np.ndarray:
    held = [result.scene.select(pin.points) for pin in result.scene.pin] if result.scene else []
    return np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *held]))


def round_length(length: float) -> float:
    """Returns the largest of 1, 2, 5, 10, ... [m] not above `length`, a spacing for grids."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(f * power for f in (1, 2, 5) if f * power <= length * (1 + 1e-9)))
