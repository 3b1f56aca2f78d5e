"""What each part of a scene costs: variables, and time per internal step against the bare scene in the same run.

    python3 python/run.py bench [--picture FILE.png]

Every scene is the same 4 x 4 x 4 box with a fixed internal step; the bare one has no plane, damping, gravity, load or energy. Each is run
in turn with the bare one, several times over, and the smallest time of each counts; the ratio is what to read.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from softffd import Simulation
from softffd.fmu.package import package_fmu, scene_masses
from softffd.fmu.variables import variables
from softffd.scene.scene import load_scene

STEP, INTERVAL, INTERVALS, REPEATS = 1e-4, 0.1, 20, 7
BARE = """
[material]
stiffness = 1e3
damping = {damping}
volume_stiffness = {volume}
[initial]
stretch = [{stretch}]
[outputs]
reactions = {reactions}
energy = {energy}
[solver]
method = "leapfrog"
step = 1e-4
"""
DEFAULTS = {"damping": 0.0, "volume": 0.0, "stretch": "1.02, 1.0, 1.0", "reactions": "false", "energy": "false"}
GRAVITY = "[environment]\ngravity = [0.0, 0.0, -9.81]\n"
PLANE = '[[plane]]\nname = "ground"\npoint = [0.0, 0.0, {height}]\nnormal = [0.0, 0.0, 1.0]\nfriction = 0.4\n'
SCENES = {
    "bare: springs alone": ({}, ""),
    "damping": ({"damping": 0.01}, ""),
    "gravity": ({}, GRAVITY),
    "load": ({}, '[[load]]\nname = "push"\npoints = "x+"\n'),
    "64 force inputs": ({}, '[inputs]\nforces = "all"\n'),
    "energy outputs": ({"energy": "true"}, ""),
    "a plane out of reach": ({"reactions": "true"}, PLANE.format(height=-9.0)),
    "16 points resting on a plane": ({"reactions": "true"}, GRAVITY + PLANE.format(height=0.0)),
    "volume stiffness, body in shape": ({"volume": 9e3}, ""),
    "volume stiffness, all corners folded": ({"volume": 1e-6, "stretch": "1.02, 1.0, -1.0"}, ""),  # too soft to unfold
    "a pinned face": ({"reactions": "true"}, '[[pin]]\nname = "base"\npoints = "z-"\n'),
}


def main() -> None:
    """Prints the table, and draws it if asked to."""
    parser = argparse.ArgumentParser(prog="run.py bench", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--picture", type=Path, metavar="FILE.png", help="draw the table too")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        built = {name: _build(Path(folder), number, *parts) for number, (name, parts) in enumerate(SCENES.items())}
        bare = next(iter(built.values()))[0]
        print(f"{'scene':38} variables  us/step  ratio to bare")
        for name, (fmu, count) in built.items():
            own, base = _race(fmu, bare)
            rows.append((name, own * 1e6, own / base))
            print(f"{name:38} {count:9} {own * 1e6:8.2f} {own / base:8.2f}")
    if options.picture:
        _draw(rows, options.picture)


def _draw(rows: list[tuple[str, float, float]], path: Path) -> None:
    """A bar for each scene, as long as its ratio to the bare one."""
    from softffd.show.picture import INK, SOFT, new_figure

    figure = new_figure(8.5, 0.34 * len(rows) + 1.0, dpi=130)
    axes = figure.add_axes((0.38, 0.12, 0.56, 0.74))
    names, times, ratios = zip(*rows[::-1], strict=True)
    bars = axes.barh(names, ratios, color="#0072b2", height=0.6)
    axes.bar_label(
        bars, [f"{ratio:.2f}  ({microseconds:.1f} us)" for ratio, microseconds in zip(ratios, times, strict=True)], padding=4, color=INK
    )
    axes.axvline(1.0, color=SOFT, linewidth=1, linestyle=":")
    axes.set_xlim(0, 1.25 * max(ratios))
    axes.set_xlabel("time per internal step, in those of the bare scene", color=SOFT)
    axes.set_title(
        "What a scene uses is what it pays for: 4 x 4 x 4 control points, one core", loc="left", x=-0.66, color=INK, weight="bold"
    )
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(left=False)
    figure.savefig(path, dpi=figure.dpi)
    print(f"picture in {path}")


def _build(folder: Path, number: int, values: dict[str, object], text: str) -> tuple[Path, int]:
    source = folder / f"scene_{number}.toml"
    source.write_text(BARE.format(**DEFAULTS | values) + text)
    scene = load_scene(source)
    fmu = package_fmu(scene, folder / f"scene_{number}.fmu")
    return fmu, len(variables(scene, scene_masses(scene).mass))


def _race(fmu: Path, bare: Path) -> tuple[float, float]:
    times: dict[int, list[float]] = {0: [], 1: []}
    with Simulation(fmu) as own, Simulation(bare) as base:
        for _ in range(REPEATS):
            for which, simulation in enumerate((own, base)):
                times[which].append(_time_per_step(simulation))
    return min(times[0]), min(times[1])


def _time_per_step(simulation: Simulation) -> float:
    simulation.restart()
    simulation.step(INTERVAL)
    began = time.process_time()
    for _ in range(INTERVALS):
        simulation.step(INTERVAL)
    return (time.process_time() - began) / (INTERVALS * INTERVAL / STEP)


if __name__ == "__main__":
    main()
