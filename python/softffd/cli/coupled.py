"""`softffd ssp`: couples a scene's FMU and other components in one system."""

import argparse
import re
from pathlib import Path
from typing import Any

from softffd.cli.options import setting
from softffd.errors import SoftffdError
from softffd.files import require_new
from softffd.fmu.ssp import told_ssp


def write_coupled(options: argparse.Namespace) -> str:
    """Writes the system and returns the lines to print about it. Raises SoftffdError if two components have the same name."""
    components: dict[str, str] = {}
    for text in (options.scene, *options.others):
        given, _, what = text.rpartition("=") if re.match(r"[\w-]+=", text) else ("", "", text)  # [NAME=]FILE
        if (name := given or Path(what).stem) in components:
            raise SoftffdError(f"{what}: there is a component {name} already; wanted --with NAME={what} with another name")
        components[name] = what
    connections = [_connection(text) for text in options.connections]
    settings = (setting(text, "COMPONENT.VARIABLE=VALUE, e.g. --set plate.mass=2") for text in options.settings)
    starts = {name: value.split(",") if "," in value else value for name, value in settings}
    path = options.output or Path(f"{next(iter(components))}.ssp")
    require_new([path], "another name by -o X.ssp", overwrite=options.overwrite)
    return "\n".join(told_ssp(path, components, connections, starts, options.recorded))


def _connection(text: str) -> tuple[Any, ...]:
    ends, *numbers = text.split(":")
    first, equals, second = ends.partition("=")
    try:
        if equals and first and second and len(numbers) <= 2:
            return (first.strip(), second.strip(), *map(float, numbers))
    except ValueError:
        pass
    raise SoftffdError(f"--connect {text}: wanted END=END[:FACTOR[:OFFSET]], e.g. --connect plate.point=box.plane.plate.point")
