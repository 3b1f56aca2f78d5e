"""A scene's FMU under test, stepped as by a host and evaluated with independent mechanics in numpy."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from softffd.embedding.deform import Embedding
from softffd.embedding.nodes import node_positions
from softffd.errors import FmuError, UnknownName
from softffd.fmu.block import Block
from softffd.fmu.instance import DISCARD
from softffd.fmu.package import scene_samples
from softffd.lattice import all_points, to_flat, to_grid
from softffd.names import variable_names
from softffd.run.inputs import Inputs
from softffd.run.simulation import Simulation
from softffd.scene.scene import Scene, scene_from
from validation.mechanics import Body
from validation.patches import Patches
from validation.resolved import resolved
from validation.shapes import Shape, write
from validation.stability.free_bodies import FreeBodies

GRAVITY = 9.81
DOWN = {"gravity": [0.0, 0.0, -GRAVITY]}
Z, X = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
ORIGIN = (0.0, 0.0, 0.0)
Vector = Sequence[float] | np.ndarray


def box(
    stiffness: float = 1e3, damping: float = 0.0, *, points: tuple[int, int, int] = (4, 4, 4), method: str = "auto", **sections: Any
) -> dict[str, Any]:
    """Returns the document of a box of 1 m and 1 kg with springs of one stiffness [N/m] and a damping of each control point [N s/m].

    sections: further sections, merged into the document."""
    document: dict[str, Any] = {
        "lattice": {"points": list(points)},
        "material": {"stiffness": stiffness, "damping": damping},
        "solver": {"method": method},
    }
    for name, section in sections.items():
        document[name] = document.get(name, {}) | section if isinstance(section, dict) else section
    return document


def plane(name: str = "ground", *, point: Vector = ORIGIN, normal: Vector = Z, friction: float = 0.0, **motion: Any) -> dict[str, Any]:
    """Returns the section of an obstacle plane. motion: keys `motion` and `inputs` of a plane moved by inputs."""
    return {"name": name, "point": list(point), "normal": list(normal), "friction": friction, **motion}


def tilted(degrees: float) -> dict[str, Any]:
    """Returns the gravity with which the plane z = 0 acts as an incline."""
    angle = math.radians(degrees)
    return {"gravity": [GRAVITY * math.sin(angle), 0.0, -GRAVITY * math.cos(angle)]}


class Refused(Exception):
    """Raised if the component returns fmi2Discard or fmi2Error. The text is the message of the component."""


class StateTouched(Exception):
    """Raised if the component discards a step but changes the state."""


class Drive:
    """One run of a scene from the start. Use as a context manager.

    `impulse` (3,) [N s] is the impulse of planes and pins on the object since the start.

    document: a scene, or the content of its TOML file; all positions, velocities, reactions, energies and solver outputs are added.
    settings: start values by variable name. surface: surface of the object, in the box of the lattice, for contact with obstacles. Raises
    SceneError for an invalid scene, Refused if the FMU does not start.
    """

    def __init__(self, document: Mapping[str, Any] | Scene, settings: Mapping[str, Any] | None = None, *, surface: Shape | None = None):
        self.scene = _observed(document) if surface is None else _of_surface(document, surface)
        self.side = max(self.scene.lattice_box.size)
        self.rest = self.scene.rest_positions()
        self.resolved = resolved(self.scene)
        self.body = Body.of(self.resolved)
        self.mass = self.body.mass
        self._patches = Patches(self.scene) if self.scene.material.model == "solid" else None
        samples, box = scene_samples(self.scene), self.scene.lattice_box
        self._samples = None if samples is None else Embedding(samples.places, box.origin, box.size, box.points, box.basis)
        with _refusals():
            self.simulation = Simulation(self.scene, start_values=settings)
        try:
            points = list(all_points(self.scene.lattice.points))
            self._x, self._v = (self.simulation.block(variable_names(family, points)) for family in ("position", "velocity"))
            self._blocks: dict[str, Block] = {}
            self.free = FreeBodies(self.scene, self._block)
            self._fixtures = [str(obstacle.part) for obstacle in self.scene.obstacles] + [f"pin.{pin.name}" for pin in self.scene.pin]
            self._start()
        except BaseException:
            self.close()
            raise

    def _start(self) -> None:
        with _refusals():
            self.simulation.initialize()
        self.impulse = np.zeros(3)
        self.start_energy, self.start_centre, self.start_momentum = self.energy(), self.centre, self.momentum
        self.start_angular_momentum = self.angular_momentum

    def restart(self, settings: Mapping[str, Any], stop_time: float | None = None, *, tolerance: float | None = None) -> None:
        """Restarts the run with other start values. stop_time: end of the run as stated by the host [s], for which the tolerance holds.

        tolerance: of the host, relative to the largest side of the box; by default the tolerance of the scene.
        """
        with _refusals():
            self.simulation.restart(start_values=settings, stop_time=stop_time, tolerance=tolerance)
        self._start()

    def set(self, **vectors: Any) -> None:
        """Sets inputs by names with two underscores for a dot and values of all components: plane__lid__point=(0, 0, 1)."""
        for name, values in vectors.items():
            self._block(name.replace("__", ".")).set(values)

    def set_rates(self, name: str, rates: Any) -> None:
        """Sets the time derivatives of an input vector for the next step."""
        self._block(name).set_rates(rates)

    def step(self, length: float) -> None:
        """Makes one communication step of this length [s].

        Raises Refused with the component's message, and StateTouched if a discarded step has changed the state."""
        before = self.x, self.v
        try:
            self.simulation.step(length)
        except FmuError as error:
            if self.simulation.log and self.simulation.log[-1].status == DISCARD and not self._is(*before):
                raise StateTouched(f"a discarded step has changed the state: {error}") from None
            raise Refused(str(error)) from None
        for fixture in self._fixtures:
            self.impulse -= self.reaction(fixture) * length

    def run(self, duration: float, step: float, each: Callable[[], None] | None = None, inputs: Inputs | None = None) -> None:
        """Makes steps of one length [s] for a duration [s]. each: called after every step; inputs: vary linearly from step to step."""
        if inputs:
            inputs.derive_only({variable.name for variable in self.simulation.component.variables("input")})
        given, driven = (self.simulation.block(names) for names in _input_names(inputs))
        for _ in range(max(1, round(duration / step))):
            if inputs:
                given.set(inputs.values(self.time, self.time + step))
                driven.set_rates(inputs.rates(self.time, self.time + step))
            self.step(step)
            if each:
                each()

    def net_force(self) -> np.ndarray:
        """Returns the spring forces on the points (n, 3) [N], computed in numpy."""
        assert self._patches is None
        return self.body.spring_force(self.x)

    def _is(self, x: np.ndarray, v: np.ndarray) -> bool:
        return np.array_equal(self.x, x) and np.array_equal(self.v, v)

    def _block(self, name: str) -> Block:
        """Returns the cached block of a scalar or vector variable."""
        if name not in self._blocks:
            self._blocks[name] = self.simulation.block([name])
        return self._blocks[name]

    @property
    def time(self) -> float:
        """Time [s]"""
        return self.simulation.time

    @property
    def x(self) -> np.ndarray:
        """Positions of the control points (n, 3) [m]"""
        return self._x.get().reshape(-1, 3).copy()

    @property
    def v(self) -> np.ndarray:
        """Velocities of the control points (n, 3) [m/s]"""
        return self._v.get().reshape(-1, 3).copy()

    @property
    def material_points(self) -> np.ndarray:
        """Positions (n, 3) [m] of the points with mass: control points, or the nodes of a solid"""
        return self._material_points(self.x)

    def _material_points(self, values: np.ndarray) -> np.ndarray:
        """Returns the values (n, 3) at the points with mass from the values (n, 3) at control points."""
        return values if self._patches is None else to_flat(node_positions(to_grid(values, self.scene.lattice_box.points)))

    @property
    def touching(self) -> np.ndarray:
        """Positions (n, 3) [m] of the points that obstacles meet: control points, nodes of a solid, or points of the surface"""
        return self.material_points if self._samples is None else self._samples.deform(to_grid(self.x, self.scene.lattice_box.points))

    def reaction(self, plane: str) -> np.ndarray:
        """Returns the mean force (3,) [N] of the object on a plane or pin over the last step. plane: name as in the FMU, "plane.ground"."""
        return self._block(f"{plane}.reaction").get().copy()

    def value(self, name: str) -> float:
        """Returns a scalar output."""
        return float(self._block(name).get()[0])

    @property
    def warned(self) -> str:
        """Warnings of the component so far, joined into one text"""
        return "; ".join(self.simulation.warnings)

    @property
    def centre(self) -> np.ndarray:
        """Centre of mass (3,) [m]"""
        return self.mass @ self.material_points / self.mass.sum()

    @property
    def momentum(self) -> np.ndarray:
        """Momentum (3,) [kg m/s]"""
        return self.mass @ self._material_points(self.v)

    @property
    def angular_momentum(self) -> np.ndarray:
        """Angular momentum about the centre of mass (3,) [kg m2/s]"""
        x, v = self.material_points, self._material_points(self.v)
        return self.mass @ np.cross(x - self.centre, v - self.momentum / self.mass.sum())

    def energy(self) -> float:
        """Returns the present kinetic, elastic and gravity energy [J] of the object and the free bodies, by numpy and not by the FMU."""
        x, v = self.material_points, self._material_points(self.v)
        elastic = self.body.elastic_energy(x) if self._patches is None else float(self._patches.energy(x))
        gravity = np.array(self.scene.environment.gravity or (0.0, 0.0, 0.0))
        return self.body.kinetic_energy(v) + elastic - float(self.mass @ (x @ gravity)) + self.free.energy()

    def balance(self) -> float:
        """Returns the energy imbalance [J]: present energy plus the FMU's dissipated energy, minus the FMU's work and the start energy."""
        return self.energy() + self.value("energy.dissipated") - self.value("energy.work") - self.start_energy

    def missing_momentum(self) -> np.ndarray:
        """Returns the change of momentum since the start (3,) [kg m/s] that planes, pins, weight and damping do not explain. The damping is
        taken as equal at all points."""
        weight = self.mass.sum() * np.array(self.scene.environment.gravity or (0.0, 0.0, 0.0))
        damped = self.body.damping.sum() * (self.centre - self.start_centre)
        return self.momentum - self.start_momentum - self.impulse - weight * self.time + damped

    def turning_change(self) -> float:
        """Returns the relative change of the angular momentum since the start."""
        before = self.start_angular_momentum
        return float(np.linalg.norm(self.angular_momentum - before) / np.linalg.norm(before))

    def finite(self) -> bool:
        """True if all positions and velocities are finite."""
        return bool(np.isfinite(self.x).all() and np.isfinite(self.v).all())

    def close(self) -> None:
        """Frees the FMU and its files."""
        self.simulation.close()

    def __enter__(self) -> Drive:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()


@contextmanager
def _refusals() -> Iterator[None]:
    try:
        yield
    except UnknownName:
        raise  # a fault of the survey, not a refusal
    except FmuError as error:
        raise Refused(str(error)) from None


def _input_names(inputs: Inputs | None) -> tuple[list[str], list[str]]:
    """Returns the names of all inputs that are set, and of those inputs that the source gives directly."""
    return ([*inputs.names, *inputs.derived_names], inputs.names) if inputs else ([], [])


def _observed(document: Mapping[str, Any] | Scene) -> Scene:
    outputs = {"positions": "all", "velocities": "all", "reactions": True, "energy": True, "solver": True}
    if isinstance(document, Scene):
        return document.replace({f"outputs.{name}": value for name, value in outputs.items()})
    return scene_from({**document, "outputs": outputs | document.get("outputs", {})}, path="case.toml")


def _of_surface(document: Mapping[str, Any] | Scene, surface: Shape) -> Scene:
    """Returns a scene whose object has this surface, with contact between surface and obstacles."""
    assert isinstance(document, Mapping)
    with TemporaryDirectory() as folder:
        mesh = {"file": write(Path(folder) / "surface.obj", surface)}
        lattice = {"origin": [0.0, 0.0, 0.0], "size": [1.0, 1.0, 1.0]} | document["lattice"]
        return _observed({**document, "mesh": mesh, "lattice": lattice, "contact": {"of": "surface"}})
