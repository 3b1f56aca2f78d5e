"""The reference pages are those of the program as it is."""

import runpy
from pathlib import Path

import pytest

from softffd.installed import table
from softffd.scene.keys import SceneKeys

DOCS = Path(__file__).resolve().parents[1] / "docs"
MAKER = runpy.run_path(str(DOCS / "site" / "reference_pages.py"))
scene_page, variables_page = MAKER["scene_page"], MAKER["variables_page"]


@pytest.mark.parametrize("name, page", [("scene.md", scene_page), ("variables.md", variables_page)])
def test_a_reference_page_is_up_to_date(name, page):
    assert (DOCS / name).read_text(encoding="utf-8") == page(), "write it anew: python docs/site/reference_pages.py docs"


def test_the_scene_page_has_every_section_and_the_facts_of_its_keys():
    page = scene_page()
    for name in SceneKeys.model_fields:
        assert f"[{name}]" in page or f"`{name}`" in page
    assert "| `stop_time` | `1.0` | s; > 0 | End of the simulation |" in page
    assert "| `file` | *must be given* |" in page and '`"z"` | `"x"`, `"y"`, `"z"` |' in page


def test_the_variables_page_has_a_line_for_every_row_of_the_table():
    lines = [line for line in variables_page().splitlines() if line.startswith("| `") and line.count(" | ") == 4]
    assert len(lines) == len(table()["family"])
    assert lines[0].startswith("| `force[i,j,k].x` `.y` `.z` | N | each control point of `inputs.forces` | continuous |")
    assert not [line for line in lines if "{" in line or "}" in line]


def test_every_part_of_the_table_has_words():
    assert MAKER["PRESENT"].keys() == {row["part"] for row in table()["family"]}
