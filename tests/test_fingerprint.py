"""Results keep their bits: tests/support/fingerprint.py says what is hashed, and how to record anew where bits change on purpose."""

import pytest

import fingerprint

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
