"""Stiff bodies that fly and turn: auto takes long steps in a frame that turns with them, and says so."""

import numpy as np
import pytest

from scenes import GRAVITY, box
from stepping import Stepper

FLIGHT = (
    "ros34pw2 in a floating frame",
    "auto: a stiff body is in free flight and its fast vibrations are small: implicit steps damp them",
)
IN_FLIGHT = [FLIGHT]
ABOVE_GROUND = (
    "modal superposition in a floating frame",
    "a stiff body is in free flight near an obstacle; its modes describe its vibrations",
)

KINDS = ("kinetic", "elastic", "gravity", "dissipated")
GROUND = {"name": "ground", "friction": 0.4}


def thrown(*, stiffness=1e8, damping=0.0, planes=()):
    """A box of uneven masses, turning about all its axes, with a load on a corner."""
    return box(
        lattice={"points": [4, 4, 3], "size": [1.0, 0.8, 0.5]}, stiffness=stiffness, damping=damping,
        region=[{"points": "x+", "mass": 0.03}], gravity=GRAVITY, plane=planes, offset=[0.0, 0.0, 1.0], velocity=[1.0, 0.0, 1.0],
        angular_velocity=[8.0, 15.0, -11.0], load=[{"name": "push", "points": [[3, 3, 2]]}], velocities="all", energy=True,
        outputs={"solver": True},
    )  # fmt: skip


def push(stepper, newton):
    stepper.set({f"load.push.{axis}": newton * share for axis, share in zip("xyz", (2.0, -1.0, 3.0), strict=True)})


def angular_momentum(stepper, mass):
    x, v = stepper.points(), stepper.point_velocities()
    centre, velocity = mass @ x / mass.sum(), mass @ v / mass.sum()
    return mass @ np.cross(x - centre, v - velocity)


def masses(points=48):
    """Of the box: 1 kg, then the region's."""
    mass = np.full(points, 1 / points)
    mass[3::4] = 0.03
    return mass


@pytest.fixture(scope="module")
def explicit():
    """Positions after 0.2 s of leapfrog at half the stable step, by damping and push."""
    known = {}

    def run(damping, newton):
        if (damping, newton) not in known:
            with Stepper(thrown(damping=damping), start_values={"solver.method": "leapfrog", "solver.step": 2e-6}) as stepper:
                push(stepper, newton)
                stepper.step(0.1, times=2)
                known[damping, newton] = stepper.points()
        return known[damping, newton]

    return run


@pytest.mark.short("0.01-*-1e-06", "0.1-*-0.0001", "0.001-pushed-1e-06")
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize(("damping", "newton"), [(0.0, 0.0), (0.1, 0.0), (0.0, 2.0)], ids=["free", "damped", "pushed"])
@pytest.mark.parametrize("step", [1e-3, 1e-2, 1e-1])
def test_the_motion_is_that_of_explicit_steps(explicit, step, damping, newton, tolerance):
    """The reference vibrates by about 1e-7 m about the stretch that turning causes; short steps may follow that, explicitly."""
    with Stepper(thrown(damping=damping), start_values={"solver.tolerance": tolerance}, stop_time=0.2) as stepper:
        push(stepper, newton)
        stepper.step(step, times=round(0.2 / step))
        error = np.abs(stepper.points() - explicit(damping, newton)).max()
        assert stepper.methods() == IN_FLIGHT or step == 1e-3
    assert error < tolerance


def test_a_turning_drop_flies_in_long_steps_and_strikes_in_explicit_ones():
    with Stepper(thrown(stiffness=1e9, planes=[GROUND])) as stepper:
        stepper.step(0.01, times=35)
        assert stepper.methods() == [ABOVE_GROUND]
        assert stepper.number("solver.steps") == 35
        while len(stepper.methods()) == 1:
            stepper.step(0.01)
        assert stepper.methods()[1] == ("leapfrog", "a stiff body hits an obstacle, or vibrates on one")
        assert stepper.points()[:, 2].min() >= 0


def test_the_spin_is_kept_until_a_point_touches():
    """Within reach of the ground too, where it could be met: the last step before it is met keeps the spin as the first does."""
    with Stepper(thrown(planes=[GROUND])) as stepper:
        before = angular_momentum(stepper, masses())
        while True:
            lowest, after = stepper.points()[:, 2].min(), angular_momentum(stepper, masses())
            stepper.step(0.02)
            if stepper.read("plane.ground.reaction.z")[0] != 0:
                break
        assert stepper.methods()[0] == ABOVE_GROUND
    assert lowest < 0.4
    assert np.linalg.norm(after - before) < 1e-11 * np.linalg.norm(before)


@pytest.mark.parametrize("stiffness", [1e7, 1e9, 1e12])
def test_a_long_flight_keeps_its_angular_momentum_and_its_energies(stiffness):
    with Stepper(thrown(stiffness=stiffness), stop_time=5.0) as stepper:
        before, start = angular_momentum(stepper, masses()), stepper.energy(*KINDS)
        stepper.step(0.01, times=500)
        after, end = angular_momentum(stepper, masses()), stepper.energy(*KINDS)
        assert stepper.methods() == IN_FLIGHT
    assert np.linalg.norm(after - before) < 1e-11 * np.linalg.norm(before)
    assert end == pytest.approx(start, rel=1e-12)


def test_work_of_a_growing_load_is_in_the_balance():
    with Stepper(thrown(damping=0.05)) as stepper:
        start = stepper.energy(*KINDS)
        for number in range(30):
            push(stepper, 0.1 * number)
            stepper.set_rates({"load.push.x": 20.0, "load.push.y": -10.0, "load.push.z": 30.0})
            stepper.step(0.01)
        end, work, dissipated = stepper.energy(*KINDS), stepper.energy("work"), stepper.energy("dissipated")
        assert stepper.methods() == IN_FLIGHT
    assert end - work == pytest.approx(start, rel=1e-12)
    assert dissipated > 0


def state_of(stepper):
    return np.concatenate([stepper.points().ravel(), stepper.point_velocities().ravel(), stepper.outputs()]).tolist()


def test_a_flight_goes_on_from_a_saved_state_with_the_same_bits():
    """Saved between and right after the choices of the method, and with a factor half used; in this instance and in another one."""
    body = thrown(stiffness=1e9, planes=[GROUND])
    with Stepper(body) as stepper, Stepper(body) as other:
        saved = []
        for number in range(60):
            if number % 6 == 0:
                saved.append((number, stepper.save()))
            stepper.step(0.007)
        end = state_of(stepper)
        assert stepper.methods()[0] == ABOVE_GROUND
        for number, state in reversed(saved):
            other.restore(bytes(state))
            stepper.restore(state)
            for which in (stepper, other):
                which.step(0.007, times=60 - number)
                assert state_of(which) == end
