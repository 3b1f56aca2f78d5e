"""The browser that the pages are shown in."""

import pytest

import browser


@pytest.fixture(scope="session", autouse=True)
def browsers_end():
    yield
    browser.end_all()
