"""Writes meshes as files; each kind of file keeps the looks that it can hold."""

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from softffd.files import replacing, write_bytes, write_text
from softffd.mesh.bodies import quiet_trimesh
from softffd.mesh.gltf import glb_file
from softffd.mesh.looks import Group, Looks, Material, to_light
from softffd.mesh.mesh import Mesh
from softffd.mesh.mtl import mtl_text
from softffd.mesh.normals import ShadingNormals, split_at_creases

Column = tuple[Sequence[str], str, np.ndarray]
"""Names of properties, their type, and their values (N, properties)."""


def write_obj(mesh: Mesh, path: Path, vertices: np.ndarray, decimals: int) -> None:
    """Writes an OBJ file; materials go beside it as NAME.mtl, pictures as NAME.png, or NAME_1.png and so on."""
    looks, lines = mesh.looks, []
    names = _own_names(looks.materials)
    if looks.materials:
        library = path.with_suffix(".mtl")
        write_text(library, mtl_text(zip(names, looks.materials, strict=True), _write_textures(looks, path)))
        lines.append(f"mtllib {library.name}")
    positions = _rows(vertices, decimals)
    if looks.colours is not None:
        positions = [f"{place} {colour}" for place, colour in zip(positions, _rows(looks.colours, 4), strict=True)]
    lines += [f"v {row}" for row in positions]
    corners = [f"{i}/" for i in range(1, len(vertices) + 1)]
    if mesh.uv is not None:
        decimals = min(decimals, 9)  # a small mesh has texture coordinates of the usual size
        texels, texel = np.unique(np.round(mesh.uv, decimals), axis=0, return_inverse=True)
        lines += [f"vt {row}" for row in _rows(texels, decimals)]
        corners = [f"{corner}{t}" for corner, t in zip(corners, texel.reshape(-1) + 1, strict=True)]
    normals, normal = np.unique(np.round(_normals(mesh, vertices).reshape(-1, 3), 4), axis=0, return_inverse=True)
    lines += [f"vn {row}" for row in _rows(normals, 4)]
    lines += _faces(mesh, corners, (normal.reshape(-1, 3) + 1).tolist(), names)
    write_text(path, "\n".join(lines) + "\n")


def write_ply(mesh: Mesh, path: Path, vertices: np.ndarray) -> None:
    """Writes a binary PLY file with the colours of vertices and materials; a single picture goes beside it, several are not written."""
    looks, head = mesh.looks, ["ply", "format binary_little_endian 1.0"]
    columns: list[Column] = [("xyz", "f4", vertices)]
    if mesh.uv is not None:
        columns.append(("st", "f4", mesh.uv))
        head += [f"comment TextureFile {name}" for name in _write_textures(looks, path).values()] if mesh.texture is not None else []
    if looks.colours is not None:
        columns.append((("red", "green", "blue"), "u1", np.round(255 * looks.colours)))
    corners: list[Column] = [(("vertex_indices",), "i4", mesh.faces)]
    if any(material.colour is not None for material in looks.materials):
        shades = np.array([material.colour or (1.0, 1.0, 1.0) for material in looks.materials])
        corners.append((("red", "green", "blue"), "u1", np.round(255 * shades)[looks.material_of]))
    head += [f"element vertex {len(vertices)}", *_properties(columns), f"element face {len(mesh.faces)}"]
    head += ["property list uchar int vertex_indices", *_properties(corners[1:]), "end_header", ""]
    sizes: Column = ((), "u1", np.full((len(mesh.faces), 1), 3))
    write_bytes(path, "\n".join(head).encode() + _packed(columns) + _packed([sizes, *corners]))


def write_stl(mesh: Mesh, path: Path, vertices: np.ndarray) -> None:
    """Writes a binary STL file, with triangles only."""
    import trimesh

    with quiet_trimesh():
        write_bytes(path, cast(bytes, trimesh.Trimesh(vertices, mesh.faces, process=False).export(file_type="stl")))


def write_glb(mesh: Mesh, path: Path, vertices: np.ndarray) -> None:
    """Writes a GLB file: a node for each group, with a primitive for each of the group's materials; pictures lie inside."""
    groups, _, bodies = zip(*glb_bodies(mesh, vertices), strict=True)
    tree, data = glb_tree(bodies)
    numbers = list(dict.fromkeys(groups))
    names = [" ".join(filter(None, mesh.looks.groups[group])) if mesh.looks.groups else "" for group in numbers]
    primitives = [[own["primitives"][0] for own, of in zip(tree["meshes"], groups, strict=True) if of == group] for group in numbers]
    tree["meshes"] = [{"primitives": each} for each in primitives]
    tree["nodes"] = [{"mesh": n} | ({"name": name} if name else {}) for n, name in enumerate(names)]
    tree["scenes"], tree["scene"] = [{"nodes": list(range(len(names)))}], 0
    write_bytes(path, glb_file(tree, data))


def glb_tree(bodies: Iterable[Any]) -> tuple[dict[str, Any], bytes]:
    """Returns the JSON of a GLB file of trimesh bodies, a mesh for each in their order, and the blocks that follow the JSON."""
    import trimesh

    with quiet_trimesh():
        written = cast(bytes, trimesh.Scene(list(bodies)).export(file_type="glb", include_normals=True))
    end = 20 + int.from_bytes(written[12:16], "little")
    return json.loads(written[20:end]), written[end:]


def glb_bodies(mesh: Mesh, vertices: np.ndarray) -> Iterator[tuple[int, np.ndarray, Any]]:
    """Yields for each part of one group and one material: group, original vertex of each of its vertices (W,), and trimesh body."""
    import trimesh

    normals = _normals(mesh, vertices)
    for group, faces in _parts(mesh.looks, len(mesh.faces)):
        used, shades, corners = split_at_creases(vertices, mesh.faces[faces], normals[faces])
        part = mesh.looks.with_faces(faces[:1]).with_vertices(used)
        visual = _visual(part, None if mesh.uv is None else mesh.uv[used])
        yield group, used, trimesh.Trimesh(vertices[used], corners, vertex_normals=shades, visual=visual, process=False)


def _normals(mesh: Mesh, vertices: np.ndarray) -> np.ndarray:
    """Returns the unit normals (F, 3, 3) of the corners of all faces; the mesh at rest decides which edges are creases."""
    return ShadingNormals(mesh.vertices, mesh.faces).corners(vertices)


def _parts(looks: Looks, faces: int) -> list[tuple[int, np.ndarray]]:
    """Returns the groups and faces of the parts, in the order of their first faces."""
    group_of, material_of = (np.zeros(faces, dtype=np.int64) if i is None else i for i in (looks.group_of, looks.material_of))
    keys, first, part_of = np.unique(group_of * max(1, len(looks.materials)) + material_of, return_index=True, return_inverse=True)
    groups = (keys // max(1, len(looks.materials))).tolist()
    return [(groups[n], np.flatnonzero(part_of.reshape(-1) == n)) for n in np.argsort(first)]


def _visual(looks: Looks, uv: np.ndarray | None) -> Any:
    """Returns the trimesh visual of a part that has one material."""
    from trimesh.visual import ColorVisuals, TextureVisuals
    from trimesh.visual.material import PBRMaterial

    colours = None if looks.colours is None else np.round(255 * to_light(np.hstack([looks.colours, np.ones((len(looks.colours), 1))])))
    if uv is None and not looks.materials:
        return None if colours is None else ColorVisuals(vertex_colors=colours.astype(np.uint8))
    material = looks.materials[looks.material_of[0]] if looks.material_of is not None else Material()
    factor = np.append(to_light(np.array(material.colour or (1.0, 1.0, 1.0))), material.opacity)
    name, mode = material.name or None, "BLEND" if material.opacity < 1 else None
    made = PBRMaterial(name, baseColorFactor=factor, baseColorTexture=material.texture, alphaMode=mode, metallicFactor=0.0)
    visual = TextureVisuals(uv=uv, material=made)
    if colours is not None:
        visual.vertex_attributes["color"] = colours.astype(np.uint8)
    return visual


def _faces(mesh: Mesh, corners: list[str], normals: list[list[int]], names: list[str]) -> list[str]:
    """Returns the face records in order; object, group and material records stand before the faces at which they change."""
    pairs = zip(mesh.faces.tolist(), normals, strict=True)
    lines = [f"f {corners[a]}/{n} {corners[b]}/{m} {corners[c]}/{k}" for (a, b, c), (n, m, k) in pairs]
    looks = mesh.looks
    before: dict[int, list[str]] = {}
    if looks.group_of is not None:
        was = Group()
        for face in _changes(looks.group_of):
            group = looks.groups[looks.group_of[face]]
            words = Group(*(" ".join(name.split()) for name in group))  # a name with line breaks would be read as records
            marks = [f"o {words.object}"] * (group.object != was.object) + [f"g {words.group}"] * (group.group != was.group)
            was, before[face] = group, marks
    if looks.material_of is not None:
        for face in _changes(looks.material_of):
            before[face] = [*before.get(face, []), f"usemtl {names[looks.material_of[face]]}"]
    return [text for face, line in enumerate(lines) for text in (*before.get(face, ()), line)]


def _changes(index: np.ndarray) -> list[int]:
    """Returns the first face, and the faces whose entry differs from that of the face before."""
    return [0, *(np.flatnonzero(np.diff(index)) + 1).tolist()]


def _own_names(materials: tuple[Material, ...]) -> list[str]:
    """Returns a unique name for each material, without `#`, which would start a comment."""
    names: list[str] = []
    for material in materials:
        name = " ".join(material.name.replace("#", "_").split()) or "none"
        names.append(name if name not in names else f"{name}_{len(names) + 1}")
    return names


def _write_textures(looks: Looks, path: Path) -> dict[int, str]:
    """Writes the pictures beside the mesh; returns their file names by id() of the picture."""
    images, files = looks.textures, {}
    for number, image in enumerate(images, 1):
        file = path.with_suffix(".png") if len(images) == 1 else path.with_name(f"{path.stem}_{number}.png")
        with replacing(file) as stream:
            image.save(stream, "PNG")
        files[id(image)] = file.name
    return files


def _rows(rows: np.ndarray, decimals: int) -> list[str]:
    return [" ".join(f"{value:.{decimals}f}" for value in row) for row in (rows + 0.0).tolist()]


def _properties(columns: list[Column]) -> list[str]:
    kinds = {"f4": "float", "u1": "uchar"}
    return [f"property {kinds[kind]} {name}" for names, kind, _ in columns for name in names]


def _packed(columns: list[Column]) -> bytes:
    """Returns the columns as consecutive little-endian records."""
    record = np.dtype([(f"f{n}", f"<{kind}", (values.shape[1],)) for n, (_, kind, values) in enumerate(columns)])
    table = np.empty(len(columns[0][2]), record)
    for n, (_, _, values) in enumerate(columns):
        table[f"f{n}"] = values
    return table.tobytes()
