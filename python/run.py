#!/usr/bin/env python3
"""Sets everything up in this folder and runs the program: needs Python 3.11 with venv, nothing else.

    python3 python/run.py demo                the car, with pictures
    python3 python/run.py test [ARGUMENTS]    the tests, on all cores (pytest's arguments; -n 0: in one process)
    python3 python/run.py lint                layout and types of the code
    python3 python/run.py test --full         with the long ones: complete matrices, endurance, importers, surveys
    python3 python/run.py bench               times of everything, as ratios to what one would use otherwise
    python3 python/run.py stability           stiff and extreme scenes, each judged by an exact answer or a bound
    python3 python/run.py random 200          the same of scenes drawn at random
    python3 python/run.py benchmarks          numbers of textbooks and papers, and what comes out
    python3 python/run.py scipy SCENE ...     error against run time, with SciPy's solvers beside
    python3 python/run.py twin SCENE          an FMU of the same model in numpy
    python3 python/run.py cross-check DIR     the files of the FMI Cross-Check
    python3 python/run.py docs                this documentation as a site, in build/docs/site
    python3 python/run.py release             a wheel with the libraries of all platforms (some ten minutes)
    python3 python/run.py wasm                the library for web pages, which `softffd live` needs (some minutes)
    python3 python/run.py build SCENE ...     any other command of softffd

Makes .venv, builds the C++ library into it (with the machine's compiler, else with the one in the package `ziglang`), and hands over.
"""

import hashlib
import os
import platform
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

from release import WASM, build_release, build_wasm, installed_libraries

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
BUILD = ROOT / "build" / "native"
STAMP = VENV / "softffd-built"
BUILT_FROM = ("pyproject.toml", "CMakeLists.txt", "LICENSE", "fmu_src", "modelDescription")
TOOLS = ("stability", "random", "benchmarks", "scipy", "twin", "cross-check")  # commands of python/validation
ALONE = ("release", "wasm", "docs")  # commands that take no arguments
LEAST_PYTHON = (3, 11)
COMPILED = re.compile(r"^\s*\[\s*([1-9]\d*/\d+|\d+%)\]")  # the progress that ninja and make print
CLEAR = "\r\033[K"
TELL_EVERY = 5  # interval of progress lines where the output is no terminal [s]
HANGS = 900  # time after which a test of the short run or of a group of long tests is taken to hang [s]
IMPORTED_AS = {"pillow": "PIL"}
PIP_FAILED = "pip failed (see above). It needs the Python package index, or a mirror of it, in reach."


def stop(message):
    sys.exit(f"run.py: {message}")


def step(words):
    print(f"run.py: {words}", flush=True)


def pip_command(*arguments):
    return [PYTHON, "-m", "pip", "--disable-pip-version-check", "-q", *arguments]


def pip(*arguments, env=None):
    if subprocess.call(pip_command(*arguments), env=env) != 0:
        stop(PIP_FAILED)


def pip_compile(*arguments, env=None):
    """Runs pip and prints the progress of the compiler. If pip fails, stops with all of its output."""
    command = [word for word in pip_command(*arguments, "-v") if word != "-q"]
    build = subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    said, told, terminal = [], -TELL_EVERY, sys.stdout.isatty()
    for line in build.stdout:
        said.append(line)
        found = COMPILED.match(line)
        if found and (terminal or time.monotonic() - told >= TELL_EVERY):
            told = time.monotonic()
            print(f"{CLEAR if terminal else ''}run.py:    compiled {found[1]}", end="" if terminal else "\n", flush=True)
    if terminal:
        print(CLEAR, end="", flush=True)
    if build.wait() != 0:
        stop("".join(said) + PIP_FAILED)


def make_venv():
    if PYTHON.exists() and subprocess.call([PYTHON, "-c", "import pip"], stderr=subprocess.DEVNULL) == 0:
        return
    try:
        import ensurepip  # noqa: F401
        import venv
    except ImportError:
        stop("this Python cannot make virtual environments. On Debian and Ubuntu: sudo apt-get install -y python3-venv")
    print("run.py: making .venv", flush=True)
    venv.create(VENV, with_pip=True, clear=VENV.exists())


def forget_wasm():
    """Deletes the library that `run.py wasm` has built, since it was built from the sources before the change."""
    shutil.rmtree(installed_libraries(PYTHON) / WASM, ignore_errors=True)


def compiler_environment():
    """Returns the environment variables to build with: the machine's C++ compiler, else zig's."""
    env = dict(os.environ)
    if env.get("CXX") or os.name == "nt" or any(shutil.which(name) for name in ("c++", "g++", "clang++")):
        return env
    print("run.py: no C++ compiler here; taking the one in the package ziglang (about 100 MB, once)", flush=True)
    if subprocess.call(pip_command("install", "ziglang")) != 0:
        stop("there is no C++ compiler and none for this machine on the package index. On Debian: sudo apt-get install -y g++")
    where = "import ziglang, os; print(os.path.join(os.path.dirname(ziglang.__file__), 'zig'))"
    zig = subprocess.check_output([PYTHON, "-c", where], text=True).strip()
    machine = platform.machine().replace("arm64", "aarch64")
    target = f" -target {machine}-linux-gnu.2.17" if sys.platform == "linux" else ""
    env["CXX"] = f"{zig} c++{target}"
    return env


def fingerprint():
    modules = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "python").rglob("*.py"))
    # the names of the modules count, because an editable install knows only the modules that existed when it was made
    digest = hashlib.sha256("\n".join([str(PYTHON), *modules]).encode())
    for name in BUILT_FROM:
        path = ROOT / name
        for file in [path] if path.is_file() else sorted(f for f in path.rglob("*") if f.is_file()):
            if "__pycache__" not in file.parts:
                digest.update(str(file.relative_to(ROOT)).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()


def settings(section):
    """Returns a section of pyproject.toml."""
    import tomllib  # needs Python 3.11, for which `set_up` has checked by now

    return tomllib.loads((ROOT / "pyproject.toml").read_text())[section]


def requirements():
    """Returns the packages that building needs, and those that the package and its tests need besides."""
    others = [*settings("project")["dependencies"], *settings("project")["optional-dependencies"]["test"]]
    return [*settings("build-system")["requires"], *(name for name in others if name.startswith(("cmake>", "ninja>")))], others


def building_environment():
    """Returns `compiler_environment` with the tools of .venv first on the PATH."""
    env = compiler_environment()
    return env | {"PATH": f"{PYTHON.parent}{os.pathsep}{env['PATH']}"}


def missing():
    """Returns the modules that the program needs and that are absent or incomplete in .venv."""
    names = (re.match(r"[\w-]+", each)[0] for each in settings("project")["dependencies"])
    modules = ["softffd", *(IMPORTED_AS.get(name, name) for name in names)]
    code = "import sys; from importlib.util import find_spec as f; print(*(m for m in sys.argv[1:] if not ((s := f(m)) and s.origin)))"
    return subprocess.check_output([PYTHON, "-c", code, *modules], text=True).split()


def set_up():
    if sys.version_info < LEAST_PYTHON:
        stop(f"wanted Python {'.'.join(map(str, LEAST_PYTHON))} or newer, this is {platform.python_version()}")
    print_once = fingerprint()
    if PYTHON.exists() and STAMP.exists() and STAMP.read_text() == print_once and not missing():
        return
    STAMP.unlink(missing_ok=True)  # a set-up that is interrupted from here on begins anew
    make_venv()
    forget_wasm()
    print("run.py: building and installing into .venv (some minutes, once)", flush=True)
    building, others = requirements()
    step("1 of 3: packages that building needs")
    pip("install", *building)
    step("2 of 3: the C++ library; beside it the packages that the program and its tests need")
    meanwhile = subprocess.Popen(pip_command("install", *others))
    # in this environment and in a folder that is kept, because the C++ tests are made of the same objects
    options = ["-C", f"build-dir={BUILD}", "-C", "cmake.define.SOFTFFD_TESTS=OFF"]
    pip_compile("install", "--no-deps", "--no-build-isolation", *options, "-e", ROOT, env=building_environment())
    step("3 of 3: what is left of the packages")
    if meanwhile.wait() != 0:
        stop(PIP_FAILED)
    if lost := missing():  # pip was interrupted before and takes these for installed
        stop(f".venv holds parts only of {', '.join(lost)}; remove the folder {VENV} and run this again")
    STAMP.write_text(print_once)


def add_extra(extra, without):
    """Installs the packages of an extra, for the numpy that is there; prints what is missing where a package cannot be installed."""
    there = subprocess.check_output([PYTHON, "-c", "import numpy; print('numpy==' + numpy.__version__)"], text=True).strip()
    for name in settings("project")["optional-dependencies"][extra]:
        if subprocess.call(pip_command("install", name, there)) != 0:
            step(f"no {name} for this Python and {there}, see above: {without}")


def main():
    arguments = sys.argv[1:]
    if not arguments or {"-h", "--help"} & {arguments[0], *(arguments if arguments[0] in ALONE else ())}:
        print(__doc__)
        return 0
    set_up()
    if arguments[0] == "release":
        return build_release(PYTHON)
    if arguments[0] == "wasm":
        return build_wasm(PYTHON)
    if arguments[0] == "docs":
        pip("install", *settings("project")["optional-dependencies"]["docs"])
        return subprocess.call([PYTHON, ROOT / "docs" / "site" / "make_site.py"])
    if arguments[0] in ("test", "lint"):
        options = ["-n", "auto", "--dist", "worksteal", *(["-m", "lint"] if arguments[0] == "lint" else [])]
        if "--full" not in arguments:  # a test that hangs ends its process with a stack trace, and fails
            options += ["-o", f"faulthandler_timeout={HANGS}", "-o", "faulthandler_exit_on_timeout=true"]
        else:
            for extra in ("readers", "mujoco"):
                add_extra(extra, "its tests are skipped")
        env = compiler_environment()
        env.pop("PYTHONDONTWRITEBYTECODE", None)  # with it, each process that a test starts would compile the package anew
        return subprocess.call([PYTHON, "-m", "pytest", *options, *arguments[1:]], cwd=ROOT, env=env)
    if arguments[0] == "bench":
        add_extra("comparisons", "its rows are missing")
        return subprocess.call([PYTHON, ROOT / "benchmarks" / "bench.py", *arguments[1:]])
    command = [str(PYTHON), "-m", "validation" if arguments[0] in TOOLS else "softffd", *arguments]
    if os.name == "posix":  # replaces this process, so that signals reach the command
        os.execv(PYTHON, command)
    return subprocess.call(command)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
