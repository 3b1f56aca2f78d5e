"""The parts of a running FMU by name: obstacles, pins, loads, probes, and the vectors that they consist of."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast, overload

import numpy as np

from softffd.errors import FmuError, UnknownName
from softffd.spelling import did_you_mean, nearest_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from softffd.run.simulation import Simulation

T = TypeVar("T")


def _in_place(change: Callable[[Any, Any], Any]) -> Any:
    """`+=` and its like of a Vector, from what the FMU has now."""

    def changed(vector: Vector, other: Any) -> Vector:
        vector[...] = change(np.asarray(vector) if vector._send is None else vector._read(), other)
        return vector

    return changed


class Vector(np.ndarray):
    """A variable's components (3,) or (4,) as they were when it was read. Assigning to one of them, or `+=` and its like, sets it in the
    FMU and leaves the others as they are there now. Parts of it and functions that write into it are refused: it is read-only for them."""

    _send: Callable[[np.ndarray], None] | None
    _read: Callable[[], np.ndarray]

    @classmethod
    def of(cls, read: Callable[[], np.ndarray], send: Callable[[np.ndarray], None]) -> Vector:
        """read: gives the components, a buffer that is copied; send: takes all of them when one was assigned to."""
        vector = cast(Vector, read().astype(float).view(cls))
        vector._send, vector._read = send, read
        vector.flags.writeable = False
        return vector

    def __array_finalize__(self, source: Any) -> None:
        self._send = None  # what is computed from a vector is a number of the host's

    def __setitem__(self, key: Any, value: Any) -> None:
        if self._send is None:
            super().__setitem__(key, value)
            return
        changed = self._read().astype(float)
        changed[key] = value
        self._send(changed)
        self.flags.writeable = True
        super().__setitem__(..., changed)
        self.flags.writeable = False

    __iadd__, __isub__, __imul__, __itruediv__ = (_in_place(way) for way in (operator.add, operator.sub, operator.mul, operator.truediv))


class VectorField:
    """An attribute of a part that is a vector: reading gives a Vector, assigning sets all components."""

    def __init__(self, doc: str):
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, part: None, owner: type) -> VectorField: ...
    @overload
    def __get__(self, part: Part, owner: type) -> Vector: ...
    def __get__(self, part: Part | None, owner: type) -> VectorField | Vector:
        return self if part is None else part.simulation.vector(f"{part.path}.{self._name}")

    def __set__(self, part: Part, value: ArrayLike) -> None:
        part.simulation[f"{part.path}.{self._name}"] = value


class NumberField:
    """An attribute of a part that is one number."""

    def __init__(self, doc: str):
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, part: None, owner: type) -> NumberField: ...
    @overload
    def __get__(self, part: Part, owner: type) -> float: ...
    def __get__(self, part: Part | None, owner: type) -> NumberField | float:
        return self if part is None else part.simulation.number(f"{part.path}.{self._name}")

    def __set__(self, part: Part, value: float) -> None:
        part.simulation[f"{part.path}.{self._name}"] = value


class Part:
    """Something of a scene that has variables of its own. An attribute that the FMU does not have answers with FmuError."""

    __slots__ = ("path", "simulation")

    def __init__(self, simulation: Simulation, path: str):
        self.simulation, self.path = simulation, path

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in Part.__slots__ and not hasattr(type(self), name):
            known = [each for each in dir(type(self)) if not each.startswith("_")]
            raise FmuError(f"{self.path}.{name}: the FMU has no such variable{did_you_mean(nearest_of(name, known))}")
        super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        known = [each for each in dir(type(self)) if not each.startswith("_") and each not in Part.__slots__]
        raise FmuError(f"{self.path}.{name}: the FMU has no such variable{did_you_mean(nearest_of(name, known))}")

    def __repr__(self) -> str:
        return f"<{self.path}>"


class Plane(Part):
    """An obstacle. Its friction and what is an input of its pose and motion can be set at any time, the rest before the first step."""

    __slots__ = ()
    point = VectorField("(3,) m, at the communication point; of a plane that is no input: at the start")
    normal = VectorField("(3,); need not have unit length; the solid is on the other side")
    rotation = VectorField(
        "(3,) rad, of a box, which has no normal: along the axis and as long as the angle of its turn from the world's axes"
    )
    velocity = VectorField("(3,) m/s, of the obstacle at `point` during the step")
    angular_velocity = VectorField("(3,) rad/s, about `point`")
    friction = NumberField("Coulomb coefficient, >= 0")
    reaction = VectorField("(3,) N: force of the object on the obstacle, mean of the last communication step")
    torque = VectorField("(3,) N.m about `point`, mean of the last communication step")
    centre = VectorField("(3,) m: centre of pressure, where `reaction` acts; the plane's point where nothing presses")
    contacts = NumberField("Number of control points, or points of the surface, in contact")


class Pin(Part):
    """Control points attached to a rigid frame. Of one that inputs move these can be set at any time, the rest of its pose
    and motion before the first step."""

    __slots__ = ()
    position = VectorField("(3,) m: origin of the frame at the communication point")
    orientation = VectorField("(4,): quaternion (w, x, y, z); need not have unit length")
    velocity = VectorField("(3,) m/s, of the origin during the step")
    angular_velocity = VectorField("(3,) rad/s")
    reaction = VectorField("(3,) N: force of the object on its fixture, mean of the last communication step")
    torque = VectorField("(3,) N.m about the frame's origin, mean of the last communication step")


class Parts(Mapping[str, T], Generic[T]):
    """The parts of one kind by name, in the order of the scene; FmuError with the nearest name for an unknown one."""

    def __init__(self, kind: str, names: list[str], part: Callable[[str], T]):
        self._kind, self._names, self._part = kind, names, part

    def __getitem__(self, name: str) -> T:
        require_name(self._kind, name, self._names)
        return self._part(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __repr__(self) -> str:
        return f"<{self._kind}: {', '.join(self._names) or 'none'}>"


class Vectors(Parts[Vector]):
    """Parts that are vectors themselves; the inputs among them can be set."""

    def __init__(self, kind: str, names: list[str], simulation: Simulation):
        super().__init__(kind, names, lambda name: simulation.vector(f"{kind}.{name}"))
        self._simulation = simulation

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        require_name(self._kind, name, self._names)
        self._simulation[f"{self._kind}.{name}"] = value


def require_name(kind: str, name: str, names: list[str]) -> None:
    """FmuError with the nearest name where there is no part of this name."""
    if name not in names:
        there = f"; there is {', '.join(names)}" if names else ""
        raise UnknownName(f"{kind} {name}: there is no such {kind}{did_you_mean(nearest_of(str(name), names)) or there}")
