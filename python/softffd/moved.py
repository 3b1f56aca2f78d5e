"""Old names of modules and of what is in them: they lead to the new ones, with a DeprecationWarning."""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, cast

MODULES = {
    "softffd.component": "softffd.fmu.component",
    "softffd.inputs": "softffd.run.inputs",
    "softffd.package": "softffd.fmu.package",
    "softffd.result": "softffd.run.result",
}
"""Modules whose name is no module any more"""

ATTRIBUTES = {
    "softffd.scene": "softffd.scene.scene",
    "softffd.mesh": "softffd.mesh.mesh",
}
"""Modules that are packages now: the module within them that has what they had"""


class _OldModules:
    """A finder and loader of the import system."""

    def find_spec(self, name: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        return ModuleSpec(name, cast(Any, self)) if name in MODULES else None

    def create_module(self, spec: ModuleSpec) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        old = module.__name__
        _warn(old, MODULES[old])
        sys.modules[old] = import_module(MODULES[old])


def install() -> None:
    """From now on the old modules can be imported."""
    if not any(isinstance(finder, _OldModules) for finder in sys.meta_path):
        sys.meta_path.append(_OldModules())


def attribute(package: str, name: str) -> Any:
    """What `package` had under this name when it was a module; AttributeError where it had nothing."""
    home = ATTRIBUTES[package]
    if name.startswith("_") or home == f"{package}.{name}":
        raise AttributeError(name)
    module = import_module(home)
    if getattr(getattr(module, name, None), "__module__", "").partition(".")[0] != "softffd":
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    _warn(f"{package}.{name}", f"{home}.{name}", level=4)
    return getattr(module, name)


def _warn(old: str, new: str, *, level: int = 3) -> None:
    warnings.warn(f"{old} is now {new}", DeprecationWarning, stacklevel=level)
