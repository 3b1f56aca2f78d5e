"""HTML pages come from template files, in which {{name}} stands for a part."""

import re
from collections.abc import Mapping
from importlib import resources


def filled(package: str, template: str, parts: Mapping[str, str]) -> str:
    """The text of a package's template, as "view.html" of softffd.show, with its parts in their places."""
    text = resources.files(package).joinpath(template).read_text(encoding="utf-8")
    return re.sub(r"{{(\w+)}}", lambda place: parts[place[1]], text)
