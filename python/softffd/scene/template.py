"""The commented scene file that `softffd new NAME` writes."""

import json
from pathlib import Path

TEMPLATE = Path(__file__).parent / "template.toml"


def template(name: str) -> str:
    """The text of a new scene called `name`: every section and key with its unit, ready to run.

    A line that begins with `#` and no blank is a key that is not in force: without the `#` it is.
    """
    title = toml_string(f"{name}: a soft box dropped on the ground")
    return TEMPLATE.read_text(encoding="utf-8").replace('"TITLE"', title)


def toml_string(text: str) -> str:
    """The text as a string of TOML; what is no letter of Unicode, as in names of files in other encodings, becomes "?"."""
    text = text.encode(errors="replace").decode()
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
