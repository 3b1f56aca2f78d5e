"""Arrows between the rooms point one way: a room uses rooms to its right, none to its left; the package uses no tools of the sources."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CPP, PACKAGE = ROOT / "fmu_src", ROOT / "python" / "softffd"

CPP_ROOMS = [
    *("calls", "instance", "variables", "life_cycle", "messages", "resource"),  # fmi
    *("estimate", "soft_body", "stepping", "impacts", "kit", "watch", "flight", "methods", "contact", "matrix"),  # core
    *("embedding", "body", "forces", "model", "machine"),
]
MADE = ("variable_table.hpp", "fmi2FunctionTypes.h", "fmi2Functions.h", "fmi2TypesPlatform.h", "fmi3FunctionTypes.h", "fmi3Functions.h")
"""Belong to no room; the core has no way to them on its include path, nor to the rooms of fmi."""

PACKAGE_ROOMS = [
    *("cli", "accuracy", "show", "drivers", "run", "fmu", "scene", "embedding", "mesh"),
    *("names", "lattice", "obstacles", "rotation", "files", "installed", "spelling", "errors"),
]
"""The shipped scenes are data, and the package's own __init__ knows everybody."""

ASKED = {"run/shown.py": {"show.figure", "show.picture", "show.view"}}
"""The one place that looks up: a result's picture and page are drawn when it is asked for them, by the room that stands on it."""

CPP_FILES = sorted(file.relative_to(CPP).as_posix() for file in CPP.rglob("*.[ch]pp"))
PACKAGE_FILES = sorted(file.relative_to(PACKAGE).as_posix() for file in PACKAGE.rglob("*.py"))


def cpp_room(included: str) -> int:
    """The place of a room in the row, by what an include line says."""
    return CPP_ROOMS.index(Path(included).parts[0].split(".")[0])


def package_room(file_or_module: str) -> str:
    return file_or_module.replace("/", ".").split(".")[0]


@pytest.mark.parametrize("file", CPP_FILES)
def test_no_include_points_up(file):
    included = re.findall(r'^#include "(.+)"', (CPP / file).read_text(), re.MULTILINE)
    place = cpp_room(file.partition("/")[2])
    assert [name for name in included if name not in MADE and cpp_room(name) < place] == []


def imported(file: str) -> set[str]:
    """Modules below softffd that a file imports, anywhere in it but for type checking."""
    tree = ast.parse((PACKAGE / file).read_text())
    checked = [node for node in ast.walk(tree) if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)]
    skipped = {id(inner) for node in checked for inner in ast.walk(node)}
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and id(node) not in skipped and not node.level]
    return {node.module.removeprefix("softffd.") for node in nodes if node.module.startswith("softffd.")}


@pytest.mark.parametrize("file", [name for name in PACKAGE_FILES if package_room(name) in PACKAGE_ROOMS])
def test_no_import_of_the_package_points_up(file):
    place = PACKAGE_ROOMS.index(package_room(file))
    assert [name for name in imported(file) - ASKED.get(file, set()) if PACKAGE_ROOMS.index(package_room(name)) < place] == []


@pytest.mark.parametrize("file", PACKAGE_FILES)
def test_the_package_does_without_the_tools_of_the_sources(file):
    assert not re.search(r"^\s*(from|import) validation\b", (PACKAGE / file).read_text(), re.MULTILINE)
