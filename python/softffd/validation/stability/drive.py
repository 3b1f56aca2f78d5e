"""A scene's FMU under test: stepped as a host steps it, and looked at with mechanics of its own, written in numpy."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.component import DISCARD, Component
from softffd.fmu.package import package_fmu
from softffd.run.inputs import Inputs
from softffd.scene.scene import Scene, scene_from
from softffd.validation.mechanics import Body
from softffd.validation.resolved import resolved


class Refused(Exception):
    """The component answered fmi2Discard or fmi2Error; the text is its message."""


class StateTouched(Exception):
    """The component discarded a step but did not leave the state as it was."""


class Drive:
    """One scene from its start on. Use as a context manager.

    document: a scene, or what its TOML file would give; all positions, velocities, reactions, energies and solver outputs are added.
    settings: start values by variable name. Raises SceneError for a scene that cannot be, Refused where the FMU does not start.
    """

    def __init__(self, document: Mapping[str, Any] | Scene, settings: Mapping[str, Any] | None = None):
        self.scene = _observed(document)
        self.side = max(self.scene.lattice.size)
        self.rest = self.scene.rest_positions()
        self.resolved = resolved(self.scene)
        self.body = Body.of(self.resolved)
        self.mass = self.body.mass
        self.time = 0.0
        self._folder = Path(mkdtemp(prefix="softffd-"))
        try:
            self.component = Component(package_fmu(self.scene, self._folder / "case.fmu"))
            nx, ny, nz = self.scene.lattice.points
            places = [f"[{i},{j},{k}].{axis}" for k in range(nz) for j in range(ny) for i in range(nx) for axis in "xyz"]
            self._x = self.component.block([f"position{place}" for place in places])
            self._v = self.component.block([f"velocity{place}" for place in places])
            self._blocks = {}
            self._begin(settings or {})
        except BaseException:
            self.close()
            raise

    def _begin(self, settings: Mapping[str, Any], stop_time: float | None = None) -> None:
        self.time, self.moved, self.last_step = 0.0, {}, 0.0
        self.component.messages.clear()
        try:
            self.component.initialize(dict(settings), stop_time=stop_time)
            self.component.exit_initialization()
        except FmuError as error:
            raise Refused(str(error)) from None
        self.start_energy = self.energy()

    def restart(self, settings: Mapping[str, Any], stop_time: float | None = None) -> None:
        """From the start again, with other start values; stop_time [s]: what the host says of the end, for which the tolerance holds."""
        self.component.reset()
        self._begin(settings, stop_time)

    def set(self, **vectors: Any) -> None:
        """Sets inputs: names with two underscores for a dot, values for all components: plane__lid__point=(0, 0, 1)."""
        for name, values in vectors.items():
            name = name.replace("__", ".")
            numbers = np.atleast_1d(np.asarray(values, float))
            names = [name] if len(numbers) == 1 else [f"{name}.{axis}" for axis in ("xyz" if len(numbers) == 3 else "wxyz")]
            block = self._block(tuple(names), True)
            block.values[:] = numbers
            self.component.set(block)

    def step(self, length: float) -> None:
        """One communication step [s]. Refused with the component's message; StateTouched when a discarded step has changed something."""
        before = self.x, self.v
        try:
            self.component.do_step(self.time, length)
        except FmuError as error:
            if self.component.messages and self.component.messages[-1][0] == DISCARD and not self._is(*before):
                raise StateTouched(f"a discarded step has changed the state: {error}") from None
            raise Refused(str(error)) from None
        self.time += length
        self.last_step = length

    def run(self, duration: float, step: float, each: Callable[[], None] | None = None, inputs: Inputs | None = None) -> None:
        """Steps of one length for a time [s]; each: called after every step; inputs: go linearly from step to step."""
        block = self._block((*inputs.names, *inputs.derived_names), True) if inputs else None
        for _ in range(max(1, round(duration / step))):
            if inputs:
                block.values[:] = inputs.values(self.time, self.time + step)
                self.component.set(block)
                self.component.set_rates(self._block(tuple(inputs.names), True), inputs.rates(self.time, self.time + step))
            self.step(step)
            if each:
                each()

    def net_force(self) -> np.ndarray:
        """Forces of the springs on the points (n, 3) [N], by numpy."""
        return self.body.spring_force(self.x)

    def _is(self, x: np.ndarray, v: np.ndarray) -> bool:
        return np.array_equal(self.x, x) and np.array_equal(self.v, v)

    def _block(self, names: tuple[str, ...], real: bool):
        if names not in self._blocks:
            self._blocks[names] = self.component.block(list(names), real=real)
        return self._blocks[names]

    def _vector(self, name: str) -> np.ndarray:
        block = self._block(tuple(f"{name}.{axis}" for axis in "xyz"), True)
        self.component.get(block)
        return block.values.copy()

    @property
    def x(self) -> np.ndarray:
        """Control points (n, 3) [m]."""
        self.component.get(self._x)
        return self._x.values.reshape(-1, 3).copy()

    @property
    def v(self) -> np.ndarray:
        """Their velocities (n, 3) [m/s]."""
        self.component.get(self._v)
        return self._v.values.reshape(-1, 3).copy()

    def reaction(self, plane: str) -> np.ndarray:
        """Mean force of the object on a plane or pin over the last step (3,) [N]; name as in the FMU: "plane.ground"."""
        return self._vector(f"{plane}.reaction")

    def value(self, name: str) -> float:
        """A scalar output."""
        block = self._block((name,), self.component.variable(name).type == "Real")
        self.component.get(block)
        return float(block.values[0])

    @property
    def warned(self) -> str:
        """The component's warnings so far, in one text."""
        return "; ".join(self.component.warnings())

    @property
    def centre(self) -> np.ndarray:
        """Centre of mass (3,) [m]."""
        return self.mass @ self.x / self.mass.sum()

    @property
    def momentum(self) -> np.ndarray:
        """(3,) kg m/s"""
        return self.mass @ self.v

    @property
    def angular_momentum(self) -> np.ndarray:
        """About the centre of mass (3,) [kg m2/s]."""
        return self.mass @ np.cross(self.x - self.centre, self.v - self.momentum / self.mass.sum())

    def energy(self) -> float:
        """Kinetic, elastic and gravity energy of the points and springs as they are now [J], by numpy and not by the FMU's outputs."""
        x, v = self.x, self.v
        gravity = np.array(self.scene.environment.gravity or (0.0, 0.0, 0.0))
        return self.body.kinetic_energy(v) + self.body.elastic_energy(x) - float(self.mass @ (x @ gravity))

    def balance(self) -> float:
        """What the FMU's own energies miss: now, with what was dissipated and less the work, minus the start [J]."""
        return self.energy() + self.value("energy.dissipated") - self.value("energy.work") - self.start_energy

    def finite(self) -> bool:
        """Whether all positions and velocities are numbers."""
        return bool(np.isfinite(self.x).all() and np.isfinite(self.v).all())

    def close(self) -> None:
        """Frees the FMU and its files."""
        if component := getattr(self, "component", None):
            component.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> Drive:
        return self

    def __exit__(self, *_exception) -> None:
        self.close()


def _observed(document: Mapping[str, Any] | Scene) -> Scene:
    outputs = {"positions": "all", "velocities": "all", "energy": True, "solver": True}
    if isinstance(document, Scene):
        return document.model_copy(update={"outputs": document.outputs.model_copy(update=outputs)})
    return scene_from({**document, "outputs": outputs | document.get("outputs", {})}, path="case.toml")
