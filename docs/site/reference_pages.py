"""The reference pages of the documentation, written from what the program itself goes by: `python docs/site/reference_pages.py docs`.

docs/scene.md comes from the keys of a scene, docs/variables.md from the table of variables.
"""

from __future__ import annotations

import re
import sys
import textwrap
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from softffd.files import write_text
from softffd.fmu.variables import list_of_values, of_whole
from softffd.installed import table
from softffd.scene import selection
from softffd.scene.faults import toml_text
from softffd.scene.keys import SceneKeys

FREE = '`[[sphere]]`, `[[cylinder]]`, `[[box]]` or `[[pin]]` with `motion = "free"`'
FREE_OBSTACLE = '`[[sphere]]`, `[[cylinder]]` or `[[box]]` with `motion = "free"`'
PRESENT = {
    "forces": "each control point of `inputs.forces`",
    "loads": "each `[[load]]`",
    "input_planes": 'each component in `inputs` of a `[[plane]]`, `[[sphere]]`, `[[cylinder]]` or `[[box]]` with `motion = "input"`',
    "fixed_planes": "each other component of a `[[plane]]`, `[[sphere]]`, `[[cylinder]]` or `[[box]]`",
    "input_motions": 'each component in `inputs` of a `[[plane]]`, `[[sphere]]`, `[[cylinder]]` or `[[box]]` with `motion = "input"`',
    "fixed_motions": "each other component of a `[[plane]]`, `[[sphere]]`, `[[cylinder]]` or `[[box]]` that is not free",
    "free_bodies": f"each {FREE}",
    "turning_bodies": f"each {FREE} and no `guide`",
    "free_obstacles": f"each {FREE_OBSTACLE}",
    "turning_obstacles": f"each {FREE_OBSTACLE} and no `guide`",
    "input_normals": 'each component in `inputs` of a `[[plane]]`, `[[sphere]]` or `[[cylinder]]` with `motion = "input"`',
    "fixed_normals": "each other component of a `[[plane]]`, `[[sphere]]` or `[[cylinder]]`",
    "input_boxes": 'each component in `inputs` of a `[[box]]` with `motion = "input"`',
    "fixed_boxes": "each other component of a `[[box]]`",
    "planes": "each `[[plane]]`, `[[sphere]]`, `[[cylinder]]` or `[[box]]`",
    "input_pins": 'each component in `inputs` of a `[[pin]]` with `motion = "input"`',
    "fixed_pins": 'each other component of a `[[pin]]` with `motion = "input"`',
    "always": "every scene",
    "stiffness": "scenes without `material.youngs_modulus`",
    "modulus": "`material.youngs_modulus`",
    "solid": '`material.model = "solid"`',
    "damping": "`material.damping` or that of a region > 0",
    "internal_damping": "`material.internal_damping` or that of a region > 0",
    "gravity": "`environment.gravity`",
    "rotation": "`initial.rotation`",
    "positions": "each control point of `outputs.positions`",
    "velocities": "each control point of `outputs.velocities`",
    "probes": "each `[[probe]]`",
    **{f"probe_{word}": f"each `[[probe]]` of a solid with `{word} = true`" for word in ("stress", "von_mises", "stretch")},
    **{f"probe_{word}": f"each `[[probe]]` with `{word} = true`" for word in ("velocity", "acceleration")},
    **{
        f"probe_largest_{word}": f"each `[[probe]]` with `{word} = true` and `maximum = true`"
        for word in ("velocity", "acceleration", "von_mises")
    },
    "sensors": "each `[[sensor]]`",
    "taxels": "each taxel of a `[[sensor]]`",
    "plane_reactions": "each `[[plane]]`, `[[sphere]]`, `[[cylinder]]` or `[[box]]`, `outputs.reactions`",
    "plane_torques": "each `[[plane]]`, `[[sphere]]`, `[[cylinder]]` or `[[box]]` that is not free, `outputs.reactions`",
    "pin_reactions": "each `[[pin]]`, `outputs.reactions`",
    "pin_torques": "each `[[pin]]` that is not free, `outputs.reactions`",
    "free_plane_reactions": f"each {FREE_OBSTACLE}, `outputs.reactions`",
    "free_pin_reactions": 'each `[[pin]]` with `motion = "free"`, `outputs.reactions`',
    "energy": "`outputs.energy`",
    "energy_gravity": "`outputs.energy` and gravity",
    "solver": "`outputs.solver`",
    "error_estimate": "`solver.error_estimate`",
}
"""When a variable is there, by the `part` of its row."""

CAUSALITIES = {
    "input": "## Inputs\n\nInputs are set at a communication point and act during the step that follows.",
    "parameter": "## Parameters\n\nFixed parameters are set before initialization, tunable ones at any communication point too.",
    "output": "## Outputs\n\nEvery Real output has a [first derivative](coupling.md#derivatives-of-inputs-and-outputs).",
}

SCENE_HEAD = """# The scene file

This page lists every key of a scene file: its default, its unit and range, and its meaning.

{}

A scene is a TOML file in SI units and a right-handed world frame. Every section and key may be left out unless it says *must be given*.
Sections in double brackets may be repeated. All problems of a file are reported at once: the place, what was wanted, what was given, and
the nearest valid choice.

- `softffd new NAME` writes a commented scene to start from.
- `softffd schema` prints the JSON schema for editors.
- `softffd scenes` lists the shipped scenes.

This page is made from the program's own description of the keys: `python docs/site/reference_pages.py docs`.
"""

VARIABLES_HEAD = """# The variables of an FMU

This page lists every variable that the FMU of a scene can have: its name, unit, causality and meaning.

{}

The FMU has only the variables that its scene needs; `softffd info SCENE` lists them.

| In a name | Means |
| --- | --- |
| `NAME` | the name of the obstacle, pin, load, probe or sensor in the scene |
| `i,j,k` | the indices of a control point, from 0; in a block of variables `i` runs fastest, then `j`, then `k` |
| `.x` `.y` `.z` | a vector in the world frame, one variable for each component |
| `plane.NAME` | a plane; the variables of a `[[sphere]]`, `[[cylinder]]` or `[[box]]` are the same under their own kind: \
`sphere.NAME.point.x`, \
`cylinder.NAME.reaction.z`, `box.NAME.friction`; those that only free bodies have stand under `box.NAME`, and a free `[[pin]]` has them \
as `pin.NAME` |

The variables of a line below are one block of value references. With `[fmu] names = "flat"` names have letters, digits and underscores
only: `position_i_j_k_x` in place of `position[i,j,k].x`, `plane_NAME_point_z` in place of `plane.NAME.point.z`. The value references are
the same, and `variableNamingConvention` is `flat`.

This page is made from the table of variables: `python docs/site/reference_pages.py docs`.
"""


def scene_page() -> str:
    """docs/scene.md."""
    top = [(name, field) for name, field in SceneKeys.model_fields.items() if _section(field) is None]
    sections = [(name, field) for name, field in SceneKeys.model_fields.items() if _section(field) is not None]
    parts = ["## At the top of the file\n\n" + _keys(top)]
    for name, field in sections:
        section = _section(field)
        assert section is not None
        head = f"[[{name}]]" if get_origin(field.annotation) is tuple else f"[{name}]"
        about = (section.__doc__ or "").strip()
        parts.append(f"## `{head}`\n\n{about}\n\n" + _keys(list(section.model_fields.items())))
    parts.append("## Selections\n\n" + _paragraphs(selection.__doc__ or "") + "\n")
    return _page(SCENE_HEAD, parts)


def variables_page() -> str:
    """docs/variables.md."""
    parts = []
    for causality, head in CAUSALITIES.items():
        rows = [_variable(row) for row in table()["family"] if row["causality"] == causality]
        parts.append(f"{head}\n\n" + _table(["Name", "Unit", "There is one for", "Kind", "Meaning"], rows))
    methods = [[f"{method['value']}", f"`{method['key']}`", method["description"]] for method in table()["method"]]
    parts.append("## Values of `solver.method`\n\n" + _table(["Value", "Name", "Meaning"], methods))
    categories = [[f"`{category['name']}`", category["description"]] for category in table()["log_category"]]
    parts.append("## Log categories\n\n" + _table(["Name", "Holds"], categories))
    return _page(VARIABLES_HEAD, parts)


def _page(head: str, parts: list[str]) -> str:
    """A page with links to its parts, which begin with a title each."""
    titles = [part.partition("\n")[0].removeprefix("## ") for part in parts]
    links = [f"[{title}](#{re.sub(r'[^a-z -]', '', title.lower()).replace(' ', '-')})" for title in titles]
    return "\n".join([head.format(textwrap.fill(" · ".join(links), 140, break_long_words=False, break_on_hyphens=False)), *parts])


def _keys(fields: list[tuple[str, FieldInfo]]) -> str:
    return _table(["Key", "Default", "Unit, range", "Meaning"], [_key(name, field) for name, field in fields])


def _key(name: str, field: FieldInfo) -> list[str]:
    """Name, default, unit and range (which close the description of a quantity) or the words to choose from, meaning."""
    meaning, facts = field.description or "", ""
    if field.json_schema_extra and (found := re.fullmatch(r"(.*) \[([^\[\]]+)\]", meaning)):
        meaning, facts = found.groups()
    if get_origin(field.annotation) is Literal:
        facts = ", ".join(f"`{toml_text(word)}`" for word in get_args(field.annotation))
    return [f"`{name}`", _default(field), facts, meaning[:1].upper() + meaning[1:]]


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "*must be given*"
    return "absent" if field.default is None else f"`{toml_text(field.default)}`"


def _section(field: FieldInfo) -> type[BaseModel] | None:
    """The section that a key of the scene holds, alone or several times."""
    candidates = [field.annotation, *get_args(field.annotation)]
    return next((each for each in candidates if isinstance(each, type) and issubclass(each, BaseModel)), None)


def _variable(row: dict[str, Any]) -> list[str]:
    components = row.get("components", "")
    methods = list_of_values({method["key"]: method["value"] for method in table()["method"]})
    words = {
        "name": "NAME",
        "obstacle": "box.NAME" if row["part"].endswith(("_boxes", "_obstacles")) or row["part"] == "free_plane_reactions" else "plane.NAME",
        "body": "box.NAME",
        "i": "i",
        "j": "j",
        "k": "k",
        "c": "{c}",
        "methods": methods,
        "point_of": "Point of the obstacle plane NAME, or centre of the solid",
        "normal_of": "Normal of the obstacle plane NAME, out of the solid, or axis of the cylinder; no effect on a sphere",
        "touching": "control points, or points of the surface,",
    }
    stem = row["name"].format(**words).removesuffix(".{c}")
    name = " ".join([f"`{stem}.{components[0]}`", *(f"`.{component}`" for component in components[1:])]) if components else f"`{stem}`"
    kind = ", ".join(word for word in (row["variability"], row.get("type", "")) if word)
    return [name, row.get("unit", ""), PRESENT[row["part"]], kind, of_whole(row["description"]).format(**words)]


def _table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


def _paragraphs(text: str) -> str:
    """A docstring's text without its first line's heading."""
    return text.strip().partition("\n\n")[2].strip()


def main() -> None:
    """Writes both pages into the folder that is named."""
    folder = Path(sys.argv[1])
    write_text(folder / "scene.md", scene_page())
    write_text(folder / "variables.md", variables_page())


if __name__ == "__main__":
    main()
