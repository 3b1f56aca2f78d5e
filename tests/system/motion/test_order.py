"""The order of every method: of the motion, of the energy balance and of the impulses on pins, at given internal steps.

Each method runs the same scenes with H / n as its internal step, H the communication step. Errors are against dop853 at a step so small
that rounding is left (some 1e-14 m), which is where all methods converge to; the root mean square over all points and communication
points, because the largest error of a single point jumps from step to step by more than the orders tell apart.
"""

from dataclasses import dataclass

import numpy as np
import pytest

from scenes import LED, box
from stepping import Stepper

H = 0.012

LOADS = {"load": [{"name": "push", "points": "x+"}, {"name": "pull", "points": [[0, 0, 0]]}]}
PIN = {"pin": [{"name": "hand", "points": "x-", **LED}]}
CENTRE = np.array([0.0, 0.5, 0.5])


def turning(damping=0.0, gravity=-9.81, **parts):
    """The free box with these parts."""
    return box(
        stiffness=1e3, damping=damping, gravity=[0.0, 0.0, gravity], stretch=[1.04, 0.98, 1.0], angular_velocity=[1.0, -2.0, 3.0],
        velocities="all", energy=True, reactions=True, outputs={"solver": True}, **parts,
    )  # fmt: skip


CASES = {
    "free": turning(),
    "damped": turning(damping=0.1),
    "ramp": turning(**LOADS),
    "damped ramp": turning(damping=0.1, **LOADS),
    "curved": turning(damping=0.1, **LOADS),
    "pin": turning(**PIN),
    "damped pin": turning(damping=0.1, **PIN),
    "turning pin": turning(gravity=0.0, **PIN),
    "dashpots ramp": turning(damping=0.1, material={"internal_damping": 1e-4}, **LOADS),
    "dashpots pin": turning(material={"internal_damping": 1e-4}, **PIN),
}


@dataclass(frozen=True)
class Row:
    """A method: its order, what n is for its internal steps H / n, and by how much the observed order may miss the claimed one.

    Errors of order 12 fall from the first step that is stable to rounding within a factor 2 of the step, where the terms of higher
    order still show: the slope over all steps is within 0.5 of 12, those between neighbouring steps scatter by more.
    """

    order: int
    divisions: tuple[int, ...]
    within: float = 0.15


METHODS = {
    "leapfrog": Row(2, (48, 96, 192)),
    "central_difference": Row(2, (48, 96, 192)),
    "bm4": Row(4, (16, 32, 64)),
    "rkn12": Row(12, (5, 6, 7, 8), within=0.5),
    "dop853": Row(8, (8, 12, 16)),
    "ros34pw2": Row(3, (32, 64, 128)),
}


def pairs(cases, methods=METHODS):
    """Of cases and methods, without those that a method would leave to another."""
    return [(case, method) for case in cases for method in methods if method not in leaving(case)]


def leaving(case):
    if "dashpots" in case:
        return "rkn12", "bm4", "central_difference"
    return ("rkn12",) if CASES[case].material.damping else ()


def loads(time, order=0):
    """The course of the loads [N], or its derivative of some order."""
    turned = order * np.pi / 2
    push = 20**order * 8 * np.sin(20 * time + turned), 15**order * 5 * np.cos(15 * time + turned), 0.0
    pull = 0.0, 0.0, (30 * time, 30.0, 0.0, 0.0)[order]
    return dict(zip((f"load.{name}.{axis}" for name in ("push", "pull") for axis in "xyz"), [*push, *pull], strict=True))


START, SPEED, ACCELERATION = CENTRE, np.array([0.5, 0.2, -0.3]), np.array([3.0, -4.0, 5.0])
TURN, TURN_RATE = 1.0, 8.0


def drive(stepper, case, time):
    """Sets inputs and their derivatives for the communication step that begins now."""
    if "ramp" in case:  # straight lines from one communication point to the next
        now, then = loads(time), loads(time + H)
        stepper.set(now)
        stepper.set_rates({name: (then[name] - now[name]) / H for name in now})
    if case == "curved":
        stepper.set(loads(time))
        stepper.set_rates({name: [loads(time, order)[name] for order in (1, 2, 3)] for name in loads(time)})
    if "pin" in case:
        moves = 0.0 if case == "turning pin" else 1.0
        place = START + moves * (SPEED * time + 0.5 * ACCELERATION * time**2)
        angle = TURN * time + 0.5 * TURN_RATE * time**2
        stepper.set(vector("pin.hand.position", place) | vector("pin.hand.velocity", moves * (SPEED + ACCELERATION * time)))
        stepper.set({"pin.hand.orientation.w": np.cos(angle / 2), "pin.hand.orientation.x": np.sin(angle / 2)})
        stepper.set({"pin.hand.angular_velocity.x": TURN + TURN_RATE * time})
        stepper.set_rates(vector("pin.hand.velocity", moves * ACCELERATION) | {"pin.hand.angular_velocity.x": TURN_RATE})


def vector(name, values):
    return {f"{name}.{axis}": float(value) for axis, value in zip("xyz", values, strict=True)}


@dataclass(frozen=True)
class Course:
    """A run at its communication points: x [m] and v [m/s] (T, n, 3), energy + dissipated - work (T,) [J], pin (T, 2, 3) [N, N m]."""

    x: np.ndarray
    v: np.ndarray
    energy: np.ndarray
    pin: np.ndarray


def run(stepper, case, method, n, steps):
    stepper.restart({"solver.method": method, "solver.step": H / n})
    rows = []
    for number in range(steps + 1):
        kept = stepper.energy("kinetic", "elastic", "gravity", "dissipated") - stepper.energy("work")
        pin = [stepper.vector(f"pin.hand.{what}") if "pin" in case else np.zeros(3) for what in ("reaction", "torque")]
        rows.append((stepper.points(), stepper.point_velocities(), kept, pin))
        if number < steps:
            drive(stepper, case, number * H)
            stepper.step(H)
    assert stepper.number("solver.steps") == steps * n, "the given step was divided"
    return Course(*(np.array(column) for column in zip(*rows, strict=True)))


@pytest.fixture(scope="module", params=[10, 20], ids="{} steps".format)
def courses(request):
    """courses(case, method, n) runs so many communication steps once and remembers."""
    steppers, known = {}, {}

    def course(case, method, n):
        if case not in steppers:
            steppers[case] = Stepper(CASES[case])
        if (case, method, n) not in known:
            known[case, method, n] = run(steppers[case], case, method, n, request.param)
        return known[case, method, n]

    yield course
    for stepper in steppers.values():
        stepper.close()


def rms(difference):
    """Root mean square over all points and communication points."""
    return np.sqrt((difference**2).sum(axis=-1).mean())


def observed(divisions, errors):
    """The slope of log error over log step."""
    return -np.polyfit(np.log(divisions), np.log(errors), 1)[0]


@pytest.mark.short("10 steps-dashpots pin-*", "10 steps-damped ramp-*", "10 steps-curved-*")
@pytest.mark.parametrize(("case", "method"), pairs([case for case in CASES if case != "turning pin"]))
def test_the_motion_has_the_methods_order(courses, case, method):
    row = METHODS[method]
    exact = courses(case, "dop853", 60)
    runs = [courses(case, method, n) for n in row.divisions]
    for quantity in ("x", "v"):
        errors = [rms(getattr(run, quantity) - getattr(exact, quantity)) for run in runs]
        assert observed(row.divisions, errors) == pytest.approx(row.order, abs=row.within), (quantity, errors)


@pytest.mark.short("10 *damped ramp", "10 *damped pin")
@pytest.mark.parametrize("case", [case for case in CASES if case != "turning pin" and "dashpots" not in case])
def test_the_references_agree_to_rounding(courses, case):
    one, other = courses(case, "bm4", 1200), courses(case, "dop853", 60)
    assert rms(one.x - other.x) < 1e-13
    assert rms(one.v - other.v) < 1e-10  # rounding of a position times the highest frequency, 930 rad/s, and some growth


SMOOTH = [method for method in METHODS if method != "central_difference"]


@pytest.mark.short("10 *ramp-*", "10 *pin-*", "10 *curved-*")
@pytest.mark.parametrize(("case", "method"), pairs([case for case in CASES if case != "turning pin"], SMOOTH))
def test_the_energy_balance_closes_with_the_methods_order(courses, case, method):
    """Kinetic + elastic + gravity + dissipated - work. Runge-Kutta methods have one order more here: they lose energy in odd powers."""
    row = METHODS[method]
    gaps = [np.abs(run.energy - run.energy[0]).max() for run in (courses(case, method, n) for n in row.divisions)]
    assert observed(row.divisions, gaps) > row.order - row.within, gaps
    assert gaps[-1] < 0.05


@pytest.mark.short("10 *ramp-*", "10 *pin-*")
@pytest.mark.parametrize(("case", "method"), pairs([case for case in CASES if case not in ("turning pin", "curved")], SMOOTH))
def test_momentum_is_what_loads_drag_and_pins_gave(courses, case, method):
    """The change of momentum in every communication step is the impulse of gravity, loads, damping and pin: to rounding (1e-13 N s).
    But the drag of fixed-step methods is no sum over the way of the points: it has the method's order."""
    scene, row = CASES[case], METHODS[method]
    damping = scene.material.damping
    times = H * np.arange(len(courses(case, method, row.divisions[0]).x))
    load = np.array([[loads(t)[f"load.push.{axis}"] + loads(t)[f"load.pull.{axis}"] for axis in "xyz"] for t in times]) * ("ramp" in case)
    given = 0.5 * H * (load[1:] + load[:-1]) + H * np.array(scene.environment.gravity)

    def gap(n):
        run = courses(case, method, n)
        momentum, way = run.v.mean(axis=1), run.x.sum(axis=1)  # 1 kg in all, the same on every point
        return np.abs(np.diff(momentum, axis=0) - given + damping * np.diff(way, axis=0) + H * run.pin[1:, 0]).max()

    gaps = [gap(n) for n in row.divisions]
    if damping and row.order <= 4 and max(gaps) > 1e-13:
        assert observed(row.divisions, np.maximum(gaps, 1e-14)) > row.order - row.within, gaps
    else:
        assert max(gaps) < 1e-13


@pytest.mark.short("10 *")
@pytest.mark.parametrize("method", SMOOTH)
def test_angular_momentum_is_what_the_pin_gave(courses, method):
    """About the origin of a frame that only turns. Kicks and drifts keep it to rounding, Runge-Kutta methods to their order."""
    row, gaps = METHODS[method], []
    for n in row.divisions:
        run = courses("turning pin", method, n)
        spin = np.cross(run.x - CENTRE, run.v).mean(axis=1)
        gaps.append(np.abs(np.diff(spin, axis=0) + H * run.pin[1:, 1]).max())
    if method in ("dop853", "ros34pw2"):
        assert observed(row.divisions, gaps) > row.order - row.within, gaps
    else:
        assert max(gaps) < 1e-13  # rkn12 is below it at its longest step
