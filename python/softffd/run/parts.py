"""The parts of a running FMU by name: obstacles, pins, loads, probes, and the vectors that they consist of."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

import numpy as np

from softffd.errors import FmuError, UnknownName
from softffd.spelling import did_you_mean, nearest_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from softffd.run.simulation import Simulation

T = TypeVar("T")


class VectorField:
    """An attribute of a part that is a vector: reading gives an array, a copy; assigning sets all components."""

    def __init__(self, doc: str):
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, part: None, owner: type) -> VectorField: ...
    @overload
    def __get__(self, part: Part, owner: type) -> np.ndarray: ...
    def __get__(self, part: Part | None, owner: type) -> VectorField | np.ndarray:
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


class Obstacle(Part):
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


class Vectors(Parts[np.ndarray]):
    """Parts that are vectors themselves; the inputs among them can be set as a whole."""

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
