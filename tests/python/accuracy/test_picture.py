"""The picture of error against run time."""

import numpy as np
import pytest

from softffd.accuracy.picture import front_picture
from softffd.accuracy.records import Record, Records
from softffd.accuracy.reference import Reference
from softffd.accuracy.rig import Setting


@pytest.mark.parametrize("error", [0.0, 1e-5, 0.7, 30.0])
def test_runs_are_drawn_whatever_their_errors(error):
    runs = [Record(Setting("auto", tolerance=1e-3), cpu_time=time, errors=np.array([error])) for time in (0.1, 0.2)]
    reference = Reference(np.empty((0, 0, 3)), 1e-7, "one method", "another", independent=True)
    records = Records("scene", "Title", 0.1, 1.0, np.arange(2.0), 8, 1e-4, reference, runs, complete=True)
    assert front_picture(records).startswith(b"\x89PNG")
