"""The result of a run: its numbers, and the forms in which they can be given, each by a method of one class."""

from __future__ import annotations

import base64
import html
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from softffd.embedding.deform import deform, outside
from softffd.errors import MeshError, SoftffdError, UnknownName
from softffd.fmu.instance import Message
from softffd.lattice import LatticeBox, all_points
from softffd.names import ByName, listed, variable_names
from softffd.obstacles import Obstacles
from softffd.run.courses import ObstacleCourses
from softffd.run.pressure import Covered, covered, grid_of, surface_pressure, taxel_pressure
from softffd.run.result_file import read_result, write_files
from softffd.run.stress import deformation, green_strain, lattice_gradients, lattice_stress
from softffd.run.tables import dataset, package
from softffd.spelling import did_you_mean, nearest_of
from softffd.taxels import TaxelGrid

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from softffd.mesh.mesh import Mesh
    from softffd.scene.scene import Scene

T = TypeVar("T")

POSITIONS = 'outputs.positions = "all", and "position" in output= where that is given'
"""What a run needs to be shown, in messages"""
LARGEST_PAGE = 2e6  # largest interactive page that is embedded in a notebook [characters]


class Columns(ByName[T]):
    """Values by variable name; a name that does not exist raises UnknownName with the nearest name that does."""

    def __init__(self, values: Mapping[str, T], what: str):
        super().__init__(values)
        self._what = what

    def __missing__(self, name: str) -> T:
        if name in self:
            return super().__missing__(name)
        raise UnknownName(f"{name}: there is no {self._what} of this name in the result{did_you_mean(nearest_of(str(name), self))}")


@dataclass(frozen=True, eq=False, repr=False)
class Result(ObstacleCourses):
    """The result of a run, one row per communication point."""

    time: np.ndarray
    """Communication points (T,) [s]"""
    positions: np.ndarray
    """Positions (T, nx, ny, nz, 3) [m] of the control points; NaN for those that are not among the outputs"""
    outputs: dict[str, np.ndarray]
    """The other outputs by variable name, (T,) each"""
    inputs: dict[str, np.ndarray]
    """Inputs by variable name as held over the step that begins at each time, (T,) each"""
    parameters: dict[str, float]
    """Parameters by variable name"""
    summary: dict[str, Any]
    """title, simulated_time_s, run_time_s, real_time_factor, communication_steps, warnings, ..."""
    scene: Scene | None = None
    """The scene, if the run started from one"""
    lattice: LatticeBox | None = None
    """Numbers of control points, box at rest and basis, as the FMU has them; None for an FMU that is not of this package"""
    flat_names: bool = False
    """True if names at control points are the flat ones (fmu.names), in `outputs`, `inputs` and the files"""
    obstacles: Obstacles | None = None
    """What of the object the obstacles touch, and shapes of solids, as the FMU has them; None for an FMU that is not of this package"""
    log: tuple[Message, ...] = ()
    """All messages of the component"""
    taxels: tuple[TaxelGrid, ...] = ()
    """The grids of the sensors that have taxels, as the FMU has them"""
    sceneless: str = ""
    """Why a result that was loaded from a file does not have its scene"""

    def __post_init__(self) -> None:
        for field_name, what in (("outputs", "output"), ("inputs", "input"), ("parameters", "parameter")):
            object.__setattr__(self, field_name, Columns(getattr(self, field_name), what))

    def __repr__(self) -> str:
        span = f"{self.time[0]:.6g} to {self.time[-1]:.6g} s" if len(self.time) else "no time"
        lines = [f"Result of {self.title}: {span} in {len(self.time)} rows"]
        if self.positions.size:
            depths = self.deformation()
            row = int(np.argmax(depths))
            found = f"largest deformation {depths[row]:.4g} m at {self.time[row]:.4g} s" if self.has_positions else "not all recorded"
            lines.append(f"positions {self.positions.shape} m, {found}")
        lines += [f"{what}: {listed(names)}" for what in ("outputs", "inputs", "parameters") if (names := getattr(self, what))]
        if warnings := self.summary.get("warnings"):
            lines.append(f"{len(warnings)} warning{'s' * (len(warnings) > 1)}, the first: {warnings[0]}")
        if self.sceneless:
            lines.append(f"without its scene: {self.sceneless}")
        return "\n  ".join(lines)

    @property
    def title(self) -> str:
        """Title of the scene; without a scene the title that the FMU gives."""
        return str(self.summary.get("title", "")) if self.scene is None else self.scene.title

    @property
    def loaded_mesh(self) -> Mesh | None:
        """The mesh of the run's scene at rest; None if there is none."""
        return self.scene.loaded_mesh if self.scene else None

    @property
    def has_positions(self) -> bool:
        """True if the positions of all control points were recorded."""
        return self.positions.size > 0 and not np.isnan(self.positions).any()

    def deformation(self) -> np.ndarray:
        """Returns how far the lattice is deformed at each time, (T,) [m]: the largest distance of a control point from the rest shape,
        after the rest shape is moved and rotated to fit best. Without a lattice the first positions stand for the rest shape. NaN if
        positions were not recorded."""
        if not self.has_positions:
            return np.full(len(self.time), np.nan)
        return deformation(self.positions, self.positions[0] if self.lattice is None else self.lattice.rest())

    def strain(self, row: int | slice = -1) -> np.ndarray:
        """Returns the Green-Lagrange strain at the centre of each cell (nx - 1, ny - 1, nz - 1, 3, 3) at a row of `time`, the last by
        default; (T, ...) for a slice. SoftffdError if positions of control points were not recorded."""
        return green_strain(lattice_gradients(*self._of_lattice(row, "strain")))

    def stress(self, row: int | slice = -1) -> np.ndarray:
        """Returns the Cauchy stress at the centre of each cell [Pa], in the shape of `strain`; NaN in inverted cells. For springs, it
        is the stress of all springs in a cell; for a solid, that of its material at the centre. Parameters have their values at the
        start. SoftffdError also for a run without its scene."""
        positions, lattice = self._of_lattice(row, "stress")
        if self.scene is None:
            raise SoftffdError(f"stress: wanted a run with its scene, which defines the material{self.sceneless and f'; {self.sceneless}'}")
        return lattice_stress(positions, lattice, self.scene, self.parameters)

    def taxel_pressure(self, name: str) -> np.ndarray:
        """Returns the contact pressure on the taxels of a sensor, (T, n, m) [Pa]: means over the communication steps that end at the
        times.

        The pressure is the force on a taxel towards the object, along the axis that the sensor's patch faces most, divided by the
        taxel's area at rest seen along this axis. SoftffdError with the nearest name for an unknown sensor or one without taxels, and
        for a patch that faces both ways along every axis."""
        return taxel_pressure(self.outputs, grid_of(self.taxels, name))

    def contact_pressure(self, row: int | slice = -1) -> np.ndarray:
        """Returns the contact pressure (V,) [Pa] at the vertices of the scene's mesh, without a mesh those of the box's surface that
        pictures show, at a row of `time`, the last by default; (T, V) for a slice. The pressure is linear between the centres of
        taxels, 0 where there are none, and the largest where sensors overlap. SoftffdError for a run without taxels, or with neither a
        mesh nor recorded positions."""
        from softffd.show.stage import surface_of

        self._positions_at(row, "contact_pressure")
        return surface_pressure(self.outputs, self.covered_by_taxels(surface_of(self)), row)

    def covered_by_taxels(self, surface: Mesh) -> list[Covered]:
        """Returns what each sensor's taxels cover of a surface at rest, the scene's mesh or that of the box; empty without taxels."""
        patches = {sensor.name: sensor.where for sensor in self.scene.sensor} if self.scene and surface is self.loaded_mesh else {}
        return covered(self.taxels, self.outputs, surface, patches)

    def _of_lattice(self, row: int | slice, who: str) -> tuple[np.ndarray, LatticeBox]:
        if self.lattice is None or not self.has_positions:
            raise SoftffdError(f"{who}: wanted a run of an FMU of softffd with {POSITIONS}")
        return self._positions_at(row, who), self.lattice

    def _positions_at(self, row: int | slice | np.ndarray, who: str) -> np.ndarray:
        """Returns the positions at a row of `time`, a slice or an array of rows; SoftffdError for anything else."""
        rows, asked = len(self.time), np.asarray(0 if isinstance(row, slice) else row)
        if not (asked.dtype.kind in "iu" and (-rows <= asked).all() and (asked < rows).all()):
            raise SoftffdError(f"{who}: wanted a row of {rows}, counted from 0 or from the end, or a slice of them, got row={row!r:.70}")
        return self.positions[row]

    def deformed(self, mesh: Mesh | np.ndarray | None = None, *, row: int | slice = -1) -> np.ndarray:
        """Returns the deformed vertices (V, 3) [m] of a mesh in the run's lattice at a row of `time`, the last by default; a slice: (T, V,
        3).

        mesh: a Mesh or vertices (V, 3) [m] at rest; the scene's mesh by default. MeshError if there is none or a vertex is outside the
            box, SoftffdError if positions of control points were not recorded.
        """
        mesh = self.loaded_mesh if mesh is None else mesh
        if mesh is None:
            why = self.sceneless or "the run's scene has none"
            raise MeshError(f"deformed: wanted a mesh, for {why}")
        if not hasattr(mesh, "vertices") and (np.ndim(mesh) != 2 or np.shape(mesh)[1] != 3):
            raise MeshError(f"deformed: wanted a Mesh or vertices (V, 3), got the shape {np.shape(mesh)}")
        positions = self._positions_at(row, "deformed")
        if self.lattice is None or np.isnan(positions).any():
            raise SoftffdError(f"deformed: wanted a run of an FMU of softffd with {POSITIONS}")
        points: Any = getattr(mesh, "vertices", mesh)
        if found := outside(points, self.lattice.origin, self.lattice.size):
            hint = "" if points is mesh else ", as load_mesh reads a mesh with the scene's scale and up"
            raise MeshError(f"deformed: {found}. Wanted points of the rest shape in m within the box{hint}.")
        return deform(mesh, positions, origin=self.lattice.origin, size=self.lattice.size, basis=self.lattice.basis)

    def save(self, path: str | Path) -> list[Path]:
        """Writes NAME.npz, all of the result in one file, for a path with that ending; for any other a folder of result.npz, result.csv
        and summary.json. Each file appears whole or not at all. Returns the paths of the files.

        A file keeps the keys of the scene; of a mesh it keeps the path of the mesh file and a fingerprint.
        """
        return write_files(Path(path), vars(self), {"time": self.time, **self.columns()})

    @classmethod
    def load(cls, path: str | Path, *, mesh: str | Path | None = None) -> Result:
        """Returns the result that `save` or `softffd run` wrote, from NAME.npz or from the folder.

        The result has its scene if the scene's mesh is found and unchanged; otherwise `scene` is None and `sceneless` says why. The mesh
        is looked for beside the file; else where it was, if that is below the file's folder or the working one; in any other place only if
        `mesh` says so. SoftffdError for a file that is missing, damaged or something else.
        """
        return cls(**read_result(Path(path), None if mesh is None else Path(mesh)))

    def columns(self) -> dict[str, np.ndarray]:
        """Returns all outputs that were recorded, positions among them, by variable name, (T,) each."""
        recorded = [point for point in all_points(self.positions.shape[1:4]) if not np.isnan(self.positions[0, *point, 0])]
        columns = (self.positions[:, *point, axis] for point in recorded for axis in range(3))
        names = variable_names("position", recorded, flat=self.flat_names)
        return {**self.outputs, **dict(zip(names, columns, strict=True))}

    def to_dataframe(self) -> pd.DataFrame:
        """Returns outputs and inputs as a DataFrame, whose index is the time [s]: `columns` and `inputs`. Needs softffd[dataframes]."""
        pandas = package("pandas", "to_dataframe", "dataframes")
        return pandas.DataFrame({**self.columns(), **self.inputs}, index=pandas.Index(self.time, name="time"))

    def to_xarray(self) -> xr.Dataset:
        """Returns outputs and inputs as a Dataset with units: a vector is one array (time, axis), vectors at control points (time, i,
        j, k, axis), as `position`; parameters are attributes. Needs softffd[datasets]."""
        return dataset(self.time, self.positions, {**self.outputs, **self.inputs}, {"title": self.title, **self.parameters})

    def plot(
        self, path: str | Path | None = None, *, x: str = "time", y: str | Iterable[str] = (), colour: str | None = None,
        lattice: bool | None = None,
    ) -> Figure:  # fmt: skip
        """Draws the picture of the run: its telling moments, with its scene's mesh, and the curves; written to `path` if given (PNG,
        SVG or PDF).
        colour: "von_mises" (stress) or "stretch" (the largest principal one) of the cells, or "contact_pressure" on taxels, in place of
            the object's own colours.
        lattice: show the lattice; by default if there is no mesh.
        With `y`, names of outputs or inputs (a vector's name means its components), only their curves are drawn over `x`, time or another
        of them: plot(x="plane.press.point.z", y="plane.press.reaction.z").
        Returns matplotlib's Figure. UnknownName with the nearest name for an unknown one; SoftffdError if the picture needs positions
        that were not recorded."""
        from softffd.show.figure import kept_at
        from softffd.show.picture import curve_picture, run_picture

        if (x != "time" and not y) or ((colour or lattice is not None) and y):
            raise SoftffdError("plot: wanted x with y, and colour and lattice without them")
        return kept_at(path, curve_picture(self, x=x, y=y) if y else run_picture(self, colour=colour, lattice=lattice))

    def plot_taxels(self, name: str, path: str | Path | None = None) -> Figure:
        """Draws the contact pressure on the taxels of a sensor: maps of the grid when half of the largest force is reached, at the
        largest pressure, at the largest force, and at the end if the grid is pressed then; the largest and the mean pressure over time.
        Writes the figure to `path` (PNG, SVG or PDF) if one is given. Returns matplotlib's Figure. SoftffdError as in `taxel_pressure`."""
        from softffd.show.figure import kept_at
        from softffd.show.taxels import taxel_picture

        return kept_at(path, taxel_picture(self, name))

    def view(self, path: str | Path | None = None, *, browser: bool = True) -> Path:
        """Writes the interactive page to `path`, by default a temporary file, and opens it in the browser. Returns the page's path.
        SoftffdError if positions were not recorded."""
        from softffd.show.view import write_view

        written = write_view(self, Path(tempfile.mkdtemp(prefix="softffd-view-")) / "view.html" if path is None else path)
        if browser:
            import webbrowser

            webbrowser.open(written.resolve().as_uri())
        return written

    def export(
        self, path: str | Path, *, to: str | None = None, tolerance: float | None = None, frames: int | None = None,
        lattice: bool | None = None,
    ) -> list[Path]:  # fmt: skip
        """Writes the run for another program, in the format of the path's ending, or `to`: vtkhdf, vtu, glb, usd, pc2, ply, gif or mp4.
        Either all files appear, in place of files of their names, or none does. Returns their paths.
        tolerance: for glb, the largest error of a vertex as a fraction of the largest side of the box; 1e-3 by default.
        frames: how many rows to take, evenly chosen, >= 2; all by default.
        lattice: for gif and mp4, show the lattice; by default if there is no mesh.
        SoftffdError if positions were not recorded or something is missing."""
        from softffd.export.formats import export_result

        return export_result(self, path, to=to, tolerance=tolerance, frames=frames, lattice=lattice)

    def _repr_html_(self) -> str:
        """Returns the text for a notebook and, if positions were recorded, the picture and, if it is small, the interactive page."""
        words = f'<pre style="white-space: pre-wrap">{html.escape(repr(self))}</pre>'
        if not self.has_positions:
            return words
        from softffd.show.figure import png_of
        from softffd.show.view import page_text

        data = base64.b64encode(png_of(self.plot())).decode("ascii")
        picture = f'<img alt="{html.escape(self.title)}" style="max-width: 100%" src="data:image/png;base64,{data}">'
        page = page_text(self)
        if len(page) > LARGEST_PAGE:
            return f"{words}{picture}<p>The interactive page is large: <code>view()</code> opens it in the browser.</p>"
        frame = f'<iframe loading="lazy" style="width: 100%; height: 36rem; border: 0" srcdoc="{html.escape(page)}"></iframe>'
        return f"{words}{picture}<details><summary>interactive page</summary>{frame}</details>"
