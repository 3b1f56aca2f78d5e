"""The interactive page of a run: one HTML file that needs nothing else.

The page carries the surface at rest and the control points of every frame; its vertex shader evaluates the volume,
so a frame costs the control points whatever the size of the mesh; of B-splines or patches 64 of them count at a vertex.
`view.html` is the page with its style; `view_drawing.js`, `view_touch.js` and `view.glsl` draw what a source gives them, here
`view_recorded.js`; `view.js` listens and tells, `view_keys.js` has the keys, `view_keep.js` saves pictures and films.
"""

import base64
import html
import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from softffd.embedding.basis import parameter
from softffd.embedding.deform import BASES, deform
from softffd.files import write_text
from softffd.lattice import to_flat
from softffd.mesh.looks import Picture
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import split_at_creases
from softffd.run.findings import energies, reactions
from softffd.run.result import Result
from softffd.show.raster import Tint
from softffd.show.solid import Form
from softffd.show.stage import FREE, PINNED, VIEW, PlaneTrack, SolidTrack, Stage, round_length, stage_of
from softffd.show.template import filled, text_of
from softffd.show.tension import Cells, cells_of
from softffd.show.touch import INK, MARK, touch_of

MOST_FRAMES = 600
MOST_POINT_BYTES = 24e6  # of the control points of all frames, before they become text: 600 frames of up to 3300 points

MOST_TEXELS = 1024
SAMPLES = 1000
RAMP = ("ffffd9", "edf8b1", "c7e9b4", "7fcdbb", "41b6c4", "1d91c0", "225ea8", "253494", "081d58")
"""From little to much: ColorBrewer's YlGnBu with nine classes (Harrower & Brewer 2003)."""

ENERGY_MARKS = {"kinetic": "#0072b2", "elastic": "#d55e00"}


def write_view(result: Result, path: str | Path) -> Path:
    """Write the page that plays `result` to `path`; returns the path.

    A run of more than 600 frames is thinned evenly, keeping the first and the last, and the page says so.
    Raises SoftffdError when positions of control points were not recorded.
    """
    write_text(path, page_text(result))
    return Path(path)


def page_text(result: Result) -> str:
    """The page itself, see write_view."""
    stage = stage_of(result)
    frames = _frames(stage.positions)
    thinned = len(frames) < len(stage.time)
    run = {
        **scenery(stage, frames, result.loaded_mesh),
        "note": f"{len(frames):,} of {len(stage.time):,} recorded frames are shown" if thinned else "",
        "time": _text(stage.time[frames], "<f8"),
        "positions": _text(to_flat(stage.positions[frames]) - stage.centre, "<f4"),
        "rows": _rows(result, stage, frames),
        "largest": largest(stage, frames),
        "cells": [_cells(each) for each in cells_of(result, frames)],
        "touch": _touch(result, stage, frames),
    }
    return page_of(run, source=text_of("softffd.show", "view_recorded.js"))


def page_of(run: dict[str, Any], *, source: str, policy: str = "", style: str = "", panel: str = "", data: str = "") -> str:
    """The page of what `view_drawing.js` calls the run, and of the script that makes its source; what else that needs: what scripts
    may do, rules of style, controls, and elements with data."""
    parts = {"source": source, "policy": policy, "style": style, "panel": panel, "data": data}
    return filled("softffd.show", "view.html", parts | {"title": html.escape(run["title"]), "run": as_json(run)})


def as_json(data: Any) -> str:
    """Data as a page holds them in an element `script`."""
    return json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def scenery(stage: Stage, frames: np.ndarray, mesh: Mesh | None) -> dict[str, Any]:
    """What does not change: words, the surface at rest, colours, and where things are; of obstacles their poses in some frames, too."""
    return {
        **_words(stage, mesh),
        **_surface(stage),
        **_colours(stage),
        **_sights(stage),
        "counts": stage.counts,
        "bases": [BASES.index(stage.basis) if n > 4 else 0 for n in stage.counts],
        "pinned": stage.pinned.tolist(),
        "planes": [_obstacle(plane, stage, frames) | {"floor": plane.is_floor} for plane in stage.planes],
        "solids": [_obstacle(solid, stage, frames) | _form(solid.form) for solid in stage.solids],
    }


def _frames(positions: np.ndarray) -> np.ndarray:
    """Which frames the page holds: all, or evenly chosen ones with the first and the last."""
    count, points = len(positions), int(np.prod(positions.shape[1:4]))
    most = max(2, min(MOST_FRAMES, int(MOST_POINT_BYTES / (12 * points))))
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def _words(stage: Stage, mesh: Mesh | None) -> dict[str, Any]:
    subtitle = " × ".join(str(n) for n in stage.counts) + " control points"
    if mesh is not None:
        subtitle += f" · {mesh.name}: {len(mesh.vertices):,} vertices, {len(mesh.faces):,} triangles"
    return {"title": stage.title, "subtitle": subtitle}


def _surface(stage: Stage) -> dict[str, Any]:
    """Parameters (W, 3), normals and tints (W, 4) of which three count, places in pictures (W, 2), and triangles (F, 3).

    Triangles with one picture follow each other: `parts` are pairs of a picture's number and how many there are.
    """
    source, normals, faces = split_at_creases(stage.vertices, stage.faces)
    order = np.argsort(stage.skin.picture_of, kind="stable")
    pictures, counts = np.unique(stage.skin.picture_of, return_counts=True)
    places = zip(((stage.vertices[source] - stage.origin) / stage.size).T, stage.counts, strict=True)
    return {
        "cage": int(stage.is_cage),
        "coordinates": _text(np.stack([parameter(t, n, stage.basis) for t, n in places], axis=1), "<f4"),
        "normals": _text(np.pad(normals * 32767.0, ((0, 0), (0, 1))).round(), "<i2"),
        "tints": _text(np.pad(stage.skin.tints[source] * 255.0, ((0, 0), (0, 1))).round(), "u1"),
        "uv": _text(stage.skin.uv[source], "<f4"),
        "triangles": _text(faces[order], "<u4"),
        "parts": np.stack([pictures, counts], axis=1).tolist(),
    }


def _colours(stage: Stage) -> dict[str, Any]:
    given = np.array([list(bytes.fromhex(colour)) for colour in RAMP])
    places = np.linspace(0.1, 1.0, 64) * (len(RAMP) - 1)
    ramp = np.stack([np.interp(places, np.arange(len(RAMP)), channel) for channel in given.T], axis=1)
    return {
        "free": FREE,
        "fixed": PINNED,
        "pictures": [_image(picture) for picture in stage.skin.pictures],
        "ramp": ramp.round().astype(int).ravel().tolist(),
    }


def _image(texture: Picture) -> str:
    """A texture as a PNG inside the page, at most 1024 pixels wide and high."""
    small = texture.convert("RGB")
    small.thumbnail((MOST_TEXELS, MOST_TEXELS))
    stream = BytesIO()
    small.save(stream, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def _sights(stage: Stage) -> dict[str, Any]:
    """Where things are, relative to the stage's centre, so that single precision is enough anywhere in the world."""
    return {
        "origin": (stage.origin - stage.centre).tolist(),
        "size": stage.size.tolist(),
        "half": stage.half.tolist(),
        "radius": stage.radius,
        "up": stage.up.tolist(),
        "view": VIEW,
        "spacing": round_length(stage.radius / 2.5),
    }


def _obstacle(track: PlaneTrack | SolidTrack, stage: Stage, frames: np.ndarray) -> dict[str, Any]:
    """Its name, its colour and its poses (T, 9): a point relative to the stage's centre [m], the unit normal, a unit tangent."""
    poses = np.hstack([track.points - stage.centre, track.normals, track.tangents])[frames]
    return {"name": track.name, "tint": track.tint, "poses": _text(poses, "<f4")}


def _form(form: Form) -> dict[str, Any]:
    """Vertices (V, 3) [m] along tangent, normal x tangent and normal, their normals (V, 3), and triangles (F, 3)."""
    return {"vertices": _text(form.vertices, "<f4"), "normals": _text(form.normals, "<f4"), "triangles": _text(form.faces, "<u4")}


def _touch(result: Result, stage: Stage, frames: np.ndarray) -> dict[str, Any]:
    """Places touched (N, 3), as many of them as `counts` has for each frame; beginnings and ways of arrows (T, 3); all in m."""
    touch = touch_of(result, stage)
    places = [np.concatenate(touch.places(frame)) - stage.centre for frame in frames]
    arrows = [
        {"starts": _text((starts - stage.centre)[frames], "<f4"), "ways": _text(ways[frames], "<f4")}
        for starts, ways in zip(touch.starts, touch.ways, strict=True)
    ]
    counts = [len(each) for each in places]
    return {"places": _text(np.concatenate(places), "<f4"), "counts": counts, "arrows": arrows, "mark": MARK, "outline": INK}


def _rows(result: Result, stage: Stage, frames: np.ndarray) -> list[dict[str, Any]]:
    """The curves of the readout: sizes of the reactions [N] with their vectors, kinetic and elastic energy [J]."""
    marks = {each.name: hex_of(each.tint) for each in stage.obstacles}
    rows = []
    for part, force in reactions(result).items():
        mark = marks.get(part.name, "var(--pin)") if part.is_obstacle else "var(--pin)"
        rows.append(_row(part.name, "reaction", "N", mark, np.linalg.norm(force, axis=1)[frames], force[frames]))
    recorded = energies(result)
    for name, mark in ENERGY_MARKS.items():
        if name in recorded:
            rows.append(_row(name, "energy", "J", mark, recorded[name][frames]))
    return rows


def _row(label: str, kind: str, unit: str, mark: str, values: np.ndarray, vectors: np.ndarray | None = None) -> dict[str, Any]:
    texts = {"label": label, "kind": kind, "unit": unit, "mark": mark}
    return texts | {"values": _text(values, "<f4"), "vectors": None if vectors is None else _text(vectors, "<f4")}


def hex_of(tint: Tint) -> str:
    """The colour of an obstacle's words and curves."""
    return "#" + "".join(f"{round(255 * 0.8 * c):02x}" for c in tint)


def largest(stage: Stage, frames: np.ndarray) -> dict[str, float]:
    """Ends of the colour scales, which 1 % of the worst frame's samples exceed: displacement [m], Green strain."""
    chosen = np.linspace(0, len(stage.vertices) - 1, min(len(stage.vertices), SAMPLES)).astype(int)
    samples = stage.vertices[chosen]
    few = stage.positions[frames[:: max(1, len(frames) // 100)]]
    box: dict[str, Any] = {"origin": stage.origin, "size": stage.size, "basis": stage.basis}
    moved = deform(samples, few, **box)
    nudge = 1e-4 * stage.size * np.where(samples > stage.origin + stage.size / 2, -1.0, 1.0)
    nudged = [deform(samples + nudge * axis, few, **box) for axis in np.eye(3)]
    gradient = np.stack([(n - moved) / nudge[:, [a]] for a, n in enumerate(nudged)], axis=-1)
    green = (np.einsum("tvab,tvac->tvbc", gradient, gradient) - np.eye(3)) / 2
    sizes = {"displacement": np.linalg.norm(moved - samples, axis=2), "strain": np.linalg.norm(green, axis=(2, 3))}
    return {name: float(np.quantile(size, 0.99, axis=1).max()) for name, size in sizes.items()}


def _cells(cells: Cells) -> dict[str, Any]:
    """Shares of the scale in 255 and whether a cell is inverted (T, cells, 2), x running fastest."""
    low, high = cells.ends
    known = np.isfinite(cells.values)
    shares = np.where(known, (np.where(known, cells.values, low) - low) / (high - low), 0.0)
    both = np.stack([255.0 * shares.clip(0, 1), 255.0 * ~known], axis=-1).round()
    texts = {"name": cells.name, "words": cells.words, "unit": cells.unit, "ends": cells.ends}
    return texts | {"values": _text(both.transpose(0, 3, 2, 1, 4), "u1")}


def _text(values: ArrayLike, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
