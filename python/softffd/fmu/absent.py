"""Why an FMU of this package lacks a variable: what its scene would have to contain."""

from collections.abc import Collection
from typing import Any

from softffd.installed import table
from softffd.names import MEMBERS, OBSTACLES, Part, components_in, parse_name
from softffd.spelling import did_you_mean, nearest_of

FREE = 'motion = "free" of the part'
SCENE_NEEDS = {
    "forces": "[inputs] forces with this control point",
    "positions": "[outputs] positions with this control point",
    "velocities": "[outputs] velocities with this control point",
    "input_pins": 'motion = "input" of the pin',
    "probe_velocity": "velocity = true of the probe",
    "probe_acceleration": "acceleration = true of the probe",
    "taxels": "taxels of the sensor",
    **dict.fromkeys(("plane_reactions", "plane_torques", "pin_reactions", "pin_torques"), "[outputs] reactions = true"),
    **dict.fromkeys(("free_bodies", "free_obstacles"), FREE),
    **dict.fromkeys(("turning_bodies", "turning_obstacles"), f"{FREE}, without a guide"),
    **dict.fromkeys(("free_plane_reactions", "free_pin_reactions"), f"{FREE} and [outputs] reactions = true"),
    "stiffness": "[material] stiffness in place of youngs_modulus",
    "modulus": "[material] youngs_modulus in place of stiffness",
    "solid": '[material] model = "solid"',
    "damping": "[material] damping above 0",
    "internal_damping": "[material] internal_damping above 0",
    "gravity": "[environment] gravity",
    "rotation": "[initial] rotation",
    "energy": "[outputs] energy = true",
    "energy_gravity": "[outputs] energy = true and [environment] gravity",
    "solver": "[outputs] solver = true",
    "error_estimate": "[solver] error_estimate = true",
}  # by the part of a family (variables.toml), the entry of the scene that creates its variables
OF_VARIABLES = ("inputs", "outputs")  # sections of the scene whose keys select variables with nearly the same names


def hint_for(name: str, there: Collection[str], choices: Collection[str] | None = None, *, own: bool = True) -> str:
    """Returns what follows "the FMU has no such variable": the members of a group of that name, what the scene needs for it, else the
    nearest of `choices`, by default of all names.
    """
    choices = there if choices is None else choices
    if members := components_in(set(choices), name, MEMBERS):
        return f"; it has {', '.join(members.values())}"
    nearest = did_you_mean(nearest_of(name, choices))
    if not own or name in there:  # the variable exists, but is not what is wanted
        return nearest
    return _scene_needs(name, there) or (not nearest and _new_part(name)) or _scene_key(name, there) or nearest


def _scene_needs(name: str, there: Collection[str]) -> str:
    row = _row_of(name)
    found = parse_name(name) or parse_name(f"{name}.x")
    if not row or not (needed := SCENE_NEEDS.get(row["part"])):
        return ""
    others = [other for each in there if (other := parse_name(each))]
    if found and isinstance(found.instance, Part):
        absent = any(other.instance == found.instance for other in others)  # else the part itself is missing
    else:
        absent = not any(other.family == row["key"] for other in others)  # else other control points have one, or the component is wrong
    return f": its scene needs {needed} for it" if absent else ""


def _row_of(name: str) -> dict[str, Any] | None:
    """Returns the family's row of the table for the name of a variable or a vector, or for the first words of a variable's name."""
    if found := parse_name(name) or parse_name(f"{name}.x"):
        return next(row for row in table()["family"] if row["key"] == found.family)
    return next((row for row in table()["family"] if row["name"].startswith((f"{name}.", f"{name}["))), None)


def _new_part(name: str) -> str:
    kind, _, rest = name.partition(".")
    part = rest.partition(".")[0]
    if kind not in (*OBSTACLES, "pin", "load", "probe", "sensor") or not part:
        return ""
    row = _row_of(name)
    needed = SCENE_NEEDS.get(row["part"]) if row else None
    return f': its scene needs a [[{kind}]] with name = "{part}"{f" and {needed}" if needed else ""} for it'


def _scene_key(name: str, there: Collection[str]) -> str:
    from softffd.scene.keys import SceneKeys  # imports pydantic, which opening an FMU does not need
    from softffd.scene.section import Section

    for section, field in SceneKeys.model_fields.items():
        keys = type(field.default).model_fields if isinstance(field.default, Section) and section not in OF_VARIABLES else {}
        key = name.removeprefix(f"{section}.")
        if key in keys and f"{section}.{key}" not in there:
            return f"; it is a key of the scene and no variable: set {key} in [{section}] of the scene"
    return ""
