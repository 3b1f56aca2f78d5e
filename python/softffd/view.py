"""The interactive page of a run: one HTML file that needs nothing else.

The page carries the surface at rest and the control points of every frame; its vertex shader evaluates the volume, so a frame
costs the control points whatever the size of the mesh. `view.html` is the page, `view.js` its script, `view.glsl` its shaders.
"""

import base64
import html
import json
import re
from importlib import resources
from pathlib import Path

import numpy as np
from matplotlib import colormaps

from softffd.deform import deform
from softffd.history import energies, reactions
from softffd.stage import round_length, stage_of
from softffd.surface import split_at_creases

MOST_FRAMES = 600
MOST_POINT_BYTES = 24e6
SAMPLES = 1000
FIRST_VIEW = (-1.0, 0.27)
TINTS = ((0.63, 0.67, 0.73), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65), (0.0, 0.62, 0.45), (0.90, 0.62, 0.0), (0.94, 0.89, 0.26))
MARKS = {"kinetic": "#0072b2", "elastic": "#d55e00", "gravity": "#009e73", "dissipated": "#8c6d00", "work": "#b0548a"}


def write_view(result, path, *, mesh=None, origin=None, size=None):
    """Write the page that plays `result` to `path`; returns the path.

    mesh: the object at rest, or None for the boundary of the Bezier volume. origin, size: its box (3,) [m] if not the scene's.
    A run of more than 600 frames is thinned evenly, keeping the first and the last, and the page says so.
    Raises SoftffdError when positions of control points were not recorded.
    """
    stage = stage_of(result, mesh=mesh, origin=origin, size=size)
    frames = _frames(stage.positions)
    coordinates, normals, triangles = _surface(stage)
    run = {
        "title": stage.title, "subtitle": _subtitle(stage, mesh), "note": _note(len(frames), len(stage.time)),
        "counts": stage.counts, "origin": _list(stage.origin - stage.centre), "size": _list(stage.size), "cage": int(stage.is_cage),
        "time": _text(stage.time[frames], "<f8"), "positions": _text(_flat(stage.positions[frames]) - stage.centre, "<f4"),
        "coordinates": coordinates, "normals": normals, "triangles": triangles, "pinned": _list(stage.pinned),
        "planes": _planes(stage, frames), "rows": _rows(result, stage, frames),
        "radius": stage.radius, "half": _list(stage.half), "up": _list(stage.up), "view": FIRST_VIEW, "spacing": round_length(stage.radius / 2.5),
        "largest": _largest(stage, frames), "ramp": (colormaps["YlGnBu"](np.linspace(0.1, 1, 64))[:, :3] * 255).astype(int).ravel().tolist(),
    }  # fmt: skip
    Path(path).write_text(_page(run), encoding="utf-8")
    return Path(path)


def _page(run):
    parts = resources.files("softffd")
    texts = {
        "title": html.escape(run["title"]),
        "shaders": parts.joinpath("view.glsl").read_text(encoding="utf-8"),
        "script": parts.joinpath("view.js").read_text(encoding="utf-8"),
        "run": json.dumps(run, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"),
    }
    return re.sub(r"{{(\w+)}}", lambda place: texts[place[1]], parts.joinpath("view.html").read_text(encoding="utf-8"))


def _frames(positions):
    """Which frames the page holds: all, or evenly chosen ones with the first and the last."""
    points = int(np.prod(positions.shape[1:4]))
    most = max(2, min(MOST_FRAMES, int(MOST_POINT_BYTES / (12 * points))))
    count = len(positions)
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def _note(shown, recorded):
    return "" if shown == recorded else f"{shown:,} of {recorded:,} recorded frames are shown"


def _subtitle(stage, mesh):
    lattice = " × ".join(str(n) for n in stage.counts) + " control points"
    return lattice if mesh is None else f"{lattice} · {mesh.name}: {len(stage.vertices):,} vertices, {len(stage.faces):,} triangles"


def _surface(stage):
    """Box coordinates (V, 3) float32, normals (V, 4) int16 of which three count, triangles (F, 3) uint32, as text."""
    vertices, normals, faces = split_at_creases(stage.vertices, stage.faces)
    padded = np.pad(normals * 32767.0, ((0, 0), (0, 1))).round()
    return _text((vertices - stage.origin) / stage.size, "<f4"), _text(padded, "<i2"), _text(faces, "<u4")


def _planes(stage, frames):
    """Poses (T, 9): a point relative to the stage's centre [m], the unit normal, a unit tangent."""
    return [
        {
            "name": plane.name,
            "tint": tint,
            "poses": _text(np.hstack([plane.points - stage.centre, plane.normals, plane.tangents])[frames], "<f4"),
        }
        for plane, tint in zip(stage.planes, _tints(stage), strict=True)
    ]


def _rows(result, stage, frames):
    """The curves of the readout: magnitudes of the reactions [N] with their vectors, and energies [J]."""
    tints = {f"plane.{plane.name}": tint for plane, tint in zip(stage.planes, _tints(stage), strict=True)}
    rows = [
        _row(f"{name.split('.')[1]} reaction", "N", _hex(tints.get(name, (0.1, 0.1, 0.12))), np.linalg.norm(force, axis=1), frames, force)
        for name, force in reactions(result).items()
    ]
    return rows + [_row(f"{kind} energy", "J", MARKS[kind], energy, frames) for kind, energy in energies(result).items()]


def _row(label, unit, mark, values, frames, vectors=None):
    vectors = None if vectors is None else _text(vectors[frames], "<f4")
    return {"label": label, "unit": unit, "mark": mark, "values": _text(values[frames], "<f4"), "vectors": vectors}


def _tints(stage):
    return [TINTS[i] if i < len(TINTS) else TINTS[0] for i in range(len(stage.planes))]


def _hex(tint):
    return "#" + "".join(f"{round(255 * 0.8 * c):02x}" for c in tint)


def _largest(stage, frames):
    """Ends of the colour scales: displacement [m] and strain (size of the Green strain tensor) that 1 % of a frame's samples exceed."""
    chosen = np.linspace(0, len(stage.vertices) - 1, min(len(stage.vertices), SAMPLES)).astype(int)
    samples = stage.vertices[chosen]
    few = stage.positions[frames[:: max(1, len(frames) // 100)]]
    middle = stage.origin + stage.size / 2
    moved = deform(samples, few, origin=stage.origin, size=stage.size)
    nudge = 1e-4 * stage.size * np.where(samples > middle, -1.0, 1.0)
    columns = [
        (deform(samples + nudge * axis, few, origin=stage.origin, size=stage.size) - moved) / nudge[:, axis == 1] for axis in np.eye(3)
    ]
    gradient = np.stack(columns, axis=-1)
    strain = np.linalg.norm(np.einsum("tvab,tvac->tvbc", gradient, gradient) - np.eye(3), axis=(2, 3)) / 2
    displacement = np.linalg.norm(moved - samples, axis=2)
    return {name: float(np.quantile(v, 0.99, axis=1).max()) for name, v in (("displacement", displacement), ("strain", strain))}


def _flat(positions):
    """(T, nx, ny, nz, 3) to (T, n, 3) with the x index fastest."""
    return positions.transpose(0, 3, 2, 1, 4).reshape(len(positions), -1, 3)


def _list(values):
    return np.asarray(values).tolist()


def _text(values, kind):
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
