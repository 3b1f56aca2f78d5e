"""What a live page needs to know of its scene's variables: value references, start values, purposes. Page scripts read no XML."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from softffd.embedding.basis import parameter
from softffd.fmu.package import scene_masses, scene_texts
from softffd.fmu.records import NAME
from softffd.fmu.variables import STANDARD_GRAVITY
from softffd.lattice import all_points
from softffd.names import Part, parse_name, stem, variable_names, vector_names
from softffd.scene.rigid import Box, Cylinder, Pin, Plane, Sphere
from softffd.scene.scene import Scene
from softffd.scene.springs import cell_stiffness
from softffd.show.live.scene import RECORDED
from softffd.show.stage import Stage
from softffd.show.view_body import ENERGY_MARKS, hex_of

MOST_SPEED = 3.0  # largest speed of a dragged part, in sizes of the object per second
MOST_TURN = 3.0  # largest angular velocity of a turned part [rad/s]
MOST_PULL = 10.0  # largest pulling force, in weights of what is pulled
GIVES, STIFFEST, DAMPED, MOST_DAMPED = 0.01, 0.15, 1.4, 0.3
"""The spring that pulls a free body: its extension under the body's weight, in sizes of the object; the greatest stiffness over mass /
step^2; the damping over sqrt(k m) of mass and spring; the greatest damping over mass / step"""
PROBED = "#009e73"
"""Colour of the curves of probes"""
SENSED = "#cc79a7"
"""Colour of the curves of sensors"""


class Described:
    """A live scene's variables. Each part of the page asks for the outputs that it reads, and so gives them their places among all."""

    def __init__(self, scene: Scene, stage: Stage):
        self.scene, self.stage = scene, stage
        self.texts, listed, self.guid = scene_texts(scene)
        self.masses = scene_masses(scene).mass
        """Masses of the control points, or of a solid's nodes (n,) [kg]"""
        self.size, self.weight = float(np.linalg.norm(stage.size)), float(self.masses.sum()) * STANDARD_GRAVITY
        """Diagonal of the box [m]; weight [N]"""
        self._family: dict[str, dict[str, Any]] = {}
        self._reference: dict[str, int] = {}
        self._start: dict[str, float] = {}
        self._outputs: list[str] = []
        for variable in listed:
            for n, (name, _) in enumerate(variable.elements()):
                self._family[name], self._reference[name] = variable.family, variable.reference + n
                if variable.start:
                    self._start[name] = float(variable.start[n % len(variable.start)])
        self._tunable = [name for name, family in self._family.items() if family["variability"] == "tunable"]

    def _read(self, names: Iterable[str]) -> list[int]:
        """Adds outputs to those that the page gets with each frame; returns their places among them."""
        first = len(self._outputs)
        self._outputs.extend(names)
        return list(range(first, len(self._outputs)))

    def _references(self, names: Iterable[str]) -> list[int]:
        return [self._reference[name] for name in names]

    def opened(self) -> dict[str, Any]:
        """Returns what the worker opens the component with. Of the inputs, those of obstacles and pins come first, then loads [N], then
        forces [N] on the points."""
        points = list(all_points(self.scene.lattice.points))
        moving, parts = self._parts()
        loads = []
        for load in self.scene.load:
            held, names = self.scene.select(load.points).tolist(), vector_names("load", load.name)
            loads.append({"label": load.name, "at": len(moving), "points": held, "start": [self._start[name] for name in names]})
            moving += names
        inputs = [*moving, *variable_names("force", points)]
        return {
            "scene": self.texts[f"resources/{NAME}"].decode(),
            "guid": self.guid,
            "h": self.scene.experiment.communication_step,
            "recorded": f"{RECORDED}: {' '.join(self.scene.title.split())}",
            "centre": self.stage.centre.tolist(),
            "most_speed": MOST_SPEED * self.size,
            "most_turn": MOST_TURN,
            "parts": parts,
            "loads": loads,
            "names": inputs,
            "inputs": self._references(inputs),
            "starts": [self._start[name] for name in inputs],
            "forces": len(moving),
            "positions": self._references(variable_names("position", points)),
            "outputs": self._references(self._outputs),
            "parameters": [{"name": name, "reference": self._reference[name], "start": self._start[name]} for name in self._tunable],
        }

    def _parts(self) -> tuple[list[str], list[dict[str, Any]]]:
        """Returns the inputs of obstacles and pins that a hand moves, and for each of these parts: where its point [m], its turn, and
        both velocities [m/s, rad/s] are among the inputs, their starts, and the points that a pin holds; for a free body where its force
        [N] is."""
        inputs: list[str] = []
        parts = []
        for each in (*self.scene.obstacles, *self.scene.pin):
            held = self.scene.select(each.points).tolist() if isinstance(each, Pin) else []
            if not isinstance(each, Plane) and each.motion == "free":
                parts.append({"label": each.name, "held": held, "at": len(inputs), "turns": None} | self._free(each))
                inputs += vector_names("body_force", each.part)
            elif each.motion == "input":
                place, *turns, velocity, spin = each.POSE
                family = "plane" if each.part.is_obstacle else "pin"
                at, starts = {}, {}
                for word in each.POSE:
                    names = vector_names(f"{family}_{word}", each.part)
                    at[word], starts[word] = len(inputs), [self._start[name] for name in names]
                    inputs += names
                part = {"label": each.name, "held": held, "at": at[place], "point": starts[place]}
                part |= {"speed": at[velocity], "drift": starts[velocity], "spins": at[spin], "turns": turns[0] if turns else None}
                parts.append(part | ({"turned": at[turns[0]], "axis": starts[turns[0]]} if turns else {}))
        return inputs, parts

    def _free(self, body: Sphere | Cylinder | Box | Pin) -> dict[str, Any]:
        """Returns for a free body, which a spring and a dashpot pull: the start of its centre [m], the references of its position,
        velocity and orientation, stiffness [N/m], damping [N s/m] and greatest force [N]. The spring gives little under the weight."""
        start, step = self.scene.pin_start(body)[0] if isinstance(body, Pin) else body.point, self.scene.experiment.communication_step
        mass = self._start[variable_names("body_mass", [body.part])[0]]
        stiffness = mass * min(STIFFEST / step**2, STANDARD_GRAVITY / (GIVES * self.size))
        where = {word: self._references(vector_names(f"body_{word}", body.part)) for word in ("position", "velocity", "orientation")}
        damping = min(DAMPED * (stiffness * mass) ** 0.5, MOST_DAMPED * mass / step)
        return {
            "point": list(start),
            "free": where,
            "stiffness": stiffness,
            "damping": damping,
            "most": MOST_PULL * mass * STANDARD_GRAVITY,
        }

    def rows(self) -> list[dict[str, Any]]:
        """Returns the curves of the readout: reactions [N] with their vectors, energies [J], and the outputs of probes and sensors."""
        marks = {each.name: hex_of(each.tint) for each in self.stage.obstacles}
        rows = []
        for each in (*self.scene.obstacles, *self.scene.pin):
            names = vector_names("plane_reaction" if each.part.is_obstacle else "pin_reaction", each.part)
            rows.append(self._row(each.name, "reaction", names, marks.get(each.name, "var(--pin)")))
        rows += [self._row(name, "energy", [f"energy.{name}"], mark) for name, mark in ENERGY_MARKS.items()]
        rows += [self._row(probe.name, "moved", vector_names("probe", probe.name), PROBED) for probe in self.scene.probe]
        for name, family in self._family.items():
            if family["key"].startswith("probe_"):
                rows.append(self._row(_label_of(name), family["key"].removeprefix("probe_").replace("_", " "), [name], PROBED))
        for sensor in self.scene.sensor:
            for key in ("force", "pressure", "peak_pressure"):
                rows.append(self._row(sensor.name, key.replace("_", " "), variable_names(f"sensor_{key}", [sensor.name]), SENSED))
        return rows

    def _row(self, label: str, kind: str, names: list[str], mark: str) -> dict[str, Any]:
        unit = self._family[names[0]].get("unit", "")
        return {"label": label, "kind": kind, "unit": "" if unit == "1" else unit, "mark": mark, "at": self._read(names)}

    def arrows(self) -> list[dict[str, Any]]:
        """Returns where the force on each obstacle [N] and its centre of pressure [m] are among the outputs."""
        keys = {"force": "plane_reaction", "centre": "plane_centre"}
        return [{word: self._read(vector_names(key, each.part)) for word, key in keys.items()} for each in self.scene.obstacles]

    def probes(self) -> list[dict[str, Any]]:
        """Returns names and parameters (3,) of the places at rest that probes follow."""
        probes = []
        for probe in self.scene.probe:
            place = (np.array(probe.at) - self.stage.origin) / self.stage.size
            uvw = [parameter(place[[axis]], n, self.stage.basis).item() for axis, n in enumerate(self.stage.counts)]
            probes.append({"label": probe.name, "uvw": uvw})
        return probes

    def material(self) -> dict[str, Any]:
        """Returns for stress whether the body is a solid; else the springs of its cells (cells * 13) [N/m], and the stiffness that they
        gain if all tunable stiffnesses are doubled, regions apart."""
        if self.scene.is_solid:
            return {"solid": True}
        doubled = {name: 2 * self._start[name] for name in self._tunable if name.startswith(("stiffness", "youngs_modulus"))}
        once, twice = (cell_stiffness(self.scene, parameters).ravel() for parameters in ({}, doubled))
        texts = {"springs": once, "stiffer": twice - once}
        return {"solid": False} | {name: [float(f"{value:.6g}") for value in values] for name, values in texts.items()}

    def pull(self) -> dict[str, float]:
        """Returns the spring between hand and object: half as stiff as a spring of the body, or a rod of it [N/m], and its greatest force
        [N]."""
        springs, modulus = self.scene.material.stiffness, self.scene.material.youngs_modulus
        stiffness = 0.5 * (springs.edge if springs else (modulus or 0.0) * float(self.stage.size.min()))
        return {"stiffness": stiffness, "most": max(MOST_PULL * self.weight, 0.2 * stiffness * self.size)}

    def sliders(self) -> list[dict[str, Any]]:
        """Returns a slider for each tunable parameter, one for all components of a vector and all kinds of springs: name, unit, start and
        range. The range is a decade to both sides. A parameter that starts at 0 or has a greatest value ranges from 0 to that value,
        gravity to twice its start."""
        groups: dict[str, list[int]] = {}
        for n, name in enumerate(self._tunable):
            groups.setdefault("stiffness" if name.startswith("stiffness.") else stem(name), []).append(n)
        sliders = []
        for whole, places in groups.items():
            starts, family = [self._start[self._tunable[n]] for n in places], self._family[self._tunable[places[0]]]
            start, most = max(map(abs, starts)), family.get("max")
            bounded, falls = whole == "gravity" or start == 0 or most is not None, whole == "gravity" and start == 0
            sliders.append({
                "label": " ".join(whole.split(".")[-2:]).replace("_", " "),
                "unit": "" if family["unit"] == "1" else family["unit"],
                "start": start,
                "low": 0.0 if bounded else start / 10,
                "high": (2 * STANDARD_GRAVITY if falls else most or 2 * start or 1.0) if bounded else start * 10,
                "logarithmic": not bounded,
                "parameters": places,
                "factors": [0.0, 0.0, -1.0] if falls else [each / start if start else 1.0 for each in starts],
            })  # fmt: skip
        return sorted(sliders, key=lambda slider: slider["label"].endswith(" friction"))  # sliders of friction last


def _label_of(name: str) -> str:
    found = parse_name(name)
    assert found and isinstance(found.instance, Part)
    return found.instance.name
