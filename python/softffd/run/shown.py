"""What a result says of itself: a few lines in a console, and in a notebook its picture and its page."""

from __future__ import annotations

import base64
import html
import secrets
import shutil
import tempfile
import time
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from softffd.errors import SoftffdError
from softffd.names import listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from softffd.run.result import Result

PAGES, DAY = "softffd-view-", 86400.0
"""How folders of temporary pages begin, and how long they stay [s]"""

LARGEST_PAGE = 2e6
"""Characters of an interactive page that a notebook takes into itself."""


def in_words(result: Result) -> str:
    """Title and time, positions with the largest deformation, names of outputs, inputs and parameters, the first warning."""
    span = f"{result.time[0]:.6g} to {result.time[-1]:.6g} s" if len(result.time) else "no time"
    lines = [
        f"Result of {result.title}: {span} in {len(result.time)} rows",
        *([f"positions {result.positions.shape} m, {_deformed(result)}"] if result.positions.size else []),
        *(f"{what}: {listed(names)}" for what in ("outputs", "inputs", "parameters") if (names := getattr(result, what))),
    ]
    if warnings := result.summary.get("warnings"):
        lines.append(f"{len(warnings)} warning{'s, the first' if len(warnings) > 1 else ', the first'}: {warnings[0]}")
    if result.sceneless:
        lines.append(f"without its scene: {result.sceneless}")
    return "\n  ".join(lines)


def picture(
    result: Result, path: str | Path | None = None, *, x: str = "time", y: str | Iterable[str] = (), colour: str | None = None,
    lattice: bool = False,
) -> Figure:  # fmt: skip
    """The picture of the run, or of outputs `y` over `x` where there are any, written to `path` where one is given."""
    from softffd.show.figure import save_figure
    from softffd.show.picture import curve_picture, run_picture

    if (x != "time" and not y) or ((colour or lattice) and y):
        raise SoftffdError("plot: wanted x with y, and colour and lattice without them")
    figure = curve_picture(result, x=x, y=y) if y else run_picture(result, mesh=result.loaded_mesh, colour=colour, lattice=lattice)
    if path is not None:
        save_figure(figure, path)
    return figure


def page(result: Result, path: str | Path | None = None, *, browser: bool) -> Path:
    """Writes the interactive page, to a new temporary file without a path, and opens it in the browser if that is asked for."""
    from softffd.show.view import write_view

    if path is None:
        path = _pages() / f"view-{secrets.token_hex(4)}.html"
    written = write_view(result, path, mesh=result.loaded_mesh)
    if browser:
        import webbrowser

        webbrowser.open(written.resolve().as_uri())
    return Path(written)


@cache
def _pages() -> Path:
    """The folder for this process's temporary pages, which the browser may read when the process is over; those of yesterday go."""
    folder = Path(tempfile.mkdtemp(prefix=PAGES))
    for other in folder.parent.glob(f"{PAGES}*"):
        with suppress(OSError):
            if other.stat().st_mtime < time.time() - DAY:
                shutil.rmtree(other, ignore_errors=True)
    return folder


def in_notebook(result: Result) -> str:
    """The words and, where positions were recorded, the picture and, if it is small, the interactive page, to be opened with a click."""
    said = f'<pre style="white-space: pre-wrap">{html.escape(in_words(result))}</pre>'
    if not result.has_positions:
        return said
    from softffd.show.figure import png_of
    from softffd.show.view import page_text

    image = base64.b64encode(png_of(picture(result))).decode("ascii")
    said += f'<img alt="{html.escape(result.title)}" style="max-width: 100%" src="data:image/png;base64,{image}">'
    text = page_text(result, mesh=result.loaded_mesh)
    if len(text) > LARGEST_PAGE:
        return f"{said}<p>The interactive page is large: <code>view()</code> opens it in the browser.</p>"
    frame = f'<iframe loading="lazy" style="width: 100%; height: 36rem; border: 0" srcdoc="{html.escape(text)}"></iframe>'
    return f"{said}<details><summary>interactive page</summary>{frame}</details>"


def _deformed(result: Result) -> str:
    if not result.has_positions:
        return "not all recorded"
    depths = result.deformation()
    row = int(np.argmax(depths))
    return f"largest deformation {depths[row]:.4g} m at {result.time[row]:.4g} s"
