"""The live page: one HTML file with the renderer of the replay, the component in WebAssembly, and a worker that steps it.

`worker.js` steps the component, `source.js` keeps the page's clock, `hand.js` finds what is under the pointer, `contact.js` what touches;
`panel.js` has the controls.
JavaScript reads no model description: what it needs of variables, their value references and start values, is written here.
"""

from __future__ import annotations

import base64
import gzip
import shlex
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from softffd.embedding.basis import parameter
from softffd.errors import SoftffdError
from softffd.files import write_text
from softffd.fmu.package import scene_masses, scene_texts
from softffd.fmu.records import NAME
from softffd.installed import data_folder
from softffd.lattice import to_flat
from softffd.names import Part, parse_name, stem, variable_names, vector_names
from softffd.run.progress import Note, silent
from softffd.run.simulate import simulate
from softffd.scene.document import SHIPPED
from softffd.scene.scene import Scene, scene_of
from softffd.show.live.scene import MARK as RECORDED
from softffd.show.live.scene import live_scene
from softffd.show.stage import Stage, stage_of
from softffd.show.template import text_of
from softffd.show.touch import INK, LONGEST, MARK, NEAR
from softffd.show.view import ENERGY_MARKS, as_json, hex_of, largest, page_of, scenery

HERE = "softffd.show.live"
SCRIPTS = ("source.js", "hand.js", "contact.js", "panel.js")
MOST_SPEED = 3.0  # of what is dragged: sizes of the object per second
MOST_PULL = 10.0  # of the object's weights
LEAST_SCALE = 0.1  # end of a colour scale: strain, or share of the object's size


@dataclass
class _Variables:
    """Value references and start values by name; the lists that the worker sets and gets, which grow by what is asked for."""

    reference: dict[str, int] = field(default_factory=dict)
    start: dict[str, float] = field(default_factory=dict)
    rows: dict[str, dict[str, Any]] = field(default_factory=dict)
    inputs: list[str] = field(default_factory=list)
    outputs: list[str] = field(default_factory=list)

    def at(self, kind: list[str], names: Iterable[str]) -> list[int]:
        """Where the variables are in a list, to which they are added."""
        first = len(kind)
        kind.extend(names)
        return list(range(first, len(kind)))

    def references(self, names: Iterable[str]) -> list[int]:
        return [self.reference[name] for name in names]


def write_live(scene: Scene | str | Path, path: str | Path, *, stage: Note = silent) -> Path:
    """Writes the page in which the scene is simulated to `path`; returns the path.

    stage: is told what is being done. Raises SoftffdError where this installation has no WebAssembly library.
    """
    library = wasm_library()
    scene = scene_of(scene, "write_live")
    stage("simulating, to see how much room it takes")
    run = simulate(scene.replace({"outputs.positions": "all"}), inputs=scene.default_inputs)
    stage(f"writing {Path(path).name}")
    write_text(path, live_page(scene, stage_of(run), library.read_bytes()))
    return Path(path)


def wasm_library() -> Path:
    """The component in WebAssembly; SoftffdError, with both ways to it, where this installation has none."""
    path = data_folder() / "binaries" / "wasm32-wasi" / "softffd.wasm"
    if not path.is_file():
        raise SoftffdError(
            "softffd live: this installation has no WebAssembly library (wasm32-wasi). In a checkout, build it: python3 python/run.py wasm; "
            "or install a released wheel, which has it"
        )
    return path


def live_page(scene: Scene, stage: Stage, library: bytes) -> str:
    """The page itself. stage: of a run of the scene, which says what is in view; library: the component in WebAssembly."""
    scene = live_scene(scene)
    variables, live = _described(scene, stage)
    first = np.zeros(1, dtype=int)
    size = float(stage.size.max())
    scales = largest(stage, np.arange(len(stage.time)))
    run = {
        **scenery(stage, first, scene.loaded_mesh),
        "note": "",
        "rows": _rows(scene, stage, variables),
        "largest": {"displacement": max(scales["displacement"], LEAST_SCALE * size), "strain": max(scales["strain"], LEAST_SCALE)},
        "cells": [],
        "touch": {"mark": MARK, "outline": INK, "arrows": _arrows(scene, stage, variables), "longest": LONGEST * np.linalg.norm(stage.size)},
    }
    live["open"] |= {"inputs": variables.references(variables.inputs), "outputs": variables.references(variables.outputs)}
    live["open"] |= {"names": variables.inputs, "starts": [variables.start[name] for name in variables.inputs]}
    blocks = {
        "application/json": {"live": as_json(live)},
        "text/plain": {
            "wasm": base64.b64encode(gzip.compress(library, 9, mtime=0)).decode("ascii"),
            "worker": text_of("softffd.show", "live_component.js") + text_of(HERE, "worker.js"),
        },
    }
    more = "".join(f'<script type="{kind}" id="{name}">{text}</script>\n' for kind, some in blocks.items() for name, text in some.items())
    return page_of(
        run,
        source="".join(text_of(HERE, script) for script in SCRIPTS),
        policy=" 'wasm-unsafe-eval' blob:; worker-src blob:",
        style=text_of(HERE, "live.css"),
        panel=text_of(HERE, "panel.html"),
        data=more,
    )


def _described(scene: Scene, stage: Stage) -> tuple[_Variables, dict[str, Any]]:
    """Of a live scene: its variables, of which those that a hand moves are in the list of inputs, and what the page knows of them."""
    texts, listed, guid = scene_texts(scene)
    variables = _Variables()
    tunable = []
    for variable in listed:
        starts = variable.start * (variable.count // max(1, len(variable.start)))
        for n, (name, _) in enumerate(variable.elements()):
            variables.reference[name], variables.rows[name] = variable.reference + n, variable.family
            if starts:
                variables.start[name] = float(starts[n])
            if variable.family["variability"] == "tunable":
                tunable.append(name)
    parts = [_part(each, scene, stage, variables) for each in (*scene.obstacles, *scene.pin) if each.motion == "input"]
    every = [tuple(map(int, point)) for point in np.ndindex(stage.counts[::-1])]
    points = [point[::-1] for point in every]
    forces = variables.at(variables.inputs, variable_names("force", points))
    mass = scene_masses(scene).mass
    size, weight = float(np.linalg.norm(stage.size)), float(mass.sum()) * 9.81
    stiffness = _pull_stiffness(scene, stage)
    opened = {
        "scene": texts[f"resources/{NAME}"].decode(), "guid": guid, "h": scene.experiment.communication_step,
        "recorded": f"{RECORDED}: {scene.title.splitlines()[0]}; scene {guid}", "centre": stage.centre.tolist(),
        "positions": variables.references(variable_names("position", points)), "forces": forces[0], "parts": parts,
        "parameters": [{"name": name, "reference": variables.reference[name], "start": variables.start[name]} for name in tunable],
        "most_speed": MOST_SPEED * size,
    }  # fmt: skip
    live = {
        "open": opened, "sliders": _sliders(tunable, variables), "masses": [float(f"{each:.6g}") for each in mass],
        "pull": {"stiffness": stiffness, "most": max(MOST_PULL * weight, 0.2 * stiffness * size)}, "probes": _probes(scene, stage),
        "start": (to_flat(stage.positions[:1])[0] - stage.centre).round(6).ravel().tolist(), "weight": weight,
        "near": 3 * NEAR * size, "meets": scene.contact.of, "solids": [{"kind": each.part.kind, "size": each.shape().size} for each in scene.solids],
        "command": f"softffd run {shlex.quote(_called(scene))} --input",
    }  # fmt: skip
    return variables, live


def _called(scene: Scene) -> str:
    """What a user calls the scene."""
    return scene.name if scene.path.parent == SHIPPED else scene.path.name


def _pull_stiffness(scene: Scene, stage: Stage) -> float:
    """Of the spring between hand and object [N/m]: half that of a spring of the body, or of a rod of its material."""
    springs = scene.material.stiffness
    return 0.5 * springs.edge if springs else 0.5 * float(scene.material.youngs_modulus or 0.0) * float(stage.size.min())


def _part(each: Any, scene: Scene, stage: Stage, variables: _Variables) -> dict[str, Any]:
    """An obstacle or pin that a hand moves: where its point and velocity are among the inputs, its start [m], its own velocity [m/s]."""
    part, pin = each.part, each.part.kind == "pin"
    families = ("pin_position", "pin_velocity") if pin else ("plane_point", "plane_velocity")
    point, velocity = (vector_names(family, part) for family in families)
    at, speed = variables.at(variables.inputs, point), variables.at(variables.inputs, velocity)
    starts = [[variables.start[name] for name in names] for names in (point, velocity)]
    held = scene.select(each.points).tolist() if pin else []
    return {"name": str(part), "label": part.name, "at": at[0], "speed": speed[0], "point": starts[0], "drift": starts[1], "held": held}


def _probes(scene: Scene, stage: Stage) -> list[dict[str, Any]]:
    """Names and parameters (3,) of the places at rest that probes follow."""
    places = [(np.array(probe.at) - stage.origin) / stage.size for probe in scene.probe]
    return [
        {"label": probe.name, "uvw": [float(parameter(np.array([t]), n, stage.basis)[0]) for t, n in zip(place, stage.counts, strict=True)]}
        for probe, place in zip(scene.probe, places, strict=True)
    ]


def _sliders(tunable: list[str], variables: _Variables) -> list[dict[str, Any]]:
    """One for each tunable parameter, for vectors and for the kinds of springs together: what it is called, where it starts, and from
    where to where it goes: by a decade to both sides, or where that is no range from the least to the greatest value."""
    groups: dict[str, list[int]] = {}
    for n, name in enumerate(tunable):
        groups.setdefault(name.rpartition(".")[0] if name.startswith("stiffness.") else stem(name), []).append(n)
    sliders = []
    for label, places in groups.items():
        starts = [variables.start[tunable[n]] for n in places]
        family = variables.rows[tunable[places[0]]]
        start, most = max(map(abs, starts)), family.get("max")
        words = label.split(".")[-2:] if label.endswith(".friction") else [label.replace("_", " ")]
        entry: dict[str, Any] = {"label": " ".join(words), "unit": "" if family["unit"] == "1" else family["unit"]}
        if label == "gravity":
            entry |= {"low": 0.0, "high": 2 * start or 1.0}
        elif start == 0 or most is not None:
            entry |= {"low": 0.0, "high": most or 1.0}
        else:
            entry |= {"low": start / 10, "high": start * 10, "logarithmic": True}
        factors = [each / start if start else 1.0 for each in starts]
        sliders.append(entry | {"start": start, "parameters": places, "factors": factors})
    return sorted(sliders, key=lambda slider: slider["label"].endswith(" friction"))  # those of the body first


def _rows(scene: Scene, stage: Stage, variables: _Variables) -> list[dict[str, Any]]:
    """The curves of the readout: reactions [N] with their vectors, energies [J], and what probes tell."""
    marks = {each.name: hex_of(each.tint) for each in stage.obstacles}
    rows = [
        _row(each.name, "reaction", "N", marks.get(each.name, "var(--pin)"), variables, vector_names(_reaction(each.part), each.part))
        for each in (*scene.obstacles, *scene.pin)
    ]
    rows += [_row(name, "energy", "J", mark, variables, [f"energy.{name}"]) for name, mark in ENERGY_MARKS.items()]
    for probe in scene.probe:
        rows.append(_row(probe.name, "moved", "m", "#009e73", variables, vector_names("probe", probe.name)) | {"moved": True})
    told = [name for name, family in variables.rows.items() if family["key"].startswith("probe_")]
    rows += [_row(_of_probe(name), "", variables.rows[name].get("unit", ""), "#009e73", variables, [name]) for name in told]
    return rows


def _of_probe(name: str) -> str:
    found = parse_name(name)
    assert found and isinstance(found.instance, Part)
    return f"{found.instance.name} {found.family.removeprefix('probe_').replace('_', ' ')}"


def _row(label: str, kind: str, unit: str, mark: str, variables: _Variables, names: list[str]) -> dict[str, Any]:
    at = variables.at(variables.outputs, names)
    return {"label": label, "kind": kind, "unit": "" if unit == "1" else unit, "mark": mark, "at": at, "moved": False}


def _reaction(part: Part) -> str:
    return "plane_reaction" if part.is_obstacle else "pin_reaction"


def _arrows(scene: Scene, stage: Stage, variables: _Variables) -> list[dict[str, Any]]:
    """Where the force on each obstacle and its centre of pressure are among the outputs."""
    return [
        {"force": variables.at(variables.outputs, vector_names("plane_reaction", each.part)),
         "centre": variables.at(variables.outputs, vector_names("plane_centre", each.part))}
        for each in scene.obstacles
    ]  # fmt: skip
