"""With the oldest packages that pyproject.toml allows the program does what it does with the newest."""

import re
import subprocess
import sys
import tomllib
import venv
from importlib.metadata import distribution
from pathlib import Path

import pytest
import trimesh
from packaging.requirements import Requirement
from packaging.version import Version

import softffd
from softffd.installed import data_folder

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS = PROJECT["optional-dependencies"]
TOOLS = ("docs", "test", "comparisons", "readers")
"""Extras that no user of the package needs."""
USED = [Requirement(line) for line in (*PROJECT["dependencies"], *(line for name in EXTRAS if name not in TOOLS for line in EXTRAS[name]))]


def bound(requirement: Requirement) -> Version:
    """The oldest version that is allowed."""
    (version,) = [Version(each.version) for each in requirement.specifier if each.operator == ">="]
    return version


def test_a_package_has_one_lower_bound():
    for line in EXTRAS["test"]:
        same = [bound(used) for used in USED if used.name == (asked := Requirement(line)).name]
        assert same in ([], [bound(asked)]), line


@pytest.mark.full
def test_the_oldest_packages_do(tmp_path):
    venv.create(tmp_path / "venv", with_pip=True)
    python = tmp_path / "venv" / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")

    def pip(*words: str) -> subprocess.CompletedProcess:
        return subprocess.run([python, "-m", "pip", "--disable-pip-version-check", *words], capture_output=True, text=True)

    if (asked := pip("index", "versions", "fmpy")).returncode:
        pytest.skip(f"no package index is in reach: {asked.stderr.strip()[-200:]}")
    least = Requirement(f"python{PROJECT['requires-python']}")

    def oldest(requirement: Requirement) -> str:
        """For the oldest Python the bound itself, for a later one the oldest version with a wheel for it."""
        if Version(f"{sys.version_info[0]}.{sys.version_info[1]}") == bound(least):
            return f"{requirement.name}=={bound(requirement)}"
        told = pip("index", "versions", "--only-binary=:all:", requirement.name).stdout
        found = map(Version, re.search(r"Available versions: (.+)", told)[1].split(", "))
        return f"{requirement.name}=={min(version for version in found if version >= bound(requirement))}"

    installed = pip("install", "-q", "--prefer-binary", *map(oldest, USED))
    assert installed.returncode == 0, installed.stderr
    done = subprocess.run(
        [python, ROOT / "tests" / "support" / "oldest_packages.py", balls(tmp_path / "balls")],
        env={"PYTHONPATH": str(beside(tmp_path / "site")), "HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-1000:] + done.stderr


def beside(folder: Path) -> Path:
    """A folder from which the package that is tested is imported, with its library, in any environment."""
    (folder / "softffd").mkdir(parents=True)
    parts = {entry.name: entry for entry in Path(softffd.__file__).parent.iterdir()} | {"data": data_folder()}
    for name, entry in parts.items():
        (folder / "softffd" / name).symlink_to(entry)
    about = Path(distribution("softffd")._path)
    (folder / about.name).symlink_to(about)
    return folder


def balls(folder: Path) -> Path:
    """The same ball in every kind of mesh file."""
    folder.mkdir()
    ball = trimesh.creation.icosphere(1)
    for kind in ("obj", "stl", "ply", "glb", "off", "3mf", "dae"):
        content = ball.export(file_type=kind)
        (folder / f"ball.{kind}").write_bytes(content if isinstance(content, bytes) else content.encode())
    for name, content in ball.scene().export(file_type="gltf").items():
        (folder / name.replace("model", "ball")).write_bytes(content)
    return folder
