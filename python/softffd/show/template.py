"""HTML pages from template files: {{name}} stands for a part, and {{file.js}} for the content of a file beside the template."""

import re
from collections.abc import Mapping
from importlib import resources


def filled(package: str, template: str, parts: Mapping[str, str]) -> str:
    """Returns the text of a package's template, such as "view.html" of softffd.show.page, with its parts inserted."""
    whole = text_of(package, template)
    return re.sub(r"{{([\w.]+)}}", lambda place: parts[place[1]] if place[1] in parts else text_of(package, place[1]), whole)


def text_of(package: str, file: str) -> str:
    """Returns the text of a package's file."""
    return resources.files(package).joinpath(file).read_text(encoding="utf-8")
