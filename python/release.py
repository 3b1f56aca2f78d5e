"""Builds for every platform. `python3 python/run.py release` makes a wheel that carries the library for every platform, and the files for
the FMI Cross-Check. `python3 python/run.py wasm` builds the library for web pages alone and puts it into the installed package.

The libraries are compiled on this machine by zig (package `ziglang`), from the presets of CMakePresets.json that have a platform's name.
"""

import os
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WASM = "wasm32-wasi"
PLATFORMS = ("linux64", "win64", "aarch64-linux", "darwin64", WASM)


def build_release(python: Path) -> int:
    """Builds with the environment of the interpreter `python`; the wheel is written to dist. Returns the exit status."""
    libraries = ROOT / "build" / "libraries"
    shutil.rmtree(libraries, ignore_errors=True)
    wheel = [*pip(python), "wheel", ".", "--no-deps", "-w", "dist"]
    wheel += ["-C", f"cmake.define.SOFTFFD_LIBRARIES={libraries}", "-C", "wheel.platlib=false", "-C", "build-dir=build/wheel"]
    cross_check = [python, "-m", "validation", "cross-check", "dist/cross-check"]
    status = run_all("release", python, [*compiling(python, PLATFORMS, libraries), wheel, cross_check])
    if status == 0:
        print(f"release: {', '.join(file.name for file in sorted((ROOT / 'dist').glob('*.whl')))} and cross-check in dist")
    return status


def build_wasm(python: Path) -> int:
    """Builds the library for web pages and puts it into the package that the interpreter `python` has. Returns the exit status."""
    libraries = installed_libraries(python)
    status = run_all("wasm", python, compiling(python, [WASM], libraries))
    if status == 0:
        print(f"wasm: {libraries / WASM / 'softffd.wasm'}")
    return status


def installed_libraries(python: Path) -> Path:
    """Returns the folder that holds the libraries, by platform, in the package that the interpreter `python` has."""
    site = subprocess.check_output([python, "-c", "import sysconfig; print(sysconfig.get_path('platlib'))"], text=True).strip()
    return Path(site) / "softffd" / "data" / "binaries"


def pip(python):
    return [python, "-m", "pip", "--disable-pip-version-check", "-q"]


def compiling(python, platforms, libraries):
    """Returns the commands that compile the libraries of these platforms into folders of `libraries`."""
    commands = [[*pip(python), "install", "ziglang", "cmake>=3.26", "ninja", "cmeel-eigen", "fmpy"]]
    for name in platforms:
        commands.append(["cmake", "--preset", name, "-G", "Ninja", "-DSOFTFFD_TESTS=OFF", f"-DPython3_EXECUTABLE={python}"])
        commands.append(["cmake", "--build", f"build/{name}", "--target", "softffd"])
        commands.append(["cmake", "-E", "copy_directory_if_different", f"build/{name}/binaries", libraries])
    return commands


def run_all(what, python, commands):
    """Runs the commands with the tools of this interpreter's environment. Returns the exit status of the first that fails, else 0."""
    environment = os.environ | {"PATH": f"{python.parent}{os.pathsep}{os.environ['PATH']}"}
    for number, command in enumerate(commands):
        print(f"{what}: {number + 1} of {len(commands)}: {' '.join(map(str, command[:3]))} ...", flush=True)
        if status := subprocess.call(command, cwd=ROOT, env=environment):
            return status
    return 0
