"""The page of a measurement: pictures, tables and the recommended setting for each scene."""

import html
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any
from urllib.parse import quote

from softffd.accuracy.page import NONE, folded, image, page, paragraph, row, section, small, table, time_words
from softffd.accuracy.picture import drawn_order, setting_words
from softffd.accuracy.records import CHOSEN, LEVELS, MISSED, PUBLISHED, WITHIN, Record, Records, level_words

INTRODUCTION = """<p>Every run goes through the FMU, as a host drives it. A time is the CPU time of the loop over the communication steps,
the smallest of several repeats. An error is the largest distance of any control point from the reference at any communication point,
divided by the largest side of the box. The published scheme is <code>central_difference</code> (Xia &amp; Wang 2009).</p>"""

SUMMARY = f"""<p>Time of <code>auto</code> to reach an error; how many times as fast as the published scheme that is; and its time over
that of the best other method (wanted: at most {WITHIN}).</p>"""


def report_page(measured: Sequence[Records], missing: Mapping[str, str], about: Mapping[str, Any], pictures: Mapping[str, bytes]) -> str:
    """Returns the page's text. missing: scenes without records, and why; about: machine, versions, settings; pictures: PNGs by scene."""
    sections = [_summary(measured), *(_scene(records, pictures[records.scene]) for records in measured)]
    return page("Error against run time", about, [INTRODUCTION, _missing(missing, measured)], sections)


def factor_words(factor: tuple[float, bool] | None) -> str:
    """Returns a factor over the published scheme: "82", or "> 1200" if that does not get there; empty if nothing can be said."""
    if factor is None or (factor[1] and factor[0] < 1):
        return ""
    return f"{'> ' * factor[1]}{factor[0]:.3g}"


def _missing(missing: Mapping[str, str], measured: Sequence[Records]) -> str:
    lines = {
        "Not measured": [f"{name} ({why})" for name, why in missing.items()],
        "Not complete": [f"{records.scene} (interrupted)" for records in measured if not records.complete],
    }
    return paragraph(" ".join(f"{what}: {', '.join(names)}." for what, names in lines.items() if names), "warning")


def _summary(measured: Sequence[Records]) -> str:
    rows = (
        row(f'<a href="#{quote(records.scene)}">{html.escape(records.scene)}</a>', (_summary_cell(records, level) for level in LEVELS))
        for records in measured
    )
    return section("All scenes", SUMMARY, _by_level("scene", rows))


def _summary_cell(records: Records, level: float) -> str:
    chosen = records.cheapest(CHOSEN, level)
    if chosen is None:
        return NONE
    factor, ratio = records.factor(chosen, level), records.ratio(level)
    over = f"{words} times as fast" if (words := factor_words(factor)) else ""
    beside = f"{ratio:.2f} of the best" if ratio else ""
    return f"{time_words(chosen.cpu_time)}{small(over)}{small(beside)}"


def _scene(records: Records, picture: bytes) -> str:
    facts = (
        f"{records.scene}: {records.points} control points, {records.stop_time:.4g} s in communication steps of "
        f"{records.communication_step:.4g} s. Reference: {records.reference}."
    )
    doubt = "" if records.reference.confirmed else "The reference is unconfirmed: no second, independent method stands behind it."
    left_out = "; ".join(f"{name} {why}" for name, why in records.left_out.items())
    return section(
        records.title,
        paragraph(facts, "soft"),
        paragraph(doubt, "warning"),
        image(picture),
        "<h3>Time to reach an error</h3>",
        _by_level("method", _method_rows(records), _factor_rows(records)),
        paragraph(f"Left out: {left_out}." if left_out else "", "soft"),
        _tolerances(records),
        "<h3>Setting for this scene</h3>",
        _recommendation(records),
        _all_runs(records),
        name=records.scene,
    )


def _by_level(first: str, *bodies: Iterator[str]) -> str:
    return table([first, *map(level_words, LEVELS)], *bodies)


def _method_rows(records: Records) -> Iterator[str]:
    for name in drawn_order(records):
        cells = []
        for level in LEVELS:
            run, best = records.cheapest(name, level), records.best(level)
            inside = NONE if run is None else f"{time_words(run.cpu_time)}{small(setting_words(run))}"
            cells.append((inside, "best" * (run is not None and run is best)))
        yield row(f"{name} {small('published')}" if name == PUBLISHED else name, cells, "chosen" * (name == CHOSEN))


def _factor_rows(records: Records) -> Iterator[str]:
    def words(label: str, of_level: Callable[[float], str]) -> str:
        return row(label, (html.escape(of_level(level)) or NONE for level in LEVELS))

    yield words("published / best", lambda level: factor_words(records.factor(records.best(level), level)))
    yield words("published / auto", lambda level: factor_words(records.factor(records.cheapest(CHOSEN, level), level)))
    yield words("auto / best", lambda level: f"{ratio:.2f}" if (ratio := records.ratio(level)) else "")


def _tolerances(records: Records) -> str:
    runs = [run for name in records.names("softffd") if (run := records.worst_of_tolerance(name))]
    words = [f"{run.name} {run.error / run.setting.tolerance:.2g} (at {run.setting.tolerance:.3g})" for run in runs]
    missed = any(run.error > MISSED * run.setting.tolerance for run in runs)
    return paragraph(f"Largest error over tolerance: {', '.join(words)}." if words else "", "warning" if missed else "soft")


def _recommendation(records: Records) -> str:
    own = records.recommended(records.tolerance)
    if own is None:
        return paragraph(f"No method reaches the scene's own tolerance of {records.tolerance:g} here.")
    reached = f"{time_words(own.cpu_time)}, measured error {own.error:.1e}"
    why = paragraph(f"For an error of {records.tolerance:g} of the box, the scene's own tolerance: {reached}.")
    rows = (
        row(level_words(level), [f"{run.name}, {setting_words(run)}", time_words(run.cpu_time)])
        for level in LEVELS
        if (run := records.recommended(level))
    )
    return f"{why}<pre>{html.escape(own.toml, quote=False)}</pre>{table(['error', 'setting', 'time'], rows)}"


def _all_runs(records: Records) -> str:
    rows = (row(run.name, [setting_words(run), *_told(run)]) for run in records.runs)
    return folded(f"All {len(records.runs)} runs", table(["method", "setting", "time", "error", "internal steps"], rows))


def _told(run: Record) -> list[str]:
    if run.failure:
        return ["", "", html.escape(run.failure)]
    return [time_words(run.cpu_time), f"{run.error:.2e}", "" if run.steps is None else str(run.steps)]
