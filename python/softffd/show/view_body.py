"""What a page holds of one run, its body: the surface at rest, the control points of its frames, its obstacles and its contacts."""

import base64
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from softffd.embedding.deform import BASES, deform
from softffd.lattice import to_flat
from softffd.mesh.looks import Picture
from softffd.run.findings import energies, reactions
from softffd.run.pressure import taxel_pressure, with_pressure
from softffd.run.result import Result
from softffd.run.stress import green_strain
from softffd.show.raster import Tint
from softffd.show.solid import Form
from softffd.show.stage import PlaneTrack, SolidTrack, Stage
from softffd.show.surface import surface
from softffd.show.tension import PRESSED, AtlasPlaces, Cells, atlas_places, cells_of, pressure_of
from softffd.show.touch import Touch, touch_of
from softffd.taxels import TaxelGrid

MOST_FRAMES = 600
MOST_POINT_BYTES = 24e6  # size of the control points of all frames before encoding as text: 600 frames of up to 3300 points
MOST_TEXELS = 1024
SAMPLES = 1000
ENERGY_MARKS = {"kinetic": "#0072b2", "elastic": "#d55e00"}


@dataclass(frozen=True, eq=False)
class Body:
    """A run that a page plays. `name`: its name among several runs, "" for a single run. `pane`: number of the picture that shows it."""

    name: str
    pane: int
    result: Result
    stage: Stage

    @cached_property
    def frames(self) -> np.ndarray:
        """The frames in the page: all, or evenly chosen ones with the first and the last."""
        count, points = len(self.stage.time), int(np.prod(self.stage.counts))
        most = max(2, min(MOST_FRAMES, int(MOST_POINT_BYTES / (12 * points))))
        return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))

    @cached_property
    def cells(self) -> dict[str, Cells]:
        return {each.name: each for each in (*cells_of(self.result, self.frames), pressure_of(self.result, self.frames)) if each}

    @cached_property
    def touch(self) -> Touch:
        return touch_of(self.result, self.stage)

    @property
    def scale(self) -> float:
        """Scale of the arrows, proportional to an arrow's length by the square root of its force [m / N^0.5]."""
        return float(np.linalg.norm(self.stage.size)) / np.sqrt(self.touch.largest or np.inf)

    def held(self, scales: dict[str, tuple[float, float]], scale: float) -> dict[str, Any]:
        """Returns all data of the body. scales: ends of the colour scales of its cells by name; scale: of the arrows [m / N^0.5]."""
        stage, frames = self.stage, self.frames
        return {
            **scenery(stage, frames, self.name, self.pane, atlas_places(self.result, stage) if PRESSED in scales else None),
            "time": text(stage.time[frames], "<f8"),
            "positions": text(to_flat(stage.positions[frames]) - stage.centre, "<f4"),
            "cells": [_cells(self.cells[name], ends) for name, ends in scales.items()],
            "sizes": [self.cells[name].values.shape[1:] for name in scales],
            "touch": self._touch(scale / (self.scale or 1.0)),
        }

    def _touch(self, scale: float) -> dict[str, Any]:
        """Returns touched places (N, 3), as many for each frame as `counts` says, and beginnings and vectors of arrows (T, 3); all in m."""
        stage, frames = self.stage, self.frames
        places = [np.concatenate(self.touch.places(frame)) - stage.centre for frame in frames]
        arrows = [
            {"starts": text((starts - stage.centre)[frames], "<f4"), "ways": text(scale * ways[frames], "<f4")}
            for starts, ways in zip(self.touch.starts, self.touch.ways, strict=True)
        ]
        return {"places": text(np.concatenate(places), "<f4"), "counts": [len(each) for each in places], "arrows": arrows}

    def rows(self, most: float) -> list[dict[str, Any]]:
        """Returns the curves of the readout: magnitudes of the reactions [N] with their vectors, kinetic and elastic energy [J], and for
        sensors with taxels the largest pressure [Pa] and the maps of all taxels, whose colours end at `most` [Pa]."""
        marks, frames = {each.name: hex_of(each.tint) for each in self.stage.obstacles}, self.frames
        rows = []
        for part, force in reactions(self.result).items():
            mark = marks.get(part.name, "var(--pin)") if part.is_obstacle else "var(--pin)"
            rows.append(_row(part.name, "reaction", "N", mark, np.linalg.norm(force, axis=1)[frames], force[frames]))
        recorded = energies(self.result)
        for name, mark in ENERGY_MARKS.items():
            if name in recorded:
                rows.append(_row(name, "energy", "J", mark, recorded[name][frames]))
        outputs = self.result.outputs
        return rows + [_map(grid, taxel_pressure(outputs, grid, frames), most) for grid in with_pressure(self.result.taxels, outputs)]


def scenery(stage: Stage, frames: np.ndarray, name: str = "", pane: int = 0, taxels: AtlasPlaces | None = None) -> dict[str, Any]:
    """Returns the data that do not change: name, lattice, surface at rest, and obstacles; and the poses of the obstacles in `frames`."""
    return {
        "name": name,
        "pane": pane,
        "counts": stage.counts,
        "bases": [BASES.index(stage.basis) if n > 4 else 0 for n in stage.counts],
        "origin": (stage.origin - stage.centre).tolist(),
        "size": stage.size.tolist(),
        "pinned": stage.pinned.tolist(),
        "cage": int(stage.is_cage),
        "surface": surface(stage, taxels),
        "pictures": [_image(picture) for picture in stage.skin.pictures],
        "planes": [_obstacle(plane, stage, frames) | {"floor": plane.is_floor} for plane in stage.planes],
        "solids": [_obstacle(solid, stage, frames) | _form(solid.form) for solid in stage.solids],
    }


def _image(texture: Picture) -> str:
    """Returns a texture as a PNG inside the page, at most 1024 pixels wide and high."""
    small = texture.convert("RGB")
    small.thumbnail((MOST_TEXELS, MOST_TEXELS))
    stream = BytesIO()
    small.save(stream, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def _obstacle(track: PlaneTrack | SolidTrack, stage: Stage, frames: np.ndarray) -> dict[str, Any]:
    """Returns an obstacle's name, colour and poses (T, 9): a point relative to the stage's centre [m], the unit normal, a unit tangent."""
    poses = np.hstack([track.points - stage.centre, track.normals, track.tangents])[frames]
    return {"name": track.name, "tint": track.tint, "poses": text(poses, "<f4")}


def _form(form: Form) -> dict[str, Any]:
    """Returns kind and size [m]; vertices (V, 3) [m] along tangent, normal x tangent and normal, normals (V, 3), and triangles (F, 3)."""
    shape = {"kind": form.shape.kind, "size": form.shape.size}
    arrays = {"vertices": text(form.vertices, "<f4"), "normals": text(form.normals, "<f4"), "triangles": text(form.faces, "<u4")}
    return shape | arrays


def _row(label: str, kind: str, unit: str, mark: str, values: np.ndarray, vectors: np.ndarray | None = None) -> dict[str, Any]:
    texts = {"label": label, "kind": kind, "unit": unit, "mark": mark}
    return texts | {"values": text(values, "<f4"), "vectors": None if vectors is None else text(vectors, "<f4")}


def _map(grid: TaxelGrid, pressure: np.ndarray, most: float) -> dict[str, Any]:
    """Returns a sensor's row: the pressures of its taxels (T, m, n) in 255ths of `most` [Pa], the grid's first side running fastest."""
    shares = (255.0 * (pressure / most).clip(0, 1)).round().transpose(0, 2, 1)
    right, up = ("xyz"[axis] for axis in grid.along)
    wide, high = (end - begin for begin, end in zip(grid.lower, grid.upper, strict=True))
    about = {"counts": grid.counts, "shares": text(shares, "u1"), "words": f"{right} to the right, {up} up", "most": most}
    about["aspect"] = wide / high if wide > 0 and high > 0 else grid.counts[0] / grid.counts[1]
    return _row(grid.name, "peak", "Pa", "#009e73", pressure.max(axis=(1, 2))) | {"taxels": about}


def hex_of(tint: Tint) -> str:
    """Returns the colour of an obstacle's text and curves, in hexadecimal."""
    return "#" + "".join(f"{round(255 * 0.8 * c):02x}" for c in tint)


def largest(stage: Stage, frames: np.ndarray) -> dict[str, float]:
    """Returns the ends of the colour scales, which 1 % of the worst frame's samples exceed: displacement [m], Green strain."""
    chosen = np.linspace(0, len(stage.vertices) - 1, min(len(stage.vertices), SAMPLES)).astype(int)
    samples = stage.vertices[chosen]
    few = stage.positions[frames[:: max(1, len(frames) // 100)]]
    box: dict[str, Any] = {"origin": stage.origin, "size": stage.size, "basis": stage.basis}
    moved = deform(samples, few, **box)
    nudge = 1e-4 * stage.size * np.where(samples > stage.origin + stage.size / 2, -1.0, 1.0)
    nudged = [deform(samples + nudge * axis, few, **box) for axis in np.eye(3)]
    gradient = np.stack([(n - moved) / nudge[:, [a]] for a, n in enumerate(nudged)], axis=-1)
    sizes = {"displacement": np.linalg.norm(moved - samples, axis=2), "strain": np.linalg.norm(green_strain(gradient), axis=(2, 3))}
    return {name: float(np.quantile(size, 0.99, axis=1).max()) for name, size in sizes.items()}


def _cells(cells: Cells, ends: tuple[float, float]) -> str:
    """Returns the values in 255ths of the scale, and whether a cell is inverted (T, cells, 2), x running fastest."""
    low, high = ends
    known = np.isfinite(cells.values)
    shares = np.where(known, (np.where(known, cells.values, low) - low) / (high - low), 0.0)
    both = np.stack([255.0 * shares.clip(0, 1), 255.0 * ~known], axis=-1).round()
    return text(both.transpose(0, 3, 2, 1, 4), "u1")


def text(values: ArrayLike, kind: str) -> str:
    """Returns an array as base64 text for a page; numbers too large for its type become infinite."""
    with np.errstate(over="ignore"):
        return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
