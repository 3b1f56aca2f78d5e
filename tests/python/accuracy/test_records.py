"""What is concluded from a measurement."""

import numpy as np
import pytest

from softffd.accuracy.records import Record, Records
from softffd.accuracy.reference import Reference
from softffd.accuracy.report import factor_words
from softffd.accuracy.rig import Setting


def made_up_records(uncertainty: float = 1e-12) -> Records:
    times = np.array([0.0, 0.5, 1.0])
    reference = Reference(np.zeros((3, 8, 3)), uncertainty, "dop853", "rkn12", True)
    records = Records("box", "A box", 0.5, 1.0, times, 8, 1e-4, reference, complete=True)

    def add(method, time, error, **setting):
        records.runs.append(Record(Setting(method, **setting), "softffd", time, 3, 100, None, np.array([0.0, error / 2, error])))

    add("auto", 0.011, 5e-3, tolerance=1e-2)
    add("auto", 0.016, 5e-5, tolerance=1e-4)
    add("central_difference", 0.1, 5e-3, step=1e-3)
    add("central_difference", 1.0, 5e-5, step=1e-4)
    add("rkn12", 0.012, 2e-3, tolerance=1e-2)
    add("rkn12", 0.010, 5e-5, tolerance=1e-4)
    add("rkn12", 0.020, 5e-7, tolerance=1e-6)
    records.runs.append(Record(Setting("rkn12", tolerance=1e-8), failure="too tight"))
    return records


def test_times_factors_and_ratios_are_those_of_the_cheapest_runs():
    records = made_up_records()
    assert records.cheapest("rkn12", 1e-2).cpu_time == 0.010  # the more accurate run happens to be the cheaper one
    assert records.factor(records.cheapest("auto", 1e-4), 1e-4) == (pytest.approx(1.0 / 0.016), False)
    assert records.factor(records.best(1e-6), 1e-6) == (pytest.approx(1.0 / 0.020), True)
    assert factor_words(records.factor(records.best(1e-6), 1e-6)) == "> 50"
    assert records.ratio(1e-2) == pytest.approx(1.1) and records.ratio(1e-4) == pytest.approx(1.6) and records.ratio(1e-6) is None
    assert [run.cpu_time for run in records.front()] == [0.010, 0.020]


def test_auto_is_recommended_where_it_is_close_to_the_best_and_of_equal_times_the_more_accurate_run():
    records = made_up_records()
    assert records.recommended(1e-2).name == "auto" and records.recommended(1e-4).name == "rkn12" and records.recommended(1e-8) is None
    records.runs.append(Record(Setting("auto", tolerance=3e-3), "softffd", 0.0115, 3, 100, None, np.array([0.0, 1e-4, 2e-4])))
    assert records.cheapest("auto", 1e-2).setting.tolerance == 1e-2 and records.recommended(1e-2).setting.tolerance == 3e-3


def test_the_worst_miss_of_a_tolerance_is_found_and_unresolved_errors_are_not_judged():
    records = made_up_records()
    records.runs.append(Record(Setting("auto", tolerance=1e-6), "softffd", 0.03, 3, 100, None, np.array([0.0, 1e-5, 2e-5])))
    assert records.worst_of_tolerance("auto").error == 2e-5  # twenty tolerances; the others stay below one
    assert made_up_records().worst_of_tolerance("central_difference") is None
    assert made_up_records(uncertainty=1e-3).worst_of_tolerance("rkn12") is None


def test_an_error_below_three_uncertainties_is_not_claimed():
    records = made_up_records(uncertainty=1e-6)
    assert records.cheapest("rkn12", 1e-6) is None and records.cheapest("rkn12", 3e-6).error == 5e-7
