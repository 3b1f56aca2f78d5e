"""A ball and a tetrahedron as files of every kind."""

import json
import struct

import numpy as np
import trimesh

from softffd.mesh.mesh import Mesh, load_mesh, save_mesh

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
