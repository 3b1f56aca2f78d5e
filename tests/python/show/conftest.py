"""The browser that the pages are shown in, and live pages."""

from functools import cache
from itertools import count

import pytest

import browser
from softffd import SoftffdError
from softffd.installed import wasm_library
from softffd.show.live.page import write_live


@pytest.fixture(scope="session", autouse=True)
def browsers_end():
    yield
    browser.end_all()


@pytest.fixture(scope="session")
def live_page(tmp_path_factory):
    """live_page(scene) is the live page of a scene or of a scene's name, written once."""
    try:
        wasm_library()
    except SoftffdError:
        pytest.skip("no WebAssembly library in this installation")
    folder, number = tmp_path_factory.mktemp("live"), count()
    return cache(lambda scene: write_live(scene, folder / f"{next(number)}.html"))
