"""A running FMU that is stepped, read, set, saved and restored by name. Every host of this package uses it."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from softffd.errors import FmuError
from softffd.fmu.component import Component
from softffd.fmu.instance import Message
from softffd.lattice import LatticeBox
from softffd.names import OBSTACLES, part_names
from softffd.run.parts import Obstacle, Parts, Pin, PointField, PointVectors, Sensor, Vectors
from softffd.run.variables import Variables
from softffd.spelling import did_you_mean, nearest_of, one_number

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

HEAD = struct.Struct("<8sd?")  # before the FMU's own bytes of a state: mark, time [s], whether the first step is still to come
MARK = b"softffd1"
ASSIGNED = ("forces", "time", "initializing", "component")  # attributes of a Simulation that are assigned as a whole
SLIVER = 1e-6  # a difference of times that is no more than this part of a communication step is one of rounding


class State:
    """A saved state of a simulation, made by `Simulation.save`. `bytes(state)` goes to a file or another process.

    The state is freed with the last reference to it, or with the simulation.
    """

    def __init__(self, component: Component, time: float, initializing: bool):
        self.component, self.handle = component, component.get_state()
        self.time, self.initializing = time, initializing

    def __bytes__(self) -> bytes:
        return HEAD.pack(MARK, self.time, self.initializing) + self.component.state_bytes(self.handle)

    def __reduce__(self) -> NoReturn:
        raise FmuError("a State belongs to its simulation: bytes(state) is what is pickled and copied, and what restore takes elsewhere")

    def __del__(self) -> None:
        if hasattr(self, "handle"):
            self.component.free_state(self.handle)


class Simulation(Variables):
    """One FMU of a scene, running from its start. Use as a context manager.

        with softffd.Simulation(scene, tolerance=1e-5) as sim:
            sim.plane["plate"].point = (0, 0, 0.9)
            sim.step(0.01)
            print(sim.time, sim.positions.shape, sim.plane["plate"].reaction[2])

    scene_or_fmu: a scene, the path of its file, the name of a shipped one, the path of an FMU, or an opened Component, which is closed at
        the end.
    tolerance: error aimed at in any control point, or node of a solid, at the end of the run, relative to the box's largest side; the
        scene's own by default.
    method: method of the time integration, as `solver.method` in the scene.
    start_values: parameters and inputs by name, numbers or vectors.
    start_time, stop_time: start and end of the run [s]. Without a stop time the tolerance holds for a run as long as the scene's; with
        one, no step may go past it.
    log: called with each Message (status, category, text) as it arrives, e.g. `print`; `sim.log` has all messages. What the
        function raises comes out of the call that sent the message; a step is then done.

    Everything, fixed parameters too, can be set until the first step or `initialize`, and again after `restart`; later only inputs and
    tunable parameters. A vector is set by assigning the whole, `plate.point = (0, 0, 0.9)`, or one component by its name,
    `sim["plane.plate.point.z"] = 0.9`. Reading returns a copy, except for blocks, whose buffers are kept. Wrong names, values out of range
    and refused steps raise FmuError. A discarded step leaves time and state as they were; the standard then allows reading, `restore` and
    `restart`.
    """

    def __init__(
        self, scene_or_fmu: Scene | str | Path | Component, *, tolerance: float | None = None, method: str | None = None,
        start_values: Mapping[str, Any] | None = None, start_time: float = 0.0, stop_time: float | None = None,
        log: Callable[[Message], object] | None = None,
    ):  # fmt: skip
        if log is not None and not callable(log):
            raise FmuError(f"log: wanted a function that takes a message, such as print, got {log!r:.70}")
        super().__init__(scene_or_fmu if isinstance(scene_or_fmu, Component) else Component(run_source(scene_or_fmu, "Simulation")))
        self.component.listener = log
        self._fields: dict[str, PointField] = {}
        try:
            self._begin(method, start_values, tolerance=tolerance, start_time=start_time, stop_time=stop_time)
        except BaseException:
            self.component.close()
            raise

    # ---- start, steps, end ----

    def _begin(
        self, method: str | None, values: Mapping[str, Any] | None, *, tolerance: float | None, start_time: float, stop_time: float | None
    ) -> None:
        self.time = one_number("start time", start_time)
        """Time of the communication point [s]"""
        self.initializing = True
        if not isinstance(values or {}, Mapping):
            raise FmuError(f"start_values: wanted values by name, such as {{'mass': 2}}, got {values!r:.70}")
        for name, value in {**({} if method is None else {"solver.method": method}), **(values or {})}.items():
            self[name] = value
        if tolerance is not None and not (one_number("tolerance", tolerance) > 0 and math.isfinite(tolerance)):
            raise FmuError(f"tolerance: wanted > 0, got {tolerance:g}")
        self.component.set_up(start_time=start_time, stop_time=stop_time, tolerance=tolerance)

    def initialize(self) -> None:
        """Ends the initialization; otherwise the first step does. FmuError if the FMU cannot start from the values that were set."""
        if self.initializing:
            with self.component.undisturbed():
                self.component.exit_initialization()
                self.initializing = False

    def step(self, length: float | None = None, *, end: float | None = None) -> None:
        """Does one communication step.

        length: length of the step [s], > 0; by default the communication step of the scene.
        end: time at the end of the step [s], time + length by default. With a length, a host may compute the end otherwise, as a multiple
            of its step, to within a millionth of the length.
        Raises FmuError with the component's message for a step that it refuses or discards; time and state are then those before the step.
        """
        if end is not None:
            end = one_number("end", end)
        if length is None:
            length = self.component.interface.step if end is None else end - self.time
            if length is None:
                raise FmuError("step: wanted a length > 0 s, got none; the FMU has no default: give step(H)")
        length = one_number("step", length)
        if not (length > 0 and math.isfinite(length)):
            raise FmuError(f"step: wanted a length > 0 s, got {length:g}")
        reached = self.time + length
        if reached == self.time:
            raise FmuError(f"step: wanted a length that changes the time {self.time:g} s, got {length:g}")
        if end is not None and not abs(end - reached) <= SLIVER * length + 4 * math.ulp(reached):
            raise FmuError(
                f"step: wanted an end at {reached:g} s, {length:g} s after {self.time:g} s, got {end:g}: leave out one of the two"
            )
        if self.initializing:
            self.initialize()
        with self.component.undisturbed():
            self.component.do_step(self.time, length)
            self.time = reached if end is None else end

    def restart(
        self, *, tolerance: float | None = None, method: str | None = None, start_values: Mapping[str, Any] | None = None,
        start_time: float = 0.0, stop_time: float | None = None,
    ) -> None:  # fmt: skip
        """Begins again as if just opened, with only the settings given here; clears the log. Saved states remain usable."""
        self.component.reset()
        self.component.messages.clear()
        self._begin(method, start_values, tolerance=tolerance, start_time=start_time, stop_time=stop_time)

    def close(self) -> None:
        """Frees the instance, its states and its files."""
        self.component.close()

    def __reduce__(self) -> NoReturn:
        raise FmuError("a Simulation is neither copied nor pickled: open another one and restore there what bytes(sim.save()) gives")

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name.startswith("_") or name in ASSIGNED):
            how = '; values are set by name, sim["mass"] = 2, sim.load["push"] = (0, 0, 1)'
            raise FmuError(f"{name}: a Simulation has no such attribute to assign{did_you_mean(nearest_of(name, ASSIGNED))}{how}")
        super().__setattr__(name, value)

    def __repr__(self) -> str:
        counts = f": {' x '.join(map(str, self.lattice.points))} control points" if self.lattice else ""
        kinds = (*OBSTACLES, "pin", "load", "probe", "sensor")
        parts = [f"{kind} {', '.join(found)}" for kind in kinds if (found := part_names(self.variables, kind))]
        return "\n  ".join([f"Simulation of {self.component.interface.title} at {self.time:.6g} s{counts}", *parts])

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    # ---- states ----

    def save(self) -> State:
        """Returns the state of this moment, with its time, to restore as often as wanted. bytes(state) are for files and other
        processes."""
        return State(self.component, self.time, self.initializing)

    def restore(self, state: State | bytes) -> None:
        """Returns to a saved state, also one of another simulation of the same scene, or its bytes; the run continues with the same bits.

        Raises FmuError for damaged bytes and states of other scenes; the simulation is then as it was before.
        """
        component = self.component
        if isinstance(state, State) and state.component is component:
            self._return_to(state.handle, state.time, state.initializing)
            return
        data = bytes(state) if isinstance(state, State | bytes | bytearray | memoryview) else b""
        if len(data) < HEAD.size or not data.startswith(MARK):
            raise FmuError(f"restore: wanted a state of Simulation.save or its bytes, got {state!r:.70}")
        handle = component.state_from(data[HEAD.size :])
        try:
            self._return_to(handle, *HEAD.unpack_from(data)[1:])
        finally:
            component.free_state(handle)

    def _return_to(self, handle: int, time: float, initializing: bool) -> None:
        with self.component.undisturbed():
            self.component.set_state(handle)
            self.time, self.initializing = time, initializing

    # ---- the body and its parts ----

    @property
    def lattice(self) -> LatticeBox | None:
        """Numbers of control points, box at rest and basis; None for an FMU that is not of this package."""
        return self.component.lattice

    @property
    def positions(self) -> np.ndarray:
        """The positions of the control points (nx, ny, nz, 3) [m], a read-only copy; NaN for those that are not among the outputs."""
        return self._field("position").read()

    @property
    def velocities(self) -> np.ndarray:
        """The velocities of the control points (nx, ny, nz, 3) [m/s], a read-only copy; NaN for those that are no outputs. FmuError if
        none is."""
        return self._field("velocity").read()

    @property
    def forces(self) -> np.ndarray:
        """The external forces on the control points (nx, ny, nz, 3) [N], a read-only copy, to be assigned as a whole; NaN where there
        is no input. `sim.force[i, j, k]` sets the force on one control point."""
        return self._field("force").read()

    @forces.setter
    def forces(self, values: ArrayLike) -> None:
        self._field("force").write(values)

    def _field(self, family: str) -> PointField:
        if family not in self._fields:
            self._fields[family] = PointField(self.component, family)
        return self._fields[family]

    @cached_property
    def obstacle(self) -> Parts[Obstacle]:
        """Planes, spheres, cylinders and boxes by name: .point .normal .velocity .angular_velocity .friction .reaction .torque .centre
        .contacts. A box has .rotation in the place of .normal. A free body also has .position .orientation .mass .force
        .reaction_torque, and .start_velocity .start_angular_velocity."""
        return Parts("obstacle", self, Obstacle, of=OBSTACLES)

    @cached_property
    def plane(self) -> Parts[Obstacle]:
        """The planes by name, as in `obstacle`."""
        return Parts("plane", self, Obstacle)

    @cached_property
    def pin(self) -> Parts[Pin]:
        """The pins by name: .position .orientation .velocity .angular_velocity .reaction .torque; a free body also has .mass .force
        .reaction_torque."""
        return Parts("pin", self, Pin)

    @cached_property
    def load(self) -> Vectors:
        """The loads by name: total forces (3,) [N], to be set as a whole."""
        return Vectors("load", self)

    @cached_property
    def probe(self) -> Vectors:
        """The probes by name: current positions (3,) [m] of points of the object."""
        return Vectors("probe", self)

    @cached_property
    def sensor(self) -> Parts[Sensor]:
        """The sensors by name: .force .torque .area .pressure .peak_pressure .taxels"""
        return Parts("sensor", self, Sensor)

    @cached_property
    def force(self) -> PointVectors:
        """External forces on single control points: sim.force[i, j, k] = (0, 0, -1) [N]."""
        return PointVectors("force", self)

    # ---- messages ----

    @property
    def log(self) -> list[Message]:
        """All messages so far: status, category, text."""
        return self.component.messages

    @property
    def warnings(self) -> list[str]:
        """The texts of all warnings, and of more severe messages, so far."""
        return self.component.warnings()

    def methods(self) -> list[tuple[str, str]]:
        """Returns the methods that took over so far, each with its reason, in their order."""
        return [choice for message in self.log if (choice := choice_in(message.text))]


BEGINS = "; internal step"  # the text after method and reason in a message about a choice


def choice_in(text: str) -> tuple[str, str] | None:
    """Returns method and reason from a message of a component; None for a message that reports no choice."""
    method, _, reason = text.partition(BEGINS)[0].partition(": ")
    return (method, reason) if BEGINS in text else None


def run_source(scene_or_fmu: Any, who: str) -> Scene | Path:
    """Returns the path of an FMU, which ends in .fmu, or the scene that is given by itself, by its file's path or by its name."""
    if isinstance(scene_or_fmu, str | Path) and Path(scene_or_fmu).suffix.lower() == ".fmu":
        return Path(scene_or_fmu)
    from softffd.scene.scene import scene_of  # imports pydantic, which is not needed for an FMU

    return scene_of(scene_or_fmu, who, "a Scene, the path or name of one, or the path of an FMU")
