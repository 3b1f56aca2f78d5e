"""Other people's importers and checkers of FMUs: fetched once into build/importers, run as processes.

The versions are fixed, so that what a tool says changes only when this file does. A tool that cannot be had
(no network, no wheel for this Python, no Java) raises Missing with the reason.
"""

import json
import os
import shutil
import subprocess
import sys
import venv
import zipfile
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
FOLDER = HERE.parents[2] / "build" / "importers"
PYTHON_PACKAGES = {
    "fmutool": ("fmu-manipulation-toolbox==2.0",),
    "libcosim": ("libcosimpy==0.0.6",),
    "ecos": ("ecospy==0.7.2", "tbb==2023.2.0"),
    "cofmupy": ("cofmupy==1.0.0",),
    "zig": ("ziglang==0.17.1",),
}
MAVEN_PACKAGES = {
    "vdmcheck2": ("org.into-cps.vdmcheck.fmi2:vdmcheck2:1.1.3",),
    "maestro": ("org.into-cps.maestro:maestro:3.1.1", "commons-io:commons-io:2.16.1"),  # it names a commons-io that is too old for itself
}
COPY_DEPENDENCIES = "org.apache.maven.plugins:maven-dependency-plugin:3.6.1:copy-dependencies"
POM = """<project xmlns="http://maven.apache.org/POM/4.0.0">
  <modelVersion>4.0.0</modelVersion>
  <groupId>softffd</groupId> <artifactId>importers</artifactId> <version>1</version>
  <dependencies>{}</dependencies>
</project>
"""
DEPENDENCY = "<dependency><groupId>{}</groupId><artifactId>{}</artifactId><version>{}</version></dependency>"


class Missing(Exception):
    """A tool cannot be had on this machine; the text says what was missing."""


@dataclass(frozen=True)
class Tool:
    """A tool that can be run; `command` is followed by its arguments."""

    command: tuple[str, ...]
    environment: tuple[tuple[str, str], ...] = ()

    def run(self, *arguments: str | Path) -> list[str]:
        """The lines that the tool prints, without empty ones; a last one tells a failing exit status."""
        done = subprocess.run(
            [*self.command, *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, **dict(self.environment)},
            text=True,
            errors="replace",
            timeout=300,
        )
        lines = [line.rstrip() for line in done.stdout.splitlines() if line.strip()]
        return lines + ([f"exit status {done.returncode}"] if done.returncode else [])


@dataclass(frozen=True)
class Run:
    """What a co-simulation master does with one FMU; handed to its driver as a JSON file.

    step [s]; start: parameters by name. inputs: for each input variable its values at communication points,
    one per step. outputs, counts: names of the Real and of the Integer variables that are read after steps.
    """

    fmu: str
    step: float
    steps: int
    start: dict[str, float]
    inputs: dict[str, list[float]]
    outputs: list[str]
    counts: list[str]


def drive(tool: Tool, run: Run, folder: Path) -> tuple[list[str], dict[str, list[list[float]]]]:
    """What the master printed, and rows (one per step) of `outputs` and `counts`; none where it failed."""
    job, result = folder / "job.json", folder / "result.json"
    result.unlink(missing_ok=True)
    job.write_text(json.dumps(run.__dict__))
    printed = tool.run(job, result)
    return printed, json.loads(result.read_text()) if result.is_file() else {"outputs": [], "counts": []}


def fmutool() -> Tool:
    return Tool((str(installed("fmutool").with_name("fmutool")),))


def libcosim() -> Tool:
    return Tool((str(installed("libcosim")), "-I", str(HERE / "drive_libcosim.py")))


def ecos() -> Tool:
    """Ecos unpacks FMUs with `unzip -o FILE -d FOLDER`, a program; where there is none, Python takes its place."""
    python = installed("ecos")
    path = () if shutil.which("unzip") else (("PATH", f"{_unzip_by(python)}{os.pathsep}{os.environ['PATH']}"),)
    return Tool((str(python), "-I", str(HERE / "drive_ecos.py")), path)


def _unzip_by(python: Path) -> Path:
    """A folder with a program unzip."""
    if os.name == "nt":
        raise Missing("Ecos unpacks FMUs with the program unzip, which is not on this machine")
    folder = FOLDER / "unzip"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "unzip").write_text(f'#!/bin/sh\nexec "{python}" -I -m zipfile -e "$2" "$4"\n')
    (folder / "unzip").chmod(0o755)
    return folder


def installed(name: str) -> Path:
    """Python of the importers' own environment, with the packages of a tool in it."""
    packages = PYTHON_PACKAGES[name]
    python = _environment()
    stamp = FOLDER / "venv" / f"{name}.installed"
    if not stamp.is_file() or stamp.read_text() != " ".join(packages):
        install = (str(python), "-I", "-m", "pip", "install", "--only-binary=:all:", "--timeout=15")
        _fetch(f"pip could not install {' '.join(packages)}", [*install, "--retries=1", "--quiet", *packages])
        stamp.write_text(" ".join(packages))
    return python


def _environment() -> Path:
    folder, stamp = FOLDER / "venv", FOLDER / "venv" / "python.made"
    if not stamp.is_file() or stamp.read_text() != f"{sys.base_prefix} {sys.version}":
        try:
            venv.create(folder, clear=True, with_pip=True, symlinks=os.name != "nt")
        except (OSError, subprocess.CalledProcessError) as error:
            raise Missing(f"no virtual environment could be made: {error}") from None
        stamp.write_text(f"{sys.base_prefix} {sys.version}")
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def cofmupy() -> Tool:
    return Tool((str(installed("cofmupy")), "-I", str(HERE / "drive_cofmupy.py")))


def maestro() -> Tool:
    """Maestro, whose command line is a class among some hundred jars."""
    return Tool((sys.executable, "-I", str(HERE / "drive_maestro.py"), str(_jars("maestro", "-Dmdep.prependGroupId=true"))))


def vdmcheck(main_class: str) -> Tool:
    """VDMCheck2: main class VDMCheck checks against a model of the standard, VDMCheckPlus against rules."""
    folder = FOLDER / f"vdmcheck2-{version('vdmcheck2')}"
    jars = _jars("vdmcheck2")
    if not (folder / "vdmcheck2.jar").is_file():
        _arrange_vdmcheck(list(jars.glob("*.jar")), folder)
    options = "-XX:TieredStopAtLevel=1 -XX:+UseSerialGC"  # for runs of seconds: half the time
    return Tool(("java", "-cp", str(folder / "vdmcheck2.jar"), main_class), (("JDK_JAVA_OPTIONS", options),))


def version(name: str) -> str:
    """That of a tool which is fetched."""
    return (PYTHON_PACKAGES.get(name) or MAVEN_PACKAGES[name])[0].replace("==", ":").rpartition(":")[2]


def _jars(name: str, *options: str) -> Path:
    """The folder with the jars of a Java program, fetched from Maven Central. options: of Maven, on how they are named."""
    maven = shutil.which("mvn")
    if not maven or not shutil.which("java"):
        raise Missing(f"java and mvn, which fetches {name} from Maven Central, are not both on this machine")
    packages = MAVEN_PACKAGES[name]
    folder, stamp = FOLDER / "maven" / name, FOLDER / "maven" / f"{name}.fetched"
    if not stamp.is_file() or stamp.read_text() != " ".join(packages):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        (folder / "pom.xml").write_text(POM.format("".join(DEPENDENCY.format(*package.split(":")) for package in packages)))
        repository = f"-Dmaven.repo.local={FOLDER / 'maven' / 'repository'}"
        places = (repository, f"-DoutputDirectory={folder / 'jars'}", "-DincludeScope=runtime")
        _fetch(f"mvn could not fetch {name}", [maven, "-q", "-B", "-f", str(folder / "pom.xml"), COPY_DEPENDENCIES, *places, *options])
        stamp.write_text(" ".join(packages))
    return folder / "jars"


def _arrange_vdmcheck(jars: list[Path], folder: Path) -> None:
    """Its distribution's layout: jars named without versions, folders with models and schema unpacked."""
    partial = folder.with_name(folder.name + ".partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for jar in jars:
        shutil.copy(jar, partial / f"{jar.stem.rsplit('-', 1)[0]}.jar")
        with zipfile.ZipFile(jar) as archive:
            archive.extractall(partial, [name for name in archive.namelist() if name.startswith("fmi2")])
    shutil.rmtree(folder, ignore_errors=True)
    partial.rename(folder)


def _fetch(failure: str, command: list[str]) -> None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=600)
    except subprocess.TimeoutExpired:
        raise Missing(f"{failure} within 600 s") from None
    if done.returncode:
        said = [line for line in (done.stderr + done.stdout).splitlines() if "ERROR" in line]
        raise Missing(f"{failure}: {said[0] if said else f'exit status {done.returncode}'}")
