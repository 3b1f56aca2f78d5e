"""Common parts of the reports: one self-contained HTML page, its tables and pictures, and the format of numbers."""

import base64
import html
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from softffd.accuracy.kept import condition_words
from softffd.show.template import filled

NONE = "&ndash;"  # content of a table's cell that has nothing to say


def page(title: str, about: Mapping[str, Any], header: Iterable[str], sections: Iterable[str]) -> str:
    """Returns the page's text. header, sections: HTML. about: as `conditions` returns it."""
    words = html.escape(condition_words(about))
    parts = {"title": html.escape(title), "conditions": words, "header": _joined(header), "sections": _joined(sections)}
    return filled("softffd.accuracy", "page.html", parts)


def section(title: str, *parts: str, name: str = "") -> str:
    """Returns a card of the page. parts: HTML. name: the target of links."""
    anchor = f' id="{html.escape(name)}"' if name else ""
    return _joined([f"<section{anchor}><h2>{html.escape(title)}</h2>", *parts, "</section>"])


def table(heads: Sequence[str], *bodies: Iterable[str], kind: str = "") -> str:
    """Returns a table of rows, one body after the other. kind: its class."""
    head = "".join(f"<th>{word}</th>" for word in heads)
    inner = "".join(f"<tbody>{text}</tbody>" for rows in bodies if (text := "".join(rows)))
    return f'<div class="scroll"><table{_class(kind)}><thead><tr>{head}</tr></thead>{inner}</table></div>'


def row(head: str, cells: Iterable[str | tuple[str, str]], kind: str = "") -> str:
    """Returns a row of HTML cells, each a text, or a pair of text and class. kind: the row's class."""
    pairs = ((cell, "") if isinstance(cell, str) else cell for cell in cells)
    return f"<tr{_class(kind)}><th>{head}</th>{''.join(f'<td{_class(what)}>{cell}</td>' for cell, what in pairs)}</tr>"


def small(text: str) -> str:
    """Returns words below the main ones of a cell; nothing for an empty text."""
    return f"<small>{html.escape(text)}</small>" if text else ""


def paragraph(text: str, kind: str = "") -> str:
    """Returns a paragraph of plain words; nothing for an empty text. kind: "soft" or "warning"."""
    return f"<p{_class(kind)}>{html.escape(text)}</p>" if text else ""


def folded(summary: str, inside: str) -> str:
    """Returns a part that is shown on a click on its summary."""
    return f"<details><summary>{summary}</summary>{inside}</details>"


def image(png: bytes) -> str:
    """Returns an element that contains the picture itself."""
    return f'<img src="data:image/png;base64,{base64.b64encode(png).decode("ascii")}" alt="">'


def time_words(seconds: float) -> str:
    """Returns a time with three digits: "5.32 ms"."""
    return f"{1e3 * seconds:.3g} ms" if seconds < 0.9995 else f"{seconds:.3g} s"


def _class(kind: str) -> str:
    return f' class="{kind}"' if kind else ""


def _joined(parts: Iterable[str]) -> str:
    return "\n".join(part for part in parts if part)
