"""Files appear whole, or what stood there before stays."""

import os

import pytest

from softffd.files import replacing, write_bytes, write_text


def test_what_is_written_replaces_what_was_there(tmp_path):
    path = tmp_path / "report.html"
    path.write_text("old")
    write_text(path, "new\nμ")
    assert path.read_bytes() == "new\nμ".encode()
    write_bytes(path, b"newer")
    assert path.read_bytes() == b"newer" and os.listdir(tmp_path) == ["report.html"]


@pytest.mark.parametrize("fault", [ValueError, KeyboardInterrupt])
def test_an_interrupted_write_leaves_the_old_file_and_nothing_beside_it(tmp_path, fault):
    path = tmp_path / "result.npz"
    path.write_text("old")
    with pytest.raises(fault), replacing(path) as stream:
        stream.write(b"half of the n")
        raise fault
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["result.npz"]


def test_while_it_is_written_the_old_file_is_there(tmp_path):
    path = tmp_path / "result.csv"
    path.write_text("old")
    with replacing(path) as stream:
        stream.write(b"new")
        stream.flush()
        assert path.read_text() == "old"
    assert path.read_text() == "new"


def test_who_reads_the_old_file_reads_it_to_its_end(tmp_path):
    path = tmp_path / "result.csv"
    path.write_text("old")
    with path.open() as reader:
        write_text(path, "new")
        assert reader.read() == "old"


def test_a_new_file_has_the_rights_of_any_new_file(tmp_path):
    (tmp_path / "plain").write_text("")
    write_text(tmp_path / "written", "")
    assert (tmp_path / "written").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_a_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "a.fmu").write_text("old")
    (tmp_path / "b.fmu").symlink_to(tmp_path / "there" / "a.fmu")
    write_text(tmp_path / "b.fmu", "new")
    assert (tmp_path / "b.fmu").is_symlink() and (tmp_path / "there" / "a.fmu").read_text() == "new"


def test_a_missing_folder_is_an_error_of_the_system(tmp_path):
    with pytest.raises(FileNotFoundError):
        write_text(tmp_path / "none" / "x", "")
