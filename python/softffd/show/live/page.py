"""The live page: one HTML file with the renderer of the replay, the component in WebAssembly, and a worker that steps the component.

`worker.js` steps the component, `source.js` keeps the page's clock, `hand.js` finds what is under the pointer, `turning.js` computes
turns, `contact.js` finds contact, `cells.js` the colours of stress, `panel.js` has the controls. They know the variables from
`described.py`.
"""

import base64
import gzip
import shlex
from pathlib import Path

import numpy as np

from softffd.files import write_text
from softffd.installed import wasm_library
from softffd.lattice import to_flat
from softffd.run.progress import Note, silent
from softffd.run.result import Result
from softffd.run.simulate import Progress, simulate
from softffd.scene.document import SHIPPED
from softffd.scene.scene import Scene, scene_of
from softffd.show.live.described import Described
from softffd.show.live.scene import live_scene
from softffd.show.stage import GLANCES, stage_of
from softffd.show.surface import PLACE_BITS
from softffd.show.template import text_of
from softffd.show.tension import cells_of
from softffd.show.touch import LONGEST, NEAR
from softffd.show.view import about, as_json, page_of, sights, subtitle
from softffd.show.view_body import Body, largest, scenery

HERE = "softffd.show.live"
SCRIPTS = ("turning.js", "source.js", "hand.js", "contact.js", "panel.js", "cells.js")
LEAST_SCALE = 0.1  # least end of a colour scale: strain, or displacement as a fraction of the object's size


def write_live(scene: Scene | str | Path, path: str | Path, *, stage: Note = silent, progress: Progress | None = None) -> Path:
    """Writes the page in which a scene is simulated to `path`; returns the path.

    scene: a scene, the path of its file, or the name of a shipped one. The scene's own run, with the inputs beside its file, determines
    what is in view. stage: receives what is being done; progress: receives how far that run is, as in `simulate`. Raises SoftffdError
    where this installation has no library for web pages.
    """
    library = wasm_library()
    scene = scene_of(scene, "write_live")
    stage("simulating, to see how much room it takes")
    run = simulate(scene.replace({"outputs.positions": "all"}), inputs=scene.default_inputs, progress=progress)
    stage(f"writing {Path(path).name}")
    write_text(path, live_page(scene, run, library.read_bytes()))
    return Path(path)


def live_page(scene: Scene, result: Result, library: bytes) -> str:
    """Returns the HTML of the page. result: a run of the scene; library: the component in WebAssembly."""
    stage = stage_of(result)
    frames = np.unique(np.linspace(0, len(stage.time) - 1, GLANCES).astype(int))
    described = Described(live_scene(scene), stage)
    size, diagonal, scales = float(stage.size.max()), float(np.linalg.norm(stage.size)), largest(stage, frames)
    run = {
        **sights([stage], stage.title),
        "subtitle": subtitle(Body("", 0, result, stage)),
        "note": "",
        "rows": [row | {"body": 0} for row in described.rows()],
        "largest": {"displacement": max(scales["displacement"], LEAST_SCALE * size), "strain": max(scales["strain"], LEAST_SCALE)},
        "cells": [about(each, each.ends) for each in cells_of(result, frames)],
        "bodies": [scenery(stage, np.array([0])) | {"touch": {"arrows": described.arrows(), "longest": LONGEST * diagonal}}],
    }
    live = {
        "probes": described.probes(),
        "sliders": described.sliders(),
        "pull": described.pull(),
        **described.material(),
        "masses": [float(f"{each:.6g}") for each in described.masses],
        "weight": described.weight,
        "start": (to_flat(stage.positions[:1])[0] - stage.centre).round(6).ravel().tolist(),
        "near": (3 * NEAR + 0.5**PLACE_BITS) * diagonal,
        "meets": scene.contact.of,
        "command": f"softffd run {shlex.quote(scene.name if scene.path.is_relative_to(SHIPPED) else scene.path.name)} --input",
        "open": described.opened(),  # last: only now are all outputs known that the others read
    }
    texts = {
        "wasm": base64.b64encode(gzip.compress(library, 9, mtime=0)).decode("ascii"),
        "worker": text_of("softffd.show", "live_component.js") + text_of(HERE, "turning.js") + text_of(HERE, "worker.js"),
    }
    blocks = [f'<script type="text/plain" id="{name}">{text}</script>\n' for name, text in texts.items()]
    return page_of(
        run,
        source="".join(text_of(HERE, script) for script in SCRIPTS),
        stills=[result],
        policy=" 'wasm-unsafe-eval'; worker-src blob:",
        style=text_of(HERE, "live.css"),
        panel=text_of(HERE, "panel.html"),
        data="".join([f'<script type="application/json" id="live">{as_json(live)}</script>\n', *blocks]),
    )
