"""Method "sdirk2" where it is asked for: order, creep without obstacles, bodies without dashpots, given steps."""

from itertools import pairwise

import numpy as np
import pytest

from readings import orders, vector
from scenes import GRAVITY, box
from softffd import Scene, simulate
from softffd.fmu.package import scene_masses
from stepping import Stepper

TOLERANCE = 1e-4 * 0.1
"""m; the default of solver.tolerance for the pad"""
GROUND = {"name": "ground", "friction": 0.5}
PAD = {"size": [0.1, 0.1, 0.05], "origin": [0.0, 0.0, 0.0], "mass": {"total": 0.5}, "gravity": GRAVITY, "reactions": True}


def pad(tau: float, **keys) -> Scene:
    """On the ground; tau: of its dashpots [s]."""
    material = {"stiffness": 1e5, "internal_damping": tau, "damping": 0.0}
    return box(**PAD | {"method": "sdirk2", "material": material, "plane": [GROUND], "communication_step": 0.01} | keys)


def pressed(step: float) -> tuple[np.ndarray, np.ndarray]:
    """Places (10, n, 3) [m] and reactions of the ground [N] of a pad that is pressed and let go at 20 Hz, without sliding."""
    rough, steps, H = GROUND | {"friction": 5.0}, 10, 0.005
    loads = -200 * (1 - np.cos(2 * np.pi * 20 * H * np.arange(steps + 1)))
    rows = []
    with Stepper(pad(1e-2, plane=[rough], load=[{"name": "push", "points": "z+"}]), start_values={"solver.step": step}) as body:
        for begin, end in pairwise(loads):
            body.set({"load.push.z": begin})
            body.set_rates({"load.push.z": (end - begin) / H})
            body.step(H)
            assert body.number("plane.ground.contacts") == 16
            rows.append((body.points(), body.vector("plane.ground.reaction")))
        assert body.methods() == [("sdirk2", "as set")]
    return np.array([x for x, _ in rows]), np.array([f for _, f in rows])


def test_it_is_of_second_order_in_lasting_contact():
    exact = pressed(5e-5)
    runs = [pressed(h) for h in (2.5e-3, 1.25e-3, 6.25e-4, 3.125e-4)]
    for what in (0, 1):
        errors = [np.abs(run[what] - exact[what]).max() for run in runs]
        assert orders(errors) == pytest.approx([2.0, 2.0, 2.0], abs=0.15)
    assert np.abs(runs[0][1] - exact[1]).max() < 1e-5 * np.abs(exact[1]).max()


@pytest.mark.parametrize("tau", [0.1, 0.01])
def test_an_overdamped_bar_creeps_exponentially(tau):
    """Springs along edges alone: four lines of one spring and one point, with two real rates each."""
    k, load = 1e4, 400.0
    bar = box(
        points=[2, 2, 2], material={"stiffness": {"edge": k, "face": 0.0, "body": 0.0}, "internal_damping": tau, "damping": 0.0},
        pin=[{"name": "wall", "points": "x-"}], load=[{"name": "pull", "points": "x+"}], method="sdirk2",
    )  # fmt: skip
    m = scene_masses(bar).mass[1]
    fast, slow = (-tau * k + sign * np.sqrt((tau * k) ** 2 - 4 * k * m) for sign in (-1, 1))
    time = tau / 4 * np.arange(1, 13)
    with Stepper(bar) as body:
        body.set({"load.pull.x": load})
        ends = np.array([(body.step(tau / 4), body.points()[1::2, 0] - 1)[1] for _ in time])
        assert body.methods() == [("sdirk2", "as set")]
    one, other = fast / (2 * m), slow / (2 * m)
    exact = load / 4 / k * (1 - (one * np.exp(other * time) - other * np.exp(one * time)) / (one - other))
    assert np.abs(ends - exact[:, None]).max() < 1e-4  # m; the tolerance
    if tau == 0.1:  # with so much of it, mass hardly counts
        assert exact == pytest.approx(load / 4 / k * (1 - np.exp(-time / tau)), rel=1e-2)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_a_slender_beam_remembers_its_errors_for_as_long_as_it_swings(tolerance):
    """At 8 Hz: what a step errs by is there for a second, as long as the swing lasts, though its cells ring much faster."""
    beam = box(
        points=[7, 2, 2], size=[0.12, 0.02, 0.02], mass={"total": 0.05}, gravity=GRAVITY, pin=[{"name": "wall", "points": "x-"}],
        material={"stiffness": 2e3, "internal_damping": 1e-3, "damping": 0.0}, stop_time=0.6, communication_step=0.01, method="sdirk2",
    )  # fmt: skip
    result = simulate(beam, start_values={"solver.tolerance": tolerance})
    exact = simulate(beam, start_values={"solver.method": "dop853", "solver.tolerance": 1e-8})
    assert np.abs(exact.positions - exact.positions[0]).max() > 0.01  # m
    assert np.abs(result.positions - exact.positions).max() < 3 * tolerance * 0.12


STARTS = {
    "rests": {},
    "slides": {"velocity": [0.3, 0.0, 0.0]},
    "drops": {"offset": [0.0, 0.0, 0.005]},
    "drops tilted": {"offset": [0.0, 0.0, 0.03], "rotation": {"axis": [1.0, 0.4, 0.0], "degrees": 25.0}},
    "hangs": {"plane": [], "pin": [{"name": "top", "points": "z+"}]},
    "flies": {"plane": [], "angular_velocity": [0.0, 3.0, 1.0], "velocity": [1.0, 0.0, 0.0]},
}


@pytest.mark.parametrize("case", STARTS)
def test_bodies_without_dashpots_are_right_to_ten_tolerances(case):
    scene = pad(0.0, stop_time=0.06, **STARTS[case])
    result, exact = simulate(scene), simulate(scene, start_values={"solver.method": "leapfrog", "solver.tolerance": 1e-6})
    assert np.abs(result.positions - exact.positions).max() < 10 * TOLERANCE


@pytest.mark.parametrize("tau", [0.0, 1e-4])
@pytest.mark.parametrize("case", STARTS)
def test_given_steps_are_taken_as_they_are_and_only_lose_energy(case, tau):
    """Impacts within them are plastic, so that everything comes to rest."""
    scene = pad(tau, energy=True, stop_time=0.4, outputs={"solver": True}, **STARTS[case])
    result = simulate(scene, start_values={"solver.step": 1e-3})
    stored = sum(result.outputs[f"energy.{part}"] for part in ("kinetic", "elastic", "gravity"))
    assert result.outputs["solver.steps"][-1] == 400
    assert (stored - stored[0]).max() < 1e-12
    if tau and "plane" not in STARTS[case]:
        assert vector(result, "plane.ground.reaction")[-1] == pytest.approx([0.0, 0.0, -0.5 * 9.81], abs=1e-6)
