"""A ball and a tetrahedron as files of every kind."""

import json
import struct

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual import ColorVisuals, TextureVisuals
from trimesh.visual.material import PBRMaterial

from softffd.mesh.files import load_mesh, save_mesh
from softffd.mesh.mesh import Mesh

ENDINGS = ["obj", "stl", "ply", "glb"]

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
FACES = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"

PLY_HEAD = """ply
format {format} 1.0
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""
PLY_TEXT = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
OFF = "OFF\n4 4 0\n" + PLY_TEXT
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")


def ball(uv=False, texture=None):
    sphere = trimesh.creation.icosphere(1)
    coordinates = np.random.default_rng(0).random((len(sphere.vertices), 2)) if uv else None
    return Mesh(sphere.vertices, sphere.faces, coordinates, "ball", texture)


def written(tmp_path, name, content):
    file = tmp_path / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return file


def loaded(tmp_path, name, content, **keys):
    return load_mesh(written(tmp_path, name, content), **keys)


def saved(tmp_path, kind, mesh=None):
    file = tmp_path / f"ball.{kind}"
    save_mesh(mesh or ball(), file)
    return file.read_bytes()


def ply(vertices=4, faces=4, format="ascii"):
    return PLY_HEAD.format(vertices=vertices, faces=faces, format=format)


def binary_ply(faces=((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)), order="little"):
    mark = {"little": "<", "big": ">"}[order]
    lists = b"".join(struct.pack(f"{mark}B{len(face)}i", len(face), *face) for face in faces)
    head = ply(faces=len(faces), format=f"binary_{order}_endian").encode()
    return head + CORNERS.astype(mark + "f4").tobytes() + lists


def text_stl():
    return trimesh.Trimesh(CORNERS, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).export(file_type="stl_ascii")


def glb_with(change):
    """A sound GLB whose JSON went through `change`."""
    data = trimesh.Trimesh(CORNERS, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).export(file_type="glb")
    size = struct.unpack("<I", data[12:16])[0]
    header = json.loads(data[20 : 20 + size])
    change(header)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON") + text + rest


RED, GREEN = (0.8, 0.2, 0.0), (0.0, 0.6, 0.4)
"""On a screen: bytes 204, 51, 0 and 0, 153, 102."""

PARTS = {"crate": (0.0, RED), "ball": (2.0, GREEN)}
"""A red box about z = 0 and a green one about z = 2: height and colour by name."""

TWO_COLOURS = ["kd.obj", "pictures.obj", "vertices.obj", "vertices.ply", "faces.ply", "faces.off", "vertices.off"]
TWO_COLOURS += ["factors.glb", "pictures.glb", "vertices.glb", "pictures.gltf"]


def two_colours(folder, name):
    """The two boxes as a file of this name, of TWO_COLOURS; each part is called as in PARTS where its kind has names."""
    how, kind = name.split(".")
    bodies = {part: (unit_box(height), colour) for part, (height, colour) in PARTS.items()}
    if kind == "obj":
        _write_obj(folder, name, how, bodies)
    elif kind in ("glb", "gltf"):
        scene = trimesh.Scene()
        for part, (body, colour) in bodies.items():
            body.visual = _gltf_visual(part, how, body, colour)
            scene.add_geometry(body, geom_name=part, node_name=part)
        data = scene.export(file_type=kind)
        for file, content in ({name: data} if kind == "glb" else {name: data.pop("model.gltf"), **data}).items():
            written(folder, file, content)
    else:
        whole = trimesh.util.concatenate([body for body, _ in bodies.values()])
        each = whole.vertices if how == "vertices" else whole.triangles_center
        shades = np.array([[*np.multiply(RED if z < 1 else GREEN, 255).round(), 255] for z in each[:, 2]], dtype=np.uint8)
        if kind == "off":
            written(folder, name, _off(whole, how, shades))
        else:
            whole.visual = ColorVisuals(whole, **{f"{'vertex' if how == 'vertices' else 'face'}_colors": shades})
            written(folder, name, whole.export(file_type="ply", encoding="ascii" if how == "faces" else "binary"))
    return folder / name


def unit_box(height):
    box = trimesh.creation.box()
    box.apply_translation([0.0, 0.0, height])
    return box


def _picture(colour):
    return Image.new("RGB", (4, 4), tuple(np.multiply(colour, 255).round().astype(int).tolist()))


def _light(colour):
    return ((np.asarray(colour) + 0.055) / 1.055) ** 2.4 * (np.asarray(colour) > 0)


def _gltf_visual(part, how, body, colour):
    if how == "pictures":
        return TextureVisuals(body.vertices[:, :2] % 1, PBRMaterial(part, baseColorTexture=_picture(colour)))
    if how == "factors":
        return TextureVisuals(material=PBRMaterial(part, baseColorFactor=[*_light(colour), 1.0]))
    shades = np.tile([*(255 * _light(colour)).round(), 255], (len(body.vertices), 1))
    return ColorVisuals(body, vertex_colors=shades.astype(np.uint8))


def _write_obj(folder, name, how, bodies):
    lines, library, first = [f"mtllib {how}.mtl"], [], 1
    for part, (body, colour) in bodies.items():
        shade = " {} {} {}".format(*colour) if how == "vertices" else ""
        lines += [f"o {part}", f"g {part} sides"] + [f"usemtl {part}"] * (how != "vertices")
        lines += ["v {} {} {}".format(*place) + shade for place in body.vertices.tolist()]
        lines += ["vt {} {}".format(*place) for place in (body.vertices[:, :2] % 1).tolist()]
        lines += ["f " + " ".join(f"{corner}/{corner}" for corner in face) for face in (body.faces + first).tolist()]
        library += [f"newmtl\t{part}", "Ns 10", "Kd {} {} {}".format(*colour if how == "kd" else (0, 0, 0))]
        if how == "pictures":
            _picture(colour).save(folder / f"the {part}.png")
            library.append(f"map_Kd the {part}.png")
        first += len(body.vertices)
    written(folder, f"{how}.mtl", "\n".join(library) + "\n")
    written(folder, name, "\n".join(lines) + "\n")


def _off(body, how, shades):
    rows = [body.vertices.tolist(), [[3, *face] for face in body.faces.tolist()]]
    place = 0 if how == "vertices" else 1
    rows[place] = [[*row, *shade] for row, shade in zip(rows[place], shades.tolist(), strict=True)]
    lines = [" ".join(map(str, row)) for row in rows[0] + rows[1]]
    return "\n".join([f"{'C' * (place == 0)}OFF # by hand", f"{len(body.vertices)} {len(body.faces)} 0", "", *lines]) + "\n"
