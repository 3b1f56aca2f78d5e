"""The reference of a measurement, by runs whose errors are known."""

from dataclasses import dataclass

import numpy as np
import pytest

from softffd import FmuError
from softffd.accuracy.reference import find_reference
from softffd.accuracy.rig import Run

ALL = ("leapfrog", "bm4", "rkn12", "dop853")


@dataclass
class MadeUpRig:
    """Runs whose errors are known: tolerance + error for adaptive methods, (100 h)^order for the others."""

    methods: tuple[str, ...]
    damped: bool = False
    dashpots: bool = False
    contact: bool = False
    free: bool = False
    tightest: float = 0.0
    longest: float = 1.0
    error: float = 0.0
    side: float = 2.0
    communication_step: float = 0.01
    stable_step: float = 1e-3

    def run(self, setting, **_options):
        if setting.tolerance and setting.tolerance < self.tightest:
            raise FmuError("too tight")
        signs = {"dop853": 1, "rkn12": -1, "bm4": 1, "leapfrog": -1}
        orders = {"bm4": 4, "leapfrog": 2}
        step = min(setting.step, self.longest)
        error = (100 * step) ** orders[setting.method] if step else setting.tolerance + self.error
        steps = 1 / step if step else 100
        return Run(np.full((2, 1, 3), 1.0) + signs[setting.method] * error, 1e-4 * steps, 1, int(steps), None)


def test_two_adaptive_methods_confirm_each_other():
    reference = find_reference(MadeUpRig(ALL))
    assert reference.confirmed and reference.method.startswith("dop853") and reference.check.startswith("rkn12")
    assert reference.uncertainty == pytest.approx(2e-13 * np.sqrt(3) / 2, rel=1e-2)  # 1e-13 to either side, of a box of 2 m


def test_a_damped_scene_is_confirmed_by_an_extrapolated_splitting_method():
    reference = find_reference(MadeUpRig(ALL, damped=True))
    assert reference.confirmed and reference.check.startswith("bm4") and reference.uncertainty < 1e-12


def test_internal_damping_is_confirmed_by_leapfrog_as_bm4_would_be_dop853_again():
    reference = find_reference(MadeUpRig(ALL, damped=True, dashpots=True))
    assert reference.method.startswith("dop853") and reference.check.startswith("leapfrog")


def test_a_step_that_was_shortened_to_the_one_before_confirms_nothing():
    """Else a body whose dashpots bound the step by less than its stiffness does would have a reference without an error."""
    reference = find_reference(MadeUpRig(("leapfrog",), contact=True, longest=1e-5))
    assert reference.uncertainty > 1e-9 and float(reference.method.split()[2]) < 1e-5


def test_a_method_that_cannot_be_so_tight_is_asked_for_less():
    reference = find_reference(MadeUpRig(("leapfrog", "rkn12", "dop853"), tightest=5e-12))
    assert reference.method == "dop853 at tolerance 1e-11" and reference.confirmed


def test_two_methods_that_disagree_confirm_nothing():
    reference = find_reference(MadeUpRig(("rkn12", "dop853"), error=1e-6))
    assert not reference.confirmed and "rkn12 at tolerance 1e-13 differs by 1.7e-06" in str(reference)


@pytest.mark.parametrize("rig", [MadeUpRig(("leapfrog", "dop853"), contact=True), MadeUpRig(("auto", "leapfrog"))])
def test_one_method_alone_is_unconfirmed_and_its_last_difference_is_the_uncertainty(rig):
    reference = find_reference(rig)
    step = float(reference.method.split()[2])
    assert not reference.confirmed and "unconfirmed" in str(reference)
    assert reference.uncertainty == pytest.approx(3 * (100 * step) ** 2 * np.sqrt(3) / 2, rel=0.1)
