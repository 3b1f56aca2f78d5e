"""`softffd run`: from a name to a result with its findings, and to the files that keep it; and `softffd demo`, which shows all that."""

import re
import shlex
import tomllib
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

from softffd.cli.told import told_after
from softffd.errors import FmuError, Interrupted, SoftffdError
from softffd.fmu.component import Component
from softffd.fmu.package import package_fmu
from softffd.installed import has_wasm_library
from softffd.mesh.files import READ, WRITTEN, save_mesh
from softffd.mesh.habits import usual_up
from softffd.run.findings import ESTIMATE, findings
from softffd.run.inputs import Source
from softffd.run.progress import Note, ProgressLine, silent
from softffd.run.result import Result
from softffd.run.result_file import KEPT
from softffd.run.simulate import simulate
from softffd.run.tables import read_csv
from softffd.scene.new import scene_of_mesh
from softffd.scene.scene import Scene, load_scene, scene_from
from softffd.show.live.scene import is_recording, live_scene
from softffd.show.touch import narrow_contact

RESULTS = (KEPT, "result.csv", "summary.json")  # the files that every run is kept in
SHOWN = re.compile(rf"picture\.png|view\.html|deformed(_\d+)?\.png|deformed\.mtl|deformed({'|'.join(map(re.escape, WRITTEN))})")
"""Other files that a run may be kept in"""


def run_scene_or_fmu(
    what: str | Path, *, inputs: Source | None = None, error: bool = False, of_mesh: dict[str, Any] | None = None, **asked: Any
) -> Result:
    """Runs a scene file, a shipped scene, a mesh that falls on the ground, or an FMU; returns the result with its findings.

    inputs: as `simulate` takes them; by default a scene's own inputs (NAME.csv beside the scene) drive it.
    error: also estimate the error at the end, in the summary as estimated_error_m; an FMU must have been built with the estimate.
    of_mesh: unit, up and density of a mesh file, see `scene_of_mesh`. asked: further arguments of `simulate`.
    """
    given = {key: value for key, value in (of_mesh or {}).items() if value is not None}
    is_mesh = Path(what).suffix.lower() in READ
    if given and not is_mesh:
        raise SoftffdError(f"--{next(iter(given))}: wanted with a mesh file, got {what}; a scene says it in [mesh] and [mass]")
    scene_or_fmu = _mesh_scene(Path(what), error, given) if is_mesh else _opened(what, error)
    if inputs is None and is_mesh:
        inputs = {}
    if isinstance(inputs, Path) and isinstance(scene_or_fmu, Scene) and is_recording(inputs):
        scene_or_fmu = live_scene(scene_or_fmu)
        asked = asked | {"open_end": True, "stop_time": asked.get("stop_time") or float(read_csv(inputs)["time"][-1])}
        print(f"{inputs}: recorded by softffd live; the scene runs as it did there, with inputs of its own", flush=True)
    try:
        return _with_findings(simulate(scene_or_fmu, inputs=inputs, **asked))
    except Interrupted as interrupt:
        raise Interrupted(_with_findings(interrupt.result)) from None


def _with_findings(result: Result) -> Result:
    found, contact = findings(result), narrow_contact(result)
    return replace(result, summary=result.summary | found | contact | {"findings": found["findings"] + contact["findings"]})


def _opened(what: str | Path, error: bool) -> Scene | Path:
    """Returns the scene or the path of the FMU, with the error estimate if asked for. Raises FmuError for an FMU without the estimate."""
    if Path(what).suffix.lower() != ".fmu":
        scene = load_scene(what)
        return scene.replace({"solver.error_estimate": True}) if error else scene
    path = Path(what)
    if error:
        with Component(path, running=False) as component:
            if ESTIMATE not in component.by_name:
                raise FmuError(
                    f"--error: {path} has no variable {ESTIMATE}; wanted an FMU whose scene says error_estimate = true in [solver]: "
                    "rebuild it with that, or run the scene itself with --error"
                )
    return path


def _mesh_scene(file: Path, error: bool, given: dict[str, Any]) -> Scene:
    """Returns the scene of a mesh, after printing what is assumed about the mesh."""
    made = scene_of_mesh(file, folder=file.parent, **given)
    change = f"softffd new {shlex.quote(file.stem)} --mesh {shlex.quote(str(file))}"
    print(f"{made.said}\n  to change what is assumed of it: {change}", flush=True)
    scene = scene_from(tomllib.loads(made.text), path=file.with_suffix(".toml"))
    return scene.replace({"solver.error_estimate": True}) if error else scene


def keep_run(
    result: Result, folder: Path, stage: Note = silent, *, pictures: bool = True, colour: str | None = None, lattice: bool | None = None
) -> list[Path]:
    """Writes results, picture, interactive page and, for a scene with a mesh, the mesh's last shape; returns the files.

    stage: receives what is being done. pictures: write picture and page.
    Files that an earlier run left in the folder are removed first.
    colour, lattice: of the picture, as in `Result.plot`.
    An interrupt after the numbers are written raises KeyboardInterrupt that says so.
    """
    stage("writing the numbers")
    if not result.has_positions:
        result.summary["findings"].append('no pictures: they need outputs.positions = "all"')
    _remove_shown(result, folder)
    files = result.save(folder)
    try:
        return files + (_show(result, folder, stage, pictures, colour, lattice) if result.has_positions else [])
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"what was simulated is kept in {folder}, but not all that shows it") from None


def _show(result: Result, folder: Path, stage: Note, pictures: bool, colour: str | None, lattice: bool | None) -> list[Path]:
    files, mesh = [], result.loaded_mesh
    picture, page = folder / "picture.png", folder / "view.html"
    if pictures:
        stage("drawing picture.png")
        result.plot(picture, colour=colour, lattice=lattice)
        stage("writing view.html")
        result.view(page, browser=False)
        files += [picture, page]
    if mesh and result.scene and result.scene.mesh:
        kind = result.scene.mesh.file.suffix.lower()
        path = folder / f"deformed{kind if kind in WRITTEN else '.glb'}"
        stage(f"deforming the mesh for {path.name}")
        save_mesh(mesh, path, vertices=result.deformed(), up=usual_up(path))
        files.append(path)
    return files


def _remove_shown(result: Result, folder: Path) -> None:
    """Removes what an earlier run showed in the folder, so that none of it stands beside other numbers; keeps this run's own mesh."""
    if not any((folder / name).exists() for name in RESULTS):
        return
    source = result.scene.mesh.file.resolve() if result.scene and result.scene.mesh else None
    for old in folder.glob("*"):
        if SHOWN.fullmatch(old.name) and not (source and source.parent == folder.resolve() and source.stem == old.stem):
            old.unlink()


def free_folder(folder: Path) -> Path:
    """Returns the folder, or the first of NAME-2, NAME-3, ... that does not exist or is empty: a run is kept beside earlier ones."""
    names = (folder if number == 1 else folder.with_name(f"{folder.name}-{number}") for number in count(1))
    return next(name for name in names if not name.exists() or (name.is_dir() and not any(name.iterdir())))


# ---- softffd demo ----


def run_demo(folder: Path, *, lattice: bool | None = None) -> None:
    """Builds, runs and shows the car in `folder`, and prints what it does. lattice: of the pictures, as in `Result.plot`."""
    from softffd.show.live.page import write_live  # large imports, which runs do not need

    scene = load_scene("car_drop")
    print(scene.title)
    with ProgressLine("packaging") as progress:
        progress.say(f"  FMU: {package_fmu(scene, folder / 'car_drop.fmu')}")
        progress.stage("simulating")
        result = run_scene_or_fmu("car_drop", progress=progress)
        progress.say(told_after(result.summary))
        keep_run(result, folder, progress.stage, lattice=lattice)
        progress.stage("simulating car_bump")
        struck = simulate("car_bump")
        progress.stage("drawing bump.png, writing bump.html")
        struck.plot(folder / "bump.png", lattice=lattice)
        struck.view(folder / "bump.html", browser=False)
        page = folder / "live.html"
        live = has_wasm_library() and write_live("car_drop", page, stage=progress.stage, progress=progress)
    print(f"  picture: {folder / 'picture.png'}")
    print(f"  to play and turn it in a browser: {folder / 'view.html'}")
    if live:
        print(f"  to crush it by hand in a browser: {live}")
    print(f"  {struck.title}: {folder / 'bump.png'}, {folder / 'bump.html'}")
    print(f"  the last shape as a mesh: {folder / 'deformed.obj'}; numbers: {folder / 'result.csv'}, {folder / 'summary.json'}")
