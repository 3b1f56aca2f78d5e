"""What the installation has, and where it is looked for."""

from zipfile import ZipFile

import pytest

from softffd import SoftffdError, installed, load_scene, package_fmu


@pytest.fixture
def with_wasm(tmp_path, monkeypatch):
    """An installation that has the library for web pages beside that of this machine."""
    own = installed.host_library()
    for platform, name, content in ((own.parent.name, own.name, own.read_bytes()), (installed.WASM, "softffd.wasm", b"for pages")):
        (tmp_path / "data" / "binaries" / platform).mkdir(parents=True)
        (tmp_path / "data" / "binaries" / platform / name).write_bytes(content)
    installed.table()  # read before, from where it is
    monkeypatch.setattr(installed, "data_folder", lambda: tmp_path / "data")


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_fmu_contains_the_library_for_web_pages_nor_can_be_asked_to(with_wasm, tmp_path, fmi):
    with ZipFile(package_fmu(load_scene("press"), tmp_path / "press.fmu", fmi=fmi)) as archive:
        binaries = [name for name in archive.namelist() if name.startswith("binaries/")]
    assert len(binaries) == 1 and "wasm" not in binaries[0]
    assert installed.wasm_library().read_bytes() == b"for pages"
    with pytest.raises(SoftffdError, match="platform wasm32-wasi: that library is for web pages, no FMU contains it; wanted one of "):
        package_fmu("press", tmp_path / "press.fmu", platforms=["wasm32-wasi"], fmi=fmi)


def test_where_it_is_missing_what_makes_it_is_named(with_wasm):
    installed.wasm_library().unlink()
    with pytest.raises(SoftffdError, match=r"python3 python/run\.py wasm builds it .* python3 python/run\.py release makes has it"):
        installed.wasm_library()
