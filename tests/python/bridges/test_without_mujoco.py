"""The bridge to MuJoCo where there is no mujoco."""

import sys

import pytest

from softffd import SoftffdError


def test_without_mujoco_the_message_names_what_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.delitem(sys.modules, "softffd.bridges.mujoco", raising=False)
    with pytest.raises(SoftffdError, match=r"pip install 'softffd\[mujoco\]'"):
        import softffd.bridges.mujoco  # noqa: F401
