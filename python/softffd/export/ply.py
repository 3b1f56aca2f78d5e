"""A series of PLY files, one for each row, and what tells ParaView their times."""

import json
from dataclasses import replace
from pathlib import Path

from softffd.export.take import Take
from softffd.mesh.files import save_mesh


def write(take: Take, path: Path) -> None:
    """Writes NAME_ply/NAME_0000.ply and so on, and NAME.ply.series, which lists them; pictures are left out."""
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
