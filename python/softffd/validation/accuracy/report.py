"""The page of a measurement: one self-contained HTML file with pictures, tables and the setting to take for each scene."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

from softffd.validation.accuracy.picture import setting_words
from softffd.validation.accuracy.records import CHOSEN, LEVELS, MISSED, PUBLISHED, WITHIN, Record, Records, level_words

NONE = "&ndash;"
Pictures = Mapping[str, Sequence[bytes]]


def report_page(measured: Sequence[Records], missing: Mapping[str, str], about: Mapping[str, Any], pictures: Pictures) -> str:
    """The page's text. missing: scenes without records, and why; about: machine, versions, settings; pictures: PNGs by scene."""
    parts = {
        "conditions": html.escape(_conditions(about)),
        "missing": _missing(missing, measured),
        "summary": _summary(measured),
        "scenes": "\n".join(_scene(records, pictures[records.scene]) for records in measured),
    }
    page = resources.files("softffd.validation.accuracy").joinpath("report.html").read_text(encoding="utf-8")
    return re.sub(r"{{(\w+)}}", lambda place: parts[place[1]], page)


def time_words(seconds: float) -> str:
    """A time with three digits: "5.32 ms"."""
    return f"{1e3 * seconds:.3g} ms" if seconds < 0.9995 else f"{seconds:.3g} s"


def factor_words(factor: tuple[float, bool] | None) -> str:
    """A factor over the published scheme: "82", or "> 1200" where that does not get there; empty where nothing can be said."""
    if factor is None or (factor[1] and factor[0] < 1):
        return ""
    return f"{'> ' * factor[1]}{factor[0]:.3g}"


def _conditions(about: Mapping[str, Any]) -> str:
    machine, versions = about["machine"], about["versions"]
    names = ", ".join(f"{name} {version}" for name, version in versions.items())
    place = f"{machine['processor']}, {machine['cores']} cores, {machine['system']}"
    return f"{about['command']}; {about['date']}; {place}; {names}"


def _missing(missing: Mapping[str, str], measured: Sequence[Records]) -> str:
    lines = {
        "Not measured": [f"{name} ({why})" for name, why in missing.items()],
        "Not complete": [f"{records.scene} (interrupted)" for records in measured if not records.complete],
    }
    words = " ".join(f"{what}: {', '.join(names)}." for what, names in lines.items() if names)
    return f'<p class="warning">{html.escape(words)}</p>' if words else ""


def _summary(measured: Sequence[Records]) -> str:
    rows = []
    for records in measured:
        cells = "".join(f"<td>{_summary_cell(records, level)}</td>" for level in LEVELS)
        rows.append(f'<tr><th><a href="#{records.scene}">{records.scene}</a></th>{cells}</tr>')
    text = (
        "Time of <code>auto</code> to reach an error; how many times as fast as the published scheme that is; and its time over that of "
        f"the best other method (wanted: at most {WITHIN})."
    )
    return f"<section><h2>All scenes</h2><p>{text}</p>{_table(['scene'], rows)}</section>"


def _summary_cell(records: Records, level: float) -> str:
    chosen = records.cheapest(CHOSEN, level)
    if chosen is None:
        return NONE
    factor, ratio = records.factor(chosen, level), records.ratio(level)
    over = f"{words} times as fast" if (words := factor_words(factor)) else ""
    beside = f"{ratio:.2f} of the best" if ratio else ""
    return f"{time_words(chosen.cpu_time)}<small>{html.escape(over)}</small><small>{beside}</small>"


def _scene(records: Records, pictures: Sequence[bytes]) -> str:
    front, course = (f'<img src="data:image/png;base64,{base64.b64encode(png).decode("ascii")}" alt="">' for png in pictures)
    facts = (
        f"{records.scene}: {records.points} control points, {records.stop_time:.4g} s in communication steps of "
        f"{records.communication_step:.4g} s. Reference: {records.reference}."
    )
    parts = [
        f'<section id="{records.scene}"><h2>{html.escape(records.title)}</h2>',
        f'<p class="soft">{html.escape(facts)}</p>',
        _doubt(records),
        front,
        "<h3>Time to reach an error</h3>",
        _table(["method"], _method_rows(records), _factor_rows(records)),
        _left_out(records),
        _tolerances(records),
        "<h3>Setting for this scene</h3>",
        _recommendation(records),
        "<h3>Error against simulated time</h3>",
        course,
        _all_runs(records),
        "</section>",
    ]
    return "\n".join(parts)


def _doubt(records: Records) -> str:
    if records.reference.confirmed:
        return ""
    return '<p class="warning">The reference is unconfirmed: no second, independent method stands behind it.</p>'


def _table(first: Sequence[str], *bodies: Sequence[str]) -> str:
    heads = "".join(f"<th>{word}</th>" for word in [*first, *map(level_words, LEVELS)])
    inner = "".join(f"<tbody>{''.join(rows)}</tbody>" for rows in bodies if rows)
    return f'<div class="scroll"><table><thead><tr>{heads}</tr></thead>{inner}</table></div>'


def _method_rows(records: Records) -> list[str]:
    rows = []
    for name in sorted(records.names(), key=lambda name: (name not in (CHOSEN, PUBLISHED), name != CHOSEN)):
        cells = []
        for level in LEVELS:
            run, best = records.cheapest(name, level), records.best(level)
            inside = NONE if run is None else f"{time_words(run.cpu_time)}<small>{setting_words(run)}</small>"
            cells.append(f"<td{' class=best' * (run is not None and run is best)}>{inside}</td>")
        label = f"{name} <small>(published)</small>" if name == PUBLISHED else name
        rows.append(f"<tr{' class=chosen' * (name == CHOSEN)}><th>{label}</th>{''.join(cells)}</tr>")
    return rows


def _factor_rows(records: Records) -> list[str]:
    def row(label: str, words) -> str:
        return f"<tr><th>{label}</th>{''.join(f'<td>{html.escape(words(level)) or NONE}</td>' for level in LEVELS)}</tr>"

    def ratio(level: float) -> str:
        value = records.ratio(level)
        return f"{value:.2f}" if value else ""

    return [
        row("published / best", lambda level: factor_words(records.factor(records.best(level), level))),
        row("published / auto", lambda level: factor_words(records.factor(records.cheapest(CHOSEN, level), level))),
        row("auto / best", ratio),
    ]


def _left_out(records: Records) -> str:
    lines = [f"{name} {why}" for name, why in records.left_out.items()]
    return f'<p class="soft">Left out: {html.escape("; ".join(lines))}.</p>' if lines else ""


def _tolerances(records: Records) -> str:
    runs = [run for name in records.names("softffd") if (run := records.worst_of_tolerance(name))]
    words = [f"{run.name} {run.error / run.setting.tolerance:.2g} (at {run.setting.tolerance:.3g})" for run in runs]
    missed = any(run.error > MISSED * run.setting.tolerance for run in runs)
    kind = "warning" if missed else "soft"
    return f'<p class="{kind}">Largest error over tolerance: {", ".join(words)}.</p>' if words else ""


def _recommendation(records: Records) -> str:
    found = [(level, records.recommended(level)) for level in LEVELS]
    rows = [_setting_row(level, run) for level, run in found if run]
    own = records.recommended(records.tolerance)
    if own is None:
        return f"<p>No method reaches the scene's own tolerance of {records.tolerance:g} here.</p>"
    reached = f"{time_words(own.cpu_time)}, measured error {own.error:.1e}"
    why = f"<p>For an error of {records.tolerance:g} of the box, the scene's own tolerance: {reached}.</p>"
    table = f"<table><thead><tr><th>error</th><th>setting</th><th>time</th></tr></thead><tbody>{''.join(rows)}</tbody></table>"
    return f"{why}<pre>{html.escape(toml_of(own), quote=False)}</pre><div class=scroll>{table}</div>"


def toml_of(run: Record) -> str:
    """The lines of a scene file that set the solver as in this run."""
    kind = "step" if run.setting.step else "tolerance"
    return f'[solver]\nmethod = "{run.setting.method}"\n{kind} = {getattr(run.setting, kind):.3g}'


def _setting_row(level: float, run: Record) -> str:
    return f"<tr><th>{level_words(level)}</th><td>{run.name}, {setting_words(run)}</td><td>{time_words(run.cpu_time)}</td></tr>"


def _all_runs(records: Records) -> str:
    rows = []
    for run in records.runs:
        told = run.failure or f"{time_words(run.cpu_time)}</td><td>{run.error:.2e}</td><td>{'' if run.steps is None else run.steps}"
        cells = f'<td colspan="3">{html.escape(told)}</td>' if run.failure else f"<td>{told}</td>"
        rows.append(f"<tr><th>{run.name}</th><td>{setting_words(run)}</td>{cells}</tr>")
    head = "<thead><tr><th>method</th><th>setting</th><th>time</th><th>error</th><th>internal steps</th></tr></thead>"
    body = f'<div class="scroll"><table>{head}<tbody>{"".join(rows)}</tbody></table></div>'
    return f"<details><summary>All {len(rows)} runs</summary>{body}</details>"
