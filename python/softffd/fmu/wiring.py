"""Components of a coupled system and the connections between them: looks up names, checks ends, and reports all problems at once.

An end is `component.variable`. The name of a vector stands for all its components: plate.point is plate.point.x, .y and .z.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple
from xml.etree import ElementTree as Xml

from softffd.errors import SoftffdError
from softffd.fmu.absent import hint_for
from softffd.fmu.block import number_of
from softffd.fmu.interface import IDENTIFIER, Interface, ScalarVariable
from softffd.names import belonging, components_in, parse_name, stem, structured, vectors_in
from softffd.spelling import did_you_mean, nearest_of

STARTS = ("Real", "Integer", "Boolean", "Enumeration")  # types of variables that take a start value
MOST_NAMES = 4  # most names that a message lists as fitting


@dataclass(frozen=True)
class Element:
    """One component of a system: the interface of its FMU, and for each unit by name the exponents of the base units, factor and
    offset."""

    name: str
    interface: Interface
    units: Mapping[str, Mapping[str, str]]


class End(NamedTuple):
    element: Element
    variable: ScalarVariable

    def __str__(self) -> str:
        return f"{self.element.name}.{self.variable.name}"

    @property
    def unit(self) -> Any:
        """A value that compares equal for equal units: the definition of the unit, or its name if the FMU does not define it."""
        return self.element.units.get(self.variable.unit or "", self.variable.unit)

    @property
    def quantity(self) -> Any:
        """A value that compares equal for equal quantities, such as lengths in m and mm."""
        unit = self.unit
        return {key: power for key, power in unit.items() if key not in ("factor", "offset")} if isinstance(unit, Mapping) else unit

    @property
    def stem(self) -> str:
        """The name of the vector that the variable is a component of, else of the variable itself; with the name of the element."""
        return f"{self.element.name}.{next(iter(vectors_in([self.variable.name])), self.variable.name)}"

    @property
    def word(self) -> str:
        """The last word of `stem`, such as "reaction"."""
        return self.stem.rpartition(".")[2]


class Connection(NamedTuple):
    """A connection from an output to an input, which gets factor * value + offset."""

    source: End
    target: End
    factor: float = 1.0
    offset: float = 0.0


@dataclass
class Wiring:
    """Connections and start values of a system, with the problems that were found in the request."""

    elements: Mapping[str, Element]
    connections: list[Connection] = field(default_factory=list)
    starts: dict[str, dict[str, float]] = field(default_factory=dict)  # by component and variable
    recorded: list[End] = field(default_factory=list)  # outputs that a host is to record, connected or not
    problems: list[str] = field(default_factory=list)

    def connect(self, asked: Iterable[Sequence[Any]]) -> None:
        """Adds connections. asked: pairs of ends, in either order, optionally with a factor, or with a factor and an offset."""
        for given in asked:
            before = len(self.problems)
            connections = list(self._connections(given))
            for connection in connections:
                self._add(connection)
            if connections and len(self.problems) > before:
                self.problems[before] += self._fitting(connections[0])

    def record(self, asked: Iterable[str]) -> None:
        """Adds outputs to record. asked: COMPONENT.NAME, where NAME means all outputs that belong to it (box.probe.top, box.energy), or
        COMPONENT."""
        for name in asked:
            element, _, wanted = str(name).partition(".")
            if element not in self.elements:
                self._unknown_element(str(name))
                continue
            known = self.elements[element].interface.variables
            outputs = [variable.name for variable in known.values() if variable.causality == "output" and variable.type in STARTS]
            by_name = {"": outputs} | belonging(outputs)
            if names := by_name.get(structured(wanted)):
                self.recorded += [End(self.elements[element], known[each]) for each in names]
            elif found := known.get(wanted):
                self.problems.append(f"{name}: wanted an output to record, got {_kind(found)}")
            else:
                nearest = nearest_of(wanted, by_name)
                self.problems.append(f"{name}: {element} has no such output{did_you_mean(nearest and f'{element}.{nearest}')}")

    def ends(self) -> dict[str, End]:
        """Returns the ends that are connected or recorded, each once, by name."""
        return {str(end): end for end in [*(end for each in self.connections for end in each[:2]), *self.recorded]}

    def start(self, values: Mapping[str, Any]) -> None:
        """Adds start values. values: numbers or vectors by end."""
        if values and (alike := [f"{a} and {b}" for a in self.elements for b in self.elements if a != b and b.startswith(a)]):
            self.problems.append(
                f"components {alike[0]}: wanted names of which none begins with another, because fmpy assigns start values by that"
            )
        for name, given in values.items():
            ends = self._ends(name)
            each = list(given) if isinstance(given, Iterable) and not isinstance(given, str) else [given]
            if ends and len(each) != len(ends):
                self.problems.append(f"{name}: wanted {len(ends)} number{'s' * (len(ends) > 1)}, got {given!r:.70}")
                continue
            for end, value in zip(ends.values(), each, strict=False):
                self._start(end, value)

    def _start(self, end: End, value: Any) -> None:
        variable = end.variable
        if variable.causality not in ("input", "parameter"):
            self.problems.append(f"{end}: wanted an input or a parameter to start from, got {_kind(variable)}")
        elif variable.type not in STARTS:
            self.problems.append(f"{end}: wanted a variable of the type {', '.join(STARTS)}, got {_kind(variable)}")
        else:
            try:
                number = number_of(variable, value)
            except SoftffdError as error:
                self.problems.append(f"{end.element.name}.{error}")
                return
            if not math.isfinite(number):
                self.problems.append(f"{end}: wanted a finite number, got {number:g}")
            self.starts.setdefault(end.element.name, {})[variable.name] = number

    def _connections(self, given: Sequence[Any]) -> Iterator[Connection]:
        wanted = "wanted two ends and, if any, a factor and an offset"
        try:
            one, other, *numbers = given
            factors = [float(number) for number in numbers]
        except (TypeError, ValueError):
            one = other = None
        if not (isinstance(one, str) and isinstance(other, str)) or isinstance(given, str) or len(factors) > 2:
            self.problems.append(f"connection: {wanted}, got {given!r:.70}")
            return
        first, second = self._ends(one), self._ends(other)
        if first and second and set(first) != set(second):
            told = (f"{name} ({', '.join(filter(None, ends)) or 'a number'})" for name, ends in ((one, first), (other, second)))
            self.problems.append(f"wanted two ends of the same components, got {' and '.join(told)}")
            return
        for component in first if second else ():
            ends = (first[component], second[component])
            source, target = ends if ends[0].variable.causality == "output" else ends[::-1]
            yield Connection(source, target, *factors)

    def _ends(self, name: str) -> dict[str, End]:
        """Returns the end of this name with the key "", or those of the vector by component. If there is none, adds a problem and returns
        {}."""
        element, _, variable = name.partition(".")
        if element not in self.elements:
            self._unknown_element(name)
            return {}
        owner = self.elements[element]
        known = owner.interface.variables
        if variable in known:
            return {"": End(owner, known[variable])}
        ends = {f".{c}": End(owner, known[full]) for c, full in components_in(known, variable).items()}
        if not ends:
            hint = hint_for(variable, known, [*known, *sorted(vectors_in(known))], own=owner.interface.identifier == IDENTIFIER)
            hint = hint.replace('did you mean "', f'did you mean "{element}.')
            self.problems.append(f"{name}: {element} has no such variable{hint}")
        return ends

    def _unknown_element(self, name: str) -> None:
        nearest = nearest_of(name.partition(".")[0], self.elements)
        self.problems.append(f"{name}: wanted COMPONENT.VARIABLE of {', '.join(self.elements)}{did_you_mean(nearest)}")

    def _add(self, new: Connection) -> None:
        problem = _problem_of(new)
        if not problem:
            earlier = next((each for each in self.connections if str(each.target) == str(new.target)), None)
            problem = earlier and f"{new.target}: wanted one connection to an input, got {earlier.source} and {new.source}"
        if problem:
            self.problems.append(problem)
        else:
            self.connections.append(new)

    def _fitting(self, refused: Connection) -> str:
        """Returns, for a connection whose causalities or units differ, the variables that each end could be connected with instead, in
        words."""
        source, target = refused[:2]
        opposite = {"output": "input", "input": "output"}
        found = []
        for end, other in ((source, target), (target, source)):
            wanted = opposite.get(other.variable.causality)
            if wanted is None or not other.variable.unit or (end.unit == other.unit and end.variable.causality == wanted):
                continue
            ends = (End(end.element, each) for each in end.element.interface.variables.values() if each.causality == wanted)
            fitting = [each.variable.name for each in ends if each.unit == other.unit]
            names = dict.fromkeys(stem(name) if parse_name(name) else next(iter(vectors_in([name])), name) for name in fitting)
            if names:
                found.append(f"; {wanted}s of {end.element.name} in {other.variable.unit}: {', '.join(list(names)[:MOST_NAMES])}")
        return "".join(found)

    def doubts(self) -> list[str]:
        """Returns messages about connections that may not be intended: a factor connects two different quantities, or an output goes to
        an input of another name while an input of its own name and unit is unconnected."""
        connected = {each.target.stem for each in self.connections}
        found: dict[str, None] = {}
        for source, target, *_ in self.connections:
            if source.variable.unit and target.variable.unit and source.quantity != target.quantity:
                made = f"the factor makes {target.variable.unit} of {source.variable.unit}"
                found[f"{source.stem} to {target.stem}: {made}{self._fitting(Connection(source, target))}"] = None
            inputs = [End(target.element, each) for each in target.element.interface.variables.values() if each.causality == "input"]
            alike = [each for each in inputs if each.word == source.word and each.unit == source.unit and each.stem not in connected]
            if target.word != source.word and alike:
                found[f'{source.stem} goes to {target.stem}; did you mean "{alike[0].stem}", to which nothing goes?'] = None
        return list(found)

    def starts_elsewhere(self) -> list[str]:
        """Returns the start values of connected inputs that are not zero: fmpy sets connected inputs to zero in its first step."""
        targets = [each.target for each in self.connections]
        values = [(end, self.starts.get(end.element.name, {}).get(end.variable.name, end.variable.start)) for end in targets]
        return [f"{end} = {float(value):g}" for end, value in values if value and float(value)]


def _problem_of(connection: Connection) -> str | None:
    source, target, factor, offset = connection
    ends = f"{source} to {target}"
    if (source.variable.causality, target.variable.causality) != ("output", "input"):
        return f"{ends}: wanted an output and an input, got {_kind(source.variable)} and {_kind(target.variable)}"
    if source.variable.type != target.variable.type:
        return f"{ends}: wanted one type, got {source.variable.type} and {target.variable.type}"
    if not (math.isfinite(factor) and factor and math.isfinite(offset)):
        return f"{ends}: wanted a finite factor that is not 0 and a finite offset, got {factor:g} and {offset:g}"
    converted = (factor, offset) != (1.0, 0.0)
    if converted and source.variable.type != "Real":
        return f"{ends}: wanted Reals for a factor and an offset, got {source.variable.type}"
    if not converted and source.variable.unit and target.variable.unit and source.unit != target.unit:
        return f"{ends}: wanted one unit or a factor from one to the other, got {source.variable.unit} and {target.variable.unit}"
    return None


def _kind(variable: ScalarVariable) -> str:
    words = f"{variable.variability} {variable.causality}" if variable.causality == "parameter" else variable.causality
    return f"{'an' if words[0] in 'aeiou' else 'a'} {words}" + ("" if variable.type == "Real" else f" ({variable.type})")


def read_units(description: bytes) -> dict[str, dict[str, str]]:
    """Returns the units that a modelDescription.xml defines, by name: exponents of the base units, factor, offset."""
    units = Xml.fromstring(description).iterfind("UnitDefinitions/Unit")
    return {unit.get("name", ""): dict(base.attrib) for unit in units if (base := unit.find("BaseUnit")) is not None}
