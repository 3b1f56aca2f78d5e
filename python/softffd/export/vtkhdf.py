"""VTKHDF 2.1, an HDF5 format that VTK reads from 9.5 on (ParaView 6): all grids and times in one file, each grid's cells once.

/VTKHDF                 a MultiBlockDataSet
  Assembly              links to its grids
  GRID                  an UnstructuredGrid: Points of all rows one after the other, Connectivity, Offsets, Types of one row
    PointData, CellData arrays, likewise
    Steps               Values: the times; where in Points and in each array a row begins; the cells begin at 0 at every row
  Steps                 the times again: without them in a collection VTK 9.7 keeps to the first time, and with them VTK 9.4 stops
"""

from pathlib import Path
from typing import Any

import numpy as np

from softffd.export.grids import Grid, grids_of
from softffd.export.take import Take


def write(take: Take, path: Path) -> None:
    """Writes the file."""
    import h5py

    with h5py.File(path, "x") as file:
        root = file.create_group("VTKHDF", track_order=True)
        _say(root, "MultiBlockDataSet")
        assembly = root.create_group("Assembly", track_order=True)  # VTK follows these links
        grids = grids_of(take)
        for grid in grids:
            assembly[grid.name] = h5py.SoftLink(f"/VTKHDF/{grid.name}")
            _begin(root.create_group(grid.name), grid, take.time)
        _steps(root, take.time)
        for number, row in take.told_rows():
            for grid in grids:
                _add(root[grid.name], grid, number, row, len(take.rows))


def _say(group: Any, kind: str) -> None:
    group.attrs["Version"] = np.array([2, 1], dtype="<i8")
    group.attrs["Type"] = np.bytes_(kind)


def _steps(group: Any, time: np.ndarray) -> Any:
    steps = group.create_group("Steps")
    steps.attrs["NSteps"], steps["Values"] = np.int64(len(time)), time.astype("<f8")
    return steps


def _begin(group: Any, grid: Grid, time: np.ndarray) -> None:
    """Writes the grid's cells and times."""
    _say(group, "UnstructuredGrid")
    count, corners = grid.cells.shape
    group["NumberOfCells"], group["NumberOfConnectivityIds"] = np.array([count], dtype="<i8"), np.array([grid.cells.size], dtype="<i8")
    group["Connectivity"] = grid.cells.reshape(-1).astype("<i8")
    group["Offsets"] = corners * np.arange(count + 1, dtype="<i8")
    group["Types"] = np.full(count, grid.kind, dtype=np.uint8)
    steps = _steps(group, time)
    steps["NumberOfParts"], steps["PartOffsets"] = np.ones(len(time), dtype="<i8"), np.zeros(len(time), dtype="<i8")
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = np.zeros((len(time), 1), dtype="<i8")
    for name in ("PointData", "CellData"):
        group.create_group(name)
        steps.create_group(f"{name}Offsets")


def _add(group: Any, grid: Grid, number: int, row: int, rows: int) -> None:
    """Writes a row's points and arrays, each as one block."""
    points, at_points, of_cells = grid.at(row)
    steps = group["Steps"]
    if number == 0:
        group["NumberOfPoints"] = np.array([len(points)], dtype="<i8")
    _block(group, steps, "Points", "PointOffsets", points, number, rows)
    for kind, arrays in (("PointData", at_points), ("CellData", of_cells)):
        for name, values in arrays.items():
            _block(group[kind], steps[f"{kind}Offsets"], name, name, values, number, rows)


def _block(data: Any, offsets: Any, name: str, offset: str, values: np.ndarray, number: int, rows: int) -> None:
    if number == 0:
        data.create_dataset(name, (rows * len(values), *values.shape[1:]), "<f4")
        offsets[offset] = len(values) * np.arange(rows, dtype="<i8")
    data[name][number * len(values) : (number + 1) * len(values)] = values
