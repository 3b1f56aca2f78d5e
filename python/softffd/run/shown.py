"""What a result is shown in beside its own methods: the HTML of a notebook, and a place for pages that nobody asked to keep."""

from __future__ import annotations

import base64
import html
import secrets
import shutil
import tempfile
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

PAGES, DAY = "softffd-view-", 86400.0
"""How folders of temporary pages begin, and how long they stay [s]"""

LARGEST_PAGE = 2e6
"""Characters of an interactive page that a notebook takes into itself."""


def in_notebook(words: str, title: str = "", image: bytes = b"", page: str = "") -> str:
    """Words and, where they are given, a picture (PNG) and the interactive page, to be opened with a click."""
    said = f'<pre style="white-space: pre-wrap">{html.escape(words)}</pre>'
    if not image:
        return said
    data = base64.b64encode(image).decode("ascii")
    said += f'<img alt="{html.escape(title)}" style="max-width: 100%" src="data:image/png;base64,{data}">'
    if len(page) > LARGEST_PAGE:
        return f"{said}<p>The interactive page is large: <code>view()</code> opens it in the browser.</p>"
    frame = f'<iframe loading="lazy" style="width: 100%; height: 36rem; border: 0" srcdoc="{html.escape(page)}"></iframe>'
    return f"{said}<details><summary>interactive page</summary>{frame}</details>"


def temporary_page() -> Path:
    """A new name for a page, in this process's folder for them."""
    return _pages() / f"view-{secrets.token_hex(4)}.html"


@cache
def _pages() -> Path:
    """The folder for this process's temporary pages, which the browser may read when the process is over; those of yesterday go."""
    folder = Path(tempfile.mkdtemp(prefix=PAGES))
    for other in folder.parent.glob(f"{PAGES}*"):
        with suppress(OSError):
            if other.stat().st_mtime < time.time() - DAY:
                shutil.rmtree(other, ignore_errors=True)
    return folder
