"""The variables of one scene's FMU: the table modelDescription/variables.toml spread over what the scene holds."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from softffd.fmu.values import list_of_values
from softffd.installed import table
from softffd.lattice import Point
from softffd.names import variable_names

if TYPE_CHECKING:
    from softffd.scene.rigid import Box, Cylinder, Pin, Plane, Sphere
    from softffd.scene.scene import Scene
    from softffd.scene.selection import Selection

STANDARD_GRAVITY = 9.80665
"""m/s2"""
TOUCHING = {"lattice": "control points", "surface": "points of the surface"}
"""What is counted on an obstacle"""
READABLE = 20_000
"""More variables than this make the descriptions slow to read in many tools"""


class Variable(NamedTuple):
    """One scalar variable as modelDescription.xml states it; `place` counts from 1 in the order of the table."""

    place: int
    name: str
    reference: int
    family: dict[str, Any]
    start: float | int | None
    most: int | None
    """Greatest value allowed"""
    nominal: float | None
    """Its usual size"""
    description: str


def method_value(key: str) -> int:
    """The number that stands for a method in solver.method."""
    return next(method["value"] for method in table()["method"] if method["key"] == key)


def spring_damping_present(scene: Scene) -> bool:
    """Does any control point have damping?"""
    return scene.material.damping > 0 or any(region.damping for region in scene.region)


def internal_damping_present(scene: Scene) -> bool:
    """Has any spring a dashpot?"""
    return scene.material.internal_damping > 0 or any(region.internal_damping for region in scene.region)


def _instance(words: dict[str, Any]) -> str | Point | None:
    """What stands in a name for a part or a control point."""
    return (words["i"], words["j"], words["k"]) if "i" in words else words.get("name")


def _point(scene: Scene, p: int) -> dict[str, Any]:
    nx, ny, _ = scene.lattice.points
    return {"i": p % nx, "j": p // nx % ny, "k": p // nx // ny}


def _plane(plane: Plane | Sphere | Cylinder | Box) -> dict[str, Any]:
    from softffd.scene.rigid import Box, Plane, Sphere  # brings pydantic along, which those who have an FMU do without

    turned = {"rotation": plane.rotation_vector()} if isinstance(plane, Box) else {"normal": plane.normal}
    if isinstance(plane, Plane):
        words = {
            "point_of": f"Point of the obstacle plane {plane.name}",
            "normal_of": f"Normal of the obstacle plane {plane.name}, out of it",
        }
    else:
        axis = "A sphere's normal is of no meaning: {}" if isinstance(plane, Sphere) else "Axis of the {}"
        words = {"point_of": f"Centre of the {plane.shape()}", "normal_of": axis.format(plane.shape())}
    return {
        **words,
        "name": plane.name,
        "point": plane.point,
        **turned,
        "velocity": plane.velocity,
        "angular_velocity": plane.angular_velocity,
        "friction": plane.friction,
        "inputs": plane.input_components(),
    }


def _pin(scene: Scene, pin: Pin) -> dict[str, Any]:
    position, orientation = scene.pin_start(pin)
    return {"name": pin.name, "position": position, "orientation": orientation, "inputs": pin.input_components()}


def parts(scene: Scene, mass: np.ndarray) -> dict[str, list[dict[str, Any]]]:
    """The instances of every part that a family can belong to, each with the values that fill its names and starts."""

    def points(selection: Selection) -> list[dict[str, Any]]:
        return [_point(scene, int(p)) for p in scene.select(selection)]

    def when(present: bool, **values: Any) -> list[dict[str, Any]]:
        return [values] if present else []

    planes, pins = scene.obstacles, scene.pin
    surfaces, frames = [_plane(plane) for plane in planes], [_pin(scene, pin) for pin in pins if pin.motion == "input"]
    faced, boxes = ([each for each in surfaces if pose in each] for pose in ("normal", "rotation"))
    material, stiffness, gravity = scene.material, scene.material.stiffness, scene.environment.gravity
    methods = table()["method"]
    touching = TOUCHING[scene.contact.of]
    return {
        "forces": points(scene.inputs.forces),
        "loads": [{"name": load.name} for load in scene.load],
        **dict.fromkeys(("planes", "input_planes", "fixed_planes"), surfaces),
        **dict.fromkeys(("input_normals", "fixed_normals"), faced),
        **dict.fromkeys(("input_boxes", "fixed_boxes"), boxes),
        **dict.fromkeys(("input_pins", "fixed_pins"), frames),
        "always": [
            {
                "mass": float(np.cumsum(mass)[-1]),  # one after the other, as the library adds them
                "method": method_value(scene.solver.method),
                "methods": list_of_values({method["key"]: method["value"] for method in methods}),
                "last_method": max(method["value"] for method in methods),
                "tolerance": scene.solver.tolerance,
                "step": scene.solver.step,
            }
        ],
        "stiffness": []
        if stiffness is None
        else [{"stiffness_edge": stiffness.edge, "stiffness_face": stiffness.face, "stiffness_body": stiffness.body}],
        "modulus": when(material.youngs_modulus is not None, youngs_modulus=material.youngs_modulus),
        "damping": when(spring_damping_present(scene), damping=material.damping),
        "internal_damping": when(internal_damping_present(scene), internal_damping=material.internal_damping),
        "gravity": when(gravity is not None, gravity=gravity),
        "rotation": when(scene.initial.rotation is not None, rotation=scene.initial.rotation_vector()),
        "positions": points(scene.outputs.positions),
        "velocities": points(scene.outputs.velocities),
        "probes": [{"name": probe.name} for probe in scene.probe],
        "plane_reactions": [{"name": plane.name, "touching": touching} for plane in planes] if scene.outputs.reactions else [],
        "pin_reactions": [{"name": pin.name} for pin in pins] if scene.outputs.reactions else [],
        "energy": when(scene.outputs.energy),
        "energy_gravity": when(scene.outputs.energy and gravity is not None),
        "solver": when(scene.outputs.solver),
        "error_estimate": when(scene.solver.error_estimate),
    }


def sizes(scene: Scene, mass: np.ndarray) -> dict[str, float]:
    """What is usual for a body of this size and mass that falls by its own length, for the variables' nominal values."""
    length = max(scene.lattice_box.size)
    given = scene.environment.gravity
    gravity = (float(np.linalg.norm(given)) if given else 0.0) or STANDARD_GRAVITY
    speed = math.sqrt(gravity * length)
    return {"length": length, "weight": float(mass.sum()) * gravity, "speed": speed, "spin": speed / length}


def value_in(family: dict[str, Any], key: str, instance: dict[str, Any], component: int) -> Any:
    """What a family's key says for a component of an instance: a value, or the name of one that the instance brings."""
    given = family.get(key)
    value = instance[given] if isinstance(given, str) else given
    return value[component] if isinstance(value, tuple | list) else value


def families_of_one_name() -> list[list[dict[str, Any]]]:
    """The families of the table, in its order, those that share their name together."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for family in table()["family"]:
        groups.setdefault(family["name"], []).append(family)
    return list(groups.values())


def has_component(family: dict[str, Any], words: dict[str, Any]) -> bool:
    """Has a family this component of this instance? Of a pose it is an input where the scene says so, else a parameter."""
    if "pose" not in family:
        return True
    return (f"{family['pose']}.{words['c']}" in words["inputs"]) == (family["causality"] == "input")


def variables(scene: Scene, mass: np.ndarray) -> list[Variable]:
    """All variables of a scene. mass: (n,) kg, the control points' masses after region overrides.

    Families of one name, of which one has the inputs and the other the parameters, stand together: a part's components in their order.
    """
    present, usual, plain = parts(scene, mass), sizes(scene, mass), scene.fmu.names == "plain"
    found: list[Variable] = []
    counts: Counter[str] = Counter()
    for families in families_of_one_name():
        letters = families[0].get("components", "") or [""]
        for instance in present[families[0]["part"]]:
            names = variable_names(families[0]["key"], (_instance(instance),), plain=plain)
            for component, (letter, name) in enumerate(zip(letters, names, strict=True)):
                words = {**instance, "c": letter}
                family = families[0] if len(families) == 1 else next(each for each in families if has_component(each, words))
                number = counts[family["key"]]
                counts[family["key"]] += 1
                found.append(
                    Variable(
                        place=len(found) + 1,
                        name=name,
                        reference=family["id"] << 24 | number,
                        family=family,
                        start=value_in(family, "start", instance, component),
                        most=value_in(family, "max", instance, component),
                        nominal=value_in(family, "nominal", usual, component),
                        description=family["description"].format(**words),
                    )
                )
    return found


def number_of_variables(scene: Scene, mass: np.ndarray) -> int:
    """How many `variables` has: each component of a part is of one of the families that share its name."""
    present = parts(scene, mass)
    return sum(len(present[families[0]["part"]]) * max(1, len(families[0].get("components", ""))) for families in families_of_one_name())


def size_warning(scene: Scene, count: int) -> str | None:
    """What to say about a scene of so many variables, and which keys make them; None where they are not too many."""
    if count <= READABLE:
        return None
    keys = {
        "outputs.positions": scene.outputs.positions,
        "outputs.velocities": scene.outputs.velocities,
        "inputs.forces": scene.inputs.forces,
    }
    made = sorted(((3 * len(scene.select(points)), key) for key, points in keys.items()), reverse=True)
    listed = ", ".join(f"{key} makes {number}" for number, key in made if number)
    return (
        f"{count} variables, of which {listed}: many tools are slow to read more than {READABLE}; select fewer control points there, "
        "follow places of the object by [[probe]] and push it by [[load]], or build for FMI 3.0 (--fmi 3), where each of these is one array"
    )
