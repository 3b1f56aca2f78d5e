"""VTU, the XML files of VTK, one for each grid and row, and a PVD file that lists them with their times; any ParaView reads these files.

The numbers are in base64, each array after its length in bytes (UInt64), as in VTK's "inline binary" format.
"""

import base64
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from softffd.export.grids import Arrays, Grid, grids_of
from softffd.export.take import Take

HEAD = '<?xml version="1.0"?>\n<VTKFile type="{}" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'


def write(take: Take, path: Path) -> None:
    """Writes NAME_vtu/GRID_0000.vtu and so on, and NAME.pvd."""
    folder = path.with_name(f"{path.stem}_vtu")
    folder.mkdir()
    grids, lines = grids_of(take), []
    for number, row in take.told_rows():
        for part, grid in enumerate(grids):
            name = f"{grid.name}_{number:04d}.vtu"
            (folder / name).write_text(_text(grid, row), encoding="ascii")
            file = quoteattr(f"{folder.name}/{name}")
            lines.append(f'<DataSet timestep="{take.time[number]:.17g}" part="{part}" name={quoteattr(grid.name)} file={file}/>\n')
    path.write_text(f"{HEAD.format('Collection')}<Collection>\n{''.join(lines)}</Collection>\n</VTKFile>\n", encoding="utf-8")


def _text(grid: Grid, row: int) -> str:
    points, at_points, of_cells = grid.at(row)
    cells, (count, corners) = grid.cells, grid.cells.shape
    topology = {
        "connectivity": cells.reshape(-1),
        "offsets": corners * np.arange(1, count + 1),
        "types": np.full(count, grid.kind, dtype=np.uint8),
    }
    groups = {"PointData": at_points, "CellData": of_cells, "Points": {"Points": points}, "Cells": topology}
    body = "".join(f"<{group}>\n{_arrays(arrays)}</{group}>\n" for group, arrays in groups.items())
    piece = f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">\n{body}</Piece>\n'
    return f"{HEAD.format('UnstructuredGrid')}<UnstructuredGrid>\n{piece}</UnstructuredGrid>\n</VTKFile>\n"


def _arrays(arrays: Arrays) -> str:
    kinds = {"f": ("Float32", "<f4"), "i": ("Int64", "<i8"), "u": ("UInt8", "u1")}
    lines = []
    for name, values in arrays.items():
        kind, stored = kinds[values.dtype.kind]
        data = np.ascontiguousarray(values, dtype=stored).tobytes()
        text = base64.b64encode(len(data).to_bytes(8, "little") + data).decode("ascii")
        width = values.shape[1] if values.ndim > 1 else 1
        lines.append(f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" format="binary">{text}</DataArray>\n')
    return "".join(lines)
