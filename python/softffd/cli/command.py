"""The command line: softffd demo | build | run | accuracy | stability | drivers | scenes | new | schema."""

from __future__ import annotations

import argparse
import json
import os
import shlex
import sys
import webbrowser
from pathlib import Path
from typing import Any

from softffd import __version__
from softffd.errors import FmuError, Interrupted, SoftffdError
from softffd.run.inputs import Inputs
from softffd.run.progress import ProgressLine
from softffd.run.result import require_writable
from softffd.run.simulation import Simulation
from softffd.scene.of_mesh import scene_of_mesh
from softffd.scene.scene import load_scene, schema, shipped_scenes
from softffd.scene.template import template


def main(arguments: list[str] | None = None) -> int:
    """Runs one command; returns its exit status: 0 success, 1 refused with a message on stderr, 2 wrong usage, 130 interrupted, 141 where
    nobody reads the output any more."""
    options = _parser().parse_args(arguments)
    try:
        options.command(options)
        sys.stdout.flush()
        return 0
    except SoftffdError as error:
        print(f"softffd: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left in the buffer goes there
        return 141
    except OSError as error:
        print(f"softffd: {error.filename or ''}: {error.strerror or error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt as interrupt:
        print(f"softffd: interrupted; {str(interrupt) or 'no file was left half written'}", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="softffd", description=sys.modules["softffd"].__doc__)
    parser.add_argument("--version", action="version", version=f"softffd {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    demo = commands.add_parser("demo", help="a car falls and is pushed in: build, simulate, pictures, interactive page")
    demo.add_argument("-o", "--output", type=Path, default=Path("softffd-demo"), metavar="DIR")
    demo.set_defaults(command=_demo)

    build = commands.add_parser("build", help="make the FMU of a scene")
    build.add_argument("scene", help="a scene file or the name of a shipped scene")
    build.add_argument("-o", "--output", metavar="X.fmu", help="default: NAME.fmu here")
    build.add_argument("--platform", action="append", metavar="NAME", help="FMI platform to carry, e.g. linux64; may be repeated")
    build.add_argument(
        "--fmi", type=int, choices=(2, 3), default=2, help="version of the standard: 2 (default), or 3, whose variables are arrays"
    )
    build.set_defaults(command=_build)

    run = commands.add_parser("run", help="simulate a scene, a mesh or an FMU and keep results and pictures")
    run.add_argument(
        "what",
        metavar="SCENE|MESH|X.fmu",
        help="a scene file, a shipped scene's name, a mesh to drop on the ground, or an FMU",
    )
    _add_mesh_options(run)
    run.add_argument("--stop-time", type=float, metavar="T", help="s")
    run.add_argument("--step", type=float, metavar="H", help="communication step, s")
    run.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="settings", help="start value of a variable")
    run.add_argument("--input", type=Path, metavar="FILE.csv", help="inputs over time: columns time and names of inputs")
    run.add_argument("--no-input", action="store_true", help="without the CSV beside the scene: inputs keep their start values")
    run.add_argument("--interpolation", default="held", metavar="HOW", help="of inputs inside a step: held (default), linear or cubic")
    run.add_argument("--error", action="store_true", help="estimate the error of the run by a second one beside it")
    run.add_argument("-o", "--output", type=Path, metavar="DIR", help="default: softffd-NAME here")
    run.add_argument("--overwrite", action="store_true", help="write over the results of an earlier run")
    run.add_argument("--view", action="store_true", help="open the interactive page when done")
    run.set_defaults(command=_run)

    accuracy = commands.add_parser("accuracy", help="measure error against run time of every method: table, pictures, report")
    accuracy.add_argument("scenes", nargs="*", metavar="SCENE", help="scene files or names of shipped ones; default: the standard set")
    accuracy.add_argument("-o", "--output", type=Path, default=Path("softffd-accuracy"), metavar="DIR")
    accuracy.add_argument("--step", type=float, metavar="H", help="communication step, s; default: each scene's own")
    accuracy.add_argument("--scipy", action="store_true", help="SciPy's solvers on the same equations beside the FMU's methods")
    accuracy.add_argument("--quick", action="store_true", help="fewer and shorter runs: a first look")
    accuracy.add_argument("--repeats", type=int, default=5, metavar="N", help="of each run, the smallest time counts; default 5")
    accuracy.set_defaults(command=_accuracy)

    stability = commands.add_parser(
        "stability", help="run stiff and extreme scenes and judge each by an oracle: map, table, report",
        epilog="example: softffd stability --random 200 --seed 1 -j 2 runs 200 scenes drawn at random, those of the seeds 1 to 200, on two "
        "cores; softffd stability --random 1 --seed 17 runs the one of seed 17 again",
    )  # fmt: skip
    stability.add_argument("-o", "--output", type=Path, default=Path("softffd-stability"), metavar="DIR")
    stability.add_argument("--quick", action="store_true", help="some cases and a coarse map: a first look")
    stability.add_argument("--only", nargs="+", default=[], metavar="NAME", help='"map", "cases", or parts of the names of cases')
    stability.add_argument("--slowness", type=float, default=1.0, metavar="FACTOR", help="cases may take so many times longer")
    stability.add_argument(
        "--random", type=int, metavar="N", help="N scenes drawn at random instead, in which auto is judged by tight runs"
    )
    stability.add_argument("--seed", type=int, default=1, metavar="S", help="of the first of them, the next has S + 1; default 1")
    stability.add_argument("-j", "--jobs", type=int, metavar="J", help="scenes at a time; default: the number of cores")
    stability.set_defaults(command=_stability)

    drivers = commands.add_parser("drivers", help="make driver FMUs (plate, actuator) and a coupled system (SSP)")
    drivers.add_argument("-o", "--output", type=Path, default=Path("."), metavar="DIR")
    drivers.set_defaults(command=_drivers)

    scenes = commands.add_parser("scenes", help="list the shipped scenes")
    scenes.set_defaults(command=_scenes)

    new = commands.add_parser("new", help="write a commented scene file to start from")
    new.add_argument("name", help="NAME of the scene; writes NAME.toml here")
    new.add_argument("--mesh", type=Path, metavar="FILE", help="of this mesh, dropped on the ground")
    _add_mesh_options(new)
    new.set_defaults(command=_new)

    printed = commands.add_parser("schema", help="print the JSON schema of scene files, for editors")
    printed.set_defaults(command=lambda options: print(json.dumps(schema(), indent=2)))
    return parser


def _add_mesh_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--unit", metavar="UNIT", help="of a mesh file: m, cm, mm, in or ft; default: by the file or its size")
    parser.add_argument("--up", metavar="AXIS", help="axis of a mesh file that becomes +z: x, y or z; default: by the kind of file")
    parser.add_argument("--density", type=float, metavar="D", help="of a mesh, kg/m3; default 100")


def _mesh_options(options: argparse.Namespace) -> dict[str, Any]:
    return {"unit": options.unit, "up": options.up, "density": options.density}


def _demo(options: argparse.Namespace) -> None:
    from softffd.cli.demo import run_demo

    require_writable(options.output)
    run_demo(options.output)


def _build(options: argparse.Namespace) -> None:
    from softffd.fmu.arrays import array_variables
    from softffd.fmu.package import package_fmu, scene_masses
    from softffd.fmu.variables import size_warning, variables

    scene = load_scene(options.scene)
    path = package_fmu(
        scene, f"{scene.name}.fmu" if options.output is None else options.output, platforms=options.platform, fmi=options.fmi
    )
    masses = scene_masses(scene)
    print(f"{path}: {scene.title}")
    count = len(variables(scene, masses.mass)) if options.fmi == 2 else len(array_variables(scene, masses.mass)) + 1  # and time
    print(f"  {count} variables, {path.stat().st_size / 1024:.0f} kB, mass {masses.mass.sum():.6g} kg")
    if masses.shift.any():
        shift = ", ".join(f"{value:.3g}" for value in masses.shift)
        print(f"  mass.uniform_share moves the centre of mass by ({shift}) m")
    if warning := size_warning(scene, count):
        print(f"  warning: {warning}")


def _run(options: argparse.Namespace) -> None:
    from softffd.cli.keep import keep_run, require_no_results, run_scene_or_fmu
    from softffd.cli.told import told_after, told_before

    settings = dict(_setting(text) for text in options.settings)
    folder = options.output or Path(f"softffd-{Path(options.what).stem}")
    require_writable(folder)
    if not options.overwrite:
        require_no_results(folder)
    interrupted = None
    with ProgressLine("packaging") as progress:

        def begun(simulation: Simulation, inputs: Inputs) -> None:
            progress.say(told_before(simulation, inputs))
            progress.stage("simulating")

        try:
            result = run_scene_or_fmu(
                options.what, stop_time=options.stop_time, step=options.step, settings=settings,
                inputs="" if options.no_input else options.input, interpolation=options.interpolation, error=options.error,
                progress=progress, begun=begun, of_mesh=_mesh_options(options),
            )  # fmt: skip
        except Interrupted as stop:
            result, interrupted = stop.result, stop
        files = keep_run(result, folder, progress.stage)
    print(told_after(result.summary))
    print(f"  kept in {folder}: {', '.join(file.name for file in files)}")
    if interrupted:
        reached, wanted = result.summary["simulated_time_s"], result.summary["interrupted_before_s"]
        raise KeyboardInterrupt(f"at {reached:g} s of {wanted:g} s; what was simulated until then is kept in {folder}")
    if options.view:
        webbrowser.open((folder / "view.html").resolve().as_uri())


def _setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise FmuError(f"--set {text}: wanted NAME=VALUE, e.g. --set mass=2")
    return name.strip(), value.strip()


def _accuracy(options: argparse.Namespace) -> None:
    from softffd.validation.accuracy.command import report_accuracy

    if options.repeats < 1:
        raise SoftffdError(f"--repeats {options.repeats}: wanted at least 1")
    require_writable(options.output)
    with ProgressLine("measuring") as progress:
        report_accuracy(
            options.scenes, options.output, step=options.step, scipy=options.scipy, quick=options.quick, repeats=options.repeats,
            note=progress.note, say=progress.say,
        )  # fmt: skip
    print(f"kept in {options.output}: report.html, accuracy.csv, accuracy.json, a picture of each scene")


def _stability(options: argparse.Namespace) -> None:
    from softffd.validation.stability.command import report_stability

    require_writable(options.output)
    if options.random is not None:
        _random(options)
        return
    with ProgressLine("running") as progress:
        report_stability(
            options.output, only=options.only, quick=options.quick, slowness=options.slowness, processes=_jobs(options), note=progress.note,
            say=progress.say,
        )  # fmt: skip
    print(f"kept in {options.output}: report.html, stability.csv, stability.json, pictures of the map")


def _jobs(options: argparse.Namespace) -> int:
    return (os.cpu_count() or 1) if options.jobs is None else options.jobs


def _random(options: argparse.Namespace) -> None:
    from softffd.validation.stability.drawn_survey import report_random

    if options.only or options.quick:
        raise SoftffdError("--random: wanted without --only and --quick, which choose among the cases; --seed S --random 1 runs one scene")
    with ProgressLine("running") as progress:
        report_random(
            options.output, options.random, options.seed, processes=_jobs(options), slowness=options.slowness, note=progress.note,
            say=progress.say,
        )  # fmt: skip
    print(f"kept in {options.output}: random.csv, random.json")


def _drivers(options: argparse.Namespace) -> None:
    from softffd.drivers import build_drivers
    from softffd.drivers.coupled import write_ssp

    require_writable(options.output)
    for path in [*build_drivers(options.output), write_ssp(options.output / "plate_on_box.ssp")]:
        print(path)


def _scenes(_options: argparse.Namespace) -> None:
    names = shipped_scenes()
    width = max(map(len, names))
    for name in names:
        print(f"{name:{width}}  {load_scene(name).title}")


def _new(options: argparse.Namespace) -> None:
    path = Path(options.name if options.name.endswith(".toml") else f"{options.name}.toml")
    if not path.name.removesuffix(".toml").strip(". "):
        raise SoftffdError(f'"{options.name}": wanted the name of a scene, e.g. softffd new mine')
    if path.exists():
        raise SoftffdError(f"{path}: exists already; wanted a new name")
    if options.mesh is not None:
        made = scene_of_mesh(options.mesh, folder=path.parent, **_mesh_options(options))
        print(made.said)
    elif given := [key for key, value in _mesh_options(options).items() if value is not None]:
        raise SoftffdError(f"--{given[0]}: wanted with --mesh FILE")
    path.write_text(template(path.stem) if options.mesh is None else made.text, encoding="utf-8")
    print(f"{path}: edit it, then: softffd run {shlex.quote(str(path))}")
