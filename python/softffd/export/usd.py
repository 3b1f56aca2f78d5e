"""USD with time samples: the format of film and robotics software, and of Blender, Houdini, Omniverse.

/softffd               z up, in metres; a second is 24 time codes
  object               Mesh: points and extent at every row, the colours of faces; normals are left to the reader
  lattice              Points, for guidance (purpose "guide"): the control points; of a solid the corners of its cells
  obstacles/NAME       Mesh, its pose at every row where it moves
"""

from pathlib import Path
from typing import Any

import numpy as np

from softffd.export.take import CLEAR, Rigid, Take
from softffd.lattice import bounding_box
from softffd.mesh.looks import to_light
from softffd.rotation import quaternions

RATE = 24.0
"""Time codes per second"""
AT_A_TIME = 1 << 26
"""Number of values that are kept before they are written to the file"""


def write(take: Take, path: Path) -> None:
    """Writes the file in the form that its ending names: .usdc or .usd in binary, .usda as text. Raises OSError if it cannot be written."""
    from pxr import Tf

    try:
        _write(take, path)
    except Tf.ErrorException as error:
        raise OSError(f"{path.name} cannot be written: {error}") from None


def _write(take: Take, path: Path) -> None:
    from pxr import Sdf, Usd, UsdGeom

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(RATE)
    stage.SetFramesPerSecond(RATE)
    stage.SetStartTimeCode(RATE * take.time[0])
    stage.SetEndTimeCode(RATE * take.time[-1])
    root = UsdGeom.Xform.Define(stage, "/softffd")
    root.GetPrim().SetMetadata("comment", take.stage.title)
    stage.SetDefaultPrim(root.GetPrim())
    for obstacle in take.obstacles:
        _obstacle(take, stage, obstacle)
    mesh = _mesh(stage, "/softffd/object", take.mesh.faces)
    shares = np.full((3, len(take.mesh.faces)), 1 / 3, dtype=np.float32)
    colours = take.stage.skin.painter(take.stage.faces)(np.arange(len(take.mesh.faces)), shares)
    mesh.CreateDisplayColorPrimvar(UsdGeom.Tokens.uniform).Set(_vectors(to_light(colours.T)))
    lattice = UsdGeom.Points.Define(stage, "/softffd/lattice")
    lattice.CreatePurposeAttr(UsdGeom.Tokens.guide)
    lattice.CreateWidthsAttr([0.02 * float(take.stage.size.max())])
    lattice.SetWidthsInterpolation(UsdGeom.Tokens.constant)
    kept = 0
    for number, row in take.told_rows():
        with Sdf.ChangeBlock():
            for shape, points in ((mesh, take.deformed(row)), (lattice, take.lattice(row))):
                _sample(shape, points, RATE * take.time[number])
                kept += points.size
        if kept > AT_A_TIME:
            stage.GetRootLayer().Save()
            kept = 0
    stage.GetRootLayer().Save()


def _vectors(values: np.ndarray) -> Any:
    from pxr import Vt

    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, dtype=np.float32))


def _mesh(stage: Any, place: str, faces: np.ndarray) -> Any:
    from pxr import UsdGeom, Vt

    mesh = UsdGeom.Mesh.Define(stage, place)
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), 3, dtype=np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(faces.reshape(-1), dtype=np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    return mesh


def _sample(shape: Any, points: np.ndarray, time: float | None) -> None:
    """Sets points and extent at a time, in time codes, or for all times if it is None."""
    from pxr import Usd

    at = Usd.TimeCode.Default() if time is None else Usd.TimeCode(time)
    shape.CreatePointsAttr().Set(_vectors(points), at)
    shape.CreateExtentAttr().Set(_vectors(np.stack(bounding_box(points))), at)


def _obstacle(take: Take, stage: Any, obstacle: Rigid) -> None:
    from pxr import Gf, Tf, UsdGeom

    mesh = _mesh(stage, f"/softffd/obstacles/{Tf.MakeValidIdentifier(obstacle.name)}", obstacle.faces)
    _sample(mesh, obstacle.vertices, None)
    mesh.CreateDisplayColorPrimvar(UsdGeom.Tokens.constant).Set(_vectors(to_light(np.array([obstacle.tint]))))
    if obstacle.kind == "plane":
        mesh.CreateDisplayOpacityPrimvar(UsdGeom.Tokens.constant).Set([CLEAR])
    place, turn = mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble), mesh.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    turns = quaternions(obstacle.axes[take.rows].transpose(0, 2, 1)).tolist()
    for number, (row, (w, *axis)) in enumerate(zip(take.rows.tolist(), turns, strict=True)):
        at = [RATE * take.time[number]] if obstacle.moves else []
        if at or number == 0:
            place.Set(Gf.Vec3d(*obstacle.points[row].tolist()), *at)
            turn.Set(Gf.Quatd(w, *axis), *at)
