"""HTML pages come from template files, in which {{name}} stands for a part, or {{file.js}} for what a file beside the template holds."""

import re
from collections.abc import Mapping
from importlib import resources


def filled(package: str, template: str, parts: Mapping[str, str]) -> str:
    """The text of a package's template, as "view.html" of softffd.show.page, with its parts in their places."""
    whole = text_of(package, template)
    return re.sub(r"{{([\w.]+)}}", lambda place: parts[place[1]] if place[1] in parts else text_of(package, place[1]), whole)


def text_of(package: str, file: str) -> str:
    """The text of a package's file."""
    return resources.files(package).joinpath(file).read_text(encoding="utf-8")
