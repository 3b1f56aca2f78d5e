"""Error against run time: the measurement."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from measured_scenes import RUBBER, SMALL
from softffd import FmuError, load_scene
from softffd.accuracy.measure import measure, settings_of
from softffd.accuracy.rig import Rig, Setting

pytestmark = pytest.mark.usefixtures("hasty")

TOUCHING = SMALL + '[[plane]]\nname = "ground"\npoint = [0.0, 0.0, -0.01]\n'


def test_leapfrog_and_the_published_scheme_show_their_order_against_a_confirmed_reference(folder):
    records = measure(load_scene("small.toml"), methods=["central_difference", "leapfrog"], quick=True, repeats=1)
    assert records.complete and records.reference.confirmed and records.reference.uncertainty < 1e-11
    for method in ("central_difference", "leapfrog"):
        runs = [run for run in records.good(method) if 1e-7 < run.error < 1e-3]
        slope = np.polyfit(np.log([run.steps for run in runs]), np.log([run.error for run in runs]), 1)[0]
        assert len(runs) >= 3 and slope == pytest.approx(-2.0, abs=0.15)
        assert all(run.cpu_time > 0 and run.errors.shape == (6,) and run.errors[0] == 0 for run in runs)


def test_a_tighter_tolerance_gives_a_smaller_error(folder):
    records = measure(load_scene("small.toml"), methods=["dop853"], quick=True, repeats=1)
    runs = records.good("dop853")
    assert len(runs) >= 5 and runs[-1].error < 1e-4 * runs[0].error and runs[-1].steps > runs[0].steps
    assert all(run.error <= 10 * run.setting.tolerance for run in runs)  # what a tolerance promises


def test_settings_go_from_coarse_to_fine():
    with Rig(load_scene("free_vibration")) as rig:
        steps = settings_of("leapfrog", rig)
        found = [next(steps).step for _ in range(6)]
        assert found[1] > rig.stable_step >= found[2] and all(1.3 <= a / b <= 2 for a, b in pairwise(found))
        assert all(rig.communication_step / step == pytest.approx(round(rig.communication_step / step)) for step in found)
        steps = settings_of("sdirk2", rig)
        assert [rig.communication_step / next(steps).step for _ in range(5)] == pytest.approx([1, 2, 3, 4, 5])
        tolerances = [setting.tolerance for setting in settings_of("dop853", rig)]
        assert tolerances[0] == pytest.approx(0.1) and tolerances[-1] == pytest.approx(1e-11) and len(tolerances) == 21


def test_scenes_with_obstacles_leave_out_what_would_be_leapfrog_and_are_unconfirmed(folder):
    Path("touching.toml").write_text(TOUCHING)
    records = measure(load_scene("touching.toml"), quick=True, repeats=1)
    assert set(records.names()) <= {"auto", "central_difference", "leapfrog"} and "bm4" in records.left_out
    assert not records.reference.confirmed and "unconfirmed" in str(records.reference)


def test_a_scene_with_a_free_body_leaves_out_the_methods_without_them(folder):
    Path("loaded.toml").write_text(SMALL + '[[pin]]\nname = "mass"\npoints = "z+"\nmotion = "free"\nmass = 1.0\nguide = [0, 0, 1]\n')
    records = measure(load_scene("loaded.toml"), quick=True, repeats=1)
    failures = [run.failure for run in records.runs if run.failure]
    assert {run.setting.method for run in records.runs if not run.failure} == {"auto", "leapfrog"}
    assert all("CPU time" in failure for failure in failures)  # which ends a sweep, on a machine that is busy
    assert records.left_out["dop853"] == "does not support free bodies"


def test_solids_count_as_obstacles():
    with Rig(load_scene("car_ball").replace({"experiment.stop_time": 0.02})) as rig:
        assert rig.contact


@pytest.mark.full
def test_sdirk2_shows_its_order_on_a_damped_body_in_contact(folder, monkeypatch):
    monkeypatch.setattr("softffd.accuracy.measure.QUICK_BUDGET", 0.2)
    Path("rubber.toml").write_text(RUBBER)
    records = measure(load_scene("rubber.toml"), methods=["auto", "leapfrog", "sdirk2"], quick=True, repeats=1)
    assert records.names() == ["auto", "leapfrog", "sdirk2"] and records.runs[-1].setting.step
    runs = [run for run in records.good("sdirk2") if 2e-4 < run.setting.step < 2e-3]
    slope = np.polyfit(np.log([run.steps for run in runs]), np.log([run.error for run in runs]), 1)[0]
    assert len(runs) == 3 and slope == pytest.approx(-2.0, abs=0.15)
    assert all(run.steps == round(records.stop_time / run.setting.step) and run.error > 30 * records.reference.uncertainty for run in runs)


LEFT_OUT = [
    ("flying", {"central_difference": "leapfrog", "bm4": "dop853", "rkn12": "dop853", "sdirk2": "beside obstacles"}, ["ros34pw2"]),
    ("rubber", {"central_difference": "as leapfrog"}, ["sdirk2"]),
    ("touching", {"sdirk2": "internal damping", "backward_euler": "rebound"}, []),
    ("small", {"backward_euler": "rebound"}, []),  # where it loses nothing it is `auto`, which would then be its own best rival
    ("driven", {"rkn12": "damping"}, ["dop853"]),
]


@pytest.mark.parametrize("scene, others, left", LEFT_OUT, ids=[scene for scene, *_ in LEFT_OUT])
def test_methods_are_left_out_where_they_are_not_defined_or_another_takes_their_steps(folder, scene, others, left):
    Path("rubber.toml").write_text(RUBBER)
    Path("flying.toml").write_text(RUBBER.replace("[[plane]]", "#").replace("name = ", "#").replace("friction = ", "#"))
    Path("touching.toml").write_text(TOUCHING)
    records = measure(load_scene(f"{scene}.toml"), methods=[*others, *left], quick=True, repeats=1)
    assert records.names() == left and all(why in records.left_out[method] for method, why in others.items())


def test_an_unknown_method_is_refused(folder):
    with pytest.raises(FmuError, match=r"wanted one of .*leapfrog, .* got 'leapfrg', did you mean \"leapfrog\""):
        measure(load_scene("small.toml"), methods=["leapfrg"])


def test_a_failing_run_is_a_record_with_its_message_and_the_next_ones_still_count(folder, fail_runs):
    error = FmuError("the component reported an error: out of luck")
    fail_runs(error, lambda _name, setting: setting.method == "leapfrog" and setting.step > 1e-3)
    records = measure(load_scene("small.toml"), methods=["leapfrog"], quick=True, repeats=1)
    assert records.runs[0].failure.endswith("out of luck") and records.good("leapfrog")


def test_a_refused_step_leaves_the_rig_fit_for_the_next_run(folder):
    with Rig(load_scene("small.toml")) as rig:
        with pytest.raises(FmuError, match="most_work"):
            rig.run(Setting("leapfrog", step=1e-12))
        first, second = (rig.run(Setting("leapfrog", step=1e-4)) for _ in range(2))
        np.testing.assert_array_equal(first.positions, second.positions)
