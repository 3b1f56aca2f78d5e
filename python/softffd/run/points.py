"""What belongs to control points: one vector by its indices, or all of a kind as one array."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from softffd.errors import FmuError
from softffd.names import parse_name, vector_names

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from softffd.fmu.interface import ScalarVariable
    from softffd.run.simulation import Simulation


class PointVectors:
    """Vectors of control points, by indices: [i, j, k]."""

    def __init__(self, family: str, simulation: Simulation):
        self._family, self._simulation = family, simulation

    def _name(self, place: tuple[int, int, int]) -> str:
        return vector_names(self._family, place)[0].rpartition(".")[0]

    def __getitem__(self, place: tuple[int, int, int]) -> np.ndarray:
        return self._simulation.vector(self._name(place))

    def __setitem__(self, place: tuple[int, int, int], value: ArrayLike) -> None:
        self._simulation[self._name(place)] = value


class PointField:
    """Vectors of all control points as one array (nx, ny, nz, 3)."""

    def __init__(self, simulation: Simulation, family: str):
        names = [
            name for name in simulation.variables if name.startswith(family) and (found := parse_name(name)) and found.family == family
        ]
        if not names:
            where = {"position": "outputs.positions", "velocity": "outputs.velocities", "force": "inputs.forces"}[family]
            raise FmuError(f"{family}[i,j,k]: the FMU has no such variables; wanted a scene with {where}")
        indices = places(names)
        box = simulation.lattice
        counts = box.points if box else tuple(int(count) for count in indices[:, :3].max(axis=0) + 1)
        self._family, self._block = family, simulation.component.block(names)
        self._shape = (*counts, 3)
        self._flat = np.ravel_multi_index(tuple(indices.T), self._shape)

    def read(self) -> np.ndarray:
        array = np.full(self._shape, np.nan)
        array.reshape(-1)[self._flat] = self._block.get()
        array.flags.writeable = False  # what is assigned to an element of a copy would be lost
        return array

    def write(self, values: ArrayLike) -> None:
        array = np.broadcast_to(np.asarray(values, dtype=float), self._shape).reshape(-1)
        rest = np.delete(array, self._flat)
        if not np.isfinite(array[self._flat]).all() or np.any(rest[~np.isnan(rest)]):
            raise FmuError(f"{self._family}[i,j,k]: wanted finite numbers, and zeros or NaN where the FMU has no such variable")
        self._block.set(array[self._flat])


def is_position(name: str) -> bool:
    """Whether a variable is a component of a control point's position."""
    return bool((found := parse_name(name)) and found.family == "position")


def in_place(variables: list[ScalarVariable]) -> list[ScalarVariable]:
    """The positions of control points in the order of an array (nx, ny, nz, 3), and then the others in theirs."""
    moved = [variable for variable in variables if is_position(variable.name)]
    order = np.lexsort(places([variable.name for variable in moved]).T[::-1])
    return [moved[place] for place in order] + [variable for variable in variables if not is_position(variable.name)]


def places(names: Sequence[str]) -> np.ndarray:
    """Indices (m, 4) of the variables of control points: i, j, k, number of the component."""
    found = [parse_name(name) for name in names]
    rows = [[*(name.instance or ()), "xyz".index(name.component)] for name in found if name and name.at_point]
    return np.array(rows, dtype=int).reshape(-1, 4)
