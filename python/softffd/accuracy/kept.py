"""The files of a measurement, each of which appears whole or not at all, and the machine and versions that it belongs to."""

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from softffd.files import table_text, write_bytes


def keep_files(folder: Path, files: Mapping[str, bytes | str]) -> None:
    """Writes files by name into a folder, which is made if missing."""
    for name, content in files.items():
        write_bytes(folder / name, content.encode() if isinstance(content, str) else content)


def csv_text(columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> str:
    """Returns a table of rows by name as CSV. A value that is absent or None is an empty cell."""
    return table_text(columns, ([row.get(name) for name in columns] for row in rows))  # csv leaves cells of None empty


def conditions(command: Iterable[str], *packages: str) -> dict[str, Any]:
    """Returns date, command, machine and versions. command: words, of which empty ones are left out. packages: those whose speed or
    results count besides softffd's own."""
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "command": " ".join(word for word in command if word),
        "machine": {"processor": _processor(), "cores": os.cpu_count(), "system": platform.platform(terse=True)},
        "versions": {"Python": platform.python_version(), **{name: _version(name) for name in ("softffd", "numpy", "fmpy", *packages)}},
    }


def condition_words(about: Mapping[str, Any]) -> str:
    """Returns such conditions in one line."""
    machine = about["machine"]
    names = ", ".join(f"{name} {number}" for name, number in about["versions"].items())
    return f"{about['command']}; {about['date']}; {machine['processor']}, {machine['cores']} cores, {machine['system']}; {names}"


def _processor() -> str:
    table = Path("/proc/cpuinfo")
    lines = table.read_text().splitlines() if table.is_file() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "?"
