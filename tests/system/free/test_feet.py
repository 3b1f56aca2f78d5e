"""A rigid foot that is bonded to the object's lower side, with a mass of its own, falls on the ground with it and comes to rest there."""

from functools import cache

import numpy as np
import pytest

from scenes import meshed
from softffd import Simulation, simulate
from validation import shapes

OBJECT, FOOT, GRAVITY = 1.0, 2.0, 9.81
FALL = (OBJECT + FOOT) * GRAVITY * 0.05
STARTS = 5


def dropped(folder, internal_damping: float, start: int = 0):
    """By 50 mm, moving and turning a little, by a ten-thousandth more from each start to the next."""
    return meshed(
        folder, shapes.cube(4, 0.0), points=[4, 4, 4], material={"stiffness": 2e3, "damping": 0.2, "internal_damping": internal_damping},
        mass={"total": OBJECT}, gravity=[0, 0, -GRAVITY], velocity=[0.3, 0.0, 0.0], angular_velocity=[0.2 * (1 + 1e-4 * start), 0.3, 0.0],
        plane=[{"name": "ground", "friction": 0.4, "point": [0, 0, -0.05]}],
        pin=[{"name": "foot", "points": "z-", "motion": "free", "mass": FOOT, "inertia": [0.3, 0.3, 0.5]}],
        outputs={"energy": True, "reactions": True}, stop_time=3.0, communication_step=0.01,
    )  # fmt: skip


def energies_of_landing(scene):
    """By name, at each communication point until it has come to rest [J]."""
    names = [f"energy.{kind}" for kind in ("kinetic", "elastic", "gravity", "dissipated", "work")]
    with Simulation(scene) as simulation:
        rows = []
        for _ in range(50):
            simulation.step()
            rows.append([simulation[name] for name in names])
    return dict(zip(names, np.array(rows).T, strict=True))


def balance(energies):
    """What is stored and dissipated, without what has come from outside [J]."""
    return sum(values for name, values in energies.items() if name.startswith("energy.")) - 2 * energies["energy.work"]


@pytest.fixture(scope="module")
def run_with(tmp_path_factory):
    """run_with(internal damping)"""
    return cache(lambda internal_damping: simulate(dropped(tmp_path_factory.mktemp("dropped"), internal_damping)))


@pytest.fixture(scope="module")
def landings(tmp_path_factory):
    """landings(internal damping), of starts that hardly differ: by which vertex comes down first, energies err by up to five times more or
    less."""
    folder = tmp_path_factory.mktemp("landings")
    return cache(lambda damping: [energies_of_landing(dropped(folder, damping, start)) for start in range(STARTS)])


@pytest.mark.short("0.0", "0.0001")
@pytest.mark.parametrize("internal_damping", [0.0, 1e-4, 1e-3])
def test_at_rest_the_foot_is_held_by_its_weight_and_the_ground_by_that_of_both(internal_damping, run_with):
    run = run_with(internal_damping)
    assert run.outputs["pin.foot.reaction.z"][-50:].mean() == pytest.approx(FOOT * GRAVITY, rel=1e-4)
    assert run.outputs["plane.ground.reaction.z"][-50:].mean() == pytest.approx(-(OBJECT + FOOT) * GRAVITY, rel=1e-4)


@pytest.mark.short("0.0", "0.0001")
@pytest.mark.parametrize("internal_damping", [0.0, 1e-4, 1e-3])
def test_what_is_dissipated_never_comes_back(internal_damping, run_with):
    assert np.diff(run_with(internal_damping).outputs["energy.dissipated"]).min() > -1e-9 * FALL


@pytest.mark.short("0.0", "0.0001")
@pytest.mark.parametrize("internal_damping", [0.0, 1e-4, 1e-3])
def test_nothing_works_from_outside(internal_damping, landings):
    largest = [np.abs(each["energy.work"]).max() for each in landings(internal_damping)]
    assert np.median(largest) < (1e-5 if internal_damping else 2e-5) * FALL


@pytest.mark.short("0.0", "0.0001")
@pytest.mark.parametrize("internal_damping", [0.0, 1e-4, 1e-3])
def test_what_the_fall_gives_is_stored_or_dissipated(internal_damping, landings, run_with):
    assert np.median([np.ptp(balance(each)) for each in landings(internal_damping)]) < (1e-5 if internal_damping else 1e-4) * FALL
    assert np.ptp(balance(run_with(internal_damping).outputs)[50:]) < 1e-5 * FALL
