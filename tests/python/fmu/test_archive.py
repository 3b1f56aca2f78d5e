"""The archives that are written: entries, order, and the same bytes for the same content."""

import zipfile

import pytest

from softffd.errors import SoftffdError
from softffd.fmu.archive import write_archive

CONTENTS = {"resources/b.txt": b"b" * 5000, "modelDescription.xml": b"<a/>", "binaries/c": bytes(range(256)) * 40, "empty": b""}


def test_zipfile_reads_what_was_put_in_and_the_same_entries_give_the_same_bytes_in_any_order(as_shipped, tmp_path):
    write_archive(tmp_path / "made" / "x.fmu", CONTENTS)
    with zipfile.ZipFile(tmp_path / "made" / "x.fmu") as archive:
        assert archive.testzip() is None
        assert archive.namelist() == ["modelDescription.xml", "binaries/c", "empty", "resources/b.txt"]
        assert {name: archive.read(name) for name in CONTENTS} == CONTENTS
        assert {info.date_time for info in archive.infolist()} == {(2020, 1, 1, 0, 0, 0)}
        assert {info.external_attr >> 16 for info in archive.infolist()} == {0o644}
        assert {info.compress_type for info in archive.infolist()} == {zipfile.ZIP_DEFLATED}
    write_archive(tmp_path / "other.fmu", dict(reversed(CONTENTS.items())))
    assert (tmp_path / "made" / "x.fmu").read_bytes() == (tmp_path / "other.fmu").read_bytes()


def test_a_file_in_the_place_of_its_folder_is_called_that(tmp_path):
    (tmp_path / "afile").write_text("")
    with pytest.raises(SoftffdError, match=r"afile: wanted a folder to write to, but .*afile is a file"):
        write_archive(tmp_path / "afile" / "x.fmu", {})
