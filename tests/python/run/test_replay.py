"""A component of a coupled run, run again alone with what it was given."""

import re
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp

from scenes import box
from softffd import FmuError, replay, write_ssp

LOW = {"origin": [0.0, 0.0, -1.0]}
LID = {"name": "lid", "point": [0, 0, 0], "normal": [0, 0, -1], "motion": "input"}
BODY = box(lattice=LOW, plane=[LID], environment={"gravity": [0, 0, -9.81]}, energy=True, load=[{"name": "push", "points": "x+"}])
OTHER = box(lattice=LOW, initial={"velocity": [0.5, 0.0, 0.2]})
STEP = 0.01


@pytest.fixture(scope="module")
def coupled(tmp_path_factory):
    """Rows of a body that is pushed by where another is, and whose lid moves with a corner of it by poses alone."""
    path = tmp_path_factory.mktemp("coupled") / "x.ssp"
    pushed = [(f"other.position[3,3,3].{axis}", f"body.plane.lid.point.{axis}") for axis in "xz"]
    write_ssp(path, {"body": BODY, "other": OTHER}, pushed, record=["body.position", "body.energy.kinetic"])
    return simulate_ssp(str(path), stop_time=29.5 * STEP, step_size=STEP)


def test_a_component_does_the_same_again_and_shows_all_of_it(coupled):
    result = replay(BODY, coupled, "body")
    assert len(result.time) == len(coupled) + 1 == 31
    for name, there in (("position[3,3,3].z", result.positions[1:, 3, 3, 3, 2]), ("energy.kinetic", result.outputs["energy.kinetic"][1:])):
        np.testing.assert_allclose(there, coupled[f"body.{name}"], rtol=1e-9, atol=1e-12)
    assert np.ptp(result.inputs["plane.lid.point.z"]) > 0.01 and result.has_positions


def test_rows_that_are_none_of_the_component_are_refused(coupled):
    for rows, name, words in (
        (coupled, "bodi", "wanted columns bodi.VARIABLE of its inputs, got none; there are columns of body, other"),
        (coupled[:1], "body", "at least two rows"),
        (coupled[["time"]][[0, 1, 5]], "body", "got none"),
        (coupled[[0, 1, 5]], "body", "wanted equal steps of time, got some of 0.01 s and some of 0.04 s"),
        ([1.0, 2.0], "body", "wanted what fmpy's simulate_ssp returns"),
    ):
        with pytest.raises(FmuError, match=re.escape(words)):
            replay(BODY, rows, name)


def test_a_csv_file_of_the_rows_does_as_well(coupled, tmp_path):
    kept = [name for name in coupled.dtype.names if "position" not in name]
    np.savetxt(tmp_path / "rows.csv", coupled[kept].tolist(), delimiter=",", header=",".join(kept), comments="", fmt="%.17g")
    again = replay(BODY, Path(tmp_path / "rows.csv"), "body", output=["energy"])
    np.testing.assert_array_equal(again.outputs["energy.kinetic"], replay(BODY, coupled, "body").outputs["energy.kinetic"])
