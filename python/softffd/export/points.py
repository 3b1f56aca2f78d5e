"""Places of all vertices at every row: PC2, or a series of PLY files.

PC2, the point cache of Blender's Mesh Cache and of 3ds Max, stands beside the mesh at rest as OBJ:

12 bytes "POINTCACHE2", 0; int32 version 1, int32 vertices V; float32 first frame, float32 frames to a sample; int32 samples R
R x V x 3 float32, all little-endian
"""

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np

from softffd.export.take import Take
from softffd.mesh.files import save_mesh


def write(take: Take, path: Path) -> None:
    """Writes the format that the path's ending names."""
    (_write_pc2 if path.suffix == ".pc2" else _write_ply)(take, path)


def _write_pc2(take: Take, path: Path) -> None:
    """Writes the cache, and NAME_rest.obj with its files, the mesh in one piece, because programs take the groups of an OBJ file apart."""
    mesh = replace(take.mesh, looks=replace(take.mesh.looks, groups=(), group_of=None))
    save_mesh(mesh, path.with_name(f"{path.stem}_rest.obj"))
    with path.open("xb") as stream:
        stream.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, len(mesh.vertices), 0.0, 1.0, len(take.rows)))
        for _, row in take.told_rows():
            stream.write(np.ascontiguousarray(take.deformed(row), dtype="<f4").tobytes())
    if len(take.rows) > 1:
        rate = (len(take.rows) - 1) / (take.time[-1] - take.time[0])
        take.say(f"{rate:.6g} samples per second: for real time at 24 frames per second, Blender's Frame Scale is {rate / 24:.4g}")


def _write_ply(take: Take, path: Path) -> None:
    """Writes NAME_ply/NAME_0000.ply and so on, and NAME.ply.series, which gives ParaView their times; textures are left out."""
    stem = path.name.removesuffix(".ply.series")
    folder = path.with_name(f"{stem}_ply")
    folder.mkdir()
    plain = tuple(each._replace(texture=None) for each in take.mesh.looks.materials)
    mesh = replace(take.mesh, texture=None, looks=replace(take.mesh.looks, materials=plain))
    files = []
    for number, row in take.told_rows():
        name = f"{stem}_{number:04d}.ply"
        save_mesh(mesh, folder / name, vertices=take.deformed(row))
        files.append({"name": f"{folder.name}/{name}", "time": take.time[number]})
    path.write_text(json.dumps({"file-series-version": "1.0", "files": files}, indent=1) + "\n", encoding="utf-8")
