"""`softffd ssp`: a scene's FMU and others as one system."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Any

from softffd.cli.options import setting
from softffd.errors import SoftffdError
from softffd.files import require_new
from softffd.fmu.ssp import told_ssp


def write_coupled(options: argparse.Namespace) -> str:
    """Writes the system and returns what is said about it."""
    named = [_named(text) for text in (options.scene, *options.others)]
    components: dict[str, str] = {}
    for name, what in named:
        if name in components:
            raise SoftffdError(f"{what}: there is a component {name} already; wanted --with NAME={what} with another name")
        components[name] = what
    connections = [_connection(text) for text in options.connections]
    path = options.output or Path(f"{named[0][0]}.ssp")
    if not options.overwrite:
        require_new([path], "another name by -o X.ssp")
    return "\n".join(told_ssp(path, components, connections, dict(map(_start, options.settings)), options.recorded))


def _named(text: str) -> tuple[str, str]:
    """Component and file of [NAME=]FILE."""
    name, _, what = text.rpartition("=") if re.match(r"[\w-]+=", text) else ("", "", text)
    return name or Path(what).stem, what


def _connection(text: str) -> tuple[Any, ...]:
    ends, *numbers = text.split(":")
    first, equals, second = ends.partition("=")
    try:
        if equals and first and second and len(numbers) <= 2:
            return (first.strip(), second.strip(), *map(float, numbers))
    except ValueError:
        pass
    raise SoftffdError(f"--connect {text}: wanted END=END[:FACTOR[:OFFSET]], e.g. --connect plate.point=box.plane.plate.point")


def _start(text: str) -> tuple[str, Any]:
    name, value = setting(text, "COMPONENT.VARIABLE=VALUE, e.g. --set plate.mass=2")
    return name, value.split(",") if "," in value else value
