"""Repairs what the library of pythonfmu 0.7 does to its process. Every FMU made with that library contains this module beside the script.

The library runs the script anew for every instance, and then drops a reference to the script's globals that it never took.

On Linux the library destroys its record of the interpreter twice: with its static objects, and after them in `finalizePythonInterpreter`,
a destructor that counts down in memory which is free by then. If that memory is in a list of the heap, the process aborts with "corrupted
double-linked list" after all its work is done: now and then in a host that is Python, always in any other. If the same function is called
before the static objects are destroyed, nothing is left to do for either. It stays callable because the library stays loaded.
"""

import ctypes
import os
import sys
from pathlib import Path
from typing import Any

MENDED: set[Path] = set()  # paths of the libraries that are repaired


def mend(script_globals: dict[str, Any]) -> None:
    """Repairs the library; the script has to call this with its globals() each time that it runs."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(script_globals))
    if sys.platform != "linux":
        return
    resources = Path(sys.path[0])  # the library has just put the path of the resources there
    for path in set(resources.parent.glob("binaries/*/*.so")) - MENDED:
        try:
            library = ctypes.CDLL(str(path), mode=os.RTLD_NOW | os.RTLD_NOLOAD)
        except OSError:  # not loaded: it is for another platform, or the FMU is being built
            continue
        if hasattr(library, "finalizePythonInterpreter"):
            ctypes.CDLL(None)["__cxa_atexit"](library.finalizePythonInterpreter, None, None)  # run in reverse order of registration
            MENDED.add(path)
