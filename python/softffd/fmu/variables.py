"""The variables of one scene's FMU: the table modelDescription/variables.toml applied to the parts of the scene.

There is one list, of arrays, as FMI 3.0 has them (fmu_src/fmi/variables/arrays.cpp); FMI 2.0 has the elements of each array, in the same
order.

    position, velocity, force    one array for all control points that the scene lists: (ni, nj, nk, 3) where they fill a box of the
                                 lattice, in ascending order, else (points, 3)
    taxels of a sensor           (n, m, 3)
    vectors                      (3,) or (4,); a scalar for each component of a pose that is partly input, partly parameter

The value reference of an element is that of the array's first element plus the element's place in the array.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.installed import table
from softffd.lattice import all_points, point_at
from softffd.names import LARGEST, PROBED, Cell, Instance, flat_form, variable_name

if TYPE_CHECKING:
    from softffd.scene.rigid import Box, Cylinder, Pin, Plane, Sphere
    from softffd.scene.scene import Scene
    from softffd.scene.selection import Selection

STANDARD_GRAVITY = 9.80665  # m/s2
TOUCHING = {"lattice": "control points", "surface": "points of the surface"}  # what an obstacle's number of contacts counts
OF_POINTS = ("forces", "positions", "velocities")  # parts whose instances are control points
_LIST = re.compile(r"[^:]*: (\d+ \w+(?:, \d+ \w+)*)")

Words = dict[str, Any]  # what an instance of a part supplies: the words in its names and descriptions, and its start values


@dataclass(frozen=True)
class Variable:
    """One variable of the list."""

    family: dict[str, Any]  # its row of the table
    instances: tuple[Words, ...]  # what it belongs to: all control points for an array of them, else one instance
    components: str  # letters of the last dimension, or of the one component that a scalar is; empty where the family has none
    shape: tuple[int, ...]  # empty for a scalar
    reference: int  # value reference of the first element
    start: tuple[float | int, ...]  # one value for all elements, or one for each; empty for outputs
    nominal: float | None  # nominal value: the usual magnitude

    @property
    def count(self) -> int:
        """Number of elements."""
        return math.prod(self.shape)

    @property
    def most(self) -> int | None:
        """Greatest value allowed."""
        return _value_in(self.family, "max", self.instances[0], 0)

    def name(self, *, flat: bool = False) -> str:
        """Returns the name of the whole variable. flat: the names' form (softffd.names)."""
        if self.family["part"] in OF_POINTS:
            return str(self.family["name"]).partition("[")[0]
        if self.family["part"] == "taxels":
            stem = str(self.family["name"]).partition("[")[0].format(**self.instances[0])
            return flat_form(stem) if flat else stem
        return variable_name(self.family["key"], _instance(self.instances[0]), "" if self.shape else self.components, flat=flat)

    @property
    def description(self) -> str:
        """Description of the whole variable."""
        text = of_whole(self.family["description"]) if self.shape else self.family["description"]
        if self.family["part"] in OF_POINTS:
            _, which = _box([_instance(words) for words in self.instances])
            text = text.replace("control point ({i},{j},{k})", f"the control points {which}")
        text = text.replace("taxel ({i},{j})", "each taxel (i,j)")
        return text.format(**self.instances[0], c=self.components)

    def elements(self, *, flat: bool = False) -> Iterator[tuple[str, str]]:
        """Yields name and description of each element. flat: the names' form (softffd.names)."""
        key, description = self.family["key"], self.family["description"]
        for words in self.instances:
            for letter in self.components or [""]:
                yield variable_name(key, _instance(words), letter, flat=flat), description.format(**words, c=letter)


def method_value(key: str) -> int:
    """Returns the number that stands for a method in solver.method."""
    return next(method["value"] for method in table()["method"] if method["key"] == key)


def list_of_values(values: dict[str, int]) -> str:
    """Returns the names of an Integer variable's values in the form of descriptions and messages: "1 auto, 2 central_difference". FMI 2.0
    has enumerations for this purpose, but many masters cannot set them."""
    return ", ".join(f"{value} {name}" for name, value in values.items())


def listed_values(description: str) -> dict[str, int] | None:
    """Returns the values by name from a description that ends in their list; None for a description without a list."""
    found = _LIST.fullmatch(description)
    return {name: int(value) for value, name in (pair.split() for pair in found[1].split(", "))} if found else None


def has_damping(scene: Scene, key: str) -> bool:
    """True if any control point or spring has damping. key: "damping" or "internal_damping"."""
    return getattr(scene.material, key) > 0 or any(getattr(region, key) for region in scene.region)


def _instance(words: Words) -> Instance:
    """Returns the part or control point that stands in a variable's name."""
    if "k" in words:
        return words["i"], words["j"], words["k"]
    return words.get("cell", words.get("part", words.get("name")))


def _plane(plane: Plane | Sphere | Cylinder | Box) -> dict[str, Any]:
    from softffd.scene.rigid import Box, Plane, Sphere  # imports pydantic, which opening an FMU does not need

    turned = {"rotation": plane.rotation_vector()} if isinstance(plane, Box) else {"normal": plane.normal}
    if isinstance(plane, Plane):
        words = {
            "point_of": f"Point of the obstacle plane {plane.name}",
            "normal_of": f"Normal of the obstacle plane {plane.name}, out of the solid",
        }
    else:
        axis = "Has no effect on the {}" if isinstance(plane, Sphere) else "Axis of the {}"
        words = {"point_of": f"Centre of the {plane.shape()}", "normal_of": axis.format(plane.shape())}
    own = {key: getattr(plane, key) for key in ("part", "name", "point", "velocity", "angular_velocity", "friction")}
    if not isinstance(plane, Plane) and plane.motion == "free":
        own |= _free(plane, plane.own_mass())
    return words | own | turned | {"inputs": plane.input_components()}


def _free(body: Sphere | Cylinder | Box | Pin, mass: float) -> Words:
    """Returns the words for a free body's variables. mass: [kg]."""
    return {"body": body.part, "mass": mass, "guided": body.guide is not None}


def _bodies(rigid: list[Words], *, turning: bool = False) -> list[Words]:
    """Returns the free ones of the obstacles or pins. turning: only those without a guide."""
    return [each for each in rigid if "body" in each and not (turning and each["guided"])]


def parts(scene: Scene, mass: np.ndarray) -> dict[str, list[dict[str, Any]]]:
    """Returns the instances of every part that a family can belong to, each with the values that fill its names and start values."""

    def points(selection: Selection) -> list[dict[str, Any]]:
        return [dict(zip("ijk", point_at(int(p), scene.lattice.points), strict=True)) for p in scene.select(selection)]

    def when(present: bool, **values: Any) -> list[dict[str, Any]]:
        return [values] if present else []

    planes, pins = scene.obstacles, scene.pin
    surfaces, led_pins = [_plane(plane) for plane in planes], [pin for pin in pins if pin.motion == "input"]
    starts = [dict(zip(("position", "orientation"), scene.pin_start(pin), strict=True)) for pin in led_pins]
    frames = [start | {"name": pin.name, "inputs": pin.input_components()} for pin, start in zip(led_pins, starts, strict=True)]
    held = [{"part": pin.part, "name": pin.name} | (_free(pin, pin.mass) if pin.motion == "free" and pin.mass else {}) for pin in pins]
    free, turning = _bodies(surfaces), _bodies(surfaces, turning=True)
    free_pins, turning_pins = _bodies(held), _bodies(held, turning=True)
    led, bound = ([each for each in several if "body" not in each] for several in (surfaces, held))
    faced, boxes = ([each for each in surfaces if pose in each] for pose in ("normal", "rotation"))
    material, stiffness, gravity = scene.material, scene.material.stiffness, scene.environment.gravity
    methods = {method["key"]: method["value"] for method in table()["method"]}
    solver = {"method": method_value(scene.solver.method), "methods": list_of_values(methods), "last_method": max(methods.values())}
    solver |= {"tolerance": scene.solver.tolerance, "step": scene.solver.step}
    solver["mass"] = float(np.cumsum(mass)[-1])  # summed one after the other, as the library sums them
    touching = TOUCHING[scene.contact.of]
    shown = {word: [{"name": probe.name, "maximum": probe.maximum} for probe in scene.probe if getattr(probe, word)] for word in PROBED}
    reactions = {"plane_reactions": [each | {"touching": touching} for each in surfaces], "pin_reactions": held}
    reactions |= {"plane_torques": led, "pin_torques": bound, "free_plane_reactions": free, "free_pin_reactions": free_pins}
    return {
        "forces": points(scene.inputs.forces),
        "loads": [{"name": load.name} for load in scene.load],
        **dict.fromkeys(("planes", "input_planes", "fixed_planes"), surfaces),
        **dict.fromkeys(("input_motions", "fixed_motions"), led),
        "free_obstacles": free,
        "turning_obstacles": turning,
        "free_bodies": free + free_pins,
        "turning_bodies": turning + turning_pins,
        **dict.fromkeys(("input_normals", "fixed_normals"), faced),
        **dict.fromkeys(("input_boxes", "fixed_boxes"), boxes),
        **dict.fromkeys(("input_pins", "fixed_pins"), frames),
        "always": [solver],
        "stiffness": [{f"stiffness_{kind}": getattr(stiffness, kind) for kind in ("edge", "face", "body")}] if stiffness else [],
        "modulus": when(material.youngs_modulus is not None, youngs_modulus=material.youngs_modulus),
        "solid": when(material.model == "solid", poissons_ratio=material.poissons_ratio),
        "damping": when(has_damping(scene, "damping"), damping=material.damping),
        "internal_damping": when(has_damping(scene, "internal_damping"), internal_damping=material.internal_damping),
        "gravity": when(gravity is not None, gravity=gravity),
        "rotation": when(scene.initial.rotation is not None, rotation=scene.initial.rotation_vector()),
        "positions": points(scene.outputs.positions),
        "velocities": points(scene.outputs.velocities),
        "probes": [{"name": probe.name} for probe in scene.probe],
        **{f"probe_{word}": shown[word] for word in PROBED},
        **{f"probe_largest_{word}": [each for each in shown[word] if each["maximum"]] for word in LARGEST},
        "sensors": [{"name": sensor.name} for sensor in scene.sensor],
        "taxels": [
            {"name": sensor.name, "cell": Cell(sensor.name, i, j), "i": i, "j": j, "sides": sensor.taxels}
            for sensor in scene.sensor
            if sensor.taxels
            for i, j in np.ndindex(*sensor.taxels)
        ],
        **(reactions if scene.outputs.reactions else {key: [] for key in reactions}),
        "energy": when(scene.outputs.energy),
        "energy_gravity": when(scene.outputs.energy and gravity is not None),
        "solver": when(scene.outputs.solver),
        "error_estimate": when(scene.solver.error_estimate),
    }


def sizes(scene: Scene, mass: np.ndarray) -> dict[str, float]:
    """Returns the usual length [m], weight [N], speed [m/s] and spin [rad/s] of a body of this size and mass that falls by its own
    length, for the variables' nominal values."""
    length = max(scene.lattice_box.size)
    given = scene.environment.gravity
    gravity = (float(np.linalg.norm(given)) if given else 0.0) or STANDARD_GRAVITY
    speed = math.sqrt(gravity * length)
    return {"length": length, "weight": float(mass.sum()) * gravity, "speed": speed, "spin": speed / length}


def variables(scene: Scene, mass: np.ndarray) -> list[Variable]:
    """Returns all variables of a scene but time. mass: (n,) kg, the control points' masses after region overrides.

    Two families of the same name, one with the inputs and one with the parameters, stand together, so that a part's components are in
    order.
    """
    present, usual = parts(scene, mass), sizes(scene, mass)
    found: list[Variable] = []
    counts: Counter[str] = Counter()

    def add(family: dict[str, Any], instances: list[Words], components: str, shape: tuple[int, ...]) -> None:
        letters = family.get("components", "")
        starts = tuple(_value_in(family, "start", instances[0], letters.find(letter)) for letter in components or " ")
        start = () if starts[0] is None else starts if len(shape) < 2 else starts[:1]
        reference = family["id"] << 24 | counts[family["key"]]
        nominal = _value_in(family, "nominal", usual, 0)
        found.append(Variable(family, tuple(instances), components, shape, reference, start, nominal))
        counts[family["key"]] += found[-1].count

    of_one_name: dict[str, list[dict[str, Any]]] = {}
    for family in table()["family"]:
        of_one_name.setdefault(family["name"], []).append(family)
    for families in of_one_name.values():
        instances, components = present[families[0]["part"]], families[0].get("components", "")
        if families[0]["part"] in OF_POINTS:
            if instances:
                add(families[0], instances, components, (*_box([_instance(words) for words in instances])[0], len(components)))
            continue
        if families[0]["part"] == "taxels":
            for _, cells in groupby(instances, key=lambda words: words["name"]):
                grid = list(cells)
                add(families[0], grid, components, (*grid[0]["sides"], len(components)))
            continue
        for words in instances:
            owners = [_owner(families, words, component) for component in components or " "]
            if all(owner is owners[0] for owner in owners):
                add(owners[0], [words], components, (len(components),) if components else ())
            else:
                for component, owner in zip(components, owners, strict=True):
                    add(owner, [words], component, ())
    return found


def _value_in(family: dict[str, Any], key: str, words: Words, component: int) -> Any:
    """Returns the value of a family's key for a component of an instance. The key holds the value, or the name of a value of the
    instance."""
    given = family.get(key)
    value = words[given] if isinstance(given, str) else given
    return value[component] if isinstance(value, tuple | list) else value


def _owner(families: list[dict[str, Any]], words: Words, component: str) -> dict[str, Any]:
    """Returns the family of a component of an instance. A component of a pose is an input where the scene says so, else a parameter."""
    if len(families) == 1:
        return families[0]
    causality = "input" if f"{families[0]['pose']}.{component}" in words["inputs"] else "parameter"
    return next(family for family in families if family["causality"] == causality)


def of_whole(description: str) -> str:
    """Returns a family's description without the words that distinguish its components."""
    for behind in ",;:":
        description = description.replace(", {c}" + behind, behind)
    return description.replace("component {c}", "components w, x, y, z").removesuffix(", {c}")


def _box(points: list[Any]) -> tuple[tuple[int, ...], str]:
    """Returns the shape of an array of these control points, and the control points in words."""
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    sides = high - low + 1
    if points == [tuple(low + np.array(point)) for point in all_points(sides)]:
        ranges = (f"{axis} = {first}" + (f" to {last}" if last > first else "") for axis, first, last in zip("ijk", low, high, strict=True))
        return tuple(map(int, sides)), f"(i,j,k), {', '.join(ranges)}"
    return (len(points),), "(i,j,k) = " + ", ".join(f"({i},{j},{k})" for i, j, k in points)
