"""Arrows between the rooms point one way: a room uses rooms to its right, none to its left; and no modules use each other in a circle."""

import ast
import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CPP, PYTHON = ROOT / "fmu_src", ROOT / "python"

CPP_ROOMS = [
    *("open", "exceptions", "sse2"),  # wasm
    *("calls", "instance", "variables", "life_cycle", "messages", "resource"),  # fmi
    *("estimate", "soft_body", "definition", "stepping", "impacts", "kit", "watch", "flight", "methods", "contact", "matrix"),  # core
    *("embedding", "body", "forces", "model", "machine"),
]
MADE = ("variable_table.hpp", "fmi2FunctionTypes.h", "fmi2Functions.h", "fmi2TypesPlatform.h", "fmi3FunctionTypes.h", "fmi3Functions.h")
"""Belong to no room; the core has no way to them on its include path, nor to the rooms of fmi."""

PYTHON_ROOMS = [
    *("validation", "cli", "accuracy", "fitting", "export", "show", "drivers", "bridges", "run", "fmu", "scene", "embedding", "mesh"),
    *("names", "lattice", "obstacles", "taxels", "rotation", "files", "installed", "spelling", "errors"),
]
"""The shipped scenes are data, and the package's own __init__ knows everybody."""

ASKED = (("softffd.run.result", "softffd.run.sweep"), ("softffd.show.", "softffd.export."))
"""The places that look up: pictures and page of results and sweeps are drawn when they are asked for, by the room that stands on them."""


def test_no_include_points_up():
    files = sorted(CPP.rglob("*.[ch]pp"))
    places = {room: place for place, room in enumerate(CPP_ROOMS)}

    def place(path: str) -> int:
        return places[path.split("/")[0].split(".")[0]]

    up = [
        f"{file} includes {name}"
        for file in files
        for name in re.findall(r'^#include "(.+)"', file.read_text(), re.MULTILINE)
        if name not in MADE and place(name) < place(file.relative_to(CPP).as_posix().partition("/")[2])
    ]
    assert len(files) > 100 and not up, "\n".join(up)


def imports() -> dict[str, set[str]]:
    """What each module of the package and of the tools uses of them, anywhere in it, for type checking too."""
    files = [file for tree in ("softffd", "validation") for file in (PYTHON / tree).rglob("*.py")]
    names = {".".join(file.relative_to(PYTHON).with_suffix("").parts).removesuffix(".__init__"): file for file in files}
    found: dict[str, set[str]] = {}
    for module, file in names.items():
        nodes = [node for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.ImportFrom) and not node.level]
        used = {each for node in nodes for name in node.names for each in (node.module, f"{node.module}.{name.name}")}
        found[module] = {
            name for name in used & names.keys() - {module, "softffd"} if not (module in ASKED[0] and name.startswith(ASKED[1]))
        }
    return found


def circles(uses: dict[str, set[str]]) -> Iterator[list[str]]:
    """Modules that use each other, each circle once."""
    while True:
        try:
            return TopologicalSorter(uses).prepare()
        except CycleError as error:
            circle = error.args[1]
            yield circle
            uses[circle[1]].discard(circle[0])


def test_no_import_points_up_or_in_a_circle():
    uses = imports()
    places = {room: place for place, room in enumerate(PYTHON_ROOMS)}

    def place(module: str) -> int:
        """Of what is no room, data and what knows everybody: none."""
        return places.get(module.removeprefix("softffd.").split(".")[0], 1000)

    up = [f"{module} imports {name}" for module, used in uses.items() for name in sorted(used) if place(name) < place(module) < 1000]
    found = circles({module: set(used) for module, used in uses.items() if module != "softffd"})
    round_about = [f"a circle: {' is used by '.join(each)}" for each in found]
    wrong = up + round_about
    assert len(uses) > 100 and not wrong, "\n".join(wrong)
