"""Files that trimesh reads, each with a scene of bodies: GLB, glTF, COLLADA and 3MF."""

import logging
import struct
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple, cast
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike

from softffd.errors import MeshError
from softffd.mesh.looks import Group, Looks, Material, as_shares, from_face_colours, to_screen
from softffd.mesh.polygons import Triangles, damaged, found_beside
from softffd.spelling import few

_NEEDED = {".dae": ("collada", "pycollada"), ".3mf": ("networkx", "lxml and networkx")}
"""By kind of file: a module that trimesh needs in addition, and the packages to install."""

_OF_DATA = (ValueError, LookupError, AssertionError, EOFError, OSError, struct.error, BadZipFile, SyntaxError)
"""Exceptions that damaged data cause; other exceptions may come from errors of the program."""


class Surface(NamedTuple):
    """Properties of a glTF material beside picture and colour. name: in the file. turned (2, 2), moved (2,): transform of the texture
    coordinates, None for the identity. coordinates: number of the set of texture coordinates."""

    name: str = ""
    turned: np.ndarray | None = None
    moved: np.ndarray | None = None
    coordinates: int = 0

    def placed(self, uv: np.ndarray) -> np.ndarray:
        """Returns the transformed texture coordinates (V, 2). v points up in `uv` and in the result, but down in glTF."""
        if self.turned is None or self.moved is None:
            return uv
        down = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]]) @ self.turned.T + self.moved
        return np.column_stack([down[:, 0], 1.0 - down[:, 1]])


def read_bodies(path: Path, data: bytes, surfaces: list[Surface] | None = None, names: Sequence[str] = ()) -> Triangles:
    """Returns the triangles of all bodies of the scene of the file, each in its place, in the order of the file.

    surfaces, names: of the materials and nodes of a glTF file, in which the names of both are numbers into these and colours are linear;
        None for other kinds.
    Raises MeshError for damaged files, and if trimesh fails for another reason, such as a missing package.
    """
    bodies = _read(path, data, surfaces, names)
    for body in bodies:
        if body.faces.min() < 0 or body.faces.max() >= len(body.vertices):
            fault = f"a face refers to vertex {body.faces.max()} (from 0) of a body that has {len(body.vertices)}"
            raise damaged(path, fault)
    return _joined(bodies)


@contextmanager
def quiet_trimesh() -> Iterator[None]:
    """Suppresses the log and the warnings of trimesh, since errors report all that matters."""
    logger = logging.getLogger("trimesh")
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)  # the loggers of the modules of trimesh inherit the level
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.setLevel(level)


def require_package(path: Path) -> None:
    """Raises MeshError if a package that reads this kind of file is not installed."""
    from importlib.util import find_spec

    module, packages = _NEEDED[path.suffix.lower()]
    if find_spec(module) is None:
        kind = path.suffix[1:].upper()
        wanted = f"{packages}: pip install 'softffd[meshes]', or save the mesh as OBJ, PLY or GLB"
        raise MeshError(f"{path}: {kind} files are read with the help of packages that are not installed; wanted {wanted}")


def _read(path: Path, data: bytes, surfaces: list[Surface] | None, names: Sequence[str]) -> list[Triangles]:
    import trimesh  # imported here, since the import takes longer than reading most files

    with quiet_trimesh():
        try:
            scene = trimesh.load_scene(BytesIO(data), file_type=path.suffix[1:].lower(), resolver=cast(Any, _Beside(path)), process=False)
            order = {name: number for number, name in enumerate(scene.geometry)}
            nodes = sorted(scene.graph.nodes_geometry, key=lambda node: order[scene.graph[node][1]])
            bodies = [_body(scene, node, surfaces, names) for node in nodes]
            return [body for body in bodies if body is not None and len(body.faces)]
        except MeshError:
            raise
        except Exception as fault:  # trimesh raises whatever the damaged place happens to cause
            text = f"{type(fault).__name__}: {' '.join(str(fault).split())}".rstrip(": ")
            if isinstance(fault, _OF_DATA):
                raise damaged(path, f"its data do not fit their description ({text[:200]})") from None
            raise MeshError(
                f"{path}: trimesh {trimesh.__version__}, which reads this kind, stops ({text[:200]}): it may be damaged, or have what that "
                "does not know. Wanted a file that it reads; save the mesh as OBJ, PLY or GLB."
            ) from None


class _Beside:
    """A resolver, in the protocol of trimesh, of files that a mesh names: they must lie in its folder or below."""

    def __init__(self, path: Path):
        self.path = path

    def get(self, name: str) -> bytes:
        file = found_beside(self.path.parent, name)
        if file is None:
            raise MeshError(f"{self.path}: names {name!r}, which is not beside it; wanted that file in its folder or below it")
        return file.read_bytes()

    __getitem__ = get


def _body(scene: Any, node: str, surfaces: list[Surface] | None, names: Sequence[str]) -> Triangles | None:
    """Returns the triangles of the node in the frame of the scene, with the outside kept if mirrored; None for points and lines."""
    matrix, name = scene.graph[node]
    geometry = scene.geometry[name]
    faces = getattr(geometry, "faces", None)
    if faces is None:
        return None
    vertices = np.asarray(geometry.vertices, dtype=float) @ matrix[:3, :3].T + matrix[:3, 3]
    faces = np.asarray(faces, dtype=np.int64)
    uv = getattr(geometry.visual, "uv", None)
    uv = np.asarray(uv, dtype=float) if uv is not None and np.shape(uv) == (len(vertices), 2) else None
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    looks = _looks(geometry, surfaces is not None)
    if surfaces and looks.materials:
        surface = surfaces[int(looks.materials[0].name)]
        uv = None if uv is None else surface.placed(uv)
        looks = replace(looks, materials=(looks.materials[0]._replace(name=surface.name),))
    name = names[int(node.partition("_")[0])] if names else str(node)  # of a primitive of several, trimesh calls the node NUMBER_SUFFIX
    looks = replace(looks, groups=(Group(name),), group_of=np.zeros(len(faces), dtype=np.int64))
    return Triangles(vertices, faces[:, ::-1] if mirrored else faces, uv, looks)


def _looks(geometry: Any, gltf: bool) -> Looks:
    visual, faces = geometry.visual, len(geometry.faces)
    screen = to_screen if gltf else np.asarray
    if visual.kind == "face":
        return from_face_colours(np.asarray(visual.face_colors)[:, :3] / 255.0)
    shades = visual.vertex_colors if visual.kind == "vertex" else getattr(visual, "vertex_attributes", {}).get("color")
    looks = Looks()
    if shades is not None and len(shades) == len(geometry.vertices):
        looks = Looks(colours=screen(_shares(shades)[:, :3]))
    material = getattr(visual, "material", None)
    if material is None:
        return looks
    return replace(looks, materials=(_material(material, screen),), material_of=np.zeros(faces, dtype=np.int64))


def _material(material: Any, screen: Callable[[np.ndarray], np.ndarray]) -> Material:
    factor = getattr(material, "baseColorFactor", None)
    factor = getattr(material, "diffuse", None) if factor is None and hasattr(material, "diffuse") else factor
    shares = np.ones(4) if factor is None else np.append(_shares(factor), 1.0)[:4]
    texture = getattr(material, "baseColorTexture", None)
    texture = getattr(material, "image", None) if texture is None else texture
    if texture is not None:
        texture.load()  # a damaged picture fails here, with a message
    return Material(str(material.name or ""), tuple(screen(shares[:3]).tolist()), texture, float(shares[3]))


def _shares(numbers: ArrayLike) -> np.ndarray:
    """Returns colours as fractions of 1; integers are divided by the largest value of their type."""
    given = np.asarray(numbers)
    return as_shares(given, np.iinfo(given.dtype).max if given.dtype.kind in "iu" else 1.0)


def _joined(bodies: list[Triangles]) -> Triangles:
    if not bodies:
        return Triangles(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    counts = [len(body.vertices) for body in bodies]
    starts = np.cumsum([0, *counts[:-1]])
    faces = np.vstack([body.faces + start for body, start in zip(bodies, starts, strict=True)])
    uv = None
    if any(body.uv is not None for body in bodies):
        uv = np.vstack([np.zeros((count, 2)) if body.uv is None else body.uv for body, count in zip(bodies, counts, strict=True)])
    return Triangles(np.vstack([body.vertices for body in bodies]), faces, uv, _joined_looks(bodies))


def _joined_looks(bodies: list[Triangles]) -> Looks:
    """Returns the looks of all bodies; equal materials and groups of equal names are one."""
    materials: dict[tuple[object, ...], Material] = {}
    material_of, colours = [], None
    for body in bodies:
        names = [(*each[:2], id(each.texture), each.opacity) for each in body.looks.materials or (Material(),)]
        for name, each in zip(names, body.looks.materials or (Material(),), strict=True):
            materials.setdefault(name, each)
        index = np.zeros(len(body.faces), dtype=np.int64) if body.looks.material_of is None else body.looks.material_of
        material_of.append(np.array([list(materials).index(name) for name in names])[index])
    if any(body.looks.colours is not None for body in bodies):
        colours = np.vstack([np.ones((len(b.vertices), 3)) if b.looks.colours is None else b.looks.colours for b in bodies])
    named = tuple(materials.values())
    if named == (Material(),):
        named = ()
    groups = {group: number for number, group in enumerate(dict.fromkeys(body.looks.groups[0] for body in bodies))}
    group_of = np.repeat([groups[body.looks.groups[0]] for body in bodies], [len(body.faces) for body in bodies])
    clear = [material.name or "without a name" for material in named if material.opacity < 1]
    notes = (f"transparent materials are shown opaque: {few(clear)}",) if clear else ()
    return Looks(named, np.concatenate(material_of) if named else None, colours, tuple(groups), group_of, notes)
