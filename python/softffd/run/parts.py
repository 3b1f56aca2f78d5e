"""The parts of a running FMU by name: obstacles, pins, loads, probes and sensors; and the control points as one array."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

from softffd.errors import FmuError, UnknownName
from softffd.fmu.component import Component
from softffd.fmu.interface import ScalarVariable
from softffd.names import Cell, parse_name, parts_of, variable_names, vector_names
from softffd.run.variables import Variables
from softffd.spelling import did_you_mean, nearest_of

T = TypeVar("T")


class Field(Generic[T]):
    """An attribute of a part: a number or a vector. Reading a vector gives a copy; assigning sets all components."""

    def __init__(self, doc: str, read: Callable[[Variables, str], T]):
        self.__doc__, self._read = doc, read

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, part: None, owner: type) -> Field[T]: ...
    @overload
    def __get__(self, part: Part, owner: type) -> T: ...
    def __get__(self, part: Part | None, owner: type) -> Field[T] | T:
        return self if part is None else self._read(part.simulation, f"{part.path}.{self._name}")

    def __set__(self, part: Part, value: ArrayLike) -> None:
        part.simulation[f"{part.path}.{self._name}"] = value


def _vector(doc: str) -> Field[np.ndarray]:
    return Field(doc, Variables.vector)


def _number(doc: str) -> Field[float]:
    return Field(doc, Variables.number)


class Part:
    """A part of a scene that has variables of its own. An attribute that the FMU does not have raises FmuError."""

    __slots__ = ("path", "simulation")

    def __init__(self, simulation: Variables, path: str):
        self.simulation, self.path = simulation, path

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in Part.__slots__ and not hasattr(type(self), name):
            raise self._unknown(name)
        super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name) if name.startswith("_") else self._unknown(name)

    def _unknown(self, name: str) -> FmuError:
        known = [each for each in dir(type(self)) if not each.startswith("_") and each not in Part.__slots__]
        return FmuError(f"{self.path}.{name}: the FMU has no such variable{did_you_mean(nearest_of(name, known))}")

    def __repr__(self) -> str:
        return f"<{self.path}>"


class Body(Part):
    """A part that may be a free body with a mass of its own; some attributes exist for free bodies only. Loads can be set at any time."""

    __slots__ = ()
    force = _vector("(3,) N, of a free body: from outside on its centre of mass during the step")
    mass = _number("kg, of a free body; before the first step its moments of inertia follow it")
    position = _vector("(3,) m: of a free body its centre of mass; of a pin the origin of its frame at the communication point")
    orientation = _vector("(4,): quaternion (w, x, y, z) from the world's axes to its own; of an input of any length > 0")
    velocity = _vector("(3,) m/s, of its centre of mass, of the origin, or of an obstacle at `point` during the step")
    angular_velocity = _vector("(3,) rad/s")
    reaction = _vector("(3,) N: force of the object on it, mean of the last communication step")
    reaction_torque = _vector("(3,) N.m about its centre, of the object on a free body, mean of the last communication step")


class Obstacle(Body):
    """An obstacle. Its friction and inputs of its pose and motion can be set at any time, the rest before the first step."""

    __slots__ = ()
    point = _vector("(3,) m, at the communication point; of a plane that is no input: at the start")
    normal = _vector("(3,); need not have unit length; the solid is on the other side")
    rotation = _vector("(3,) rad, of a box, which has no normal: along the axis and as long as the angle of its turn from the world's axes")
    start_velocity = _vector("(3,) m/s, of a free body at the start")
    start_angular_velocity = _vector("(3,) rad/s, of a free body at the start")
    friction = _number("Coulomb coefficient, >= 0")
    torque = _vector(
        "(3,) N.m of the object about `point`, mean of the last communication step; of a free body that from outside, an input"
    )
    centre = _vector("(3,) m: centre of pressure, where `reaction` acts; the plane's point without contact")
    contacts = _number("Number of control points, or points of the surface, in contact")


class Pin(Body):
    """Control points attached to a rigid frame. Inputs of its pose and motion can be set at any time, the rest before the first step."""

    __slots__ = ()
    torque = _vector("(3,) N.m of the object about the origin, mean of the last step; of a free body that from outside, an input")


class Sensor(Part):
    """A patch of the surface and the contact of obstacles with it: means over the last communication step."""

    __slots__ = ()
    force = _vector("(3,) N, on the patch")
    torque = _vector("(3,) N.m about the centre of the patch")
    area = _number("m2 of the patch that touched, as it is now")
    pressure = _number("Pa, mean over that area")
    peak_pressure = _number("Pa, largest at a place")

    @property
    def taxels(self) -> np.ndarray:
        """The force on each taxel, (n, m, 3) [N], a copy; these forces sum to `force`."""
        name = self.path.partition(".")[2]
        grid = next((grid for grid in self.simulation.component.taxels if grid.name == name), None)
        if grid is None:
            raise self._unknown("taxels")
        cells = [Cell(name, i, j) for i, j in np.ndindex(*grid.counts)]
        return self.simulation.block(variable_names("sensor_taxel", cells)).get().astype(float).reshape(*grid.counts, 3)


class Parts(Mapping[str, T]):
    """The parts of one kind by name, in the order of the scene; FmuError with the nearest name for an unknown one."""

    def __init__(self, kind: str, simulation: Variables, part: Callable[[Variables, str], T], *, of: Sequence[str] = ()):
        """part: makes a part from the beginning of its variables' names. of: the kinds that `kind` stands for, if these are several."""
        self._kind, self._simulation, self._part = kind, simulation, part
        self._paths = {each.name: str(each) for each in parts_of(simulation.variables, *(of or (kind,)))}

    def _path(self, name: str) -> str:
        require_name(self._kind, name, self._paths)
        return self._paths[name]

    def __getitem__(self, name: str) -> T:
        return self._part(self._simulation, self._path(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)

    def __contains__(self, name: object) -> bool:
        return name in self._paths  # without reading the part

    def __repr__(self) -> str:
        return f"<{self._kind}: {', '.join(self) or 'none'}>"


class Vectors(Parts[np.ndarray]):
    """Parts that are vectors themselves; those that are inputs can be set as a whole."""

    def __init__(self, kind: str, simulation: Variables):
        super().__init__(kind, simulation, Variables.vector)

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        self._simulation[self._path(name)] = value


def require_name(kind: str, name: str, names: Collection[str]) -> None:
    """Raises FmuError with the nearest name if there is no part of this name."""
    if name not in names:
        there = f"; there is {', '.join(names)}" if names else ""
        raise UnknownName(f"{kind} {name}: there is no such {kind}{did_you_mean(nearest_of(str(name), names)) or there}")


# ---- control points ----


class PointVectors:
    """Vectors at single control points, by indices: [i, j, k]."""

    def __init__(self, family: str, simulation: Variables):
        self._family, self._simulation = family, simulation

    def _name(self, place: tuple[int, int, int]) -> str:
        return vector_names(self._family, place)[0].rpartition(".")[0]

    def __getitem__(self, place: tuple[int, int, int]) -> np.ndarray:
        return self._simulation.vector(self._name(place))

    def __setitem__(self, place: tuple[int, int, int], value: ArrayLike) -> None:
        self._simulation[self._name(place)] = value


class PointField:
    """Vectors at all control points as one array (nx, ny, nz, 3)."""

    def __init__(self, component: Component, family: str):
        names = [each for each in component.by_name if each.startswith(family) and (name := parse_name(each)) and name.family == family]
        if not names:
            where = {"position": "outputs.positions", "velocity": "outputs.velocities", "force": "inputs.forces"}[family]
            raise FmuError(f"{family}[i,j,k]: the FMU has no such variables; wanted a scene with {where}")
        indices = places(names)
        counts = component.lattice.points if component.lattice else tuple(int(count) for count in indices[:, :3].max(axis=0) + 1)
        self._family, self._block = family, component.block(names)
        self._shape = (*counts, 3)
        self._flat = np.ravel_multi_index(tuple(indices.T), self._shape)

    def read(self) -> np.ndarray:
        array = np.full(self._shape, np.nan)
        array.reshape(-1)[self._flat] = self._block.get()
        array.flags.writeable = False  # a value assigned to an element of a copy would be lost
        return array

    def write(self, values: ArrayLike) -> None:
        array = np.broadcast_to(np.asarray(values, dtype=float), self._shape).reshape(-1)
        rest = np.delete(array, self._flat)
        if not np.isfinite(array[self._flat]).all() or np.any(rest[~np.isnan(rest)]):
            raise FmuError(f"{self._family}[i,j,k]: wanted finite numbers, and zeros or NaN where the FMU has no such variable")
        self._block.set(array[self._flat])


def at_point(name: str) -> bool:
    """True if the variable belongs to a control point."""
    return (found := parse_name(name)) is not None and found.at_point


def is_position(name: str) -> bool:
    """True if the variable is a component of a control point's position."""
    return bool((found := parse_name(name)) and found.family == "position")


def in_place(variables: list[ScalarVariable]) -> list[ScalarVariable]:
    """Returns the positions of control points in the order of an array (nx, ny, nz, 3), and then the others in their own order."""
    moved = [variable for variable in variables if is_position(variable.name)]
    order = np.lexsort(places([variable.name for variable in moved]).T[::-1])
    return [moved[place] for place in order] + [variable for variable in variables if not is_position(variable.name)]


def places(names: Sequence[str]) -> np.ndarray:
    """Returns the indices (m, 4) of the variables at control points: i, j, k, number of the component."""
    found = [parse_name(name) for name in names]
    rows = [[*(name.instance or ()), "xyz".index(name.component)] for name in found if name and name.at_point]
    return np.array(rows, dtype=int).reshape(-1, 4)
