"""Files appear whole, or what stood there before stays."""

import os
import secrets
from concurrent.futures import ThreadPoolExecutor

import pytest

from softffd.errors import SoftffdError
from softffd.files import appearing_in, replacing, write_bytes, write_text


def test_what_is_written_replaces_what_was_there(tmp_path):
    path = tmp_path / "report.html"
    path.write_text("old")
    write_text(path, "new\nμ")
    assert path.read_bytes() == "new\nμ".encode()
    write_bytes(path, b"newer")
    assert path.read_bytes() == b"newer" and os.listdir(tmp_path) == ["report.html"]


@pytest.mark.parametrize("fault", [ValueError, KeyboardInterrupt])
def test_an_interrupted_write_or_block_leaves_the_old_file_and_nothing_beside_it(tmp_path, fault):
    path = tmp_path / "result.npz"
    path.write_text("old")
    with pytest.raises(fault), replacing(path) as stream:
        stream.write(b"half of the n")
        raise fault
    with pytest.raises(fault), appearing_in(tmp_path) as place:
        (place / "run.pvd").write_text("half")
        raise fault
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["result.npz"]


def test_files_of_a_block_appear_together_in_place_of_those_of_their_names(tmp_path):
    (tmp_path / "series").mkdir()
    (tmp_path / "series" / "old.vtu").write_text("old")
    (tmp_path / "run.pvd").write_text("old")
    with appearing_in(tmp_path) as place:
        (place / "series").mkdir()
        (place / "series" / "new.vtu").write_text("new")
        (place / "run.pvd").write_text("new")
        assert (tmp_path / "run.pvd").read_text() == "old" and os.listdir(tmp_path / "series") == ["old.vtu"]
    assert (tmp_path / "run.pvd").read_text() == "new" and os.listdir(tmp_path / "series") == ["new.vtu"]
    assert sorted(os.listdir(tmp_path)) == ["run.pvd", "series"]


def test_while_it_is_written_the_old_file_is_there_and_who_reads_it_reads_it_to_its_end(tmp_path):
    path = tmp_path / "result.csv"
    path.write_text("old")
    with path.open() as reader:
        with replacing(path) as stream:
            stream.write(b"new")
            stream.flush()
            assert path.read_text() == "old"
        assert path.read_text() == "new" and reader.read() == "old"


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


def test_threads_that_write_one_file_do_not_meet(tmp_path):
    contents = [bytes([n]) * 100_000 for n in range(4)]

    def write(content):
        for _ in range(30):
            write_bytes(tmp_path / "run.npz", content)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(write, contents))
    assert (tmp_path / "run.npz").read_bytes() in contents and os.listdir(tmp_path) == ["run.npz"]


def test_a_link_in_the_place_of_the_file_beside_is_not_followed(tmp_path, monkeypatch):
    (tmp_path / "victim").write_text("old")
    monkeypatch.setattr(secrets, "token_hex", lambda _bytes: "guessed")
    (tmp_path / ".softffd-guessed.partial").symlink_to(tmp_path / "victim")
    with pytest.raises(FileExistsError):
        write_text(tmp_path / "x", "new")
    assert (tmp_path / "victim").read_text() == "old" and not (tmp_path / "x").exists()


def test_a_name_may_be_as_long_as_the_system_allows(tmp_path):
    write_text(tmp_path / ("x" * 251 + ".csv"), "new")
    assert [len(name) for name in os.listdir(tmp_path)] == [255]


def test_a_missing_folder_is_made_by_all_writers_and_a_place_that_cannot_be_one_is_refused(tmp_path, monkeypatch):
    write_text(tmp_path / "none" / "deep" / "x", "new")
    with appearing_in(tmp_path / "none" / "else") as place:
        (place / "y").write_text("")
    assert (tmp_path / "none" / "deep" / "x").read_text() == "new" and os.listdir(tmp_path / "none" / "else") == ["y"]
    for folder, words in [("none/deep/x", "is a file"), ("locked", "may not be written to")]:
        monkeypatch.setattr(os, "access", lambda _path, _mode, locked=folder == "locked": not locked)
        with pytest.raises(SoftffdError, match=f"{folder}.*: wanted a folder to write to.*{words}"):
            write_text(tmp_path / folder / "z", "")
        with pytest.raises(SoftffdError, match=f"{folder}.*: wanted a folder to write to.*{words}"), appearing_in(tmp_path / folder):
            pass


def test_files_that_cannot_appear_are_named_as_they_would_be(tmp_path):
    with pytest.raises(FileNotFoundError) as caught, appearing_in(tmp_path) as place:
        (place / "none" / "x").write_text("")
    assert str(caught.value).endswith(f"'{tmp_path / 'none' / 'x'}'")


def test_a_folder_is_not_written_over_by_a_file(tmp_path):
    (tmp_path / "kept.npz").mkdir()
    with pytest.raises(SoftffdError, match=r"kept\.npz: wanted the name of a file, got a folder"):
        write_text(tmp_path / "kept.npz", "")
    with pytest.raises(SoftffdError, match=r"kept\.npz: wanted the name of a file, got a folder"), appearing_in(tmp_path) as place:
        (place / "another").write_text("")
        (place / "kept.npz").write_text("")
    assert os.listdir(tmp_path) == ["kept.npz"]
