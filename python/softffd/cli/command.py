"""The commands of `softffd`, and what each of them does; options.py defines what can be typed.

Each command imports what it needs itself: importing what reads scenes and runs them takes a third of a second.
"""

import argparse
import io
import json
import os
import shlex
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from softffd.cli.options import parse, run_options
from softffd.errors import Interrupted, SoftffdError
from softffd.files import require_new, require_writable, size_of, write_text
from softffd.run.progress import ProgressLine
from softffd.spelling import is_unicode


def main(arguments: list[str] | None = None) -> int:
    """Runs one command; returns its exit status: 0 success, 1 refused with a message on stderr, 2 wrong usage, 130 interrupted, 141 where
    nobody reads the output any more."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # for characters that the stream's encoding does not have
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] == ["stability"]:
        return exit_status(lambda: _tool(words))
    options = parse(words)
    return exit_status(lambda: COMMANDS[options.command](options))


def exit_status(command: Callable[[], object]) -> int:
    """Runs a command and returns its exit status, as `main` does; messages about errors and interrupts go to stderr."""
    try:
        command()
        sys.stdout.flush()
        return 0
    except SoftffdError as error:
        print(f"softffd: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the rest of the buffer goes to the null device
        return 141
    except OSError as error:
        print(f"softffd: {error.filename or ''}: {error.strerror or error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt as interrupt:
        print(f"softffd: interrupted; {str(interrupt) or 'no file was left half written'}", file=sys.stderr)
        return 130


def _tool(words: list[str]) -> None:
    """Runs a tool of the source tree, which no wheel contains. Raises SoftffdError outside of the source tree."""
    if not (find_spec("validation") and find_spec("validation.tools")):
        raise SoftffdError(f"{words[0]} is a tool of the sources, where it is run by: python3 python/run.py {shlex.join(words)}")
    import_module("validation.tools").run_tool(words)


def _mesh_options(options: argparse.Namespace) -> dict[str, Any]:
    return {"unit": options.unit, "up": options.up, "density": options.density}


def _demo(options: argparse.Namespace) -> None:
    from softffd.cli.keep import run_demo

    require_writable(options.output)
    run_demo(options.output, lattice=options.lattice)


def _build(options: argparse.Namespace) -> None:
    from softffd.fmu.notes import body_notes, size_warning
    from softffd.fmu.package import package_fmu, platform_notes, scene_masses, scene_samples
    from softffd.fmu.variables import variables
    from softffd.installed import least_glibc, libraries
    from softffd.scene.scene import load_scene

    scene = load_scene(options.scene)
    asked = f"{scene.name}.fmu" if options.output is None else options.output
    require_new([Path(asked)], "another name by -o X.fmu", overwrite=options.overwrite)
    require_writable(Path(asked).parent)
    with ProgressLine("packaging") as progress:
        extra = None
        if options.reference:
            from softffd.run.reference import reference_files

            progress.stage("simulating")
            extra = reference_files(scene, progress=progress)
        path = package_fmu(scene, asked, platforms=options.platform, fmi=options.fmi, extra=extra)
    masses = scene_masses(scene)
    print(f"{path}: {scene.title}")
    listed = variables(scene, masses.mass)
    count = sum(variable.count for variable in listed) if options.fmi == 2 else len(listed) + 1  # one more: time
    print(f"  {count} variables, {path.stat().st_size / 1024:.0f} kB, mass {masses.mass.sum():.6g} kg")
    needs = {name: least_glibc(library) for name, library in libraries(options.platform).items()}
    print("  runs on " + ", ".join(f"{name} with glibc {glibc} or newer" if glibc else name for name, glibc in needs.items()))
    for note in [*platform_notes(needs, options.fmi), *body_notes(scene, masses, scene_samples(scene))]:
        print(f"  {note}")
    if warning := size_warning(scene, count):
        print(f"  warning: {warning}")


def _run(options: argparse.Namespace) -> None:
    asked = run_options(options)
    wanted = folder = options.output or Path(f"softffd-{Path(options.what).stem}")
    interrupted = None
    with ProgressLine("packaging") as progress:
        from softffd.cli.keep import RESULTS, free_folder, keep_run, run_scene_or_fmu
        from softffd.cli.told import told_after, told_before

        if options.output:
            require_new([folder / name for name in RESULTS], "another folder by -o DIR", overwrite=options.overwrite)
        elif not options.overwrite:
            folder = free_folder(wanted)
        require_writable(folder)

        def begun(simulation: Any, inputs: Any) -> None:
            progress.say(told_before(simulation, inputs))
            progress.stage("simulating")

        try:
            result = run_scene_or_fmu(
                options.what, error=options.error, of_mesh=_mesh_options(options), interpolation=options.interpolation,
                progress=progress, begun=begun, **asked,
            )  # fmt: skip
        except Interrupted as stop:
            result, interrupted = stop.result, stop
        files = keep_run(result, folder, progress.stage, pictures=not options.no_pictures, colour=options.colour, lattice=options.lattice)
    print(told_after(result.summary))
    beside = f" ({wanted} is there already; --overwrite writes over it)" if folder != wanted else ""
    print(f"  kept in {folder}: {', '.join(file.name for file in files)}{beside}")
    if interrupted:
        reached, wanted = result.summary["simulated_time_s"], result.summary["interrupted_before_s"]
        raise KeyboardInterrupt(f"at {reached:g} s of {wanted:g} s; what was simulated until then is kept in {folder}")
    if options.view:
        import webbrowser

        webbrowser.open((folder / "view.html").resolve().as_uri())


def _many(options: argparse.Namespace) -> None:
    from softffd.cli.many import run_fit, run_sweep

    (run_sweep if options.command == "sweep" else run_fit)(options)


def _ssp(options: argparse.Namespace) -> None:
    from softffd.cli.coupled import write_coupled

    with ProgressLine("packaging"):
        written = write_coupled(options)
    print(written)


def _accuracy(options: argparse.Namespace) -> None:
    from softffd.accuracy.command import report_accuracy
    from softffd.accuracy.space_report import report_space

    if options.space and not options.scenes:
        raise SoftffdError("softffd accuracy --space: wanted a SCENE; those of the standard set are of springs that belong to one lattice")
    require_writable(options.output)
    report = report_space if options.space else report_accuracy
    with ProgressLine("measuring") as progress:
        report(options.scenes, options.output, step=options.step, quick=options.quick, note=progress.note, say=progress.say)
    pictures = "accuracy.png" if options.space else "a picture of each scene"
    print(f"kept in {options.output}: report.html, accuracy.csv, accuracy.json, {pictures}")


def _drivers(options: argparse.Namespace) -> None:
    from softffd.drivers import DRIVERS, build_drivers
    from softffd.drivers.coupled import write_plate_ssp

    require_writable(options.output)
    system = options.output / "plate_on_box.ssp"
    require_new([*(options.output / f"{name}.fmu" for name in DRIVERS), system], "another folder by -o DIR", overwrite=options.overwrite)
    for path in [*build_drivers(options.output), write_plate_ssp(system)]:
        print(path)


def _scenes(_options: argparse.Namespace) -> None:
    from softffd.scene.document import shipped_scenes
    from softffd.scene.scene import load_scene

    names = shipped_scenes()
    width = max(map(len, names))
    for name in names:
        print(f"{name:{width}}  {load_scene(name).title}")


def _new(options: argparse.Namespace) -> None:
    from softffd.scene.new import scene_of_mesh, template

    path = Path(options.name if options.name.lower().endswith(".toml") else f"{options.name}.toml")
    if not path.name.removesuffix(".toml").strip(". "):
        raise SoftffdError(f'"{options.name}": wanted the name of a scene, e.g. softffd new mine')
    if not is_unicode(options.name):
        raise SoftffdError(f"{os.fsencode(options.name)!r}: wanted a name in UTF-8, e.g. softffd new mine")
    if path.exists():
        raise SoftffdError(f"{path}: exists already; wanted a new name")
    if options.mesh is not None:
        with ProgressLine("reading the mesh"):
            made = scene_of_mesh(options.mesh, folder=path.parent, **_mesh_options(options))
        print(made.said)
    elif given := [key for key, value in _mesh_options(options).items() if value is not None]:
        raise SoftffdError(f"--{given[0]}: wanted with --mesh FILE")
    write_text(path, template(path.stem) if options.mesh is None else made.text)
    print(f"{path}: edit it, then: softffd run {shlex.quote(str(path))}")


def _view(options: argparse.Namespace) -> None:
    import webbrowser

    from softffd.cli.view import page_to_view

    with ProgressLine("reading the runs") as progress:
        page = page_to_view(
            options.what,
            options.output,
            overwrite=options.overwrite,
            together=options.ssp,
            mesh=options.mesh,
            stage=progress.stage,
            say=progress.say,
        )
    print(page)
    webbrowser.open(page.resolve().as_uri())


def _live(options: argparse.Namespace) -> None:
    from softffd.scene.scene import load_scene
    from softffd.show.live.page import write_live

    page: Path = options.output
    require_writable(page.parent)
    require_new([page], "another name by -o X.html", overwrite=options.overwrite)
    with ProgressLine("reading the scene") as progress:
        write_live(load_scene(options.scene), page, stage=progress.stage, progress=progress)
    print(f"{page}: {page.stat().st_size / 1e6:.2f} MB; it needs nothing but a browser")
    if options.view:
        import webbrowser

        webbrowser.open(page.resolve().as_uri())


def _export(options: argparse.Namespace) -> None:
    from softffd.cli.view import kept_result
    from softffd.export.formats import FORMATS, export_result, format_of

    name = format_of(options.output, options.to)
    path = options.output or Path(options.what.resolve().stem if options.what.is_file() else options.what.resolve().name)
    files = [next(file.iterdir(), file) if file.is_dir() else file for file in FORMATS[name].files(path)]
    require_new(files, "another name by -o FILE", overwrite=options.overwrite)
    asked = {"to": name, "tolerance": options.tolerance, "frames": options.frames, "lattice": options.lattice}
    with ProgressLine("reading the result") as progress:
        result = kept_result(options.what, options.mesh, progress.say)
        progress.stage(f"exporting to {name}")
        files = export_result(result, path, **asked, note=progress.note, say=lambda line: progress.say(f"  {line}"))
    print("\n".join(f"{file}: {size_of(file) / 1024:,.0f} kB" for file in files))


def _info(options: argparse.Namespace) -> None:
    from softffd.cli.told import told_info
    from softffd.fmu.component import Component
    from softffd.run.simulation import run_source

    what = run_source(options.what, "softffd info")
    with ProgressLine("packaging"):
        component = Component(what, running=False)
    with component:
        print(told_info(component, every=options.all))


def _schema(_options: argparse.Namespace) -> None:
    from softffd.scene.keys import schema

    print(json.dumps(schema(), indent=2))


COMMANDS: dict[str, Callable[[argparse.Namespace], None]] = {
    "demo": _demo, "build": _build, "run": _run, "ssp": _ssp, "sweep": _many, "fit": _many, "accuracy": _accuracy,
    "drivers": _drivers, "scenes": _scenes, "view": _view, "live": _live, "export": _export, "info": _info, "new": _new,
    "schema": _schema,
}  # fmt: skip
