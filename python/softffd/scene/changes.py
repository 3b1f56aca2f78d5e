"""Changes to a scene by dotted keys: `material.stiffness`, `plane.plate.friction`, `region[0].mass`."""

import re
from collections.abc import Mapping
from typing import Any

from softffd.scene.faults import toml_text
from softffd.spelling import did_you_mean, nearest_of


def changed(document: dict[str, Any], changes: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """A document with other values, and the problems with the keys themselves; what the values are worth is not looked at.

    document: tables and lists of tables, not shared with anybody, and changed in place. A key names tables from the outside in; an entry
    of a list by its `name` or its number from 0, plane.plate.friction or plane[0].friction. None takes a key away: its default holds.
    """
    problems = [problem for key, value in changes.items() if (problem := _change(document, str(key), value))]
    return document, problems


def _change(document: dict[str, Any], key: str, value: Any) -> str | None:
    words = re.split(r"[.\[\]]+", key.removesuffix("]"))
    node: Any = document
    for depth, word in enumerate(words):
        place: Any = _position(node, word) if isinstance(node, list) else word
        if place is None:
            return f"{key}: {_unknown_entry(node, '.'.join(words[:depth]), word)}"
        if depth < len(words) - 1:
            node = _below(node, place)
        elif value is not None:
            node[place] = value
        elif isinstance(node, list) or place in node:
            del node[place]
    return None


def _position(entries: list[Any], word: str) -> int | None:
    """Where a list has the entry of a number or name."""
    if word.isdecimal():
        return int(word) if int(word) < len(entries) else None
    return next((n for n, entry in enumerate(entries) if isinstance(entry, dict) and entry.get("name") == word), None)


def _below(node: Any, place: Any) -> Any:
    """What stands at a place; where that holds nothing further, a table of its own, which the checks of the scene refuse in words."""
    below = node.get(place) if isinstance(node, dict) else node[place]
    if not isinstance(below, dict) and not (isinstance(below, list) and all(isinstance(entry, dict) for entry in below)):
        below = node[place] = {}
    return below


def _unknown_entry(entries: list[Any], where: str, word: str) -> str:
    names = [str(entry["name"]) for entry in entries if isinstance(entry, dict) and "name" in entry]
    numbers = f"a number below {len(entries)}" if entries else "an entry, of which there is none"
    wanted = " or ".join([*(["the name of one (" + ", ".join(names) + ")"] if names else []), numbers])
    return f"wanted {wanted} in {where}, got {toml_text(word)}{did_you_mean(nearest_of(word, names))}"
