"""Bodies have the energy that they were given: what gains more is warned of, or done again with smaller steps."""

import pytest

from scenes import box, table_and_press
from softffd import load_scene
from stepping import Stepper

RESONANT = box(
    stiffness=1e3, damping=0.0, region=[{"points": "x+", "mass": 2.3e-5}], pin=[{"name": "base", "points": "x-"}], stretch=[1.2, 1.0, 1.0],
    energy=True, outputs={"solver": True}, method="leapfrog",
)  # fmt: skip


def violent(method="leapfrog"):
    return box(
        points=[2, 2, 2], stiffness=1e3, damping=0.0, stretch=[0.5, 2.0, 2.0], angular_velocity=[-22.0, 25.0, -2.0], energy=True,
        outputs={"solver": True}, method=method, tolerance=10.0,
    )  # fmt: skip


def shake(body, share, *, h=1e-3):
    """0.05 s at a share of the stability bound."""
    body.restart({"solver.step": share * body.read("solver.stable_step")[0]})
    start = body.energy()
    most = start
    for _ in range(50):
        body.step(h)
        most = max(most, body.energy())
    return most / start


def test_a_given_step_that_feeds_vibrations_is_warned_of_once():
    with Stepper(RESONANT) as body:
        assert shake(body, 0.98) > 1.2
        (warning,) = body.said("the body has gained")
        safe = float(warning.split("set solver.step below ")[1].split(" s")[0])
        assert safe == pytest.approx(0.3 * body.read("solver.stable_step")[0], rel=0.1)  # the bound is that of the moment; 0.281
        assert shake(body, safe / body.read("solver.stable_step")[0]) < 1.01
        assert not body.said("gained")


def test_a_damped_body_whose_cells_stiffen_within_a_given_step_is_warned_of():
    """Crushed at 10 m/s to half its height, and held so: more energy than the press has given."""
    crushed = box(
        stiffness=10.0, damping=0.001, volume_stiffness=1e9, plane=table_and_press(), energy=True, method="leapfrog", step=2e-4,
    )  # fmt: skip
    with Stepper(crushed, start_values={"plane.press.velocity.z": -10.0}) as body:
        for n in range(20):
            body.set({"plane.press.point.z": 1 - 0.125 * min(n, 4), "plane.press.velocity.z": -10.0 if n < 4 else 0.0})
            body.step(0.0125)
        assert body.energy() > body.energy("work")
        assert len(body.said("the body has gained")) == 1


@pytest.mark.parametrize("share", [0.95, 0.7, 0.3])
def test_steps_that_do_no_harm_are_not(share):
    """Kinetic + elastic goes up and down by (omega h / 2)^2 of itself without harm: that is not a gain."""
    with Stepper(RESONANT) as body:
        assert shake(body, share) < 1.01
        assert not body.said("gained")


@pytest.mark.parametrize("method", ["auto", "leapfrog", "bm4"])
def test_automatic_steps_that_gain_energy_are_made_smaller(method):
    """At a tolerance that asks for nothing stability alone sets the steps of a body that is thrown inside out again and again."""
    with Stepper(violent(method)) as body:
        start, most = body.energy(), 0.0
        for _ in range(60):
            body.step(0.15)
            most = max(most, body.energy())
        assert body.said("the body gained energy with its usual internal steps; from now on they are multiplied by 0.5")
        assert not body.said("has gained")
        assert most < 1.5 * start


@pytest.mark.parametrize("name", ["free_vibration", "light_corner", "spin"])
@pytest.mark.parametrize("method", ["auto", "leapfrog", "bm4"])
def test_shipped_scenes_gain_nothing(name, method):
    example = load_scene(name)
    with Stepper(example, start_values={"solver.method": method}, stop_time=1.0) as body:
        body.step(0.05, times=20)
        assert not body.said("gained")


@pytest.mark.parametrize("held", ["load", "pin"])
def test_what_the_outside_gives_is_no_gain(held):
    """A force that ramps, a pin that is moved in jumps: some hundred times the energy that was there."""
    parts = {"load": {"name": "push", "points": "x+"}, "pin": {"name": "hand", "points": "x+", "motion": "input"}}
    scene = box(stiffness=1e3, damping=0.0, stretch=[1.01, 1.0, 1.0], energy=True, **{held: [parts[held]]})
    with Stepper(scene, start_values={"solver.method": "leapfrog", "solver.step": 5e-4}) as body:
        start = body.energy()
        for n in range(100):
            if held == "load":
                body.set({"load.push.x": 2.0 * n})
                body.set_rates({"load.push.x": 200.0})
            else:
                body.set({"pin.hand.position.x": 1.005 + 0.004 * (n % 7)})
            body.step(0.01)
        assert body.energy() > 100 * start
        assert not body.said("gained")


def test_a_saved_run_remembers_what_it_has_gained():
    """From before its steps are made smaller, and from after that."""
    with Stepper(violent()) as body:
        for _ in range(2):
            body.step(0.15, times=4)
            before = body.save()
            body.step(0.15, times=20)
            end = body.points()
            body.restore(before)
            body.step(0.15, times=20)
            assert (body.points() == end).all()
        assert body.said("gained energy with its usual internal steps")
