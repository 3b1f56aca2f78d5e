"""HTML pages come from template files, in which {{name}} stands for a part, or {{file.js}} for what a file beside the template holds."""

import re
from collections.abc import Mapping
from importlib import resources


def filled(package: str, template: str, parts: Mapping[str, str]) -> str:
    """The text of a package's template, as "view.html" of softffd.show, with its parts in their places."""
    texts, folder = dict(parts), resources.files(package)
    for name in (template, *(file.name for file in folder.iterdir() if file.name.endswith((".js", ".glsl")))):
        texts[name] = folder.joinpath(name).read_text(encoding="utf-8")
    return re.sub(r"{{([\w.]+)}}", lambda place: texts[place[1]], texts[template])
