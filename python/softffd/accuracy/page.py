"""What the reports have in common: one self-contained HTML page, its tables and pictures, and how numbers are told."""

import base64
import html
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from softffd.accuracy.kept import condition_words
from softffd.show.template import filled

NONE = "&ndash;"  # in a table where there is nothing to say


def page(title: str, about: Mapping[str, Any], header: Iterable[str], sections: Iterable[str]) -> str:
    """The page's text; header and sections are HTML. about: as `conditions` makes it."""
    words = html.escape(condition_words(about))
    parts = {"title": html.escape(title), "conditions": words, "header": _joined(header), "sections": _joined(sections)}
    return filled("softffd.accuracy", "page.html", parts)


def section(title: str, *parts: str, name: str = "") -> str:
    """A card; parts are HTML, name is where links go."""
    anchor = f' id="{html.escape(name)}"' if name else ""
    return _joined([f"<section{anchor}><h2>{html.escape(title)}</h2>", *parts, "</section>"])


def table(heads: Sequence[str], *bodies: Iterable[str], kind: str = "") -> str:
    """A table of rows, one body after the other; kind: its class."""
    head = "".join(f"<th>{word}</th>" for word in heads)
    inner = "".join(f"<tbody>{text}</tbody>" for rows in bodies if (text := "".join(rows)))
    return f'<div class="scroll"><table{_class(kind)}><thead><tr>{head}</tr></thead>{inner}</table></div>'


def row(head: str, cells: Iterable[str | tuple[str, str]], kind: str = "") -> str:
    """A row of HTML cells; a pair is a cell and its class, kind the row's."""
    pairs = ((cell, "") if isinstance(cell, str) else cell for cell in cells)
    return f"<tr{_class(kind)}><th>{head}</th>{''.join(f'<td{_class(what)}>{cell}</td>' for cell, what in pairs)}</tr>"


def small(text: str) -> str:
    """Words below the main ones of a cell; nothing for none."""
    return f"<small>{html.escape(text)}</small>" if text else ""


def paragraph(text: str, kind: str = "") -> str:
    """Plain words; nothing for none. kind: "soft" or "warning"."""
    return f"<p{_class(kind)}>{html.escape(text)}</p>" if text else ""


def folded(summary: str, inside: str) -> str:
    """What is shown on a click."""
    return f"<details><summary>{summary}</summary>{inside}</details>"


def image(png: bytes) -> str:
    """A picture, inside the page."""
    return f'<img src="data:image/png;base64,{base64.b64encode(png).decode("ascii")}" alt="">'


def time_words(seconds: float) -> str:
    """A time with three digits: "5.32 ms"."""
    return f"{1e3 * seconds:.3g} ms" if seconds < 0.9995 else f"{seconds:.3g} s"


def _class(kind: str) -> str:
    return f' class="{kind}"' if kind else ""


def _joined(parts: Iterable[str]) -> str:
    return "\n".join(part for part in parts if part)
