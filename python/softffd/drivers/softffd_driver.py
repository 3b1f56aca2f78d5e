"""The common base of the driver FMUs: variables from a table, units, a complete model structure, states that restore exactly.

Each driver FMU contains this module beside its source; the module therefore has a name of its own.
"""

import json
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real

AXES = "xyz"
UNITS: dict[str, dict[str, int]] = {
    "1": {},
    "m": {"m": 1},
    "s": {"s": 1},
    "kg": {"kg": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.s": {"kg": 1, "m": 1, "s": -1},
}  # powers of the base units


class Driver(Fmi2Slave):
    """A driver's variables are the rows of `table`: name, causality, unit, start, description.

    A start of three numbers makes three variables NAME.x .y .z; a whole number as start makes an Integer. `values` holds the whole state
    by name, vectors as lists; entries of `values` that are not in the table belong to the state but are no outputs. If the file
    resources/start.json exists, its start values of parameters replace those of the table.
    """

    table: tuple[tuple[str, str, str | None, Any, str], ...] = ()

    def __init__(self, **kwargs: Any):
        super().__init__(**kwargs)
        self.values: dict[str, Any] = {"steps": 0}
        self.unit_of: dict[str, str | None] = {}
        for name, causality, unit, start, text in self.table:
            self.values[name] = list(start) if isinstance(start, tuple) else start
            for axis in AXES if isinstance(start, tuple) else ("",):
                self._register(name, axis, causality, unit, text)
        given = Path(self.resources or ".") / "start.json"
        if given.is_file():
            self.values.update(json.loads(given.read_text()))
        self.begin()

    def begin(self) -> None:
        """Computes outputs and hidden state from the parameters; called whenever a parameter changes before the first step."""

    def _register(self, name: str, axis: str, causality: str, unit: str | None, text: str) -> None:
        full = f"{name}.{axis}" if axis else name
        self.unit_of[full] = unit

        def get() -> Any:
            return self.values[name][AXES.index(axis)] if axis else self.values[name]

        def put(value: Any) -> None:
            if axis:
                self.values[name][AXES.index(axis)] = value
            else:
                self.values[name] = value
            if causality == "parameter" and self.values["steps"] == 0:
                self.begin()

        kind = Integer if isinstance(self.values[name], int) else Real
        self.register_variable(
            kind(
                full,
                causality=Fmi2Causality[causality],
                variability=Fmi2Variability.fixed if causality == "parameter" else Fmi2Variability.continuous,
                description=f"{text}, {axis}" if axis else text,
                getter=get,
                setter=put,
            ),
            nested=False,
        )

    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        root = super().to_xml(model_options or {})
        root.set("generationDateAndTime", root.get("generationDateAndTime").replace("+00:00", "Z"))
        units = Element("UnitDefinitions")
        for unit in sorted({unit for unit in self.unit_of.values() if unit}):
            powers = {base: str(power) for base, power in UNITS[unit].items()}
            SubElement(SubElement(units, "Unit", name=unit), "BaseUnit", powers)
        root.insert(1, units)
        for variable in root.find("ModelVariables"):
            if own := self.unit_of[variable.get("name")]:
                variable[0].set("unit", own)
            if variable.get("causality") == "output":
                variable.set("initial", "calculated")
        outputs = root.find("ModelStructure/Outputs")
        initial = SubElement(root.find("ModelStructure"), "InitialUnknowns")
        for unknown in outputs:
            SubElement(initial, "Unknown", index=unknown.get("index"))
            unknown.set("dependencies", "")
        return root

    def _get_fmu_state(self) -> dict[str, Any]:
        return json.loads(json.dumps(self.values))

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self.values = json.loads(json.dumps(state))
