"""Names of variables: the table's rows turned into names and names into rows, here and nowhere else.

A row's name is a pattern (variables.toml): `position[{i},{j},{k}].{c}`, `{obstacle}.point.{c}`, `pin.{name}.position.{c}`,
`stiffness.edge`. What stands for {i},{j},{k}, for {obstacle}, {body} or for KIND.{name} is the *instance*: a control point (i, j, k), or a
part, an obstacle, pin, load, probe or sensor with its kind and its name, or a taxel, the cell {i},{j} of a sensor; {c} is the *component*.
Names have two forms, of which a scene chooses one for its FMU (fmu.names): *structured* as in the table, and *flat*, with underscores in
the place of points, commas and brackets: `position_0_1_2_x`, `plane_ground_point_z`. Either form is understood wherever names are read.
A flat name is that of the part with the shortest name it can be of: `plane_a_angular_velocity_x` belongs to the plane a. A scene with flat
names has no part whose variables would be taken for another's (`mistaken`).
The pose of a fixed obstacle, and the motion of a free body, have the same names as those of an input; as family they count the first in the
table, the input.
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
PROBED = ("stress", "von_mises", "stretch", "velocity", "acceleration")  # what a probe may show beside its place
LARGEST = ("velocity", "acceleration", "von_mises")  # of which it may show the largest
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
"""What a variable belongs to; the name alone is that of a plane, or of the pin, load, probe or sensor that the family is of."""


class Name(NamedTuple):
    """A variable's name, taken apart."""

    family: str  # key of its row in the table
    instance: Part | Cell | Point | None
    """The obstacle, pin, load, probe, sensor or taxel, or the control point; None where there is one only"""
    component: str  # "x", "y", "z" or "w"; empty for scalars

    @property
    def at_point(self) -> bool:
        """Does it belong to a control point?"""
        return isinstance(self.instance, tuple) and not isinstance(self.instance, Part | Cell)


def variable_name(family: str, instance: Instance = None, component: str = "", *, flat: bool = False) -> str:
    """The name of one variable of a family: variable_name("plane_point", "ground", "z") is plane.ground.point.z."""
    stem = _stem(_row(family), instance)
    name = f"{stem}.{component}" if component else stem
    return flat_form(name) if flat else name


def variable_names(family: str, instances: Iterable[Instance] = (None,), *, flat: bool = False) -> list[str]:
    """The names of a family for several instances, one instance with all its components after the other, as in the FMU."""
    row = _row(family)
    stems = (_stem(row, instance) for instance in instances)
    components = row.get("components", "")
    names = [f"{stem}.{component}" for stem in stems for component in components] if components else list(stems)
    return [flat_form(name) for name in names] if flat else names


def vector_names(family: str, instance: Instance = None) -> list[str]:
    """The names of all components for one instance."""
    return variable_names(family, (instance,))


def flat_form(name: str) -> str:
    """The flat form of a structured name, or of the beginning of one."""
    return name.translate(_FLAT)


def belonging(names: Iterable[str]) -> dict[str, list[str]]:
    """By everything that stands for some of these variables the names of those: by a name, position[0,0,1].x, and by the beginnings of it,
    position[0,0,1] and position; for names of the table by the flat forms of these too."""
    found: dict[str, list[str]] = {}
    for given in names:
        name = structured(given)
        whole = [name, *(name[: part.start()] for part in re.finditer(r"[.\[]", name))]
        for each in dict.fromkeys([*whole, *map(flat_form, whole)]) if parse_name(name) else whole:
            found.setdefault(each, []).append(given)
    return found


@lru_cache(maxsize=4096)  # the inputs of a run come back at every step
def parse_name(name: str) -> Name | None:
    """Family, instance and component of a name in either form; None for what is no name of the table."""
    possible = []
    for pattern, key, kind in _shapes().get(_first_word(name), ()):
        if found := re.fullmatch(pattern, name):  # compiles those of this first word alone
            words = found.groupdict()
            indices = [int(words[axis]) for axis in "ijk" if axis in words]
            of: Part | Cell | Point | None = Part(kind, words["name"]) if kind else None
            if indices:
                of = Cell(words["name"], *indices) if kind else (indices[0], indices[1], indices[2])
            possible.append(Name(key, of, words.get("c", "")))
    return min(possible, key=lambda each: len(str(each.instance)), default=None)


def other_form(name: str) -> str | None:
    """The flat name of the variable that has this structured one, or the other way round; None where there is one form only."""
    whole = structured(name)
    other = flat_form(whole) if name == whole else whole
    return other if other != name and parse_name(name) else None


@lru_cache(maxsize=4096)
def structured(name: str) -> str:
    """The name in its structured form, whichever is given; what is no name stays as it is."""
    found = parse_name(name)
    return variable_name(*found) if found else name


def mistaken(part: Part) -> str | None:
    """A structured name of this part's variables whose flat form is taken for another variable's; None where there is none."""
    for row in _rows().values():
        if part.kind in _kinds(row):
            for name in variable_names(row["key"], [part]):
                if structured(flat_form(name)) != name:
                    return name
    return None


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


def components_in(variables: Container[str], vector: str, letters: Iterable[str] = "wxyz") -> dict[str, str]:
    """By letter, the names of a vector's components among the variables, in either form; empty where there are none."""
    return {c: full for c in letters for between in "._" if (full := f"{vector}{between}{c}") in variables}


def vectors_in(variables: Iterable[str]) -> list[str]:
    """What the components among the variables are of."""
    return list(dict.fromkeys(name[:-2] for name in variables if name[-2:-1] in ("_", ".") and name[-1] in "wxyz"))


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
    """What the components and places of a variable have in common: "plane.press.point", "velocity[i,j,k]", "sensor.foot.taxel[i,j]"."""
    found = parse_name(name)
    whole = name[: -1 - len(found.component)] if found and found.component else name
    if found and isinstance(found.instance, Cell):
        return re.sub(r"\[\d+,\d+\]", "[i,j]", variable_name(found.family, found.instance).removesuffix("."))
    return f"{found.family}[i,j,k]" if found and found.at_point else whole


def unit_of(name: str) -> str:
    """The unit of a variable; empty for what is no name of the table and where there is none."""
    found = parse_name(name)
    return str(_row(found.family).get("unit", "")) if found else ""


def range_of(name: str) -> tuple[float | None, float | None]:
    """Least and greatest value of a variable, as far as the table has numbers for them; the least may be excluded."""
    row = _row(found.family) if (found := parse_name(name)) else {}
    return row.get("min", row.get("above")), most if isinstance(most := row.get("max"), float) else None


def is_step_mean(name: str) -> bool:
    """Is this the mean of the communication step that ends at its time?"""
    found = parse_name(name)
    return found is not None and bool(_row(found.family).get("mean"))


def listed(names: Iterable[str]) -> str:
    """Names in a line, for what is to be read at a glance: vectors once, the first six and how many more."""
    return few(list(dict.fromkeys(map(stem, names)))) or "none"


def part_names(names: Iterable[str], *kinds: str) -> list[str]:
    """The names of these parts."""
    return [part.name for part in parts_of(names, *kinds)]


def _stem(row: dict[str, Any], instance: Instance) -> str:
    """A structured name without its component, which comes last in every pattern."""
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
    """The kinds of parts that the row's variables belong to; empty where they belong to control points or to the whole."""
    for placeholder, kinds in (("{obstacle}", OBSTACLES), ("{body}", BODIES)):
        if placeholder in row["name"]:
            return kinds
    return (row["name"].partition(".")[0],) if "{name}" in row["name"] else ()


def _first_word(name: str) -> str:
    return re.split("[^a-z]", name, maxsplit=1)[0]


@cache
def _shapes() -> dict[str, list[tuple[str, str, str]]]:
    """What names look like in either form, by their first word: the pattern, the row's key, and the kind of part or nothing.

    Of families of one name the first in the table has it.
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
