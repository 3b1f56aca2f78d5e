"""What a simulation is opened from, and what it leaves behind."""

import gc
import os
import re
import subprocess
import sys
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from host_scenes import HELD, STEP, scene, step
from softffd import FmuError, Simulation, SoftffdError, installed, package_fmu, write_ssp
from softffd.fmu import archive
from softffd.fmu.component import Component
from softffd.scene.document import SHIPPED


def test_a_scene_goes_by_its_name_or_path_an_fmu_by_its_path_and_an_opened_component_is_taken_too(tmp_path):
    file = SHIPPED / "press.toml"
    for given in ("press", str(file), file):
        with Simulation(given) as sim:
            assert sim.plane and sim.component.interface.name == "press"
    fmu = package_fmu(scene(), tmp_path / "box.fmu")
    with Simulation(str(fmu)) as opened:
        step(opened)
    component = Component(fmu)
    with Simulation(component) as opened:
        assert opened.component is component
        step(opened)
    with pytest.raises(FmuError, match="closed"):
        component.do_step(STEP, STEP)


def test_a_closed_simulation_answers_instead_of_crashing(sim):
    block = sim.block(["plane.plate.point"])
    sim.close()
    for call in (lambda: sim.step(STEP), lambda: sim.positions, block.get, sim.save, lambda: sim["mass"]):
        with pytest.raises(FmuError, match="closed"):
            call()
    sim.close()


def test_an_opened_component_that_nobody_closes_leaves_no_folder_behind(tmp_path):
    script = "from softffd import load_scene; from softffd.fmu.component import Component; opened = Component(load_scene('press'))"
    subprocess.run([sys.executable, "-c", script], env=os.environ | {"TMPDIR": str(tmp_path)}, check=True)
    assert not list(tmp_path.iterdir())


def test_a_run_leaves_no_folder_behind(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with Simulation(scene()) as opened:
        step(opened)
        (folder,) = tmp_path.iterdir()
        files = {file.relative_to(folder).as_posix() for file in folder.rglob("*.*")}
        assert files == {"modelDescription.xml", "resources/scene.txt", "resources/notes.txt"}
    assert not list(tmp_path.iterdir())
    with pytest.raises(FmuError):
        Simulation(scene(), method="fast")
    assert not list(tmp_path.iterdir())


def test_an_fmu_with_the_installed_library_is_opened_without_unpacking_it(monkeypatch, tmp_path):
    fmu = package_fmu(scene(), tmp_path / "box.fmu")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "unpacked"))
    (tmp_path / "unpacked").mkdir()

    def opened(path):
        with Simulation(path) as simulation:
            step(simulation)
            (folder,) = (tmp_path / "unpacked").iterdir()
            return simulation.positions, {file.relative_to(folder).as_posix() for file in folder.rglob("*.*")}

    positions, files = opened(fmu)
    assert files == {"modelDescription.xml", "model.png", "resources/scene.txt", "resources/notes.txt"}
    library = f"binaries/{fmpy.platform}/{installed.host_library().name}"
    with ZipFile(fmu) as whole, ZipFile(tmp_path / "other.fmu", "w") as changed:
        for name in whole.namelist():
            changed.writestr(name, whole.read(name) + (b"another" if name == library else b""))
        changed.writestr("binaries/elsewhere/softffd.so", whole.read(library))
    with_other, others = opened(tmp_path / "other.fmu")
    assert others == files | {library}
    np.testing.assert_array_equal(with_other, positions)


@pytest.mark.parametrize(
    "what, options, words",
    [
        (None, {}, "wanted a Scene, the path or name of one, or the path"),
        (3, {}, "wanted a Scene"),
        ("pres", {}, 'did you mean "press"?'),
        *[("press", {"tolerance": wrong}, "tolerance: wanted > 0") for wrong in (0.0, -1.0, float("nan"))],
        ("press", {"start_values": ["mass"]}, "start_values: wanted values by name, such as {'mass': 2}, got ['mass']"),
        ("press", {"log": True}, "log: wanted a function"),
    ],
)
def test_what_cannot_be_opened_is_refused(what, options, words):
    with pytest.raises(SoftffdError, match=re.escape(words)):
        Simulation(what, **options)


def test_a_run_takes_the_library_of_this_machine_alone(tmp_path, monkeypatch):
    """Whatever else is installed: libraries of other platforms are not read."""
    own = installed.host_library()
    binaries = tmp_path / "binaries"
    for name, file in installed.LIBRARY_NAME.items():
        (binaries / name).mkdir(parents=True)
        (binaries / name / file).write_bytes(b"no library")
    (binaries / own.parent.name / own.name).write_bytes(own.read_bytes())
    installed.table()  # read before, from where it is
    monkeypatch.setattr(installed, "data_folder", lambda: tmp_path)
    with Simulation(scene()) as opened:
        step(opened)


def test_the_installed_library_stays_loaded_between_runs():
    """Loading it anew would leave 70 kB each time, which its C++ runtime takes and never gives back."""
    loaded = Path("/proc/self/maps")
    if not loaded.is_file():
        pytest.skip("this system does not list what a process has loaded")
    with Simulation(scene()):
        pass
    assert str(installed.host_library().resolve()) in loaded.read_text()


def test_many_run_side_by_side_in_one_process():
    with Simulation(scene()) as one, Simulation(scene(HELD)) as two, Simulation(scene()) as three:
        for each in (one, two, three, three, one, two):
            step(each)
        np.testing.assert_array_equal(one.positions, three.positions)


def test_an_archive_that_would_fill_the_disk_is_refused_before_it_is_unpacked(as_shipped, tmp_path, monkeypatch):
    fmu = package_fmu(scene(), tmp_path / "box.fmu")
    with ZipFile(fmu, "a", ZIP_DEFLATED) as packed:
        packed.writestr("resources/zeros.bin", bytes(20_000_000))
    with Simulation(fmu) as opened:
        step(opened)
    monkeypatch.setattr(archive, "LARGEST", 1e6)
    monkeypatch.setattr(archive, "MOST_TIMES", 10)
    monkeypatch.setattr("fmpy.extract", lambda *_given, **_keys: pytest.fail("unpacked"))
    for ask in (lambda: Simulation(fmu), lambda: write_ssp(tmp_path / "box.ssp", {"box": fmu}, [])):
        with pytest.raises(SoftffdError, match=r"box\.fmu: its .* MB would unpack to 0\.02\d* GB; wanted at most 0\.001 GB, or 10 times"):
            ask()


def test_one_that_nobody_closes_is_freed_with_its_last_reference(monkeypatch):
    freed = []
    monkeypatch.setattr(FMU2Slave, "freeInstance", lambda self, free=FMU2Slave.freeInstance: freed.append(free(self)))
    for use in (lambda sim: None, Simulation.step, Simulation.save, lambda sim: sim.plane):
        opened = Simulation(scene())
        kept = use(opened)
        del opened, kept
        gc.collect()
    assert len(freed) == 4
