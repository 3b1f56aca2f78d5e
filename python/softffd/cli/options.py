"""What can be typed after `softffd`: the commands, their options, an example of each; wrong words are told the nearest right one."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

from softffd import __version__
from softffd.errors import SoftffdError
from softffd.spelling import did_you_mean, nearest_of, number_in


class Parser(argparse.ArgumentParser):
    """An argparse parser that tells the nearest command, option or choice."""

    instead = ""
    """What is said of a word too many"""

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            words = [str(choice) for choice in action.choices]
            nearest = did_you_mean(nearest_of(str(value), words))
            raise argparse.ArgumentError(action, f"wanted one of {', '.join(words)}, got {value}{nearest}")

    def refuse(self, extra: list[str]) -> NoReturn:
        """Wrong usage, for words that are left over."""
        word = next((each for each in extra if each.startswith("-")), extra[0])
        option = word.partition("=")[0]
        if not option.startswith("-"):
            self.error(f"{word}: one word too many{self.instead}")
        self.error(f"{option}: there is no such option{did_you_mean(nearest_of(option, self._option_string_actions))}")


def _number(text: str) -> float:
    try:
        return number_in(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"wanted a number, got {text!r:.70}") from None


Add = Callable[..., Parser]
"""Adds a command: name, help, an example, and `more` words about that."""


def setting(text: str, wanted: str = "NAME=VALUE, e.g. --set mass=2") -> tuple[str, str]:
    """Name and value of --set NAME=VALUE. wanted: what is wanted, where it is not that."""
    name, _, value = (part.strip() for part in text.partition("="))
    if not name or not value:
        raise SoftffdError(f"--set {text}: wanted {wanted}")
    return name, value


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """The options of a command line, the command's name in `command`. Wrong usage ends the program with status 2."""
    options, extra = parser().parse_known_args(arguments)
    if extra:
        options.parser.refuse(extra)
    return options


def parser() -> Parser:
    """All commands with their options."""
    whole = Parser(prog="softffd", description=sys.modules["softffd"].__doc__, epilog="softffd COMMAND --help tells a command's options.")
    whole.add_argument("--version", action="version", version=f"softffd {__version__}")
    commands = whole.add_subparsers(required=True, metavar="COMMAND", dest="command", parser_class=Parser)

    def add(name: str, about: str, example: str, more: str = "") -> Parser:
        command = commands.add_parser(name, help=about, description=f"{about[0].upper()}{about[1:]}.", epilog=f"example: {example}{more}")
        command.set_defaults(parser=command)
        return command

    for add_commands in (_demo_and_build, _run, _ssp, _sweep, _accuracy, _others):
        add_commands(add)
    return whole


def _demo_and_build(add: Add) -> None:
    demo = add("demo", "a car falls and is pushed in: build, simulate, pictures, interactive page", "softffd demo -o car")
    demo.add_argument("-o", "--output", type=Path, default=Path("softffd-demo"), metavar="DIR")

    build = add("build", "make the FMU of a scene", "softffd build press -o press.fmu")
    build.add_argument("scene", help="a scene file or the name of a shipped scene")
    build.add_argument("-o", "--output", metavar="X.fmu", help="default: NAME.fmu here")
    _add_overwrite(build, "a file that is there")
    build.add_argument("--platform", action="append", metavar="NAME", help="FMI platform to carry, e.g. linux64; may be repeated")
    build.add_argument(
        "--fmi", type=int, choices=(2, 3), default=2, help="version of the standard: 2 (default), or 3, whose variables are arrays"
    )


def _run(add: Add) -> None:
    run = add("run", "simulate a scene, a mesh or an FMU and keep results and pictures", "softffd run press --stop-time 1.5 --set mass=2")
    run.add_argument(
        "what",
        metavar="SCENE|MESH|X.fmu",
        help="a scene file, a shipped scene's name, a mesh to drop on the ground, or an FMU",
    )
    _add_mesh_options(run)
    run.add_argument("--stop-time", type=_number, metavar="T", help="time at which the run ends, in s")
    run.add_argument("--step", type=_number, metavar="H", help="communication step, s")
    _add_accuracy_options(run)
    run.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="settings", help="start value of a variable")
    run.add_argument("--input", type=Path, metavar="FILE.csv", help="inputs over time: columns time and names of inputs")
    run.add_argument("--no-input", action="store_true", help="without the CSV beside the scene: inputs keep their start values")
    run.add_argument("--interpolation", default="held", metavar="HOW", help="how inputs go inside a step: held (default), linear or cubic")
    run.add_argument("--error", action="store_true", help="estimate the error of the run by a second one beside it")
    run.add_argument(
        "-o", "--output", type=Path, metavar="DIR",
        help="folder for the results; default: softffd-NAME here, or softffd-NAME-2 and so on where that is there",
    )  # fmt: skip
    _add_overwrite(run, "the results of an earlier run")
    run.add_argument(
        "--colour", choices=["von_mises", "stretch"], help="the picture shows the cells' von Mises stress or largest principal stretch"
    )
    run.add_argument("--lattice", action="store_true", help="the picture shows the lattice over a mesh too")
    shown = run.add_mutually_exclusive_group()
    shown.add_argument("--view", action="store_true", help="open the interactive page when done")
    shown.add_argument("--no-pictures", action="store_true", help="numbers alone; softffd view DIR makes the page later")


def _ssp(add: Add) -> None:
    ssp = add(
        "ssp",
        "couple a scene's FMU with others in a system (SSP)",
        "softffd ssp box.toml --with plate.fmu --connect plate.point=box.plane.plate.point --set plate.mass=2",
    )
    ssp.instead = "; another component goes after --with, a connection after --connect, a start value after --set"
    ssp.add_argument(
        "scene", metavar="[NAME=]SCENE", help="a scene file or the name of a shipped scene; its component has its name, or NAME"
    )
    ssp.add_argument(
        "--with",
        action="append",
        default=[],
        metavar="[NAME=]X.fmu",
        dest="others",
        help="another component: an FMU or a scene; may be repeated",
    )
    ssp.add_argument(
        "--connect", action="append", default=[], metavar="END=END[:FACTOR[:OFFSET]]", dest="connections",
        help="an output and an input, COMPONENT.VARIABLE, vectors as a whole; the input gets factor * output + offset; may be repeated",
    )  # fmt: skip
    ssp.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="END=VALUE",
        dest="settings",
        help="start value of an input or parameter, vectors as x,y,z",
    )
    ssp.add_argument(
        "--record", action="append", default=[], metavar="END", dest="recorded",
        help="outputs that hosts are to record too, e.g. box.probe.top.z, box.energy, or all of box; may be repeated",
    )  # fmt: skip
    ssp.add_argument("-o", "--output", type=Path, metavar="X.ssp", help="default: the scene's name here")
    _add_overwrite(ssp, "a file that is there")


def _sweep(add: Add) -> None:
    sweep = add(
        "sweep",
        "run a scene or an FMU for every combination of some values: table and picture",
        "softffd sweep press --vary stiffness.edge=500:2000:5:log --vary damping=0.1,0.2 --stop-time 1.5",
    )
    sweep.add_argument("what", metavar="SCENE|X.fmu", help="a scene file, a shipped scene's name, or an FMU")
    sweep.add_argument(
        "--vary", action="append", required=True, metavar="NAME=FROM:TO:COUNT[:log]",
        help="values of a parameter or input, or a list NAME=V1,V2; repeated: every combination",
    )  # fmt: skip
    sweep.add_argument(
        "--measure", action="append", metavar="OUTPUT", help="an output at the end, or max(NAME), min(NAME), mean(NAME); may be repeated"
    )
    sweep.add_argument("--stop-time", type=_number, metavar="T", help="time at which the run ends, in s")
    sweep.add_argument("--step", type=_number, metavar="H", help="communication step, s")
    _add_accuracy_options(sweep)
    sweep.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="settings", help="start value in every run")
    sweep.add_argument("--input", type=Path, metavar="FILE.csv", help="inputs over time; default: the CSV beside the scene")
    sweep.add_argument("--no-input", action="store_true", help="without the CSV beside the scene: inputs keep their start values")
    sweep.add_argument("-j", "--jobs", type=int, metavar="J", help="runs at a time; default: the number of cores")
    sweep.add_argument("--scheduler", metavar="ADDRESS", help="run on the Dask cluster of this scheduler, e.g. tcp://host:8786")
    sweep.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: softffd-sweep-NAME here; the same sweep there goes on")


def _accuracy(add: Add) -> None:
    accuracy = add(
        "accuracy", "measure error against run time of every method: table, pictures, report", "softffd accuracy free_vibration --quick"
    )
    accuracy.add_argument("scenes", nargs="*", metavar="SCENE", help="scene files or names of shipped ones; default: the standard set")
    accuracy.add_argument("-o", "--output", type=Path, default=Path("softffd-accuracy"), metavar="DIR")
    accuracy.add_argument("--step", type=_number, metavar="H", help="communication step, s; default: each scene's own")
    accuracy.add_argument("--quick", action="store_true", help="fewer and shorter runs: a first look")
    accuracy.add_argument("--repeats", type=int, default=5, metavar="N", help="of each run, the smallest time counts; default 5")


def _others(add: Add) -> None:
    drivers = add("drivers", "make driver FMUs (plate, actuator) and a coupled system (SSP)", "softffd drivers -o drivers")
    drivers.add_argument("-o", "--output", type=Path, default=Path("."), metavar="DIR")
    _add_overwrite(drivers, "files that are there")

    add("scenes", "list the shipped scenes", "softffd scenes")

    view = add("view", "open the interactive page of a run that was kept", "softffd view softffd-press")
    view.add_argument("what", type=Path, metavar="DIR|X.npz", help="a folder of softffd run, or a file of Result.save")

    info = add("info", "list the variables of a scene or an FMU: unit, start, causality; and the pins' frames", "softffd info press")
    info.add_argument("what", metavar="SCENE|X.fmu", help="a scene file, a shipped scene's name, or an FMU")
    info.add_argument("--all", action="store_true", help="each control point's variables too")

    new = add("new", "write a commented scene file to start from", "softffd new mine")
    new.add_argument("name", help="NAME of the scene; writes NAME.toml here")
    new.add_argument("--mesh", type=Path, metavar="FILE", help="of this mesh, dropped on the ground")
    _add_mesh_options(new)

    add("schema", "print the JSON schema of scene files, for editors", "softffd schema > scene.schema.json")


def _add_accuracy_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--tolerance", type=_number, metavar="T", help="error aimed at, as a share of the box's largest side")
    parser.add_argument("--method", metavar="NAME", help="of the time integration, as solver.method in the scene")


def _add_overwrite(parser: Parser, what: str) -> None:
    parser.add_argument("--overwrite", action="store_true", help=f"write over {what}")


def _add_mesh_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--unit", metavar="UNIT", help="of a mesh file: m, cm, mm, in or ft; default: by the file or its size")
    parser.add_argument("--up", metavar="AXIS", help="axis of a mesh file that becomes +z: x, y or z; default: by the kind of file")
    parser.add_argument("--density", type=_number, metavar="D", help="of a mesh, kg/m3; default 100")
