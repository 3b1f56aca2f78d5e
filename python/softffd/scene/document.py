"""Finding and reading the scene file: a path, or the name of a scene that comes with the package."""

import re
import shlex
import tomllib
from pathlib import Path
from typing import Any

from softffd.errors import SceneError
from softffd.spelling import did_you_mean, nearest_of

SHIPPED = Path(__file__).parents[1] / "scenes"
"""Folder of the scenes that come with the package, in subfolders; each scene lies beside the files that it uses."""

ZIP = b"PK\x03\x04"


def shipped_scenes() -> list[str]:
    """Returns the names of the scenes that come with the package, in alphabetical order."""
    return sorted(_shipped())


def _shipped() -> dict[str, Path]:
    return {path.stem: path for path in SHIPPED.rglob("*.toml")}


def shown(path: Path) -> str:
    """Returns the path as a user would name it: relative to the working directory if it lies below that directory."""
    return str(path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path)


def find_scene(path_or_name: str | Path) -> Path:
    """Returns the file at that path, else the file of the shipped scene of that name. Raises SceneError if there is neither."""
    if not isinstance(path_or_name, str | Path):
        raise SceneError("scene", [f"wanted the path of a scene file, or the name of a shipped scene, got {path_or_name!r:.70}"])
    path, name = Path(path_or_name), str(path_or_name) or '""'
    try:
        if path.is_file():
            return path.absolute()
        if shipped := _shipped().get(name):
            return shipped
        inside = sorted(path.glob("*.toml")) if str(path_or_name) and path.is_dir() else None
    except (OSError, ValueError) as error:
        raise SceneError(name, [f"cannot be opened: {error}"]) from None
    if inside is not None:
        held = ", ".join(file.name for file in inside[:10]) + ", ..." * (len(inside) > 10)
        problem = f"wanted a scene file, got a directory; it holds {held or 'no scene (*.toml)'}"
        raise SceneError(name, [problem])
    raise SceneError(name, [_missing(path)])


def read_document(path: Path) -> dict[str, Any]:
    """Returns the parsed TOML file. Raises SceneError if the file cannot be read, or, with the line, if it is not TOML."""
    _require_no_mesh(path)
    text = _read_text(path)
    try:
        return tomllib.loads(f"{text}\n")  # without a line end, a fault of the last line would have no place
    except RecursionError:
        problem = "not TOML that can be read: nested too deeply"
    except ValueError as error:
        problem = _syntax(str(error), text)
    raise SceneError(shown(path), [problem])


def _require_no_mesh(path: Path) -> None:
    if path.suffix.lower() == ".toml":
        return
    from softffd.mesh.files import READ  # imported only for files that do not end in .toml

    if path.suffix.lower() in READ:
        say = f"wanted a scene file (TOML), got a mesh; to drop it on the ground: softffd run {shlex.quote(shown(path))}"
        write = f"to write a scene of it: softffd new {shlex.quote(path.stem)} --mesh {shlex.quote(shown(path))}"
        raise SceneError(shown(path), [f"{say}; {write}"])


def _read_text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}"
    except UnicodeDecodeError as error:
        if error.object.startswith(ZIP):
            raise SceneError(shown(path), [_archive(path)]) from None
        line = error.object[: error.start].count(b"\n") + 1
        byte = error.object[error.start]
        problem = f"wanted a TOML text in UTF-8, got the byte 0x{byte:02x} in line {line}"
    raise SceneError(shown(path), [problem])


def _archive(path: Path) -> str:
    if path.suffix.lower() == ".fmu":
        return f"wanted a scene file (TOML), got an FMU; to run it: softffd run {shown(path)}"
    return f"wanted a scene file (TOML), got a zip archive; if it is an FMU, rename it to {path.name}.fmu"


def _missing(path: Path) -> str:
    if path.is_symlink():
        return f"wanted a scene file, got a link to {path.readlink()}, which is missing"
    names = shipped_scenes()
    beside = list(map(str, path.parent.glob("*.toml")))
    exact = path.stem if path.stem in names else None
    nearest = exact or nearest_of(str(path), beside) or nearest_of(path.stem, names)
    return f"no such file or shipped scene{did_you_mean(nearest) or '.'} Shipped scenes: {', '.join(names)}"


def _syntax(message: str, text: str) -> str:
    """Returns the message of tomllib with the place in front and the text of the line at the end."""
    found = re.search(r" \(at line (\d+), column (\d+)\)$", message)
    if found is None:
        return f"TOML syntax: {message}"
    line, column = int(found[1]), int(found[2])
    reads = text.split("\n")[line - 1].strip()
    return f"TOML syntax, line {line}, column {column}: {message[: found.start()]}; the line reads: {reads}"
