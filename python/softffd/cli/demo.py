"""`softffd demo`: the shipped scene car_drop from its file to numbers, pictures and an interactive page."""

from __future__ import annotations

from pathlib import Path

from softffd.cli.keep import keep_run, run_mesh, run_scene_or_fmu
from softffd.fmu.package import package_fmu
from softffd.run.progress import ProgressLine
from softffd.scene.scene import load_scene
from softffd.show.picture import draw_history, draw_strip


def run_demo(folder: Path) -> None:
    """Builds, runs and shows the car in `folder`, saying what it does."""
    scene = load_scene("car_drop")
    print(scene.title)
    fmu = package_fmu(scene, folder / "car_drop.fmu")
    print(f"  FMU: {fmu}")
    with ProgressLine("simulating") as progress:
        result = run_scene_or_fmu("car_drop", progress=progress)
    summary = result.summary
    print(
        f"  {summary['simulated_time_s']:g} s simulated in {summary['run_time_s']:.3g} s: "
        f"{summary['real_time_factor']:.0f} times faster than real time"
    )
    for line in summary["findings"]:
        print(f"  {line}")
    print("  drawing ...", flush=True)
    keep_run(result, folder)
    draw_strip(result, folder / "strip.png", mesh=run_mesh(result))
    draw_history(result, folder / "history.png")
    print(f"  pictures: {folder / 'strip.png'}, {folder / 'history.png'}, {folder / 'picture.png'}")
    print(f"  to play and turn it in a browser: {folder / 'view.html'}")
    print(f"  the last shape as a mesh: {folder / 'deformed.obj'}; numbers: {folder / 'result.csv'}, {folder / 'summary.json'}")
