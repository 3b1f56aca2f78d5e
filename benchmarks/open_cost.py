"""What a run costs beside its steps, and what an FMU costs: processor time against the archive's way in the same run.

    .venv/bin/python benchmarks/open_cost.py

A run of one communication step of the shipped `press`: from the scene (its folder is written, the installed library is loaded), and from
its FMU (packed, unpacked, its XML read), which is how scenes ran before. Packing with the library compressed at build time, and with
zipfile compressing it anew. The same with a library for each of four platforms installed (copies of this machine's one). Last, importing
softffd against importing numpy and fmpy's ctypes layer, each in a process of its own. Smallest of several
times; the ratios are what to read.

Predicted: of 70 ms for a run of one step 40 were compression, 8 unpacking, 8 reading XML; left are the masses, the text of 250 variables
and binding 34 functions, 15 ms: 0.2. Packing without compression leaves the texts' own: 0.2. The import of nothing but a table: below 0.1.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import softffd
from softffd import installed
from softffd.fmu.package import scene_texts

REPEATS = 15


def main() -> None:
    """Prints the table."""
    scene = softffd.load_scene("press")
    step = scene.experiment.communication_step
    with tempfile.TemporaryDirectory() as folder:
        fmu = Path(folder) / "press.fmu"

        def pack() -> None:
            softffd.package_fmu(scene, fmu)

        def run_scene() -> None:
            softffd.simulate(scene, stop_time=step)

        def pack_anew() -> None:
            compress_all(scene, fmu)

        def run_packed() -> None:
            compress_all(scene, fmu)
            softffd.simulate(fmu, stop_time=step)

        print(f"{'':44} ms of processor time   ratio")
        show("one step of an FMU that is packed first", run_packed, run_packed)
        show("one step of the scene", run_scene, run_packed)
        show("an FMU, every entry compressed", pack_anew, pack_anew)
        show("an FMU, the library compressed at build time", pack, pack_anew)
        four = with_four_platforms(Path(folder) / "data")
        with patch.object(installed, "data_folder", lambda: four):
            show("with four platforms: one step of the scene", run_scene, run_packed)
            show("with four platforms: an FMU", pack, pack_anew)
    layer, own = (import_time(words) for words in ("import numpy, fmpy.fmi2", "import softffd"))
    print(f"{'import numpy, fmpy.fmi2':44} {layer * 1e3:8.1f}               1.00")
    print(f"{'import softffd':44} {own * 1e3:8.1f}           {own / layer:8.2f}")


def compress_all(scene: softffd.Scene, fmu: Path) -> None:
    """Packs the scene's FMU with zipfile, which compresses every entry."""
    texts, _, _ = scene_texts(scene)
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in texts.items():
            archive.writestr(name, text)
        for name, file in installed.libraries().items():
            archive.write(file, f"binaries/{name}/{file.name}")


def with_four_platforms(data: Path) -> Path:
    """An installation's data with a library for every platform: copies of the one at hand, with what is kept beside it."""
    shutil.copytree(installed.data_folder(), data)
    library = next(iter(installed.libraries().values()))
    for name, file in installed.LIBRARY_NAME.items():
        folder = data / "binaries" / name
        folder.mkdir(exist_ok=True)
        for suffix in ("", ".deflated"):
            shutil.copy(library.with_name(library.name + suffix), folder / (file + suffix))
    return data


def show(what: str, call: Callable[[], None], against: Callable[[], None]) -> None:
    """One line: both are run in turn."""
    own, base = [], []
    for _ in range(REPEATS):
        own.append(processor_time(call))
        base.append(processor_time(against))
    print(f"{what:44} {min(own) * 1e3:8.1f}           {min(own) / min(base):8.2f}")


def processor_time(call: Callable[[], None]) -> float:
    """[s]"""
    began = time.process_time()
    call()
    return time.process_time() - began


def import_time(words: str) -> float:
    """Of a statement in a new interpreter [s], smallest of several."""
    program = f"import time; began = time.process_time(); {words}; print(time.process_time() - began)"
    return min(float(subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout) for _ in range(5))


if __name__ == "__main__":
    main()
