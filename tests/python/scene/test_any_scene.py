"""Scenes that nobody foresaw: whatever is in a document or a file, it is a scene or refused in words, and nothing else comes out."""

import datetime
import re
import tomllib
from copy import deepcopy
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import strategies as st

from any_example import require_of_all
from scenes import TETRAHEDRON
from softffd import Scene, SceneError, load_scene
from softffd.scene.document import find_scene, shipped_scenes
from softffd.scene.keys import schema
from softffd.scene.new import template
from softffd.scene.scene import scene_from

few_and_many = pytest.mark.parametrize("examples", [pytest.param(count, id=f"{count} scenes") for count in (50, 5000)])
few = pytest.mark.short("50 scenes")

TEXTS = [find_scene(name).read_text() for name in shipped_scenes()]
TEXTS.append(re.sub(r"^#(?=\S)", "", template("full"), flags=re.MULTILINE))  # every key in force
MESHED = {"mesh": {"file": "box.obj"}}
DOCUMENTS = [*map(tomllib.loads, TEXTS), {}, MESHED, MESHED | {"lattice": {"cells": 3, "margin": 0.1}, "material": {"youngs_modulus": 1e6}}]


def keys_of_schema():
    """All keys of a scene, as places in a document: (section, key) or, of sections that may stand several times, (section, 0, key)."""
    definition = schema()
    for name, entry in definition["properties"].items():
        several = entry.get("items", {}).get("$ref")
        table = (several or entry.get("$ref", "")).rpartition("/")[2]
        yield (name,)
        yield from (((name, 0, key) if several else (name, key)) for key in definition["$defs"].get(table, {}).get("properties", {}))


PLACES = list(keys_of_schema())
NUMBERS = st.one_of(
    st.sampled_from([0, 1, -1, 2, 32, 33, 10**400, 1e308, 5e-324, -0.0, 1e-300, 0.3]), st.integers(), st.floats()
)  # fmt: skip
WORDS = st.one_of(
    st.text(max_size=6),
    st.sampled_from(["x-", "all", "none", "cubic", "surface", "box", "volume", "matched", "flat", "input", "auto", "central_difference",
                     "box.obj", ".", "ground", "<list>", "stiffness", "stifness", "name", "nam", "points"]),
)  # fmt: skip
LEAVES = st.one_of(
    NUMBERS, WORDS, st.none(), st.booleans(), st.just(datetime.date(2020, 1, 1)),
    st.sampled_from([np.float32(2), np.ones(3), np.int64(4), np.nan, b"x", {1}, object]),
)  # fmt: skip
VALUES = st.one_of(
    st.lists(st.one_of(NUMBERS, st.floats(0, 2)), min_size=3, max_size=3),
    st.lists(st.integers(1, 4), min_size=3, max_size=3),
    st.lists(st.tuples(*[st.integers(0, 4)] * 3).map(list), max_size=3),
    st.dictionaries(st.sampled_from("ijkx"), st.lists(st.integers(0, 4), min_size=2, max_size=2), max_size=3),
    st.recursive(LEAVES, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.one_of(WORDS, NUMBERS), inner, max_size=4)),
)


@st.composite
def documents(draw):
    """A document of which up to six keys are other values, gone, misspelt or there twice."""
    document = deepcopy(draw(st.sampled_from(DOCUMENTS)))
    for place in draw(st.lists(st.sampled_from(PLACES), max_size=6)):
        node = document
        for part, following in pairwise(place):
            if isinstance(node, list):
                node.extend([{}] * (not node))
                node = node[-1]
            else:
                node = node.setdefault(part, [] if following == 0 else {})
            if not isinstance(node, dict | list):
                break
        else:
            put(draw, node, place[-1])
    return document


def put(draw, table, key):
    if not isinstance(table, dict):
        return
    match draw(st.sampled_from(["value", "value", "value", "gone", "misspelt", "twice"])):
        case "value":
            table[key] = draw(VALUES)
        case "gone":
            table.pop(key, None)
        case "misspelt":
            table[key[:-1]] = table.pop(key, 1)
        case "twice" if isinstance(table.get(key), list):
            table[key] = [*table[key], *table[key]]


@st.composite
def texts(draw):
    """The text of a file of which some parts are other ones, missing or there twice."""
    text = draw(st.sampled_from(TEXTS))
    pieces = st.one_of(
        st.text(max_size=8), VALUES.map(repr),
        st.sampled_from(["[", "]]", "[[plane]]\n", '"', "\n", "=", "'''", "a." * 3000 + "a=1\n", "[" * 600, "0x" + "f" * 9000, "nan",
                         "1e999"]),
    )  # fmt: skip
    for _ in range(draw(st.integers(0, 3))):
        first, length = draw(st.integers(0, len(text))), draw(st.integers(0, 40))
        text = text[:first] + draw(pieces | st.just(text[first : first + length] * 2)) + text[first + length :]
    return text.encode(draw(st.sampled_from(["utf-8", "utf-8", "utf-8", "utf-16"])), errors="surrogatepass")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("any_scene")
    (folder / "box.obj").write_text(TETRAHEDRON)
    return folder


def require_used_or_refused(make, line=r".+\S"):
    """It is a scene, which is the same once more, or refused in lines like this."""
    try:
        scene = make()
    except SceneError as error:
        assert error.problems and all(re.match(line, problem) for problem in error.problems)
        return
    assert isinstance(scene, Scene) and scene.replace({}) == scene and str(scene)


@few
@few_and_many
def test_any_document_is_a_scene_or_refused_in_words(folder, examples):
    def check(document):
        require_used_or_refused(lambda: scene_from(document, path=folder / "scene.toml"), r"[\w\"<\[].*: .+")  # each with its place

    require_of_all(documents(), examples, check)


@few
@few_and_many
def test_any_file_is_a_scene_or_refused_in_words(folder, examples):
    def check(data):
        (folder / "any.toml").write_bytes(data)
        require_used_or_refused(lambda: load_scene(folder / "any.toml"))

    require_of_all(texts(), examples, check)


@few
@few_and_many
def test_any_change_gives_a_scene_or_is_refused_in_words(examples):
    keys = st.one_of(
        st.sampled_from([".".join(map(str, place)) for place in PLACES]),
        st.sampled_from(["plane.press", "plane[0].friction", "plane[9]", "plane.press.point[1]", "lattice.points.0", "..", "[", ""]),
        st.text(max_size=6),
    )
    press = load_scene("press")
    require_of_all(
        st.dictionaries(keys, VALUES, max_size=3), examples, lambda changes: require_used_or_refused(lambda: press.replace(changes))
    )
