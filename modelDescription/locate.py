"""Prints, as a CMake list, the folder of fmpy's FMI headers and the prefixes that hold Eigen, both found on this interpreter's path."""

import importlib.util
import sys
from pathlib import Path

fmpy = importlib.util.find_spec("fmpy")
headers = Path(fmpy.origin).parent / "c-code" if fmpy and fmpy.origin else Path("fmpy-not-installed")
prefixes = [Path(entry) / "cmeel.prefix" for entry in sys.path]
print(";".join(path.as_posix() for path in [headers, *(p for p in prefixes if (p / "share/eigen3/cmake").is_dir())]))
