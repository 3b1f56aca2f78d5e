"""The page of a survey: one self-contained HTML file with the map, the border, and the table of cases."""

from __future__ import annotations

import base64
import html
import re
from collections import Counter
from collections.abc import Mapping
from importlib import resources
from typing import Any

from softffd.validation.accuracy.report import time_words
from softffd.validation.stability.cases import CASES, PARTS
from softffd.validation.stability.survey import Survey
from softffd.validation.stability.verdict import VERDICTS, Check, Outcome


def report_page(survey: Survey, about: Mapping[str, Any], pictures: Mapping[str, bytes]) -> str:
    """The page's text. about: machine, versions, command line; pictures: PNGs."""
    parts = {
        "conditions": html.escape(_conditions(about)),
        "result": _result(survey),
        "pictures": "\n".join(_image(png) for png in pictures.values()) or '<p class="soft">No map was asked for.</p>',
        "borders": _borders(survey),
        "cases": "\n".join(_part(survey, title, module) for title, module in PARTS.items()),
    }
    page = resources.files("softffd.validation.stability").joinpath("report.html").read_text(encoding="utf-8")
    return re.sub(r"{{(\w+)}}", lambda place: parts[place[1]], page)


def _conditions(about: Mapping[str, Any]) -> str:
    machine, versions = about["machine"], about["versions"]
    names = ", ".join(f"{name} {version}" for name, version in versions.items())
    return f"{about['command']}; {about['date']}; {machine['processor']}, {machine['cores']} cores, {machine['system']}; {names}"


def _result(survey: Survey) -> str:
    counts = Counter(outcome.verdict for outcome in survey.outcomes.values())
    cells = Counter(judged.kind for judged in survey.cells.values())
    lines = [
        f"<p>Cases: {', '.join(f'{counts[verdict]} {verdict}' for verdict in VERDICTS if counts[verdict]) or 'none'}. "
        f"Cells of the map: {', '.join(f'{number} {kind}' for kind, number in cells.most_common()) or 'none'}.</p>"
    ]
    if survey.missing:
        lines.append(f'<p class="warning">Not run, or interrupted: {html.escape("; ".join(survey.missing))}.</p>')
    wrong = survey.wrong()
    if wrong:
        items = "".join(f"<li>{html.escape(line)}</li>" for line in wrong)
        lines.append(f'<div class="wrong"><p>{len(wrong)} wrong answers given as right:</p><ul>{items}</ul></div>')
    return "\n".join(lines)


def _image(png: bytes) -> str:
    return f'<img src="data:image/png;base64,{base64.b64encode(png).decode("ascii")}" alt="">'


def _borders(survey: Survey) -> str:
    if not survey.borders:
        return ""
    rows = "".join(
        f"<tr><th>{border.stiffness:.0e}</th><td>{border.theory:.4g}</td><td>{border.raw / border.theory:.4f}</td>"
        f"<td>{border.bound / border.theory:.4f}</td><td>{border.divided / border.theory:.4f}</td></tr>"
        for border in survey.borders
    )
    heads = ("stiffness, N/m", "2 / omega, s", "raw scheme grows from", "solver.stable_step", "given step is divided from")
    head = "".join(f"<th>{words}</th>" for words in heads)
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'


def _part(survey: Survey, title: str, module) -> str:
    names = [case.name for case in module.cases() if case.name in survey.outcomes]
    if not names:
        return ""
    heads = "".join(f"<th>{word}</th>" for word in ("case", "oracle", "measured", "limit", "time", "verdict"))
    rows = "".join(_row(name, survey.outcomes[name]) for name in names)
    table = f'<div class="scroll"><table class="cases"><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></div>'
    return f"<section><h2>{html.escape(title)}</h2>{table}</section>"


def _row(name: str, outcome: Outcome) -> str:
    case, worst = CASES[name], outcome.worst
    measured, limit = (f"{worst.measured:.2g}", f"{worst.limit:.2g}") if worst else ("", "")
    what = f"<small>{html.escape(worst.what)}</small>" if worst else ""
    words = f"<small>{html.escape(outcome.words)}</small>" if outcome.words else ""
    return (
        f"<tr><th>{html.escape(name)}<small>{html.escape(case.what)}</small></th><td>{html.escape(case.oracle)}{_others(outcome)}</td>"
        f"<td>{measured}{what}</td><td>{limit}</td><td>{time_words(outcome.run_time)}</td>"
        f'<td class="{outcome.verdict}"><b>{outcome.verdict}</b>{words}</td></tr>'
    )


def _others(outcome: Outcome) -> str:
    if len(outcome.checks) < 2:
        return ""
    items = "".join(f"<li>{_check(check)}</li>" for check in outcome.checks)
    return f"<details><summary>{len(outcome.checks)} checks</summary><ul>{items}</ul></details>"


def _check(check: Check) -> str:
    text = html.escape(str(check))
    return f"<b>{text}: {check.verdict}</b>" if check.verdict != "right" else text
