"""Other people's readers of exported runs: VTK's and USD's own, Khronos's validator of glTF, and what ffmpeg says of its film."""

import json
import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from exported import planes, single, solids, surface
from softffd import Result, SoftffdError
from softffd.export.film import SIZES
from softffd.lattice import rest_grid, to_flat

SIX = (0, 1, 2, 0, 1, 0), (0, 1, 2, 1, 2, 2)


@pytest.fixture(params=["thrown", "pressed", "solid"])
def any_run(request) -> Result:
    return request.getfixturevalue(request.param)


def read_vtkhdf(path: Path, time: float) -> dict:
    """Grids of VTK by name at a time."""
    from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader(file_name=str(path))
    assert reader.CanReadFile(str(path))
    reader.UpdateTimeStep(time)
    blocks = reader.GetOutputDataObject(0)
    names = [blocks.GetMetaData(number).Get(vtkCompositeDataSet.NAME()) for number in range(blocks.GetNumberOfBlocks())]
    return {name: blocks.GetBlock(number) for number, name in enumerate(names)}


def read_pvd(path: Path, time: float) -> dict:
    from xml.etree import ElementTree

    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    grids = {}
    for each in ElementTree.parse(path).iter("DataSet"):
        if float(each.get("timestep")) == time:
            reader = vtkXMLUnstructuredGridReader(file_name=str(path.parent / each.get("file")))
            reader.Update()
            grids[each.get("name")] = reader.GetOutput()
    return grids


@pytest.mark.full
@pytest.mark.parametrize("read, ending", [(read_vtkhdf, "vtkhdf"), (read_pvd, "pvd")], ids=["vtkhdf", "vtu"])
def test_vtk_reads_the_vertices_the_strain_and_the_stress_of_every_row(any_run, read, ending, tmp_path):
    pytest.importorskip("vtk", reason="vtk is not installed: pip install 'softffd[readers]'")
    pytest.importorskip("h5py", reason="h5py is not installed: pip install 'softffd[vtkhdf]'")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    any_run.export(tmp_path / f"run.{ending}")
    rest = surface(replace(any_run, positions=any_run.lattice.rest()[None]), 0)
    for row, time in enumerate(any_run.time):
        if row % 5 and row + 1 < len(any_run.time):
            continue
        grids = read(tmp_path / f"run.{ending}", time)
        points = {name: vtk_to_numpy(grid.GetPoints().GetData()) for name, grid in grids.items()}
        wanted = surface(any_run, row)
        assert np.abs(points["mesh"] - wanted).max() <= single(wanted)
        moved = vtk_to_numpy(grids["mesh"].GetPointData().GetArray("displacement"))
        assert np.abs(moved - (wanted - rest)).max() <= single(wanted)
        cells = vtk_to_numpy(grids["mesh"].GetCells().GetConnectivityArray()).reshape(-1, 3)
        assert any_run.loaded_mesh is None or np.array_equal(cells, any_run.loaded_mesh.faces)
        parts = {str(part).replace(".", "_"): part.name for part in any_run.obstacle_parts()}
        assert set(points) == {"mesh", "lattice", *parts}
        for name, place in points.items():
            if parts.get(name) in solids(any_run, row):
                assert np.abs(place - solids(any_run, row)[parts[name]]).max() <= single(place)
            elif name in parts:
                point, normal = planes(any_run, row)[parts[name]]
                assert np.abs((place - point) @ normal).max() <= 4 * single(place)
        require_tensors(any_run, row, grids["lattice"])


@pytest.mark.full
@pytest.mark.parametrize("read, ending", [(read_vtkhdf, "vtkhdf"), (read_pvd, "pvd")], ids=["vtkhdf", "vtu"])
def test_vtk_reads_the_contact_pressure_of_a_scene_with_taxels(felt, pressed, read, ending, tmp_path):
    pytest.importorskip("vtk", reason="vtk is not installed: pip install 'softffd[readers]'")
    pytest.importorskip("h5py", reason="h5py is not installed: pip install 'softffd[vtkhdf]'")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    felt.export(tmp_path / f"felt.{ending}")
    for row, time in enumerate(felt.time):
        found = vtk_to_numpy(read(tmp_path / f"felt.{ending}", time)["mesh"].GetPointData().GetArray("contact_pressure"))
        assert np.abs(found - felt.contact_pressure(row)).max() <= 1e-6 * max(found.max(), 1.0)
    assert found.max() > 500.0
    pressed.export(tmp_path / f"plain.{ending}")
    assert read(tmp_path / f"plain.{ending}", pressed.time[0])["mesh"].GetPointData().GetArray("contact_pressure") is None


def require_tensors(result: Result, row: int, grid) -> None:
    """Strain and stress of the cells, whose middles are where those of the lattice are; a cell of VTK has a volume > 0."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

    lattice = result.lattice
    corners = result.positions[row]
    if lattice.basis == "patches":
        corners = result.deformed(to_flat(rest_grid(lattice.points, lattice.origin, lattice.size)), row=row)
    points = vtk_to_numpy(grid.GetPoints().GetData())
    assert np.abs(points - (corners if corners.ndim == 2 else to_flat(corners))).max() <= single(points)
    data = grid.GetCellData()
    for name, values in (("strain", result.strain(row)), ("stress", result.stress(row))):
        found, wanted = vtk_to_numpy(data.GetArray(name)), to_flat(values[..., *SIX])
        assert np.abs(found - wanted).max() <= 1e-6 * max(np.abs(wanted).max(), 1e-6), name
    assert {data.GetArrayName(n) for n in range(data.GetNumberOfArrays())} == {"strain", "stress", "von_mises", "stretch"}
    sizes = vtkCellSizeFilter(input_data_object=grid)
    sizes.Update()
    assert vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume")).min() > 0


VALIDATE = """
const bytes = new Uint8Array(require("fs").readFileSync(process.argv[1]));
require("gltf-validator").validateBytes(bytes).then(report => console.log(JSON.stringify(report)));
"""


@pytest.mark.full
def test_khronos_s_validator_finds_nothing_in_a_glb(any_run, tmp_path):
    """npm's package gltf-validator, where there is npm."""
    if not (shutil.which("npm") and shutil.which("node")):
        pytest.skip("npm is not installed")
    installed = subprocess.run(["npm", "install", "--prefix", tmp_path, "gltf-validator@2.0.0-dev.3.10"], capture_output=True, check=False)
    if installed.returncode:
        pytest.skip("npm's registry is not in reach")
    any_run.export(tmp_path / "run.glb")
    said = subprocess.run(["node", "-e", VALIDATE, tmp_path / "run.glb"], capture_output=True, cwd=tmp_path, check=True).stdout
    report = json.loads(said)
    assert report["issues"]["numErrors"] == report["issues"]["numWarnings"] == 0, report["issues"]["messages"]
    assert report["info"]["animationCount"] == 1


@pytest.mark.full
@pytest.mark.parametrize("ending", ["usdc", "usda"])
def test_usd_has_the_vertices_of_every_row_and_says_its_units(any_run, ending, tmp_path):
    pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'softffd[usd]'")
    from pxr import Usd, UsdGeom

    any_run.export(tmp_path / f"run.{ending}")
    stage = Usd.Stage.Open(str(tmp_path / f"run.{ending}"))
    assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == ("Z", 1.0)
    rate = stage.GetTimeCodesPerSecond()
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == pytest.approx((rate * any_run.time[0], rate * any_run.time[-1]))
    assert stage.GetDefaultPrim().GetName() == "softffd"
    mesh = UsdGeom.Mesh.Get(stage, "/softffd/object")
    assert len(mesh.GetPointsAttr().GetTimeSamples()) == len(any_run.time)
    assert len(mesh.GetDisplayColorPrimvar().Get()) == len(mesh.GetFaceVertexCountsAttr().Get())
    for row, time in enumerate(any_run.time):
        wanted, at = surface(any_run, row), Usd.TimeCode(rate * time)
        assert np.abs(np.array(mesh.GetPointsAttr().Get(at)) - wanted).max() <= single(wanted)
        assert np.array(mesh.GetExtentAttr().Get(at)) == pytest.approx(
            np.stack([wanted.min(axis=0), wanted.max(axis=0)]), abs=single(wanted)
        )
        for name, places in solids(any_run, row).items():
            shape = UsdGeom.Mesh.Get(stage, f"/softffd/obstacles/{name}")
            matrix = np.array(shape.ComputeLocalToWorldTransform(at))
            still = np.array(shape.GetPointsAttr().Get())
            assert np.abs(still @ matrix[:3, :3] + matrix[3, :3] - places).max() <= 2 * single(places)


def test_mp4_without_ffmpeg_is_refused_before_a_picture_is_drawn(pressed, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SoftffdError, match="needs the program ffmpeg, which is not on the PATH; install it, or take gif"):
        pressed.export(tmp_path / "run.mp4")
    assert os.listdir(tmp_path) == []


@pytest.mark.full
def test_mp4_lasts_as_long_as_the_run(thrown, tmp_path, monkeypatch):
    if shutil.which("ffmpeg") is None:
        pytest.skip("ffmpeg is not on the PATH")
    monkeypatch.setitem(SIZES, ".mp4", (160, 106, 30))
    thrown.export(tmp_path / "run.mp4", frames=5)
    said = subprocess.run(["ffmpeg", "-i", tmp_path / "run.mp4", "-f", "null", "-"], capture_output=True, text=True).stderr
    assert "160x106" in said and "Duration: 00:00:02.0" in said and "frame=   61" in said
