"""What opening an FMU costs an importer, FMI 3.0 with arrays against FMI 2.0 with scalars, for lattices of several sizes.

    python benchmarks/fmi3_cost.py          # SIDE ...: of these sides; 4 8 16 32 take a minute, nearly all of it for 32 in FMI 2.0

Every scene has the positions of all control points as outputs and forces on all as inputs. The time to open is that of fmpy: the model
description read, the library loaded, an instance made; each in a process of its own, smallest of three. Processor time of this machine; the
ratio of the two standards is what to read.

Predicted: reading an FMU of FMI 3.0 takes as long for any lattice, some milliseconds; what grows is the instance with its springs, the same
for both standards.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from softffd.fmu.package import package_fmu
from softffd.scene.scene import scene_from

OPEN = """
import sys, time
import fmpy
path, folder = sys.argv[1:]
fmpy.extract(path, unzipdir=folder)
began = time.process_time()
description = fmpy.read_model_description(folder, validate=False)
fmpy.instantiate_fmu(folder, description, fmi_type="CoSimulation")
print(time.process_time() - began, len(description.modelVariables))
"""


def main() -> None:
    """Prints the table."""
    print("points  FMI  variables  description MB  open s  ratio to FMI 3.0")
    for side in map(int, sys.argv[1:] or ("4", "8", "16", "32")):
        scene = scene_from({"lattice": {"points": [side] * 3, "basis": "bspline"}, "inputs": {"forces": "all"}})
        own = 0.0
        for fmi in (3, 2):
            with tempfile.TemporaryDirectory() as folder:
                path = package_fmu(scene, Path(folder) / "box.fmu", fmi=fmi)
                size = zipfile.ZipFile(path).getinfo("modelDescription.xml").file_size / 1e6
                seconds, count = min(_open(path, Path(folder) / f"{n}") for n in range(3))
            own = own or seconds
            print(f"{side:2}^3   {fmi:4} {count:10} {size:15.3f} {seconds:7.3f} {seconds / own:10.1f}", flush=True)


def _open(path: Path, folder: Path) -> tuple[float, int]:
    done = subprocess.run([sys.executable, "-c", OPEN, path, folder], capture_output=True, text=True, check=True)
    seconds, count = done.stdout.split()[-2:]
    return float(seconds), int(count)


if __name__ == "__main__":
    main()
