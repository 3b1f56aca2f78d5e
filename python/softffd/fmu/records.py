"""The resolved scene as the library reads it: a flat, versioned, checksummed text (fmu_src/fmi/resource/scene_file.hpp)."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

import numpy as np

from softffd.embedding.patches import lattice_places
from softffd.fmu.variables import has_damping, method_value
from softffd.lattice import LatticeBox, Point, point_at, to_flat
from softffd.names import PROBED
from softffd.obstacles import Obstacles, SolidShape
from softffd.taxels import TaxelGrid

if TYPE_CHECKING:
    from softffd.embedding.mass import Masses
    from softffd.embedding.patches import Patches
    from softffd.embedding.samples import Samples
    from softffd.scene.rigid import Box, Cylinder, Pin, Plane, Sphere
    from softffd.scene.scene import Scene

NAME, HEAD = "scene.txt", "softffd-scene 2"
NO_TURNING = (1.0, 1.0, 1.0)  # moments of inertia of a body that does not turn [kg m2]
ONE_WAY = 0.5  # least ratio of a patch's net area along its axis to the sum of the absolute areas, for its taxels to have a pressure
T = TypeVar("T")


def scene_records(scene: Scene, masses: Masses, samples: Samples | None = None, sensed: Patches | None = None) -> str:
    """Returns all records of the file but the guid; records that the scene does not need are left out."""
    from softffd.scene.rigid import Box, Plane  # imports pydantic, which opening an FMU does not need

    lines: list[list[Any]] = []

    def add(key: str, *values: Any, when: bool = True) -> None:
        if when:
            lines.append([key, *values])

    lattice, material, initial, solver = scene.lattice, scene.material, scene.initial, scene.solver
    add("counts", *lattice.points)
    add("origin", *(lattice.origin or ()))
    add("size", *(lattice.size or ()))
    add("topology", lattice.springs, when=not scene.is_solid)
    basis = scene.lattice_box.basis
    add("basis", basis, when=basis != "bezier")
    add("mass", *masses.mass)
    if masses.weight is not None:
        add("weight", *masses.weight)
    if material.stiffness is not None:
        add("stiffness", material.stiffness.edge, material.stiffness.face, material.stiffness.body)
    else:
        add("youngs_modulus", material.youngs_modulus)
    add("poissons_ratio", material.poissons_ratio, when=scene.is_solid)
    for key in ("damping", "internal_damping"):
        add(key, getattr(material, key), when=has_damping(scene, key))
    add("volume_stiffness", material.volume_stiffness, when=material.volume_stiffness > 0)
    if scene.environment.gravity is not None:
        add("gravity", *scene.environment.gravity)
    for region in scene.region:
        points = scene.select(region.points)
        for key in ("stiffness", "youngs_modulus", "damping", "internal_damping"):
            value = getattr(region, key)
            add(f"region_{key}", value, *points, when=value is not None)
    for plane in scene.obstacles:
        normal = (0.0, 0.0, 1.0) if isinstance(plane, Box) else plane.normal
        motion = [*plane.point, *normal, *plane.velocity, *plane.angular_velocity]
        add("plane", plane.name, _moved(plane), *motion, plane.friction)
        if isinstance(plane, Box):
            add("box", *plane.size, *plane.rotation_vector())
        elif not isinstance(plane, Plane):
            add("solid", plane.radius, plane.length)
        if not isinstance(plane, Plane) and plane.motion == "free":
            add("free", plane.own_mass(), *plane.own_inertia(), *_unit(plane.guide))
        add("plane_inputs", *plane.input_components(), when=plane.motion == "input")
    for pin in scene.pin:
        add("pin", pin.name, _moved(pin), *scene.select(pin.points))
        add("pin_origin", *scene.pin_origin(pin), when=scene.is_solid or pin.origin is not None or pin.motion == "free")
        if pin.motion == "free":
            add("pin_free", pin.mass, *(pin.inertia or NO_TURNING), *_unit(pin.guide))
        if pin.motion == "input":
            position, orientation = scene.pin_start(pin)
            add("pin_start", *position, *orientation, when=initial.rotation is not None)
            add("pin_inputs", *pin.input_components())
    for load in scene.load:
        add("load", load.name, *scene.select(load.points))
    for probe in scene.probe:
        add("probe", probe.name, *probe.at)
        shown = [word for word in (*PROBED, "maximum") if getattr(probe, word)]
        add("probe_outputs", *shown, when=bool(shown))
    for place in samples.places if samples is not None else ():
        add("sample", *place)
    if sensed is not None:
        add("areas", *sensed.areas.ravel())
        for patch in sensed.patches:
            add("sensor", patch.name, *(word for place in zip(patch.places, patch.weights, strict=True) for word in place))
            if patch.taxels:
                add("sensor_taxels", *patch.taxels, *(word for share in patch.shares for word in share))
    outputs = scene.outputs
    for key, selection in (("forces", scene.inputs.forces), ("positions", outputs.positions), ("velocities", outputs.velocities)):
        points = scene.select(selection)
        add(key, *points, when=len(points) > 0)
    add("initial", *initial.stretch, *initial.offset, *initial.velocity, *initial.angular_velocity)
    if initial.rotation is not None:
        add("initial_rotation", *initial.rotation_vector())
    add("spin_about_mass", when=initial.spin_about == "mass")
    add("flat_names", when=scene.fmu.names == "flat")
    for key in ("reactions", "energy", "solver"):
        add(key, when=getattr(outputs, key))
    add("stop_time", scene.experiment.stop_time)
    add("error_estimate", when=solver.error_estimate)
    add("method", method_value(solver.method))
    add("tolerance", solver.tolerance)
    add("step", solver.step)
    add("most_work", solver.most_work)
    add("threads", solver.threads, when=solver.threads > 1)
    return "".join(_line(line) for line in lines)


def scene_text(records: str, guid: str) -> str:
    """Returns the whole file: the head with the CRC-32 of all that follows, the guid, and the records."""
    body = f"guid {guid}\n{records}"
    return f"{HEAD} {zlib.crc32(body.encode()):08x}\n{body}"


class PinRecord(NamedTuple):
    """A pin: whether inputs move it, the number of points that it holds, and the origin of its frame at rest [m]."""

    name: str
    moved: bool
    points: int
    origin: tuple[float, float, float]


class Resources:
    """The scene file in the folder of resources of an FMU of this package; empty for an FMU of another program."""

    def __init__(self, folder: Path):
        file = folder / NAME
        text = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
        self._lines = [line.split() for line in text.splitlines() if line.strip()] if text.startswith(HEAD) else []
        self._last = {key: words for key, *words in self._lines}

    def _all(self, key: str) -> list[list[str]]:
        return [words for each, *words in self._lines if each == key]

    @cached_property
    def lattice(self) -> LatticeBox | None:
        """The scene's lattice; None for an FMU of another program."""
        if not self._lines:
            return None
        points, origin, size = _three(int, self._last["counts"]), *(_three(float, self._last[key]) for key in ("origin", "size"))
        return LatticeBox(points, origin, size, self._last.get("basis", ["bezier"])[0])

    def points(self, key: str) -> list[Point]:
        """Returns the control points of a selection (forces, positions, velocities), in the order of the selection."""
        return [point_at(int(word), _three(int, self._last["counts"])) for word in self._last.get(key, ())]

    def pins(self) -> list[PinRecord]:
        """Returns the pins in the scene's order."""
        rest, found = None if self.lattice is None else to_flat(self.lattice.rest()), list[PinRecord]()
        for key, *words in self._lines:
            if key == "pin" and rest is not None:
                name, motion, *points = words
                found.append(PinRecord(name, motion == "input", len(points), _three(float, rest[[int(p) for p in points]].mean(axis=0))))
            elif key == "pin_origin":
                found[-1] = found[-1]._replace(origin=_three(float, words))
        return found

    def obstacles(self) -> Obstacles | None:
        """Returns what the obstacles meet (surface or lattice), and the solid ones; None for an FMU of another program."""
        found, name = [], ""
        for key, *words in self._lines:
            if key == "plane":
                name = words[0]
            elif key == "box":
                found.append(SolidShape(name, "box", _three(float, words[:3])))
            elif key == "solid":
                radius, length = map(float, words)
                kind: Literal["sphere", "cylinder"] = "cylinder" if length > 0 else "sphere"
                found.append(SolidShape(name, kind, (2 * radius, 2 * radius, length or 2 * radius)))
        return Obstacles("surface" if "sample" in self._last else "lattice", tuple(found)) if self._lines else None

    def taxels(self) -> tuple[TaxelGrid, ...]:
        """Returns the grids of taxels, in the order of the sensors."""
        box, found = self.lattice, list[TaxelGrid]()
        if box is None or "sensor_taxels" not in self._last:
            return ()
        samples, areas = self._all("sample"), np.array(self._all("areas"), dtype=float).reshape(-1, 3)
        places = np.array(samples, dtype=float) if samples else lattice_places(box, solid=box.basis == "patches")
        name, mine = "", np.zeros(0, dtype=np.int64)
        for key, *words in self._lines:
            if key == "sensor":
                name, mine = words[0], np.array(words[1::2], dtype=np.int64)
            elif key == "sensor_taxels":
                shares = np.array(words[2:], dtype=float).reshape(-1, 3)
                found.append(_grid(name, places, areas, mine, (int(words[0]), int(words[1])), shares))
        return tuple(found)


def _grid(
    name: str, places: np.ndarray, areas: np.ndarray, mine: np.ndarray, counts: tuple[int, int], shares: np.ndarray
) -> TaxelGrid:  # fmt: skip
    """Returns the grid of one sensor. shares: rows of place, taxel and fraction, as in embedding/patches.py, which chooses the axis
    likewise."""
    total = areas[mine].sum(axis=0)
    axis = int(abs(total).argmax())
    size = abs(areas[:, axis])
    side = int(np.sign(total[axis])) if abs(total[axis]) >= ONE_WAY * size[mine].sum() else 0
    around = np.bincount(shares[:, 1].astype(int), shares[:, 2] * size[shares[:, 0].astype(int)], counts[0] * counts[1])
    ends = places[mine][:, [other for other in range(3) if other != axis]]
    lower, upper = ends.min(axis=0).tolist(), ends.max(axis=0).tolist()
    return TaxelGrid(name, axis, side, (lower[0], lower[1]), (upper[0], upper[1]), tuple(map(tuple, around.reshape(counts).tolist())))


def _moved(part: Plane | Sphere | Cylinder | Box | Pin) -> str:
    """Returns "input" if inputs move the part, else "fixed". Free bodies are "fixed" too: a record "free" or "pin_free" of their own
    follows."""
    return "input" if part.motion == "input" else "fixed"


def _unit(guide: tuple[float, float, float] | None) -> tuple[float, float, float]:
    """Returns the unit vector along a guide; the zero vector without a guide."""
    if guide is None:
        return (0.0, 0.0, 0.0)
    x, y, z = (each / max(map(abs, guide)) for each in guide)
    size = math.hypot(x, y, z)
    return x / size, y / size, z / size


def _three(read: Callable[[Any], T], words: Iterable[Any]) -> tuple[T, T, T]:
    x, y, z = map(read, words)
    return x, y, z


def _line(values: Iterable[Any]) -> str:
    """Returns a line of the file, in which numbers are the shortest decimals that read back as the same doubles."""
    plain = (int(value) if isinstance(value, int | np.integer) else value for value in values)
    return " ".join(str(value) if isinstance(value, int | str) else repr(float(value)) for value in plain) + "\n"
