"""What can be typed after `softffd`: the commands, their options, and an example of each; errors name the nearest right word."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import softffd
from softffd.errors import SoftffdError
from softffd.spelling import did_you_mean, nearest_of, number_in, wanted_one_of


class Parser(argparse.ArgumentParser):
    """An argparse parser whose errors name the nearest command, option or choice."""

    instead = ""  # added to the message about a word too many

    def __init__(self, **about: Any):
        super().__init__(add_help=False, **about)
        self.add_argument("-h", "--help", action="help", help="Show this help and exit.")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            raise argparse.ArgumentError(action, wanted_one_of(map(str, action.choices), value))

    def refuse(self, extra: list[str]) -> NoReturn:
        """Ends the program as wrong usage, for the words that are left over."""
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


Add = Callable[[str, str, str], Parser]  # adds a command: name, help, an example
SCENE = "Scene file, or name of a shipped scene."
KEPT_MESH = "Mesh file of the run's scene, where it lies neither beside the run nor below its folder or this one."
SCENE_OR_FMU = "Scene file, name of a shipped scene, or FMU."


def setting(text: str, wanted: str = "NAME=VALUE, e.g. --set mass=2") -> tuple[str, str]:
    """Returns name and value of --set NAME=VALUE. wanted: the wanted form, for the message of the SoftffdError for another form."""
    name, _, value = (part.strip() for part in text.partition("="))
    if not name or not value:
        raise SoftffdError(f"--set {text}: wanted {wanted}")
    return name, value


def run_options(options: argparse.Namespace) -> dict[str, Any]:
    """Returns the options of `_add_run_options` as arguments of `simulate`, `sweep` and `fit`."""
    return {
        "stop_time": options.stop_time, "step": options.step, "start_values": dict(map(setting, options.settings)),
        "inputs": {} if options.no_input else options.input, "tolerance": options.tolerance, "method": options.method,
    }  # fmt: skip


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Returns the options of a command line, with the command's name in `command`. Wrong usage ends the program with status 2."""
    options, extra = parser().parse_known_args(arguments)
    if extra:
        options.parser.refuse(extra)
    return options


def parser() -> Parser:
    """Returns the parser of all commands with their options. Every help text is a sentence, with the unit of the value that it asks for."""
    more = "softffd COMMAND --help describes the options of a command. In the sources, softffd stability runs stiff and extreme scenes."
    whole = Parser(prog="softffd", description=softffd.__doc__, epilog=more)
    whole.add_argument("--version", action="version", version=f"softffd {softffd.__version__}", help="Show the version and exit.")
    commands = whole.add_subparsers(required=True, metavar="COMMAND", dest="command", parser_class=Parser)

    def add(name: str, about: str, example: str) -> Parser:
        command = commands.add_parser(name, help=about, description=about, epilog=f"example: {example}")
        command.set_defaults(parser=command)
        return command

    for add_commands in (_demo_and_build, _run, _ssp, _sweep, _fit, _accuracy, _others):
        add_commands(add)
    return whole


def _demo_and_build(add: Add) -> None:
    demo = add(
        "demo", "Simulate a car that falls and is pushed in; write its FMU, pictures and an interactive page.", "softffd demo -o car"
    )
    _output(demo, "DIR", "Folder to write to; default: softffd-demo.", Path("softffd-demo"))
    _add_lattice(demo, "the pictures")

    build = add("build", "Make the FMU of a scene.", "softffd build press -o press.fmu")
    build.add_argument("scene", help=SCENE)
    build.add_argument("-o", "--output", metavar="X.fmu", help="File to write; default: NAME.fmu in this folder.")
    _add_overwrite(build, "a file that exists")
    platforms = "FMI platform whose library the FMU carries, such as linux64; may be repeated; default: all that are installed."
    build.add_argument("--platform", action="append", metavar="NAME", help=platforms)
    versions = "Version of the FMI standard: 2 (default), or 3, in which variables are arrays."
    _switch(build, "--reference", "Run the scene twice, and put inputs, results and their error into the FMU (FMI-LS-REF).")
    build.add_argument("--fmi", type=int, choices=(2, 3), default=2, help=versions)


def _run(add: Add) -> None:
    run = add("run", "Simulate a scene, a mesh or an FMU; keep results and pictures.", "softffd run press --stop-time 1.5 --set mass=2")
    _option(run, "what", "SCENE|MESH|X.fmu", "Scene file, name of a shipped scene, mesh file to drop on the ground, or FMU.")
    _add_mesh_options(run)
    _add_run_options(run)
    how = "How inputs change within a communication step: held (default), linear or cubic."
    run.add_argument("--interpolation", default="held", metavar="HOW", help=how)
    _switch(run, "--error", "Estimate the error of the run in m, by a second run beside it.")
    _output(run, "DIR", "Folder for the results; default: softffd-NAME, or softffd-NAME-2 and so on where that exists.")
    _add_overwrite(run, "the results of an earlier run")
    colour = (
        "Colour the picture by the von Mises stress (Pa) or largest principal stretch of the cells, or the contact pressure on taxels (Pa)."
    )
    run.add_argument("--colour", choices=["von_mises", "stretch", "contact_pressure"], help=colour)
    _add_lattice(run, "the picture")
    shown = run.add_mutually_exclusive_group()
    _switch(shown, "--view", "Open the interactive page when the run has ended.")
    _switch(shown, "--no-pictures", "Write numbers only; softffd view DIR makes the page later.")


def _ssp(add: Add) -> None:
    example = "softffd ssp box.toml --with plate.fmu --connect plate.point=box.plane.plate.point --set plate.mass=2"
    ssp = add("ssp", "Couple the FMU of a scene with other FMUs in a system (SSP).", example)
    ssp.instead = "; another component goes after --with, a connection after --connect, a start value after --set"
    scene = "Scene file, or name of a shipped scene; its component has the scene's name, or NAME."
    ssp.add_argument("scene", metavar="[NAME=]SCENE", help=scene)
    repeated: dict[str, Any] = {"action": "append", "default": []}
    _option(ssp, "--with", "[NAME=]X.fmu", "Another component, an FMU or a scene; may be repeated.", **repeated, dest="others")
    connection = (
        "Connection of an output and an input, each COMPONENT.VARIABLE, vectors as a whole; the input gets FACTOR * output + OFFSET; may "
        "be repeated."
    )
    ssp.add_argument("--connect", **repeated, metavar="END=END[:FACTOR[:OFFSET]]", dest="connections", help=connection)
    start = "Start value of an input or parameter in its unit, vectors as x,y,z; may be repeated."
    ssp.add_argument("--set", **repeated, metavar="END=VALUE", dest="settings", help=start)
    record = "Outputs that hosts are to record too, such as box.probe.top.z, box.energy, or all of box; may be repeated."
    ssp.add_argument("--record", **repeated, metavar="END", dest="recorded", help=record)
    _output(ssp, "X.ssp", "File to write; default: NAME.ssp in this folder.")
    _add_overwrite(ssp, "a file that exists")


def _sweep(add: Add) -> None:
    example = "softffd sweep press --vary stiffness.edge=500:2000:5:log --vary damping=0.1,0.2 --stop-time 1.5"
    sweep = add("sweep", "Run a scene or an FMU for every combination of some values; keep a table and a picture.", example)
    sweep.add_argument("what", metavar="SCENE|X.fmu", help=SCENE_OR_FMU)
    values = "Values of a parameter or input in its unit, or a list NAME=V1,V2; repeated: every combination."
    sweep.add_argument("--vary", action="append", required=True, metavar="NAME=FROM:TO:COUNT[:log]", help=values)
    measure = "Output at the end of each run, or max(NAME), min(NAME), mean(NAME) over it; may be repeated."
    sweep.add_argument("--measure", action="append", metavar="OUTPUT", help=measure)
    _add_run_options(sweep)
    _add_workers(sweep)
    _output(sweep, "DIR", "Folder for the results; default: softffd-sweep-NAME; the same sweep there is continued.")


def _fit(add: Add) -> None:
    example = "softffd fit press --data measured.csv --match plane.press.reaction.z --vary stiffness.edge --vary damping=0.5"
    fit = add("fit", "Fit parameters of a scene or an FMU to a measured curve; keep them with their standard errors.", example)
    _option(fit, "scenes", "SCENE|X.fmu", f"{SCENE_OR_FMU} Several: one for each --data.", nargs="+")
    repeated: dict[str, Any] = {"action": "append", "required": True}
    data = "CSV file of measured columns by the variables' names and in their units; inputs among them are played in; may be repeated."
    fit.add_argument("--data", **repeated, metavar="FILE.csv", help=data)
    _option(fit, "--match", "OUTPUT", "Output that was measured, and its column.", required=True)
    vary = "Parameter to fit, and its start in its unit; default: the start of the FMU; may be repeated."
    fit.add_argument("--vary", **repeated, metavar="NAME[=START]", help=vary)
    _option(fit, "--against", "NAME", "Input or output in the place of time, such as a displacement, and its column.")
    _switch(fit, "--recorded", "The data are outputs of a run, as result.csv: reactions are means of the steps that end at their times.")
    noise = "Standard deviation of each --data in the unit of the output; only their ratios count; default: all alike."
    fit.add_argument("--noise", type=_number, action="append", metavar="D", help=noise)
    _add_run_options(fit)
    _add_workers(fit)
    _output(fit, "DIR", "Folder for the results; default: softffd-fit-NAME.")
    _add_overwrite(fit, "the results of an earlier fit")


def _accuracy(add: Add) -> None:
    about = "Measure the error of every method against its run time; write a table, pictures and a report."
    accuracy = add("accuracy", about, "softffd accuracy free_vibration --quick")
    scenes = "Scene files, or names of shipped scenes; default: the standard set."
    accuracy.add_argument("scenes", nargs="*", metavar="SCENE", help=scenes)
    _output(accuracy, "DIR", "Folder for the report; default: softffd-accuracy.", Path("softffd-accuracy"))
    _option(accuracy, "--step", "H", "Communication step in s; default: each scene's own.", type=_number)
    _switch(accuracy, "--quick", "Make fewer and shorter runs, for a first look.")
    space = "Compare lattices and tolerances of the scenes, not methods: error against the continuum that finer lattices tend to."
    accuracy.add_argument("--space", action="store_true", help=space)


def _others(add: Add) -> None:
    drivers = add("drivers", "Make driver FMUs (plate, actuator) and a coupled system (SSP).", "softffd drivers -o drivers")
    _output(drivers, "DIR", "Folder to write to; default: this one.", Path("."))
    _add_overwrite(drivers, "files that exist")

    add("scenes", "List the shipped scenes.", "softffd scenes")

    about = "Open the interactive page of a run that was kept, or of several with one clock."
    view = add("view", about, "softffd view softffd-press softffd-press-2")
    runs = "Folder of softffd run, or file of Result.save; or a system and the CSV file of the rows that a host recorded of it."
    view.add_argument("what", type=Path, nargs="+", metavar="DIR|X.npz|X.ssp", help=runs)
    _option(view, "--mesh", "FILE", KEPT_MESH, type=Path)
    _switch(view, "--ssp", "Show the runs in one place, as components of a coupled run.")
    _output(view, "X.html", "File to write of several; default: A-B.html in this folder.")
    _add_overwrite(view, "a file that exists")

    about = "Write the page in which a scene is simulated in a browser, where obstacles, pins and the object are moved by hand."
    live = add("live", about, "softffd live press")
    live.add_argument("scene", metavar="SCENE", help=SCENE)
    _output(live, "X.html", "File to write; default: live.html in this folder.", Path("live.html"))
    _add_overwrite(live, "a file that exists")
    _switch(live, "--view", "Open the page when it is written.")

    about = "Write a run that was kept for another program: ParaView, Blender, a browser, slides."
    export = add("export", about, "softffd export softffd-press --to glb")
    _option(export, "what", "DIR|X.npz", "Folder of softffd run, or file of Result.save.", type=Path)
    _option(export, "--to", "FORMAT", "Format: vtkhdf, vtu, glb, usd, pc2, ply, gif or mp4; default: by the ending of --output.")
    _output(export, "FILE", "File to write; default: the run's name in this folder.")
    share = "Largest error of a vertex in glb, as a fraction of the largest side of the box; default: 0.001."
    export.add_argument("--tolerance", type=_number, metavar="T", help=share)
    _option(export, "--mesh", "FILE", KEPT_MESH, type=Path)
    _option(export, "--frames", "N", "Number of rows to take, evenly chosen; default: all.", type=int)
    _add_lattice(export, "gif and mp4")
    _add_overwrite(export, "files that exist")

    about = "List the variables of a scene or an FMU with causality, unit and start value, and the frames of its pins."
    info = add("info", about, "softffd info press")
    info.add_argument("what", metavar="SCENE|X.fmu", help=SCENE_OR_FMU)
    _switch(info, "--all", "List the variables of each control point too.")

    new = add("new", "Write a commented scene file to start from.", "softffd new mine")
    new.add_argument("name", help="Name of the scene; its file is NAME.toml in this folder.")
    _option(new, "--mesh", "FILE", "Mesh file that the scene drops on the ground.", type=Path)
    _add_mesh_options(new)

    add("schema", "Print the JSON schema of scene files, for editors.", "softffd schema > scene.schema.json")


def _option(parser: Any, name: str, kind: str, about: str, **more: Any) -> None:
    parser.add_argument(name, metavar=kind, help=about, **more)


def _output(parser: Parser, kind: str, about: str, default: Path | None = None) -> None:
    parser.add_argument("-o", "--output", type=Path, default=default, metavar=kind, help=about)


def _switch(parser: Any, name: str, about: str) -> None:
    parser.add_argument(name, action="store_true", help=about)


def _add_run_options(parser: Parser) -> None:
    _option(parser, "--stop-time", "T", "Time at which the run ends, in s.", type=_number)
    _option(parser, "--step", "H", "Communication step in s.", type=_number)
    _option(parser, "--tolerance", "T", "Error aimed at, as a fraction of the largest side of the box.", type=_number)
    _option(parser, "--method", "NAME", "Method of time integration, as solver.method in the scene.")
    start = "Start value of a variable in its unit; may be repeated."
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="settings", help=start)
    table = "CSV file of inputs over time: a column time in s, others by the inputs' names; default: the one beside the scene."
    driven = parser.add_mutually_exclusive_group()
    driven.add_argument("--input", type=Path, metavar="FILE.csv", help=table)
    _switch(driven, "--no-input", "Ignore the CSV file beside the scene: inputs keep their start values.")


def _add_workers(parser: Parser) -> None:
    where = parser.add_mutually_exclusive_group()
    where.add_argument("-j", "--jobs", type=int, metavar="J", help="Number of runs at a time; default: the number of processor cores.")
    _option(where, "--scheduler", "ADDRESS", "Address of the Dask cluster that does the runs, such as tcp://host:8786.")


def _add_overwrite(parser: Parser, what: str) -> None:
    _switch(parser, "--overwrite", f"Write over {what}.")


def _add_lattice(parser: Parser, where: str) -> None:
    shown = f"Show the lattice in {where}, or do not; default: where there is no mesh."
    parser.add_argument("--lattice", action=argparse.BooleanOptionalAction, help=shown)


def _add_mesh_options(parser: Parser) -> None:
    _option(parser, "--unit", "UNIT", "Unit of a mesh file: m, cm, mm, in or ft; default: by the file or its size.")
    _option(parser, "--up", "AXIS", "Axis of a mesh file that becomes +z: x, y or z; default: by the kind of file.")
    _option(parser, "--density", "D", "Density of a mesh in kg/m3; default: 100.", type=_number)
