"""The page of a survey: the map, the border, and the table of cases."""

from __future__ import annotations

import html
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from softffd.validation.page import bullets, folded, image, page, paragraph, row, section, small, table, time_words
from softffd.validation.stability.cases import CASES, PARTS
from softffd.validation.stability.survey import Survey
from softffd.validation.stability.verdict import VERDICTS, Check, Outcome

INTRODUCTION = """<p>Every run goes through the FMU, as a host drives it, in a process of its own: a crash or a hang is a result here. Each
answer is judged by an oracle that owes nothing to the FMU: an exact solution, an invariant or a bound, computed in numpy. What is given
with fmi2OK and is not so is WRONG.</p>"""

MAP = """<p>A box of 2 x 2 x 2 points, 1 m, 1 kg. <b>Vibration</b>: released from a stretch of 1 % along every axis, undamped, it breathes
for ever, 1 + 0.01 cos(omega t), exactly, at its highest frequency omega = 8 sqrt(k / 1 kg). Accurate: within 1e-4 m, ten times the
tolerance. Bounded: a larger error that <code>solver.error_estimate</code> tells within a factor of ten. <b>Damping</b>: the same box of
1000 N/m with dashpots along its springs, from tau omega = 0.01 to 1000; the damped oscillator is exact. <b>Rotation</b>: set spinning at
1 rad/s, undamped; accurate: angular momentum and energy within 1e-3; a gain of energy above 1 % is WRONG whatever is stated.
<b>Contact</b>: resting, slightly damped, on a plane that is drawn away under it; accurate: no penetration above 1e-12, friction impulse
mu times the normal one within 1e-3, momentum balanced, static sag. Method <code>central_difference</code> reproduces the published contact
rule, which penetrates and bounces, and is judged as bounded there. The component's own tolerance is 1e-5 m. <b>Rebound</b>: a box
of 4 x 4 x 4 points falls flat by 0.2 m and is thrown off, undamped; accurate: its centre after 0.4 s within 3e-4 m of that by numpy, at a
tolerance of 1e-4 m.</p>"""

BORDER = """<h3>The border of the explicit scheme</h3>
<p>The central difference without anybody to divide its steps, in ten lines of numpy: a disturbance of 1e-9 m of the box at rest grows
beyond the step given here, in units of 2 / omega. Beside it what the FMU makes of the same box.</p>"""


def report_page(survey: Survey, about: Mapping[str, Any], pictures: Mapping[str, bytes]) -> str:
    """The page's text. about: machine, versions, command line; pictures: PNGs."""
    drawn = [image(png) for png in pictures.values()] or [paragraph("No map was asked for.", "soft")]
    cases = (_part(survey, title, module) for title, module in PARTS.items())
    sections = [section("The map", MAP, *drawn, BORDER, _borders(survey)), *cases]
    return page("Stiff and extreme scenes", about, [INTRODUCTION, *_result(survey)], sections)


def _result(survey: Survey) -> Iterator[str]:
    counts = Counter(outcome.verdict for outcome in survey.outcomes.values())
    cells = Counter(judged.kind for judged in survey.cells.values())
    verdicts = ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])
    kinds = ", ".join(f"{number} {kind}" for kind, number in cells.most_common())
    yield paragraph(f"Cases: {verdicts or 'none'}. Cells of the map: {kinds or 'none'}.")
    if survey.missing:
        yield paragraph(f"Not run, or interrupted: {'; '.join(survey.missing)}.", "warning")
    if wrong := survey.wrong():
        yield f'<div class="wrong"><p>{len(wrong)} wrong answers given as right:</p>{bullets(map(html.escape, wrong))}</div>'


def _borders(survey: Survey) -> str:
    if not survey.borders:
        return ""
    heads = ("stiffness, N/m", "2 / omega, s", "raw scheme grows from", "solver.stable_step", "given step is divided from")
    rows = (
        row(f"{b.stiffness:.0e}", [f"{b.theory:.4g}", *(f"{step / b.theory:.4f}" for step in (b.raw, b.bound, b.divided))])
        for b in survey.borders
    )
    return table(heads, rows)


def _part(survey: Survey, title: str, module) -> str:
    names = [case.name for case in module.cases() if case.name in survey.outcomes]
    if not names:
        return ""
    heads = ("case", "oracle", "measured", "limit", "time", "verdict")
    return section(title, table(heads, (_case(name, survey.outcomes[name]) for name in names), kind="cases"))


def _case(name: str, outcome: Outcome) -> str:
    case, worst = CASES[name], outcome.worst
    measured, limit = (f"{worst.measured:.2g}{small(worst.what)}", f"{worst.limit:.2g}") if worst else ("", "")
    verdict = f"<b>{outcome.verdict}</b>{small(outcome.words)}", outcome.verdict
    oracle = f"{html.escape(case.oracle)}{_others(outcome)}"
    return row(f"{html.escape(name)}{small(case.what)}", [oracle, measured, limit, time_words(outcome.run_time), verdict])


def _others(outcome: Outcome) -> str:
    checks = outcome.checks
    return folded(f"{len(checks)} checks", bullets(map(_check, checks))) if len(checks) > 1 else ""


def _check(check: Check) -> str:
    text = html.escape(str(check))
    return f"<b>{text}: {check.verdict}</b>" if check.verdict != "right" else text
