"""Results keep their bits: tests/support/fingerprint.py says what is hashed, and how to record anew where bits change on purpose."""

import pytest

import fingerprint
from softffd import Simulation, installed

KEPT = fingerprint.kept()


@pytest.mark.full
@pytest.mark.parametrize("name", KEPT)
def test_positions_and_reactions_have_the_bits_that_were_recorded(name):
    assert fingerprint.entry(name, KEPT[name]) == KEPT[name]


def test_a_changed_result_has_another_fingerprint():
    name = "scene standard, leapfrog"
    assert fingerprint.entry(name, KEPT[name] | {"until": KEPT[name]["until"] / 2})["hash"] != KEPT[name]["hash"]


def test_every_shipped_scene_has_an_entry_for_every_method_it_takes():
    assert [name for name in fingerprint.names() if name.startswith("scene ") and name not in KEPT] == []


def test_another_library_is_the_one_that_runs(monkeypatch, tmp_path):
    monkeypatch.setattr(installed, "host_library", installed.host_library)  # put back at the end
    installed.loaded_library.cache_clear()
    fingerprint.use_library(tmp_path / "other.so")
    with pytest.raises(OSError, match=r"other\.so"):
        Simulation("standard")
