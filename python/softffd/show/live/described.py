"""What a live page knows of its scene's variables: value references, start values, and what they are for. Its scripts read no XML."""

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

MOST_SPEED = 3.0  # of what is dragged: sizes of the object per second
MOST_TURN = 3.0  # of what is turned, rad/s
MOST_PULL = 10.0  # of the object's weights
GIVES, STIFFEST, DAMPED, MOST_DAMPED = 0.01, 0.15, 1.4, 0.3
"""Of the spring that pulls a free body: by how much it gives under its weight, in sizes of the object; the greatest stiffness by mass and
step^2; damping by that of a mass on the spring, sqrt(k m); the greatest damping by mass and step"""
PROBED = "#009e73"
"""Colour of what probes tell"""
SENSED = "#cc79a7"
"""Of what sensors feel"""


class Described:
    """A live scene's variables. Each part of the page asks for those that it reads, which gives them their places among the outputs."""

    def __init__(self, scene: Scene, stage: Stage):
        self.scene, self.stage = scene, stage
        self.texts, listed, self.guid = scene_texts(scene)
        self.masses = scene_masses(scene).mass
        """Of the control points, or of a solid's nodes (n,) [kg]"""
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
        """Where these outputs are among those that the page gets with each frame."""
        first = len(self._outputs)
        self._outputs.extend(names)
        return list(range(first, len(self._outputs)))

    def _references(self, names: Iterable[str]) -> list[int]:
        return [self._reference[name] for name in names]

    def opened(self) -> dict[str, Any]:
        """What the worker opens the component with. Of the inputs those of obstacles and pins come first, then loads [N], then forces [N]
        on the points."""
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
        """The inputs of obstacles and pins that a hand moves, and of each of these where its point [m], its turn, and both velocities [m/s,
        rad/s] are among them, how they start, and the control points that a pin holds; of a free body where its force [N] is."""
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
        """Of a free body, which a spring and a dashpot pull: where its centre starts [m], the references of its position, velocity and
        orientation, stiffness [N/m], damping [N s/m] and greatest force [N]. The spring gives little under its weight."""
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
        """The curves of the readout: reactions [N] with their vectors, energies [J], and what probes and sensors tell."""
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
        """Where the force on each obstacle [N] and its centre of pressure [m] are among the outputs."""
        keys = {"force": "plane_reaction", "centre": "plane_centre"}
        return [{word: self._read(vector_names(key, each.part)) for word, key in keys.items()} for each in self.scene.obstacles]

    def probes(self) -> list[dict[str, Any]]:
        """Names and parameters (3,) of the places at rest that probes follow."""
        probes = []
        for probe in self.scene.probe:
            place = (np.array(probe.at) - self.stage.origin) / self.stage.size
            uvw = [parameter(place[[axis]], n, self.stage.basis).item() for axis, n in enumerate(self.stage.counts)]
            probes.append({"label": probe.name, "uvw": uvw})
        return probes

    def material(self) -> dict[str, Any]:
        """For stress: whether the body is a solid; else the springs of its cells (cells * 13) [N/m], and what these have more where all
        have twice their stiffness, regions apart."""
        if self.scene.is_solid:
            return {"solid": True}
        doubled = {name: 2 * self._start[name] for name in self._tunable if name.startswith(("stiffness", "youngs_modulus"))}
        once, twice = (cell_stiffness(self.scene, parameters).ravel() for parameters in ({}, doubled))
        texts = {"springs": once, "stiffer": twice - once}
        return {"solid": False} | {name: [float(f"{value:.6g}") for value in values] for name, values in texts.items()}

    def pull(self) -> dict[str, float]:
        """The spring between hand and object: half as stiff as a spring of the body, or a rod of it [N/m]; its greatest force [N]."""
        springs, modulus = self.scene.material.stiffness, self.scene.material.youngs_modulus
        stiffness = 0.5 * (springs.edge if springs else (modulus or 0.0) * float(self.stage.size.min()))
        return {"stiffness": stiffness, "most": max(MOST_PULL * self.weight, 0.2 * stiffness * self.size)}

    def sliders(self) -> list[dict[str, Any]]:
        """One for each tunable parameter, for vectors and for the kinds of springs together: its name and unit, where it starts, and its
        range: a decade to both sides, of what may be 0 or has a greatest value from 0 to that value, of gravity to twice what it is."""
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
        return sorted(sliders, key=lambda slider: slider["label"].endswith(" friction"))  # those of the body first


def _label_of(name: str) -> str:
    found = parse_name(name)
    assert found and isinstance(found.instance, Part)
    return found.instance.name
