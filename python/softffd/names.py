"""Names of variables. Only this module turns the rows of the table into names and names into rows.

A row's name is a pattern (variables.toml): `position[{i},{j},{k}].{c}`, `{obstacle}.point.{c}`, `pin.{name}.position.{c}`,
`stiffness.edge`. {i},{j},{k}, {obstacle}, {body} or KIND.{name} stands for the *instance*. An instance is a control point (i, j, k); or a
part, which is an obstacle, pin, load, probe or sensor with its kind and its name; or a taxel, which is the cell {i},{j} of a sensor. {c}
is the *component*.
Names have two forms, and a scene chooses one of them for its FMU (fmu.names). The *structured* form is that of the table. The *flat* form
has underscores in the place of points, commas and brackets: `position_0_1_2_x`, `plane_ground_point_z`. Either form is understood wherever
names are read.
A flat name that could belong to several parts belongs to the part with the shortest name: `plane_a_angular_velocity_x` belongs to the
plane a. A scene with flat names has no part whose variables would be taken for those of another part (`mistaken`).
The pose of a fixed obstacle and the motion of a free body have the same names as those of an input. Such a name counts as of the family
that comes first in the table, the input.
"""

import re
from collections.abc import Container, Iterable
from functools import cache, lru_cache
from typing import Any, NamedTuple, TypeVar

from softffd.installed import table
from softffd.lattice import Point
from softffd.spelling import few

T = TypeVar("T")

IDENTIFIER = "[A-Za-z_][A-Za-z0-9_]*"  # what an obstacle, pin, load, probe or sensor may be called
OBSTACLES = ("plane", "sphere", "cylinder", "box")  # kinds of obstacles
BODIES = (*OBSTACLES[1:], "pin")  # kinds of parts that may have a mass of their own
PROBED = ("stress", "von_mises", "stretch", "velocity", "acceleration")  # quantities that a probe may output beside its position
LARGEST = ("velocity", "acceleration", "von_mises")  # quantities of which a probe may output the largest value
_INDEX = r"(?:0|[1-9]\d*)"
_FLAT = str.maketrans({".": "_", "[": "_", ",": "_", "]": None})


class Part(NamedTuple):
    """An obstacle, pin, load, probe or sensor; as text "plane.ground", the beginning of its variables' names."""

    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.kind}.{self.name}"

    @property
    def is_obstacle(self) -> bool:
        return self.kind in OBSTACLES


class Cell(NamedTuple):
    """A taxel of a sensor."""

    name: str
    i: int
    j: int


Instance = Part | Cell | str | Point | None
"""What a variable belongs to. A name alone means a plane, or the pin, load, probe or sensor to which the family belongs."""


class Name(NamedTuple):
    """A variable's name, taken apart."""

    family: str  # key of its row in the table
    instance: Part | Cell | Point | None
    """The obstacle, pin, load, probe, sensor or taxel, or the control point; None for a variable that exists only once"""
    component: str  # "x", "y", "z" or "w"; empty for scalars

    @property
    def at_point(self) -> bool:
        """True if the variable belongs to a control point."""
        return isinstance(self.instance, tuple) and not isinstance(self.instance, Part | Cell)


def variable_name(family: str, instance: Instance = None, component: str = "", *, flat: bool = False) -> str:
    """Returns the name of one variable of a family: variable_name("plane_point", "ground", "z") is plane.ground.point.z."""
    stem = _stem(_row(family), instance)
    name = f"{stem}.{component}" if component else stem
    return flat_form(name) if flat else name


def variable_names(family: str, instances: Iterable[Instance] = (None,), *, flat: bool = False) -> list[str]:
    """Returns the names of a family for several instances, one instance with all its components after the other, as in the FMU."""
    row = _row(family)
    stems = (_stem(row, instance) for instance in instances)
    components = row.get("components", "")
    names = [f"{stem}.{component}" for stem in stems for component in components] if components else list(stems)
    return [flat_form(name) for name in names] if flat else names


def vector_names(family: str, instance: Instance = None) -> list[str]:
    """Returns the names of all components for one instance."""
    return variable_names(family, (instance,))


def flat_form(name: str) -> str:
    """Returns the flat form of a structured name, or of the beginning of one."""
    return name.translate(_FLAT)


def belonging(names: Iterable[str]) -> dict[str, list[str]]:
    """Returns the names of these variables by every word that selects some of them. Such a word is a name, position[0,0,1].x, or a
    beginning of it, position[0,0,1] or position; for names of the table the flat forms of these count too."""
    found: dict[str, list[str]] = {}
    for given in names:
        name = structured(given)
        whole = [name, *(name[: part.start()] for part in re.finditer(r"[.\[]", name))]
        for each in dict.fromkeys([*whole, *map(flat_form, whole)]) if parse_name(name) else whole:
            found.setdefault(each, []).append(given)
    return found


@lru_cache(maxsize=4096)  # the names of a run's inputs are parsed at every step
def parse_name(name: str) -> Name | None:
    """Returns family, instance and component of a name in either form; None if the name is not of the table."""
    possible = []
    for pattern, key, kind in _shapes().get(_first_word(name), ()):
        if found := re.fullmatch(pattern, name):  # compiles only the patterns of this first word
            words = found.groupdict()
            indices = [int(words[axis]) for axis in "ijk" if axis in words]
            of: Part | Cell | Point | None = Part(kind, words["name"]) if kind else None
            if indices:
                of = Cell(words["name"], *indices) if kind else (indices[0], indices[1], indices[2])
            possible.append(Name(key, of, words.get("c", "")))
    return min(possible, key=lambda each: len(str(each.instance)), default=None)


def other_form(name: str) -> str | None:
    """Returns the flat form of a structured name, or the structured form of a flat name; None if there is one form only."""
    whole = structured(name)
    other = flat_form(whole) if name == whole else whole
    return other if other != name and parse_name(name) else None


@lru_cache(maxsize=4096)
def structured(name: str) -> str:
    """Returns the structured form of a name in either form; a name that is not of the table is returned unchanged."""
    found = parse_name(name)
    return variable_name(*found) if found else name


def mistaken(part: Part) -> str | None:
    """Returns a structured name among this part's variables whose flat form is taken for another variable's name; None if there is
    none."""
    for row in _rows().values():
        if part.kind in _kinds(row):
            for name in variable_names(row["key"], [part]):
                if structured(flat_form(name)) != name:
                    return name
    return None


class ByName(dict[str, T]):
    """Values by variable name. Either form of a name finds a value that is stored under the other form."""

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


MEMBERS = (*"wxyz", "edge", "face", "body")
"""Last words of the names of a vector's components and of the stiffnesses of the kinds of springs"""


def components_in(variables: Container[str], vector: str, letters: Iterable[str] = "wxyz") -> dict[str, str]:
    """Returns, by letter, the names of a vector's components that are among the variables, in either form; empty if there are none."""
    return {c: full for c in letters for between in "._" if (full := f"{vector}{between}{c}") in variables}


def vectors_in(variables: Iterable[str]) -> list[str]:
    """Returns the names of the vectors whose components are among the variables."""
    return list(dict.fromkeys(name[:-2] for name in variables if name[-2:-1] in ("_", ".") and name[-1] in "wxyz"))


def is_pose(name: str) -> bool:
    """True if the variable belongs to the pose or motion of an obstacle or pin, which a scene may make an input."""
    found = parse_name(name)
    return found is not None and "pose" in _row(found.family)


def parts_of(names: Iterable[str], *kinds: str) -> list[Part]:
    """Returns the parts of some kinds ("plane", "pin", ...) to which the named variables belong, in the order of the scene.

    Each row of the table goes through its parts in that order. The family with most parts therefore comes first, and parts that it lacks
    follow. A family whose names are those of two rows (input planes, then fixed ones) comes last.
    """
    by_family: dict[str, dict[Part, None]] = {}
    for name in names:
        if name.startswith(kinds) and (found := parse_name(name)) and isinstance(found.instance, Part) and found.instance.kind in kinds:
            by_family.setdefault(found.family, {})[found.instance] = None
    patterns = [row["name"] for row in _rows().values()]
    families = sorted(by_family, key=lambda family: (patterns.count(_row(family)["name"]), -len(by_family[family])))
    return list(dict.fromkeys(part for family in families for part in by_family[family]))


def stem(name: str) -> str:
    """Returns what the components and places of a variable have in common: "plane.press.point", "velocity[i,j,k]",
    "sensor.foot.taxel[i,j]"."""
    found = parse_name(name)
    whole = name[: -1 - len(found.component)] if found and found.component else name
    if found and isinstance(found.instance, Cell):
        return re.sub(r"\[\d+,\d+\]", "[i,j]", variable_name(found.family, found.instance).removesuffix("."))
    return f"{found.family}[i,j,k]" if found and found.at_point else whole


def unit_of(name: str) -> str:
    """Returns the unit of a variable; empty if the name is not of the table or the variable has no unit."""
    found = parse_name(name)
    return str(_row(found.family).get("unit", "")) if found else ""


def range_of(name: str) -> tuple[float | None, float | None]:
    """Returns the least and greatest value of a variable, None where the table has no number; the least value may be excluded."""
    row = _row(found.family) if (found := parse_name(name)) else {}
    return row.get("min", row.get("above")), most if isinstance(most := row.get("max"), float) else None


def is_step_mean(name: str) -> bool:
    """True if the variable is the mean over the communication step that ends at its time."""
    found = parse_name(name)
    return found is not None and bool(_row(found.family).get("mean"))


def listed(names: Iterable[str]) -> str:
    """Returns names in one line, to be read at a glance: each vector once, the first six, and how many more there are."""
    return few(list(dict.fromkeys(map(stem, names)))) or "none"


def part_names(names: Iterable[str], *kinds: str) -> list[str]:
    """Returns the names of the parts of these kinds, without their kinds."""
    return [part.name for part in parts_of(names, *kinds)]


def _stem(row: dict[str, Any], instance: Instance) -> str:
    """Returns a structured name without its component, which comes last in every pattern."""
    pattern = row["name"].removesuffix(".{c}")
    if isinstance(instance, Cell):
        return pattern.format(name=instance.name, i=instance.i, j=instance.j)
    if isinstance(instance, Part):
        return pattern.format(name=instance.name, obstacle=instance, body=instance, i=0, j=0)
    if isinstance(instance, tuple):
        i, j, k = instance
        return pattern.format(i=i, j=j, k=k)
    return pattern.format(name=instance, obstacle=f"plane.{instance}")


@cache
def _rows() -> dict[str, dict[str, Any]]:
    return {row["key"]: row for row in table()["family"]}


def _row(family: str) -> dict[str, Any]:
    return _rows()[family]


def _kinds(row: dict[str, Any]) -> tuple[str, ...]:
    """Returns the kinds of parts that the row's variables belong to; empty if they belong to control points or to the whole."""
    for placeholder, kinds in (("{obstacle}", OBSTACLES), ("{body}", BODIES)):
        if placeholder in row["name"]:
            return kinds
    return (row["name"].partition(".")[0],) if "{name}" in row["name"] else ()


def _first_word(name: str) -> str:
    return re.split("[^a-z]", name, maxsplit=1)[0]


@cache
def _shapes() -> dict[str, list[tuple[str, str, str]]]:
    """Returns the patterns that names match in either form, by their first word: the pattern, the row's key, and the kind of part or
    nothing.

    A name that several families share belongs to the first of them in the table.
    """
    shapes: dict[str, list[tuple[str, str, str]]] = {}
    known = set()
    for row in _rows().values():
        words = {"{name}": f"(?P<name>{IDENTIFIER})", "{c}": f"(?P<c>[{row.get('components', '')}])"}
        words |= {f"{{{axis}}}": f"(?P<{axis}>{_INDEX})" for axis in "ijk"}
        for kind in _kinds(row) or ("",):
            whole = row["name"].replace("{obstacle}", f"{kind}.{{name}}").replace("{body}", f"{kind}.{{name}}")
            for shape in (whole, flat_form(whole)):
                pattern = "".join(words.get(piece) or re.escape(piece) for piece in re.split(r"(\{\w+\})", shape))
                if pattern not in known:
                    known.add(pattern)
                    shapes.setdefault(_first_word(shape), []).append((pattern, row["key"], kind))
    return shapes
