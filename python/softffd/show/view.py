"""The interactive page of a run, or of several: one HTML file that needs nothing else.

The page carries the surface at rest and the control points of every frame. Its vertex shader evaluates the volume, so a frame costs the
control points whatever the size of the mesh; of B-splines or patches, 64 control points count at a vertex.
In the folder `page`, `view.html` is the page with its style. `gl.js` provides WebGL functions, `camera.js` the view. `drawing.js`,
`names.js` and `touch.js` draw with `view.glsl` the data of a source, here `recorded.js`. `unpack.js` unpacks surfaces, `view.js` handles
input and readouts, `keys.js` the keys, and `keep.js` saves pictures and films.
"""

import base64
import html
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps

from softffd.errors import SoftffdError
from softffd.files import write_text
from softffd.run.result import Result
from softffd.show.picture import run_picture
from softffd.show.sight import first_sight
from softffd.show.stage import FREE, PINNED, Stage, round_length, stage_of
from softffd.show.template import filled, text_of
from softffd.show.tension import PRESSED, Cells
from softffd.show.touch import INK, MARK
from softffd.show.view_body import Body, largest

PAGE = "softffd.show.page"
STILL = 80  # quality of the still picture (WebP), which is shown where a browser cannot draw


def write_view(result: Result, path: str | Path) -> Path:
    """Writes the page that plays `result` to `path`; returns the path.

    A run of more than 600 frames, a limit that is lower for more than 3300 control points, is thinned evenly, keeping the first and the
    last frame, and the page says so. Raises SoftffdError when positions of control points were not recorded.
    """
    write_text(path, page_text(result))
    return Path(path)


def write_views(runs: Mapping[str, Result], path: str | Path, *, together: bool = False) -> Path:
    """Writes the page that plays several runs with one clock, one camera and the same scales to `path`; returns the path.

    runs: by their names in the page. Each run has a picture of its own; together: all runs are in one picture, at their places in the
    world, as the components of a coupled run. Raises SoftffdError when positions of control points were not recorded or `runs` is empty.
    """
    if not runs:
        raise SoftffdError("view: wanted one run or more, got none")
    bodies = [Body(name, 0 if together else n, each, _stage_of(name, each)) for n, (name, each) in enumerate(runs.items())]
    title = (" and " if together else " beside ").join(runs)
    write_text(path, _page(_in_one_view(bodies, together=together), title))
    return Path(path)


def _stage_of(name: str, result: Result) -> Stage:
    try:
        return stage_of(result)
    except SoftffdError as error:
        raise SoftffdError(f"{name}: {error}") from error


def page_text(result: Result) -> str:
    """Returns the HTML of the page, see write_view."""
    return _page([Body("", 0, result, stage_of(result))], result.title)


def _in_one_view(bodies: Sequence[Body], *, together: bool) -> list[Body]:
    """Returns the bodies with stages of one size: each about its own centre, or with `together` all in one common box."""
    stages = [each.stage for each in bodies]
    half = np.max([each.half for each in stages], axis=0)
    if not together:
        return [replace(each, stage=replace(each.stage, half=half)) for each in bodies]
    low, high = np.min([each.centre - each.half for each in stages], axis=0), np.max([each.centre + each.half for each in stages], axis=0)
    return [replace(each, stage=replace(each.stage, centre=(low + high) / 2, half=(high - low) / 2)) for each in bodies]


def _page(bodies: Sequence[Body], title: str) -> str:
    arrows = min((each.scale for each in bodies if each.scale), default=0.0)
    shared = {name: [each.cells[name].ends for each in bodies] for name in bodies[0].cells if all(name in each.cells for each in bodies)}
    scales = {name: (min(low for low, _ in ends), max(high for _, high in ends)) for name, ends in shared.items()}
    worst = [largest(each.stage, each.frames) for each in bodies]
    pressure = max((each.cells[PRESSED].ends[1] for each in bodies if PRESSED in each.cells), default=1.0)
    run = {
        **sights([each.stage for each in bodies], title),
        "note": "; ".join(filter(None, map(_thinned, bodies))),
        "subtitle": " · ".join(map(subtitle, bodies)),
        "rows": [row | {"body": n} for n, each in enumerate(bodies) for row in each.rows(pressure)],
        "largest": {name: max(each[name] for each in worst) for name in worst[0]},
        "cells": [about(cells, scales[name]) for name, cells in bodies[0].cells.items() if name in scales],
        "bodies": [each.held(scales, arrows) for each in bodies],
    }
    return page_of(run, source=text_of(PAGE, "recorded.js"), stills=[each.result for each in bodies])


def about(cells: Cells, ends: tuple[float, float]) -> dict[str, Any]:
    """Returns what the page shows about a colour."""
    return {"name": cells.name, "words": cells.words, "unit": cells.unit, "ends": ends}


def _thinned(body: Body) -> str:
    shown, count = len(body.frames), len(body.stage.time)
    return f"{f'{body.name}: ' if body.name else ''}{shown:,} of {count:,} recorded frames are shown" if shown < count else ""


def subtitle(body: Body) -> str:
    """Returns the description of a run: the size of its lattice, and of its mesh."""
    words, mesh = " × ".join(str(n) for n in body.stage.counts) + " control points", body.result.loaded_mesh
    if mesh is not None:
        words += f" · {mesh.name}: {len(mesh.vertices):,} vertices, {len(mesh.faces):,} triangles"
    return f"{body.name}: {body.result.title}, {words}" if body.name else words


def sights(stages: Sequence[Stage], title: str) -> dict[str, Any]:
    """Returns title, view, sizes and colours for the page. Places in the page are relative to the stages' centres, so that single
    precision is enough anywhere in the world."""
    first = stages[0]
    ramp = 255 * colormaps["YlGnBu"].resampled(1 << 16)(np.linspace(0.1, 1.0, 64))[:, :3]
    return {
        "title": title,
        "half": first.half.tolist(),
        "radius": first.radius,
        "up": first.up.tolist(),
        "view": first_sight(stages),
        "spacing": round_length(first.radius / 2.5),
        "free": FREE,
        "fixed": PINNED,
        "ramp": ramp.round().astype(int).ravel().tolist(),
        "mark": MARK,
        "outline": INK,
    }


def page_of(
    run: dict[str, Any], *, source: str, stills: Sequence[Result], policy: str = "", style: str = "", panel: str = "", data: str = ""
) -> str:
    """Returns the HTML of a page. run: what `gl.js` calls the run. source: the script that makes its source. stills: results whose
    pictures are shown where a browser cannot draw. Other needs of the source: policy of scripts, style rules, controls, data elements."""
    parts = {"source": source, "policy": policy, "style": style, "panel": panel, "data": data, "stills": "".join(map(_still, stills))}
    return filled(PAGE, "view.html", parts | {"title": html.escape(run["title"]), "run": as_json(run)})


def _still(result: Result) -> str:
    stream = BytesIO()
    run_picture(result).savefig(stream, format="webp", pil_kwargs={"quality": STILL})
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return f'<img alt="{html.escape(result.title)}: its telling moments" src="data:image/webp;base64,{data}">'


def as_json(data: Any) -> str:
    """Returns data as JSON for a page's `script` element."""
    return json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
