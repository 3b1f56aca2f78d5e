"""The docstrings' form as Markdown: lines `name: text` become a list."""

from __future__ import annotations

import re
from typing import Any

from griffe import Extension

NAMED = re.compile(r"^((?:`?\w[\w.]*`?)(?:, `?\w[\w.]*`?)*): ")


def as_markdown(text: str) -> str:
    """One docstring; below a name what begins with a capital letter and is not indented is a paragraph of its own."""
    lines: list[str] = []
    listed = False
    for line in text.splitlines():
        named = NAMED.match(line)
        if named and not listed and lines and lines[-1]:
            lines.append("")  # a list begins after an empty line
        if not named and listed and line[:1].isupper():
            lines.append("")
        lines.append(NAMED.sub(r"- `\1`: ", line) if named else line)
        listed = bool(named) or (listed and bool(lines[-1]) and not line[:1].isupper())
    return "\n".join(lines)


class Docstrings(Extension):
    """Griffe calls this for every object that it has read."""

    def on_instance(self, *, obj: Any, **_others: Any) -> None:
        if obj.docstring:
            obj.docstring.value = as_markdown(obj.docstring.value)
