"""The twin as an FMI slave, which pythonfmu calls."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from .fixtures import TwinError
from .model import Model

SCENE, DESCRIPTION = "scene.json", "description.xml"
"""Files of the resources: the resolved scene with its table of variables, and the content of modelDescription.xml."""


class TwinSlave(Fmi2Slave):
    """Accesses variables by the references of the component's table and computes outputs on request."""

    def __init__(self, **kwargs: Any):
        super().__init__(**kwargs)
        self.modelName = "softffd_twin"  # pythonfmu's name for the model identifier
        folder = Path(self.resources)
        scene = json.loads((folder / SCENE).read_text(encoding="utf-8"))
        self._description = folder / DESCRIPTION
        self._names = {variable["reference"]: variable["name"] for variable in scene["variables"]}
        self._values = {variable["name"]: variable["start"] for variable in scene["variables"] if variable["start"] is not None}
        self._model = Model(scene)
        self._outputs: dict[str, float] | None = None
        self._start_time, self._initialized = 0.0, False

    def to_xml(self, model_options: Any = None) -> Xml.Element:
        """Returns the model description made from the component's table."""
        return Xml.fromstring(self._description.read_text(encoding="utf-8"))

    def setup_experiment(self, start_time: float, *_: Any) -> None:
        self._start_time = start_time

    def exit_initialization_mode(self) -> None:
        self._read_outputs()
        self._initialized = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Makes a step. Returns False (discard) if the step fails, because exceptions corrupt the interpreter's memory in pythonfmu 0.7."""
        try:
            self._model.advance(self._values, step_size)
        except TwinError as error:
            self.log(str(error), Fmi2Status.error)
            return False
        self._outputs = None
        return True

    def get_real(self, vrs: list[int]) -> list[float]:
        return [float(self._value(reference)) for reference in vrs]

    def get_integer(self, vrs: list[int]) -> list[int]:
        return [int(self._value(reference)) for reference in vrs]

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        self._values.update(zip((self._names[reference] for reference in vrs), values, strict=True))
        if not self._initialized:
            self._outputs = None

    set_integer = set_real

    def _value(self, reference: int) -> float:
        name = self._names[reference]
        return self._values[name] if name in self._values else self._read_outputs()[name]

    def _read_outputs(self) -> dict[str, float]:
        if self._outputs is None:
            if not self._initialized:
                self._model.initialize(self._values, self._start_time)
            self._outputs = self._model.outputs()
        return self._outputs
