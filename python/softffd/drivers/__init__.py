"""Driver FMUs made with pythonfmu, to couple with a scene's FMU: a rigid plate, a prescribed load or motion.

The drivers are Python: a host needs a Python interpreter in its process. Each FMU contains pythonfmu, which need not be installed where
the FMU runs. pythonfmu's library names no libpython and takes the interpreter's symbols from the process. Hosts that are Python (fmpy,
libcosimpy, ecospy) have these symbols; another host must be linked with libpython or started with LD_PRELOAD=libpython3.N.so. On Linux the
library needs glibc 2.32 and a C++ runtime of GCC 12; each FMU has libraries for linux64 and win64. One process holds one version of the
drivers, because Python loads their modules once.
"""

import json
import subprocess
import sys
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from softffd.errors import SoftffdError
from softffd.files import write_bytes
from softffd.spelling import wanted_one_of

DRIVERS = ("plate", "actuator")
HERE = Path(__file__).parent
MENDING = HERE / "softffd_pythonfmu.py"  # a module that every driver's FMU contains and its script calls


def build_drivers(folder: str | Path) -> list[Path]:
    """Builds plate.fmu and actuator.fmu into a folder (created if absent) and returns their paths. SoftffdError without pythonfmu."""
    return [build_driver(name, folder) for name in DRIVERS]


def build_driver(name: str, folder: str | Path, *, start_values: Mapping[str, Any] | None = None) -> Path:
    """Builds one driver, `name`.fmu, into a folder and returns the path.

    start_values: parameters by name, a vector ("initial.point") as three numbers; these become the FMU's start values.
    """
    if name not in DRIVERS:
        raise SoftffdError(f"driver: {wanted_one_of(DRIVERS, name)}")
    if find_spec("pythonfmu") is None:
        raise SoftffdError("the driver FMUs are made with pythonfmu, which is not installed: pip install pythonfmu")
    path = Path(folder) / f"{name}.fmu"
    with TemporaryDirectory(prefix="softffd-") as scratch:
        files = [HERE / "softffd_driver.py", MENDING]
        if start_values:
            files.append(Path(scratch) / "start.json")
            files[-1].write_text(json.dumps({key: _plain(value) for key, value in start_values.items()}))
        build = ["-m", "pythonfmu", "build", "--handle-state", "--serialize-state", "-d", scratch, "-f", str(HERE / f"{name}.py")]
        done = subprocess.run([sys.executable, *build, *map(str, files)], cwd=scratch, capture_output=True, text=True)
        if done.returncode != 0:
            raise SoftffdError(f"{path}: pythonfmu could not build it: {done.stderr.strip() or done.stdout.strip()}")
        write_bytes(path, (Path(scratch) / f"{name.capitalize()}.fmu").read_bytes())
    return path


def _plain(value: Any) -> Any:
    return [float(part) for part in value] if isinstance(value, list | tuple) else value
