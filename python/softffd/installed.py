"""What the build puts beside the Python files: the library, the table of variables, and the documentation that goes into every FMU."""

import re
import sys
import tomllib
from collections.abc import Iterable
from ctypes import CDLL
from functools import cache
from importlib.resources import files
from pathlib import Path
from platform import machine
from typing import Any

from softffd.errors import SoftffdError

LIBRARY_NAME = {"linux64": "softffd.so", "aarch64-linux": "softffd.so", "win64": "softffd.dll", "darwin64": "softffd.dylib"}
WASM = "wasm32-wasi"  # the platform of web pages, which no FMU contains


def data_folder() -> Path:
    """Returns the folder `data` of the installed package; SoftffdError if the package is not built."""
    folder = Path(str(files("softffd").joinpath("data")))
    if not (folder / "variables.toml").is_file():
        raise SoftffdError(
            "the package is not built: its library and tables are missing. Install it (pip install . in the project's folder), "
            "or run it as: python3 python/run.py"
        )
    return folder


@cache
def table() -> dict[str, Any]:
    """Returns the parsed variables.toml: families, methods, log categories, units."""
    return tomllib.loads((data_folder() / "variables.toml").read_text())


def host_library() -> Path:
    """Returns the path of the library for the machine that this process runs on; SoftffdError if the installation has none for it."""
    arm = machine().lower() in ("aarch64", "arm64")
    system = {"win32": "win64", "darwin": "darwin64"}.get(sys.platform, "aarch64-linux" if arm else "linux64")
    return libraries([system])[system]


@cache
def loaded_library() -> CDLL:
    """Returns `host_library`, loaded for good."""
    return CDLL(str(host_library()))


@cache
def library_function(name: str, result: Any, *arguments: Any) -> Any:
    """Returns a function that the library has for this package, with the C types of its result and arguments; SoftffdError if the
    library belongs to another version."""
    try:
        function = getattr(loaded_library(), name)
    except AttributeError:
        raise SoftffdError(f"{host_library()}: wanted this version's library, got one without {name}; reinstall the package") from None
    function.restype, function.argtypes = result, arguments
    return function


def libraries(platforms: Iterable[str] | None = None) -> dict[str, Path]:
    """Returns the built libraries by FMI platform name, all or those asked for; SoftffdError names those that exist if one is missing."""
    found = {
        folder.name: folder / LIBRARY_NAME[folder.name]
        for folder in sorted((data_folder() / "binaries").iterdir())
        if (folder / LIBRARY_NAME.get(folder.name, "-")).is_file()
    }
    wanted = list(platforms or [])
    for platform in wanted:
        if platform == WASM:
            raise SoftffdError(f"platform {WASM}: that library is for web pages, no FMU contains it; wanted one of {', '.join(found)}")
        if platform not in found:
            raise SoftffdError(
                f"platform {platform}: this installation has no library for it; it has {', '.join(found)}. "
                "Build softffd on that platform, or install a wheel with all platforms: python3 python/run.py release makes one."
            )
    return {name: path for name, path in found.items() if not wanted or name in wanted}


def wasm_library() -> Path:
    """Returns the path of the library for web pages; SoftffdError, which names the commands that make one, if it is missing."""
    if not has_wasm_library():
        raise SoftffdError(
            "this installation has no library for web pages (WebAssembly). In a checkout, python3 python/run.py wasm builds it in some "
            "minutes; a wheel that python3 python/run.py release makes has it."
        )
    return data_folder() / "binaries" / WASM / "softffd.wasm"


def has_wasm_library() -> bool:
    """True if the installation has the library for web pages."""
    return (data_folder() / "binaries" / WASM / "softffd.wasm").is_file()


def least_glibc(library: Path) -> str | None:
    """Returns the oldest glibc that a library loads with, "2.17", from the symbol versions in an ELF file; None if it needs none."""
    needed = [(int(major), int(minor)) for major, minor in re.findall(rb"\0GLIBC_(\d+)\.(\d+)", library.read_bytes())]
    return "{}.{}".format(*max(needed)) if needed else None
