"""What tests of textbook mechanics do with a case."""

import pytest

from textbook import run


@pytest.fixture
def holds(tmp_path):
    """holds(case) runs it: the block is where a rigid one is, or a warning says by how much it is not."""

    def check(case):
        trial = run(case, tmp_path)
        assert trial.verdict != "wrong", f"off by {trial.error:.1f} tolerances at {trial.at:g} s; stated: {trial.stated:.1f}"

    return check
