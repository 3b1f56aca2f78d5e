"""`softffd demo`: the shipped scene car_drop from its file to numbers, pictures and an interactive page; and car_bump, shown."""

from pathlib import Path

from softffd.cli.keep import keep_run, run_scene_or_fmu
from softffd.cli.told import told_after
from softffd.errors import SoftffdError
from softffd.fmu.package import package_fmu
from softffd.installed import wasm_library
from softffd.run.progress import ProgressLine
from softffd.run.simulate import simulate
from softffd.scene.scene import load_scene
from softffd.show.live.page import write_live


def _live_page(path: Path, progress: ProgressLine) -> Path | None:
    """The live page of car_drop; None where this installation has no library for web pages."""
    try:
        wasm_library()
    except SoftffdError:
        return None
    return write_live("car_drop", path, stage=progress.stage, progress=progress)


def run_demo(folder: Path, *, lattice: bool | None = None) -> None:
    """Builds, runs and shows the car in `folder`, saying what it does. lattice: of the pictures, as in `Result.plot`."""
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
        page = _live_page(folder / "live.html", progress)
    print(f"  picture: {folder / 'picture.png'}")
    print(f"  to play and turn it in a browser: {folder / 'view.html'}")
    if page:
        print(f"  to crush it by hand in a browser: {page}")
    print(f"  {struck.title}: {folder / 'bump.png'}, {folder / 'bump.html'}")
    print(f"  the last shape as a mesh: {folder / 'deformed.obj'}; numbers: {folder / 'result.csv'}, {folder / 'summary.json'}")
