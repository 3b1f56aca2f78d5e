"""Poses of obstacles over the time of a run: from their inputs, from the motion that they start with, or as free bodies."""

from collections.abc import Mapping

import numpy as np

from softffd.errors import SoftffdError
from softffd.names import OBSTACLES, Part, parts_of, variable_name, vector_names
from softffd.rotation import matrices, turned
from softffd.run.parts import require_name


class ObstacleCourses:
    """The obstacles of a result."""

    time: np.ndarray
    outputs: Mapping[str, np.ndarray]
    inputs: Mapping[str, np.ndarray]
    parameters: Mapping[str, float]

    def plane_names(self) -> list[str]:
        """Returns the names of the obstacles without their kinds, planes and then solids, in the order of the scene."""
        return [part.name for part in self.obstacle_parts()]

    def obstacle_parts(self) -> list[Part]:
        """Returns the obstacles with their kinds, in the same order; as text "sphere.ball", the beginning of the variables' names."""
        return parts_of([*self.parameters, *self.inputs], *OBSTACLES)

    def _part(self, name: str) -> Part:
        return next((part for part in self.obstacle_parts() if part.name == name), Part("plane", name))

    def plane(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Returns points (T, 3) [m] and normals (T, 3) of an obstacle over time; FmuError with the nearest name for an unknown obstacle.

        For a solid, these are its centre and its third axis: a cylinder's axis, a box's third edge; the axis of a sphere has no meaning.
        SoftffdError for a free body that was not recorded.
        """
        require_name("plane", name, self.plane_names())
        if self.is_free(name):
            return self._of_body("position", name), self._axes(name)[..., 2]
        age = self._age(name)
        points = self._of_plane("point", name) + age * self._of_plane("velocity", name)
        if self._part(name).kind == "box":
            return points, self.edges(name)[..., 2]
        return points, turned(self._of_plane("normal", name), age * self._of_plane("angular_velocity", name))

    def edges(self, name: str) -> np.ndarray:
        """Returns the directions of a box's edges over time, columns (T, 3, 3); FmuError with the nearest name if there is no such box."""
        require_name("box", name, [part.name for part in self.obstacle_parts() if part.kind == "box"])
        if self.is_free(name):
            return self._axes(name)
        rotation, turn = self._of_plane("rotation", name), self._age(name) * self._of_plane("angular_velocity", name)
        return np.stack([turned(turned(np.broadcast_to(axis, turn.shape), rotation), turn) for axis in np.eye(3)], axis=-1)

    def is_free(self, name: str) -> bool:
        """True if an obstacle is a free body, with a mass of its own."""
        return variable_name("body_mass", self._part(name)) in self.parameters

    def _axes(self, name: str) -> np.ndarray:
        return matrices(self._of_body("orientation", name))

    def _of_body(self, what: str, name: str) -> np.ndarray:
        """Returns the position or orientation of a free body over time, (T, 3) or (T, 4)."""
        names = vector_names(f"body_{what}", self._part(name))
        if missing := [key for key in names if key not in self.outputs]:
            raise SoftffdError(f"{self._part(name)}: wanted a run whose outputs say where it is, got one without {missing[0]}")
        return np.stack([self.outputs[key] for key in names], axis=1)

    def _of_plane(self, what: str, name: str) -> np.ndarray:
        """Returns a vector of an obstacle's pose or motion over time, (T, 3)."""
        names = vector_names(f"plane_{what}", self._part(name))
        columns = [self.inputs[key] if key in self.inputs else self.parameters[key] for key in names]
        return np.stack([np.broadcast_to(column, self.time.shape) for column in columns], axis=1)

    def _age(self, name: str) -> np.ndarray:
        """Returns how long an obstacle has moved from the given pose, (T, 1) [s]: since the start, or 0 if inputs give pose or motion."""
        pose = ("point", "normal", "rotation", "velocity", "angular_velocity")
        part = self._part(name)
        led = any(key in self.inputs for what in pose for key in vector_names(f"plane_{what}", part))
        return np.zeros((len(self.time), 1)) if led else (self.time - self.time[0])[:, None]
