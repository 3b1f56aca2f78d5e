"""Rows for files that are written or loaded: FMUs, pictures, the package itself."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as Xml

from measured import Pair, row

import softffd
from softffd.scene.scene import scene_from


@row("files", "an FMU of 32^3, all positions", "ElementTree and zipfile", every_set=False, long=True)
def large_fmu() -> Iterator[Pair]:
    """98,000 variables: masses, description, archive. The baseline makes the description's elements one by one and compresses all files."""
    scene = scene_from({"lattice": {"points": [32] * 3, "basis": "bspline"}})
    with tempfile.TemporaryDirectory() as folder:
        fmu = softffd.package_fmu(scene, Path(folder) / "box.fmu")
        with zipfile.ZipFile(fmu) as archive:
            others = {name: archive.read(name) for name in archive.namelist()}
        root = Xml.fromstring(others.pop("modelDescription.xml"))

        def plain() -> None:
            with zipfile.ZipFile(Path(folder) / "plain.fmu", "w", zipfile.ZIP_DEFLATED) as archive:
                archive.writestr("modelDescription.xml", Xml.tostring(made_anew(root)))
                for name, content in others.items():
                    archive.writestr(name, content)

        yield Pair(lambda: softffd.package_fmu(scene, fmu), plain)


def made_anew(element: Xml.Element) -> Xml.Element:
    """Returns a copy, made element by element."""
    copy = Xml.Element(element.tag, dict(element.attrib))
    copy.text = element.text
    copy.extend([made_anew(child) for child in element])
    return copy


@row("files", "a picture of a run", "matplotlib's plot_trisurf, four times", every_set=False)
def picture() -> Iterator[Pair]:
    """Draws the car at four moments; only the program's picture has curves and lattice."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    scene = softffd.load_scene("car_drop")
    result = softffd.simulate(scene, stop_time=0.3, inputs=scene.default_inputs)
    faces = result.loaded_mesh.faces
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"

        def plain() -> None:
            figure = Figure(figsize=(13.0, 7.6), dpi=130)
            FigureCanvasAgg(figure)
            for n in range(4):
                axes = figure.add_subplot(1, 4, n + 1, projection="3d")
                axes.plot_trisurf(*result.deformed(row=n * (len(result.time) - 1) // 3).T, triangles=faces)
            figure.savefig(file)

        yield Pair(lambda: result.plot(file), plain)


@row("files", "import softffd", "import numpy", every_set=False)
def importing() -> Iterator[Pair]:
    """Imports each package in a new interpreter."""

    def imported(words: str) -> float:
        program = f"import time; began = time.process_time(); {words}; print(time.process_time() - began)"
        return float(subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout)

    yield Pair(lambda: imported("import softffd"), lambda: imported("import numpy"))
