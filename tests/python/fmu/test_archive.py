"""Archives of entries that are compressed already, and the files kept compressed beside the libraries."""

import subprocess
import sys
import zipfile

import pytest

from softffd.fmu import deflated as module
from softffd.fmu.archive import write_archive
from softffd.fmu.deflated import deflate, deflated_file, keep_beside
from softffd.installed import libraries

CONTENTS = {"resources/b.txt": b"b" * 5000, "modelDescription.xml": b"<a/>", "binaries/c": bytes(range(256)) * 40, "empty": b""}


def test_zipfile_reads_what_was_put_in_and_finds_nothing_wrong(tmp_path):
    write_archive(tmp_path / "made" / "x.fmu", {name: deflate(content) for name, content in CONTENTS.items()})
    with zipfile.ZipFile(tmp_path / "made" / "x.fmu") as archive:
        assert archive.testzip() is None
        assert archive.namelist() == ["modelDescription.xml", "binaries/c", "empty", "resources/b.txt"]
        assert {name: archive.read(name) for name in CONTENTS} == CONTENTS
        assert {info.date_time for info in archive.infolist()} == {(2020, 1, 1, 0, 0, 0)}
        assert {info.external_attr >> 16 for info in archive.infolist()} == {0o644}


def test_an_archive_has_the_bytes_that_zipfile_writes(tmp_path):
    write_archive(tmp_path / "own.zip", {name: deflate(content) for name, content in CONTENTS.items()})
    with zipfile.ZipFile(tmp_path / "theirs.zip", "w") as archive:
        for name in ("modelDescription.xml", "binaries/c", "empty", "resources/b.txt"):
            info = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
            info.compress_type, info.create_system, info.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            archive.writestr(info, CONTENTS[name])
    assert (tmp_path / "own.zip").read_bytes() == (tmp_path / "theirs.zip").read_bytes()


@pytest.fixture
def library(tmp_path):
    file = tmp_path / "softffd.so"
    file.write_bytes(b"a library " * 1000)
    return file


def test_what_is_kept_beside_a_file_is_taken_as_it_is(library, monkeypatch):
    wanted = deflate(library.read_bytes())
    keep_beside(library)
    monkeypatch.setattr(module, "deflate", None)
    assert deflated_file(library) == wanted


def test_what_belonged_to_an_older_file_is_not_taken(library):
    keep_beside(library)
    library.write_bytes(b"another library " * 1000)
    assert deflated_file(library) == deflate(library.read_bytes())


def test_without_a_file_beside_it_is_compressed_once(library, monkeypatch):
    calls = []
    monkeypatch.setattr(module, "deflate", lambda content: calls.append(1) or deflate(content))
    assert deflated_file(library) == deflated_file(library) == deflate(library.read_bytes())
    assert calls == [1]


def test_the_build_s_program_needs_the_standard_library_alone(library):
    subprocess.run([sys.executable, "-I", "-S", module.__file__, str(library)], check=True)
    beside = library.with_name("softffd.so.deflated").read_bytes()
    assert beside[8:] == deflate(library.read_bytes()).stream


def test_the_installed_libraries_are_taken_as_they_are_now():
    for file in libraries().values():
        assert deflated_file(file) == deflate(file.read_bytes())
