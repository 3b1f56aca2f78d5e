"""What there is to see of a run: the object's surface, its lattice over time, the obstacles, and which way is up."""

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
from softffd.run.result import Result
from softffd.show.raster import Tint
from softffd.show.skin import Skin, cage_surface, painted, skinned
from softffd.show.solid import Form, form_of

FREE, PINNED = (0.90, 0.42, 0.05), (0.10, 0.10, 0.12)
OBSTACLES = ((0.63, 0.67, 0.73), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65), (0.0, 0.62, 0.45), (0.90, 0.62, 0.0))
"""Colours that remain apart for the colour-blind, and from the object's paint: its control points, the obstacles in turn."""

VIEW = (-1.0, 0.27)  # from where one looks first, rad: about the up direction, and above the horizon
BESIDE, AROUND = 0.15, 1.0  # how far beside the lattice a solid, or a free body, is in view, as a share of the diagonal of its box
FARTHEST = 1e15  # m: of places farther off single precision, in which pictures are made, has no squares
GLANCES = 50  # frames, evenly chosen, whose solids are to be in view


@dataclass(frozen=True, eq=False)
class Track:
    """An obstacle over time: a point (T, 3) [m], a plane's unit normal or a solid's third axis (T, 3), and across it a tangent or the
    solid's first axis (T, 3); its colour."""

    name: str
    tint: Tint
    points: np.ndarray
    normals: np.ndarray
    tangents: np.ndarray

    @cached_property
    def axes(self) -> np.ndarray:
        """Its axes, unit vectors as rows (T, 3, 3)."""
        return np.stack([self.tangents, np.cross(self.normals, self.tangents), self.normals], axis=1)


@dataclass(frozen=True, eq=False)
class PlaneTrack(Track):
    """An obstacle plane over time. `is_floor`: one could stand on it all the time; it is drawn as a floor without an edge, which hides what
    is below, and every other plane as a plate as large as the scene."""

    is_floor: bool

    def gap(self, frame: int, places: np.ndarray) -> np.ndarray:
        """Distance of places (N, 3) [m] from it in a frame, negative behind it, (N,) [m]."""
        return (places - self.points[frame]) @ self.normals[frame]


@dataclass(frozen=True, eq=False)
class SolidTrack(Track):
    """A solid obstacle over time, by its centre. `in_view`: how far beside the lattice it is to be seen, as a share of its diagonal."""

    form: Form
    in_view: float = BESIDE

    def surface(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (V, 3) [m] and their normals (V, 3) in a frame."""
        return self.points[frame] + self.form.vertices @ self.axes[frame], self.form.normals @ self.axes[frame]

    def gap(self, frame: int, places: np.ndarray) -> np.ndarray:
        """Signed distance of places (N, 3) [m] from it in a frame, negative inside, (N,) [m]."""
        return self.form.gap((places - self.points[frame]) @ self.axes[frame].T)


@dataclass(frozen=True, eq=False)
class Stage:
    """A run as pictures see it.

    `time` (T,) [s]; `positions` (T, nx, ny, nz, 3) [m], all finite. `origin`, `size` (3,) [m]: the box in which the
    surface is embedded; `basis`: that of its volume. `vertices` (V, 3) [m] and `faces` (F, 3): the surface at rest;
    `skin`: its colours. `is_cage`: the surface is the boundary of the volume itself.
    `pinned`: flat indices of attached control points. `up` (3,): unit. `centre`, `half` (3,) [m]: middle and half the
    sides of the box of all that the lattice ever covers, and of solids what is beside it.
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
        """Half the diagonal of the box of all there is to see, m."""
        return float(np.linalg.norm(self.half))

    @cached_property
    def rest(self) -> np.ndarray:
        """The undeformed lattice, (nx, ny, nz, 3) [m]."""
        return rest_grid(self.counts, self.origin, self.size)

    @cached_property
    def edges(self) -> np.ndarray:
        """Neighbours along the axes, (E, 2) flat indices: the lines of the lattice."""
        index = index_grid(self.counts).T
        pairs = [(index[:, :, :-1], index[:, :, 1:]), (index[:, :-1], index[:, 1:]), (index[:-1], index[1:])]
        return np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in pairs])

    @cached_property
    def _embedding(self) -> Embedding:
        return Embedding(self.vertices, self.origin, self.size, self.counts, self.basis)

    def contact_points(self, positions: np.ndarray) -> np.ndarray:
        """What obstacles meet of a lattice (N, 3) [m] for control points (nx, ny, nz, 3) [m]: these, or the nodes of a solid."""
        return to_flat(node_positions(positions) if self.basis == "patches" else positions)

    def deformed(self, positions: np.ndarray) -> np.ndarray:
        """The surface's vertices (V, 3) [m] for control points (nx, ny, nz, 3) [m]."""
        return self._embedding.deform(positions)


def surface_of(result: Result, stage: Stage | None = None) -> Mesh:
    """The object's surface at rest: the scene's mesh, else the boundary of the box as pictures show it. stage: of the result, if known."""
    if result.loaded_mesh is not None:
        return result.loaded_mesh
    stage = stage or stage_of(result)
    return Mesh(stage.vertices, stage.faces, name="box")


def stage_of(result: Result) -> Stage:
    """The stage of a `Result`: its object is the mesh of the scene, without one the boundary of the volume; its box that of the lattice,
    else of the first frame. Raises SoftffdError when positions of control points were not recorded."""
    positions, mesh = _recorded(result), result.loaded_mesh
    origin, size = _box(result)
    if mesh is not None:
        vertices, faces, skin = skinned(mesh)
    else:
        several = max(24, 3 * (max(positions.shape[1:4]) - 1))  # squares to a cell, so that its bends look round
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
    """Names of the obstacles that are planes; in other FMUs what could be one."""
    values = {*result.parameters, *result.inputs}
    return [part.name for part in result.obstacle_parts() if part.kind == "plane" and set(vector_names("plane_normal", part)) <= values]


def beside(covered: np.ndarray, solid: SolidTrack, frame: int) -> np.ndarray:
    """What is in view of a solid in a frame, as a box: ends (2, 3) [m]; covered: those of the box that the lattice covers, and what it is
    where the solid is far from it."""
    margin = solid.in_view * np.linalg.norm(covered[1] - covered[0])
    least, most = covered[0] - margin, covered[1] + margin
    places = solid.surface(frame)[0]
    low, high = bounding_box(places)
    near = (low <= most).all() and (high >= least).all()
    return np.stack([low.clip(least, most), high.clip(least, most)]) if near else covered


def up_direction(result: Result) -> np.ndarray:
    """Unit vector (3,) against gravity; +z without a scene or without gravity."""
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
            'recorded. Wanted: a scene with outputs.positions = "all".'
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
    """The pole of a sphere, which looks the same however it is turned, is where the lattice's box is."""
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
    """Unit vectors (T, 3) across unit normals (T, 3), along one world axis through the run: that which the normal comes least close to."""
    axis, spare = np.eye(3)[np.abs(normals).max(axis=0).argsort()[:2]]
    axes = np.where(np.abs(normals @ axis)[:, None] < 0.999, axis, spare)
    return unit(axes - normals * np.einsum("ta,ta->t", normals, axes)[:, None])


def _pinned(result: Result) -> np.ndarray:
    held = [result.scene.select(pin.points) for pin in result.scene.pin] if result.scene else []
    return np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *held]))


def round_length(length: float) -> float:
    """The largest of 1, 2, 5, 10, ... [m] not above `length`: a spacing for grids."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(f * power for f in (1, 2, 5) if f * power <= length * (1 + 1e-9)))
