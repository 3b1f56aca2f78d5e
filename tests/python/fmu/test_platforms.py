"""Where an FMU has its libraries, and where a run finds them, on x86-64 and on ARM."""

import re
from pathlib import Path
from zipfile import ZipFile

import pytest

from softffd import FmuError, Simulation, installed, load_scene, package_fmu
from softffd.cli.command import main
from softffd.fmu import archive

ARM = ("linux64", "aarch64-linux")
"""What fmpy calls an ARM machine, of FMI 2.0 and of FMI 3.0"""


@pytest.fixture
def libraries(tmp_path, monkeypatch):
    """An installation with libraries for both machines, whose contents tell them apart; that of ARM is this machine's."""
    own = installed.host_library()
    for platform, content in (("linux64", b"of x86-64"), ("aarch64-linux", own.read_bytes())):
        (tmp_path / "binaries" / platform).mkdir(parents=True)
        (tmp_path / "binaries" / platform / own.name).write_bytes(content)
    found = {platform: tmp_path / "binaries" / platform / own.name for platform in ("aarch64-linux", "linux64")}
    chosen = lambda wanted=None: {name: file for name, file in found.items() if not wanted or name in wanted}  # noqa: E731
    monkeypatch.setattr("softffd.fmu.package.libraries", chosen)
    monkeypatch.setattr("softffd.installed.libraries", chosen)
    return found


def folders(file) -> dict[str, bytes]:
    with ZipFile(file) as opened:
        return {name.split("/")[1]: opened.read(name) for name in opened.namelist() if name.startswith("binaries/")}


def test_arm_alone_is_where_the_standard_and_where_importers_look_and_beside_x86_in_its_own_folder(libraries, tmp_path):
    found = folders(package_fmu("press", tmp_path / "arm.fmu", platforms="aarch64-linux"))
    assert set(found) == {"aarch64-linux", "linux64"} and found["linux64"] == libraries["aarch64-linux"].read_bytes()
    assert set(folders(package_fmu("press", tmp_path / "arm3.fmu", platforms="aarch64-linux", fmi=3))) == {"aarch64-linux"}
    found = folders(package_fmu("press", tmp_path / "both.fmu"))
    assert found == {name: file.read_bytes() for name, file in libraries.items()}


def test_the_build_says_who_will_not_find_the_library(libraries, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["build", "press", "-o", "both.fmu"]) == 0
    assert "for FMPy, FMI Library, fmi4c, rust-fmi and fmusim on ARM, build with --platform aarch64-linux alone" in capsys.readouterr().out
    assert main(["build", "press", "-o", "arm.fmu", "--platform", "aarch64-linux"]) == 0
    assert "binaries/linux64 has the library of ARM" in capsys.readouterr().out
    assert main(["build", "press", "-o", "x86.fmu", "--platform", "linux64"]) == 0
    assert "ARM" not in capsys.readouterr().out


@pytest.mark.parametrize("asked", [None, "aarch64-linux"], ids=["both", "alone"])
def test_a_run_on_arm_takes_the_library_of_arm(libraries, tmp_path, monkeypatch, asked):
    """Named as an ARM machine, this one takes the library in aarch64-linux, which is its own here, and never that in linux64."""
    file = package_fmu(load_scene("press"), tmp_path / "press.fmu", platforms=asked)
    monkeypatch.setattr(archive, "platforms", lambda: ARM)
    monkeypatch.setattr(archive, "_installed", lambda: None)  # as if it came from another build
    with Simulation(file) as simulation:
        simulation.step(0.01)
        assert "aarch64-linux" in simulation.component._library._name and simulation.time == 0.01


def test_without_a_library_of_this_platform_an_fmu_says_which_it_has(tmp_path):
    file = tmp_path / "other.fmu"
    with ZipFile(package_fmu("press", tmp_path / "press.fmu")) as own, ZipFile(file, "w") as changed:
        for name in own.namelist():
            changed.writestr(re.sub("binaries/[^/]+", "binaries/beos", name), own.read(name))
    with pytest.raises(FmuError, match=r"other\.fmu: cannot be opened as an FMU: wanted a library for \S+ or \S+, got beos$"):
        Simulation(file)


@pytest.mark.skipif(not installed.host_library().read_bytes().startswith(b"\x7fELF\x02\x01\x01"), reason="wants a Linux library")
def test_a_library_of_another_processor_is_called_that(tmp_path):
    """The system says of it that there is no such file."""
    here = Path.cwd()
    file, processor = tmp_path / "other.fmu", slice(18, 20)
    with ZipFile(package_fmu("press", tmp_path / "press.fmu")) as own, ZipFile(file, "w") as changed:
        for name in own.namelist():
            content = bytearray(own.read(name))
            if name.startswith("binaries/"):
                content[processor] = b"\xb7\0" if content[processor] == b"\x3e\0" else b"\x3e\0"
            changed.writestr(name, bytes(content))
    with pytest.raises(
        FmuError, match=r"cannot be opened as an FMU: its library binaries/\S+/softffd\.so is for \w+-linux, this machine is \w+"
    ):
        Simulation(file)
    assert Path.cwd() == here
