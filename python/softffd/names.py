"""Names of variables: the table's rows turned into names and names into rows, here and nowhere else.

A row's name is a pattern (variables.toml): `position[{i},{j},{k}].{c}`, `{obstacle}.point.{c}`, `pin.{name}.position.{c}`,
`stiffness.edge`. What stands for {i},{j},{k}, for {obstacle} or for KIND.{name} is the *instance*: a control point (i, j, k), or a part, an
obstacle, pin, load or probe with its kind and its name; {c} is the *component*.
Names have two forms, of which a scene chooses one for its FMU (fmu.names): *structured* as in the table, and *flat*, where commas and
brackets are underscores, `position_0_1_2.x`. Only names at control points differ. Either form is understood wherever names are read.
The pose of a fixed obstacle has the same names as that of an input; as family it counts the first in the table, the input.
"""

import re
from collections.abc import Iterable
from functools import cache, lru_cache
from typing import Any, NamedTuple, TypeVar

from softffd.installed import table
from softffd.lattice import Point

T = TypeVar("T")

IDENTIFIER = "[A-Za-z_][A-Za-z0-9_]*"
"""What an obstacle, pin, load or probe may be called."""

OBSTACLES = ("plane", "sphere", "cylinder", "box")
"""Kinds of obstacles"""

POINT, FLAT_POINT = "[{i},{j},{k}]", "_{i}_{j}_{k}"
"""What stands for the control point in a pattern, and in the flat form of it."""

_PART_NAME = re.compile(IDENTIFIER)
_N = r"(0|[1-9]\d*)"
_AT_POINT = re.compile(rf"([a-z_]+)(?:\[{_N},{_N},{_N}\]|_{_N}_{_N}_{_N})(?:\.(\w+))?")


class Part(NamedTuple):
    """An obstacle, pin, load or probe; as text "plane.ground", the beginning of its variables' names."""

    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.kind}.{self.name}"

    @property
    def is_obstacle(self) -> bool:
        return self.kind in OBSTACLES


Instance = Part | str | Point | None
"""What a variable belongs to; the name alone is that of a plane, or of the pin, load or probe that the family is of."""


class Name(NamedTuple):
    """A variable's name, taken apart."""

    family: str
    """Key of its row in the table"""
    instance: Part | Point | None
    """The obstacle, pin, load or probe, or the control point; None where there is one only"""
    component: str
    """"x", "y", "z" or "w"; empty for scalars"""

    @property
    def at_point(self) -> bool:
        """Does it belong to a control point?"""
        return isinstance(self.instance, tuple) and not isinstance(self.instance, Part)


def variable_name(family: str, instance: Instance = None, component: str = "", *, flat: bool = False) -> str:
    """The name of one variable of a family: variable_name("plane_point", "ground", "z") is plane.ground.point.z."""
    stem = _stem(_row(family), instance, flat)
    return f"{stem}.{component}" if component else stem


def variable_names(family: str, instances: Iterable[Instance] = (None,), *, flat: bool = False) -> list[str]:
    """The names of a family for several instances, one instance with all its components after the other, as in the FMU."""
    row = _row(family)
    stems = (_stem(row, instance, flat) for instance in instances)
    components = row.get("components", "")
    return [f"{stem}.{component}" for stem in stems for component in components] if components else list(stems)


def vector_names(family: str, instance: Instance = None) -> list[str]:
    """The names of all components for one instance."""
    return variable_names(family, (instance,))


def meant_by(name: str) -> list[str]:
    """Everything that stands for this variable: its name and the beginnings of it, position[0,0,1].x, position[0,0,1], position."""
    name = structured(name)
    return [name, *(name[: found.start()] for found in re.finditer(r"[.\[]", name))]


@lru_cache(maxsize=4096)  # the inputs of a run come back at every step
def parse_name(name: str) -> Name | None:
    """Family, instance and component of a name; None for what is no name of the table."""
    at_points, others = _shapes()
    if found := _AT_POINT.fullmatch(name):
        row, component = at_points.get(found[1]), found[8] or ""
        i, j, k = (int(number) for number in found.groups()[1:7] if number is not None)
        return Name(row["key"], (i, j, k), component) if row is not None and _has(row, component) else None
    words = tuple(name.split("."))
    last = words[-1]
    shapes: list[tuple[tuple[str | None, ...], str | None, str]] = [(words, None, ""), ((*words[:-1], None), None, last)]
    if len(words) > 2:
        kind, owner, *rest = words
        shapes += [((kind, None, *rest), owner, ""), ((kind, None, *rest[:-1], None), owner, last)]
    for shape, part, component in shapes:
        row = others.get(shape)
        if row is not None and _has(row, component) and (part is None or _PART_NAME.fullmatch(part)):
            return Name(row["key"], None if part is None else Part(words[0], part), component)
    return None


@lru_cache(maxsize=4096)
def other_form(name: str) -> str | None:
    """The flat name of the variable that has this structured one, or the other way round; None where there is one form only."""
    found = parse_name(name)
    if found is None or not found.at_point:
        return None
    return variable_name(found.family, found.instance, found.component, flat="[" in name)


def structured(name: str) -> str:
    """The name in its structured form, whichever is given; what is no name stays as it is."""
    return name if "[" in name else other_form(name) or name


class ByName(dict[str, T]):
    """Values by variable name. Either form of a name finds what is there under the other."""

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or (isinstance(name, str) and super().__contains__(other_form(name)))

    def __missing__(self, name: str) -> T:
        if name in self:
            return self[other_form(name) or name]
        raise KeyError(name)

    def get(self, name: str, default: Any = None) -> Any:
        try:
            return self[name]
        except KeyError:
            return default


def is_pose(name: str) -> bool:
    """Is this of the pose or motion of an obstacle or pin, which a scene may make an input?"""
    found = parse_name(name)
    return found is not None and "pose" in _row(found.family)


def parts_of(names: Iterable[str], *kinds: str) -> list[Part]:
    """The parts of some kinds ("plane", "pin", ...) that names of variables speak of, in the order of the scene.

    Each row of the table goes through its parts in that order. So the family with most parts leads, and what it has not got follows; but
    one whose names are those of two rows (input planes, then fixed ones) comes last.
    """
    by_family: dict[str, dict[Part, None]] = {}
    for name in names:
        if name.startswith(kinds) and (found := parse_name(name)) and isinstance(found.instance, Part) and found.instance.kind in kinds:
            by_family.setdefault(found.family, {})[found.instance] = None
    patterns = [row["name"] for row in _rows().values()]
    families = sorted(by_family, key=lambda family: (patterns.count(_row(family)["name"]), -len(by_family[family])))
    return list(dict.fromkeys(part for family in families for part in by_family[family]))


def stem(name: str) -> str:
    """What the components and control points of a variable have in common: "plane.press.point", "velocity[i,j,k]", "mass"."""
    found = parse_name(name)
    whole = name.removesuffix(f".{found.component}") if found and found.component else name
    return f"{found.family}[i,j,k]" if found and found.at_point else whole


def unit_of(name: str) -> str:
    """The unit of a variable; empty for what is no name of the table and where there is none."""
    found = parse_name(name)
    return str(_row(found.family).get("unit", "")) if found else ""


def listed(names: Iterable[str], *, most: int = 6) -> str:
    """Names in a line, for what is to be read at a glance: vectors once, the first `most` and how many more."""
    stems = list(dict.fromkeys(map(stem, names)))
    more = f" and {len(stems) - most} more" if len(stems) > most else ""
    return (", ".join(stems[:most]) or "none") + more


def part_names(names: Iterable[str], *kinds: str) -> list[str]:
    """The names of these parts."""
    return [part.name for part in parts_of(names, *kinds)]


def _stem(row: dict[str, Any], instance: Instance, flat: bool) -> str:
    """A name without its component, which comes last in every pattern."""
    pattern = row["name"].removesuffix(".{c}")
    if flat:
        pattern = pattern.replace(POINT, FLAT_POINT)
    if isinstance(instance, Part):
        return pattern.format(name=instance.name, obstacle=instance)
    if isinstance(instance, tuple):
        i, j, k = instance
        return pattern.format(i=i, j=j, k=k)
    return pattern.format(name=instance, obstacle=f"plane.{instance}")


def _has(row: dict[str, Any], component: str) -> bool:
    components = row.get("components", "")
    return component in components if component else not components


@cache
def _rows() -> dict[str, dict[str, Any]]:
    return {row["key"]: row for row in table()["family"]}


def _row(family: str) -> dict[str, Any]:
    return _rows()[family]


Rows = dict[str, dict[str, Any]]


@cache
def _shapes() -> tuple[Rows, dict[tuple[str | None, ...], dict[str, Any]]]:
    """The rows by what their names look like: of those at control points the first word, of the others all words, None for any."""
    at_points: Rows = {}
    others: dict[tuple[str | None, ...], dict[str, Any]] = {}
    for row in _rows().values():
        if POINT in row["name"]:
            at_points.setdefault(row["name"].partition(POINT)[0], row)
        else:
            for kind in OBSTACLES:
                words = row["name"].replace("{obstacle}", f"{kind}.{{name}}").split(".")
                others.setdefault(tuple(None if word.startswith("{") else word for word in words), row)
    return at_points, others
