"""Tools of the sources, `python3 python/run.py TOOL`: what each takes and does."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from softffd.accuracy.command import report_accuracy
from softffd.cli.options import Parser
from softffd.files import require_writable
from softffd.run.progress import ProgressLine
from softffd.scene.scene import load_scene
from validation.cross_check import PLACE, write_cross_check
from validation.published.report import report_published
from validation.stability.drawn_runs import FAMILIES
from validation.stability.drawn_survey import report_random
from validation.stability.results import report_stability
from validation.twin import build_twin


def parser() -> Parser:
    """Returns the parser of all tools with their options."""
    whole = Parser(prog="run.py", description=__doc__)
    tools = whole.add_subparsers(required=True, metavar="TOOL", dest="tool", parser_class=Parser)

    def add(name: str, about: str) -> Parser:
        tool = tools.add_parser(name, help=about, description=about)
        tool.set_defaults(parser=tool)
        return tool

    folder = "Folder for the results."
    stability = add("stability", "Runs stiff and extreme scenes and judges each by an oracle: map, table, report.")
    stability.add_argument("--quick", action="store_true", help="Run some cases and a coarse map, for a first look.")
    stability.add_argument(
        "--only", nargs="+", default=[], metavar="NAME", help='What to run: "map", "cases", or parts of the names of cases.'
    )
    drawn = add("random", "Runs scenes drawn at random, in which auto is judged by tighter runs that agree.")
    drawn.add_argument("number", type=int, metavar="N", help="Number of scenes.")
    drawn.add_argument("--seed", type=int, default=1, metavar="S", help="Seed of the first scene, the next has S + 1; default: 1.")
    drawn.add_argument("--family", choices=list(FAMILIES), default="lattice", help="Of scenes; default: lattice.")
    for survey in (stability, drawn):
        survey.add_argument("-o", "--output", type=Path, default=Path("softffd-stability"), metavar="DIR", help=folder)
        survey.add_argument(
            "-j", "--jobs", type=int, default=os.cpu_count() or 1, metavar="J", help="Number of processes; default: the number of cores."
        )
    scipy = add("scipy", "Measures error against run time as softffd accuracy does, with SciPy's solvers beside.")
    scipy.add_argument("scenes", nargs="*", metavar="SCENE", help="Scene files, or names of shipped scenes; default: the standard set.")
    scipy.add_argument("-o", "--output", type=Path, default=Path("softffd-accuracy"), metavar="DIR", help=folder)
    scipy.add_argument("--quick", action="store_true", help="Make fewer and shorter runs, for a first look.")
    twin = add("twin", "Makes an FMU of a scene whose model is written once more, in numpy.")
    twin.add_argument("scene", metavar="SCENE", help="Scene file, or name of a shipped scene.")
    twin.add_argument("-o", "--output", type=Path, metavar="X.fmu", help="File to write; default: NAME_twin.fmu in this folder.")
    published = add("benchmarks", "Runs published cases, of springs and of solids, and compares the numbers: a page and a table.")
    published.add_argument("--only", nargs="+", default=[], metavar="NAME", help="What to run: parts of the titles of cases.")
    published.add_argument("-o", "--output", type=Path, default=Path("softffd-published"), metavar="DIR", help=folder)
    cross_check = add("cross-check", "Makes the files of the FMI Cross-Check of the shipped scenes.")
    cross_check.add_argument("output", type=Path, metavar="DIR", help="Folder to write to; of the sources it is cross-check.")
    return whole


def run_tool(words: list[str] | None = None) -> None:
    """Runs the tool that a command line names. Raises SoftffdError. Wrong usage ends the program with status 2."""
    options, extra = parser().parse_known_args(words)
    if extra:
        options.parser.refuse(extra)
    TOOLS[options.tool](options)


def _stability(options: argparse.Namespace) -> None:
    require_writable(options.output)
    with ProgressLine("running") as progress:
        report_stability(
            options.output, only=options.only, quick=options.quick, processes=options.jobs, note=progress.note, say=progress.say
        )
    print(f"kept in {options.output}: stability.csv, stability.json, pictures of the map")


def _random(options: argparse.Namespace) -> None:
    require_writable(options.output)
    with ProgressLine("running") as progress:
        told = {"note": progress.note, "say": progress.say}
        report_random(options.output, options.number, options.seed, family=options.family, processes=options.jobs, **told)
    print(f"kept in {options.output}: random.csv, random.json")


def _scipy(options: argparse.Namespace) -> None:
    from validation.scipy import solver, sweep_scipy  # SciPy is an extra

    solver()
    require_writable(options.output)
    with ProgressLine("measuring") as progress:
        report_accuracy(
            options.scenes, options.output, anchors=sweep_scipy, typed="python3 python/run.py scipy", quick=options.quick,
            note=progress.note, say=progress.say,
        )  # fmt: skip
    print(f"kept in {options.output}: report.html, accuracy.csv, accuracy.json, a picture of each scene")


def _twin(options: argparse.Namespace) -> None:
    scene = load_scene(options.scene)
    print(build_twin(scene, options.output or f"{scene.name}_twin.fmu"))


def _benchmarks(options: argparse.Namespace) -> None:
    require_writable(options.output)
    with ProgressLine("running") as progress:
        rows = report_published(options.output, options.only, note=progress.note)
    for row in rows:
        print(f"{100 * row.error:+8.2f} %  {row.quantity}, {row.body}")
    print(f"kept in {options.output}: benchmarks.md, benchmarks.csv")


def _cross_check(options: argparse.Namespace) -> None:
    for path in write_cross_check(options.output / PLACE):
        print(path)


TOOLS = {
    "stability": _stability, "random": _random, "benchmarks": _benchmarks, "scipy": _scipy, "twin": _twin, "cross-check": _cross_check,
}  # fmt: skip
