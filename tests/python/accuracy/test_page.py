"""What the reports and files of the measurements have in common."""

import csv
import html
import json
import math
from html.parser import HTMLParser
from types import SimpleNamespace
from urllib.parse import unquote

from softffd.accuracy.kept import condition_words, conditions, csv_text, keep_files
from softffd.accuracy.page import NONE, image, page, paragraph, row, section, small, table, time_words
from softffd.accuracy.report import _summary
from softffd.files import json_text

VOID = ("meta", "link", "img")


class Nesting(HTMLParser):
    """The tags that are open."""

    def __init__(self):
        super().__init__()
        self.open = []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_the_page_is_whole_and_asks_for_nothing_from_elsewhere():
    rows = [row("first", ["1", ("2", "best"), NONE], "chosen")]
    parts = [section("A & B", paragraph("soft words", "soft"), table(["", "x", "y"], rows, []), image(b"png"), name="here")]
    text = page("1 < 2", conditions(["softffd", "", "accuracy"]), ["<p>intro</p>", ""], parts)
    nesting = Nesting()
    nesting.feed(text)
    assert nesting.open == [] and "{{" not in text and "http" not in text.replace("http-equiv", "")
    assert "<h1>1 &lt; 2</h1>" in text and '<section id="here"><h2>A &amp; B</h2>' in text and "softffd accuracy; " in text
    assert '<tr class="chosen"><th>first</th><td>1</td><td class="best">2</td><td>&ndash;</td></tr>' in text
    assert text.count("<tbody>") == 1


def test_names_of_scenes_are_no_tags():
    name = '"><script>a&b</script> %41.toml'
    record = SimpleNamespace(scene=name, cheapest=lambda *_given: None)
    text = _summary([record]) + section("title", name=name)
    assert "<script>" not in text and f"{html.escape(name)}</a>" in text
    links = []
    reader = HTMLParser()
    reader.handle_starttag = lambda _tag, attributes: links.extend(value for key, value in attributes if key in ("href", "id"))
    reader.feed(text)
    assert [unquote(link.removeprefix("#")) for link in links[:1]] == links[1:] == [name]


def test_nothing_to_say_leaves_no_tag():
    assert (small(""), paragraph("", "warning")) == ("", "")


def test_times_have_three_digits():
    assert [time_words(seconds) for seconds in (5.3217e-3, 0.99949, 0.9996, 12.345)] == ["5.32 ms", "999 ms", "1 s", "12.3 s"]


def test_conditions_name_command_machine_and_versions():
    about = conditions(["softffd accuracy", "", "--quick"], "numpy", "no-such-package")
    assert about["command"] == "softffd accuracy --quick" and about["versions"]["no-such-package"] == "?"
    assert about["machine"]["cores"] >= 1 and all(word in condition_words(about) for word in ("--quick", "Python 3", "cores"))


def test_numbers_that_json_does_not_have_are_null_and_absent_ones_empty_cells(tmp_path):
    text = json_text({"a": [1.5, math.nan, (math.inf, "x")], "b": {"c": -math.inf}})
    assert json.loads(text) == {"a": [1.5, None, [None, "x"]], "b": {"c": None}}
    keep_files(tmp_path / "new", {"table.csv": csv_text(("a", "b"), [{"a": 1.5, "b": None}, {"a": 'x,"y"', "b": 0}])})
    assert list(csv.reader((tmp_path / "new" / "table.csv").open())) == [["a", "b"], ["1.5", ""], ['x,"y"', "0"]]
