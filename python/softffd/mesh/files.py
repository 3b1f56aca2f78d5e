"""Reads and writes mesh files; damaged files are refused, and every fault is reported in one clear paragraph."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from softffd.errors import MeshError
from softffd.mesh.collada import read_dae
from softffd.mesh.gltf import read_glb, read_gltf
from softffd.mesh.habits import doubt, habit_of
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import area_vectors, first_of_each, merge_by_position
from softffd.mesh.obj import read_obj
from softffd.mesh.off import read_off
from softffd.mesh.ply import read_ply
from softffd.mesh.polygons import Triangles
from softffd.mesh.stl import read_stl
from softffd.mesh.threemf import read_3mf
from softffd.mesh.written import write_glb, write_obj, write_ply, write_stl
from softffd.spelling import did_you_mean, nearest_of, one_number, wanted_one_of

_READERS = {
    ".obj": read_obj, ".stl": read_stl, ".ply": read_ply, ".glb": read_glb,
    ".gltf": read_gltf, ".off": read_off, ".3mf": read_3mf, ".dae": read_dae,
}  # fmt: skip
_WRITERS = {".stl": write_stl, ".ply": write_ply, ".glb": write_glb}
_SOUPS = (".stl", ".dae", ".glb", ".gltf")
"""Kinds of files whose triangles share no vertices as they are read, so that load_mesh merges equal ones."""

_FARTHEST_TEXEL = 1e9
_SCENES = (".glb", ".gltf", ".dae", ".3mf")
_KINDS = ", ".join(ending[1:].upper() for ending in _READERS)

WRITTEN, READ = (".obj", *_WRITERS), tuple(_READERS)
"""Endings of the file names that can be written, and read."""

_TO_Z_UP = {
    "x": np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "z": np.eye(3),
}
"""Proper rotations (about y, about x, none) that turn the named axis of a file into +z."""


def load_mesh(path: str | Path, *, scale: float = 1.0, up: str = "z") -> Mesh:
    """Returns the mesh of an OBJ, STL, PLY, GLB, glTF, OFF, COLLADA or 3MF file, the last two with the packages of softffd[meshes].

    scale: metres per unit of the file, > 0. With scale 1, a mesh that is likely in another unit reports this when it is printed.
    up: the axis of the file, "x", "y" or "z", that a rotation turns into +z.
    Polygons become triangles, and several bodies become one mesh. Vertices that no face uses are left out, since they would widen the box
    of the lattice; the others keep the order of the file. STL, COLLADA and glTF repeat a vertex for each triangle or normal: vertices with
    equal positions and looks are merged.
    Raises MeshError, with the reason, for a missing, damaged, empty, flat or otherwise unusable file.
    """
    path = Path(path)
    _require_axis(path, up)
    scale = one_number(f"{path}: mesh.scale", scale, MeshError)
    if not (np.isfinite(scale) and scale > 0):
        raise MeshError(f"{path}: mesh.scale: wanted a number > 0, got {scale}")
    read = _read(path)
    _require_faces(path, read.vertices, read.faces)
    counts = np.bincount(read.faces.ravel())
    used, index = np.flatnonzero(counts), (np.cumsum(counts > 0) - 1)[read.faces]
    if not np.isfinite(read.vertices[used]).all():
        raise MeshError(f"{path}: {_first_not_finite(read.vertices[used])}; wanted finite coordinates throughout")
    if path.suffix.lower() in _SOUPS:
        merged, used = _merged(read, used)
        index = merged[index]
    vertices, faces = scale * (read.vertices[used] @ _TO_Z_UP[up].T), index
    _require_body(path, vertices, faces)
    uv = None if read.uv is None else read.uv[used]
    unsure = doubt(habit_of(path), float(np.ptp(vertices, axis=0).max())) if scale == 1.0 else ""
    return Mesh(vertices, faces, uv, path.stem, looks=read.looks.with_vertices(used), doubt=unsure)


def save_mesh(mesh: Mesh, path: str | Path, *, vertices: np.ndarray | None = None, up: str = "z", decimals: int | None = None) -> None:
    """Writes `mesh` as OBJ, STL, PLY or GLB. OBJ and GLB keep all looks; pictures lie inside a GLB, and beside an OBJ with NAME.mtl. PLY
    keeps colours and one picture beside it, but no names of materials and no groups. STL keeps no looks.

    vertices: (V, 3) [m], written in place of the vertices of the mesh, as `deform` returns them.
    up: the axis of the file that stands for +z, as for load_mesh ("y" for programs that follow the convention of glTF).
    decimals: number of decimals in an OBJ file, by default 9, and more for a mesh below 1 cm; the other formats hold single precision.
    Raises MeshError if the ending is none of the four or writing fails, SoftffdError if the folder cannot be made or written to, and
    ValueError for `vertices` of another shape. A missing folder is made.
    """
    path = Path(path)
    _require_known_ending(path, WRITTEN)
    _require_axis(path, up)
    vertices = np.asarray(mesh.vertices if vertices is None else vertices, dtype=float)
    if vertices.shape != mesh.vertices.shape:
        raise ValueError(f"vertices: wanted the mesh's shape {mesh.vertices.shape}, got {vertices.shape}")
    if not np.isfinite(vertices).all():
        raise MeshError(f"{path}: not written: {_first_not_finite(vertices)}")
    if not len(mesh.faces):
        raise MeshError(f"{path}: not written: the mesh has no faces")
    if path.suffix.lower() != ".obj" and np.abs(vertices).max() > np.finfo(np.float32).max:
        raise MeshError(f"{path}: not written: its coordinates go to {np.abs(vertices).max():g} m, too far for single precision; take OBJ")
    vertices = vertices @ _TO_Z_UP[up]
    try:
        if path.suffix.lower() == ".obj":
            write_obj(mesh, path, vertices, _decimals(vertices) if decimals is None else decimals)
        else:
            _WRITERS[path.suffix.lower()](mesh, path, vertices)
    except OSError as fault:
        raise MeshError(f"{path}: cannot be written: {fault.strerror or fault}") from None


def _decimals(vertices: np.ndarray) -> int:
    """Returns the number of decimals that hold vertices (V, 3) to a ten-millionth of their largest side, or to 1e-9 if that is less."""
    return max(9, 7 - math.floor(math.log10(np.ptp(vertices, axis=0).max() or 1.0)))


def placed(mesh: Mesh, *, scale: float, up: str) -> Mesh:
    """Returns the mesh in metres with +z up, as load_mesh would with `scale` and `up`."""
    return replace(mesh, vertices=scale * (mesh.vertices @ _TO_Z_UP[up].T), doubt="")


def _merged(read: Triangles, used: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merges used vertices (U,) of equal position and looks: returns the kept vertex of each (U,), and the kept (first) vertices."""
    index, _ = merge_by_position(read.vertices[used])
    keys = [index[:, None].astype(float), *(each[used] for each in (read.uv, read.looks.colours) if each is not None)]
    merged, first = first_of_each(np.hstack(keys))
    return merged, used[first]


def _read(path: Path) -> Triangles:
    """Returns the triangles of the file; the ending of the name decides the reader."""
    _require_known_ending(path, READ)
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        beside = [file.name for file in path.parent.glob("*") if file.suffix.lower() in READ]
        nearest = did_you_mean(nearest_of(path.name, beside))
        raise MeshError(f"{path}: no such file; wanted a mesh ({_KINDS}){nearest}") from None
    except OSError as fault:
        raise MeshError(f"{path}: cannot be read: {fault.strerror or fault}") from None
    if not data:
        raise MeshError(f"{path}: the file is empty (0 bytes); wanted a mesh")
    if data.startswith(b"version https://git-lfs"):
        raise MeshError(f"{path}: is a pointer of Git LFS in place of the mesh; wanted the mesh itself, which 'git lfs pull' fetches")
    with np.errstate(invalid="ignore", over="ignore"):  # later checks refuse values that are not finite
        read = _READERS[path.suffix.lower()](path, data)
        if read.uv is None or (placed := np.abs(read.uv) < _FARTHEST_TEXEL).all():
            return read
    note = f"texture coordinates that are not finite, with (0, 0) in their place: {np.count_nonzero(~placed.all(axis=1))}"
    return read._replace(uv=np.where(placed.all(axis=1, keepdims=True), read.uv, 0.0), looks=read.looks.and_notes(note))


def _require_axis(path: Path, up: str) -> None:
    if up not in _TO_Z_UP:
        raise MeshError(f"{path}: mesh.up: {wanted_one_of(_TO_Z_UP, up)}")


def _require_known_ending(path: Path, known: tuple[str, ...]) -> None:
    if path.is_dir():
        raise MeshError(f"{path}: is a directory; wanted a mesh file ({_KINDS})")
    if path.suffix.lower() not in known:
        ending = path.suffix or "no ending"
        raise MeshError(
            f"{path}: wanted a mesh file that ends with one of {', '.join(known)}, got {ending}{did_you_mean(nearest_of(ending, known))}"
        )


def _require_faces(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    if not len(vertices):
        where = " that are read: those on skins and in other files are not" * (path.suffix.lower() in _SCENES)
        raise MeshError(f"{path}: holds no vertices{where}; wanted a surface of triangles or polygons")
    if not len(faces):
        raise MeshError(f"{path}: holds {len(vertices)} vertices but no faces (a point cloud or lines); wanted a surface")


def _first_not_finite(vertices: np.ndarray) -> str:
    wrong = ~np.isfinite(vertices).all(axis=1)
    first = int(wrong.argmax())
    return f"{wrong.sum()} of {len(vertices)} vertices are not finite, the first is {vertices[first].tolist()} (number {first} from 0)"


def _require_body(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Refuses a mesh without extent along some axis, or without any area."""
    extent = np.ptp(vertices, axis=0)
    if not np.isfinite(extent).all() or extent.max() > 1e100:
        raise MeshError(f"{path}: spans {extent.tolist()} m; wanted coordinates of a sensible size")
    flat = [axis for axis, length in zip("xyz", extent, strict=True) if length <= 1e-9 * extent.max()]
    if flat:
        spans = " x ".join(f"{length:.4g}" for length in extent)
        raise MeshError(
            f"{path}: is flat along {' and '.join(flat)} (it spans {spans} m), so the lattice's box around it "
            "would have no volume. Wanted a body with an extent on every axis; give the surface a thickness."
        )
    if np.linalg.norm(area_vectors(vertices[faces] / extent.max()), axis=1).max() <= 1e-14:
        raise MeshError(f"{path}: none of its {len(faces)} faces has an area (all are points or lines); wanted a surface")
