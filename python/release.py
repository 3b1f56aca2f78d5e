"""A wheel that carries the library for every platform, and the files for the FMI Cross-Check: `python3 python/run.py release`.

Compiled here by zig (package `ziglang`), from the presets of CMakePresets.json that have a platform's name.
"""

import os
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLATFORMS = ("linux64", "win64", "aarch64-linux", "darwin64")


def build_release(python: Path) -> int:
    """Builds with the environment of this interpreter; the wheel lands in dist. Returns the exit status."""
    environment = os.environ | {"PATH": f"{python.parent}{os.pathsep}{os.environ['PATH']}"}
    libraries = ROOT / "build" / "libraries"
    shutil.rmtree(libraries, ignore_errors=True)
    commands = [[python, "-m", "pip", "--disable-pip-version-check", "-q", "install", "ziglang", "cmake", "ninja", "cmeel-eigen", "fmpy"]]
    for name in PLATFORMS:
        commands.append(["cmake", "--preset", name, "-G", "Ninja", "-DSOFTFFD_TESTS=OFF", f"-DPython3_EXECUTABLE={python}"])
        commands.append(["cmake", "--build", f"build/{name}", "--target", "softffd"])
    wheel = [python, "-m", "pip", "--disable-pip-version-check", "-q", "wheel", ".", "--no-deps", "-w", "dist"]
    commands.append(
        [*wheel, "-C", f"cmake.define.SOFTFFD_LIBRARIES={libraries}", "-C", "wheel.platlib=false", "-C", "build-dir=build/wheel"]
    )
    commands.append([python, "-m", "validation", "cross-check", "dist/cross-check"])
    for number, command in enumerate(commands):
        if "wheel" in command:
            for name in PLATFORMS:
                shutil.copytree(ROOT / "build" / name / "binaries", libraries, dirs_exist_ok=True)
        print(f"release: {number + 1} of {len(commands)}: {' '.join(map(str, command[:3]))} ...", flush=True)
        if status := subprocess.call(command, cwd=ROOT, env=environment):
            return status
    print(f"release: {', '.join(file.name for file in sorted((ROOT / 'dist').glob('*.whl')))} and cross-check in dist")
    return 0
