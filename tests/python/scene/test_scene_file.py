import os
import re
import zipfile

import pytest

from softffd.errors import SceneError
from softffd.scene.document import find_scene, read_document
from softffd.scene.scene import load_scene, scene_from


def problem(path):
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    (line,) = caught.value.problems
    return line


def written(tmp_path, content):
    path = tmp_path / "scene.toml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_a_shipped_name_is_found_even_beside_a_directory_of_that_name_and_a_file_wins_over_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "press").mkdir()
    assert find_scene("press").name == "press.toml" and find_scene("press").parent.name == "scenes"
    assert find_scene("car_drop").name == "car_drop.toml" and find_scene("car_drop").with_name("car.obj").is_file()
    (tmp_path / "press").rmdir()
    (tmp_path / "press").write_text("")
    assert find_scene("press") == tmp_path / "press"


def test_a_missing_file_names_the_shipped_scenes_and_the_nearest_of_them_or_beside_it(tmp_path):
    line = problem("car_dorp")
    assert 'no such file or shipped scene, did you mean "car_drop"?' in line
    assert "Shipped scenes: beam, bumper, bumper_mass, car_ball, car_bump, car_drop, drop_weight, flat_pad, free" in line
    path = written(tmp_path, "")
    assert f'did you mean "{path}"?' in problem(tmp_path / "scnee.toml")


def test_a_directory_says_what_it_holds_and_a_link_to_nothing_where_it_leads(tmp_path):
    assert problem(tmp_path) == "wanted a scene file, got a directory; it holds no scene (*.toml)"
    written(tmp_path, "")
    assert problem(tmp_path) == "wanted a scene file, got a directory; it holds scene.toml"
    (tmp_path / "dangling.toml").symlink_to("gone.toml")
    assert problem(tmp_path / "dangling.toml") == "wanted a scene file, got a link to gone.toml, which is missing"


AT = "TOML syntax, line 2, column"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[material]\nstiffness 5\n", f"{AT} 11: Expected '=' after a key in a key/value pair; the line reads: stiffness 5"),
        ("a = 1\na = 2\n", f"{AT} 6: Cannot overwrite a value; the line reads: a = 2"),
        ("a = 1\na = 2", f"{AT} 6: Cannot overwrite a value; the line reads: a = 2"),
        ("x = [1, 2\n", "TOML syntax: Unclosed array (at end of document)"),
        ("title = 'x'\n# café\n".encode("latin-1"), "wanted a TOML text in UTF-8, got the byte 0xe9 in line 2"),
    ],
)
def test_a_text_that_is_no_toml_is_one_line_with_its_place(tmp_path, text, line):
    assert problem(written(tmp_path, text)) == line


@pytest.mark.parametrize("text", ["a = " + "[" * 100_000, "a = " + "9" * 5000])
def test_hostile_toml_is_a_problem_not_a_crash(tmp_path, text):
    assert "TOML" in problem(written(tmp_path, text))


def test_a_byte_order_mark_is_no_problem(tmp_path):
    assert read_document(written(tmp_path, b"\xef\xbb\xbftitle = 'x'\r\n")) == {"title": "x"}


NOWHERE = "no such file or shipped scene"


@pytest.mark.parametrize(
    "name, said", [(3, "wanted the path of a scene file"), ("", NOWHERE), ("a\0b", NOWHERE), ("x" * 5000, "cannot be opened: ")]
)
def test_a_name_that_no_file_can_have_is_a_problem_not_a_crash(name, said):
    assert said in problem(name)


def test_a_name_that_is_no_utf_8_is_refused(tmp_path):
    path = tmp_path / os.fsdecode(b"bad\xff.toml")
    with pytest.raises(SceneError, match=r"wanted a file name in UTF-8, got b'bad\\xff\.toml'"):
        scene_from({}, path=path)


def test_the_file_is_named_relative_to_the_working_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, "titel = 1")
    with pytest.raises(SceneError, match=r"^scene.toml: 1 problem"):
        load_scene("scene.toml")


@pytest.mark.parametrize("name, hint", [("x.fmu", r"got an FMU; to run it: softffd run .*x\.fmu"), ("x", r"rename it to x\.fmu")])
def test_an_fmu_in_place_of_a_scene_is_called_what_it_is(tmp_path, name, hint):
    with zipfile.ZipFile(tmp_path / name, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", "<xml/>" * 100)
    assert re.search(hint, problem(tmp_path / name))
