"""`solver.error_estimate` against the true error, at the end of the run and as the largest over time.

The reference is a much more accurate run by another method. Errors and estimates are relative to the largest side of the box; below FLOOR
rounding and the reference's own error are what is left, and either may be the larger.
"""

from functools import cache

import numpy as np
import pytest

from readings import points
from scenes import LED, box
from softffd import load_scene, simulate

FLOOR = 1e-11
REFERENCES = {
    "free_vibration": [("dop853", {"solver.tolerance": 1e-13}), ("rkn12", {"solver.tolerance": 1e-13})],
    "stiff_pull": [("dop853", {"solver.tolerance": 1e-13}), ("bm4", {"solver.step": 5e-6})],
    "stiff_layer": [("dop853", {"solver.tolerance": 1e-13}), ("bm4", {"solver.step": 5e-6})],
    "light_corner": [("dop853", {"solver.tolerance": 1e-13}), ("bm4", {"solver.step": 2.5e-6})],
    "spin": [("dop853", {"solver.tolerance": 1e-13}), ("rkn12", {"solver.tolerance": 1e-13})],
}

EXPLICIT, IMPLICIT = 3, 10
"""Largest factor between estimate and error. What implicit steps have damped away is known by its amplitude, not by its phase."""

COARSE, ALL = (1e-2, 1e-4), (1e-2, 1e-4, 1e-6, 1e-9)
METHODS = {
    "free_vibration": {"leapfrog": COARSE, "bm4": ALL, "rkn12": ALL, "dop853": ALL, "ros34pw2": (1e-2,), "auto": ALL},
    "stiff_pull": {"leapfrog": COARSE[:1], "bm4": COARSE[:1], "dop853": (1e-2, 1e-8), "ros34pw2": (1e-2, 1e-4, 1e-6), "auto": ALL},
    "stiff_layer": {"leapfrog": COARSE[:1], "bm4": COARSE[:1], "dop853": COARSE[:1], "ros34pw2": ALL, "auto": ALL},
    "light_corner": {"leapfrog": COARSE, "bm4": ALL, "dop853": ALL, "ros34pw2": (1e-2,), "auto": ALL},
    "spin": {"leapfrog": COARSE, "bm4": (1e-4, 1e-6), "rkn12": ALL, "dop853": ALL, "auto": ALL},
}
CASES = [(name, method, tolerance) for name in METHODS for method in METHODS[name] for tolerance in METHODS[name][method]]


def run(name, settings, *, estimate, loads="linear"):
    """loads: between communication points "held", "linear" or "cubic"."""
    scene = load_scene(name)
    scene = scene.model_copy(update={"solver": scene.solver.model_copy(update={"error_estimate": estimate})})
    return simulate(scene, start_values=settings, inputs=scene.default_inputs, interpolation=loads)


def size(values, name):
    return values / max(load_scene(name).lattice.size)


@pytest.fixture(scope="module")
def exact():
    """exact(scene, method, loads): the positions (T, n, 3) by a method that is not this one."""
    known = {}

    def positions_of(name, method, loads="linear"):
        reference, settings = next(pair for pair in REFERENCES[name] if pair[0] != method)
        key = name, reference, loads
        if key not in known:
            known[key] = points(run(name, {"solver.method": reference} | settings, estimate=False, loads=loads))
        return known[key]

    return positions_of


def errors_and_estimates(result, reference):
    return np.abs(points(result) - reference).max(axis=(1, 2)), result.outputs["solver.error_estimate"]


def check(result, reference, name, factor):
    """At the end and for the largest over time; prints a table with pytest -rP."""
    error, estimate = (size(values, name) + FLOOR for values in errors_and_estimates(result, reference))
    end, largest = estimate[-1] / error[-1], estimate.max() / error.max()
    print(f"{name:15} error {error[-1]:8.1e} estimate / error {end:6.3f}, of the largest {largest:6.3f}")
    assert 1 / factor < end < factor
    assert 1 / factor < largest < factor


@pytest.mark.short("free_vibration-*-0.0001", "free_vibration-ros34pw2-0.01")
@pytest.mark.parametrize(("name", "method", "tolerance"), CASES)
def test_the_estimate_is_close_to_the_error(exact, name, method, tolerance):
    result = run(name, {"solver.method": method, "solver.tolerance": tolerance}, estimate=True)
    implicit = method == "ros34pw2" or (method == "auto" and name in ("stiff_pull", "stiff_layer", "spin"))
    check(result, exact(name, method), name, IMPLICIT if implicit else EXPLICIT)


@pytest.mark.full
@pytest.mark.parametrize("tolerance", (1e-2, 1e-4, 1e-6, 1e-8))
@pytest.mark.parametrize("name", ["stiff_pull", "stiff_layer"])
def test_loads_without_kinks_set_off_nothing(exact, name, tolerance):
    result = run(name, {"solver.method": "ros34pw2", "solver.tolerance": tolerance}, estimate=True, loads="cubic")
    check(result, exact(name, "ros34pw2", "cubic"), name, IMPLICIT)


@pytest.mark.short("free_vibration")
@pytest.mark.parametrize("name", REFERENCES)
def test_the_references_agree(exact, name):
    ways = [method for method, _ in REFERENCES[name]]
    assert size(np.abs(exact(name, ways[0]) - exact(name, ways[1])).max(), name) < 2 * FLOOR


@pytest.mark.full
def test_jumps_of_a_load_count_by_the_vibrations_they_set_off(exact):
    result = run("stiff_pull", {"solver.method": "ros34pw2", "solver.tolerance": 1e-2}, estimate=True, loads="held")
    check(result, exact("stiff_pull", "ros34pw2", "held"), "stiff_pull", IMPLICIT)


HELD = box(
    damping=0.5, pin=[{"name": "base", "points": "z-", **LED}], load=[{"name": "top", "points": "z+"}], stop_time=0.8,
    communication_step=0.05,
)  # fmt: skip
ESTIMATED = {"solver.error_estimate": True}


def carried(t):
    """The base moves and turns steadily, the load grows for half a second."""
    q, half = min(1.0, t / 0.5), 0.1 * t
    frame = {"position.x": 0.5 + 0.1 * t, "velocity.x": 0.1, "orientation.w": np.cos(half), "orientation.z": np.sin(half)}
    turning = {"angular_velocity.z": 0.2}
    return {"load.top.x": 20 * q**3 * (10 - 15 * q + 6 * q**2)} | {f"pin.base.{key}": value for key, value in (frame | turning).items()}


@pytest.mark.parametrize("stiffness", [1e3, 1e4])
def test_what_backward_euler_damps_is_counted(stiffness):
    """A hanging box that is let go: vibrations that steps of a communication step's length do not resolve."""
    keys = {"material.stiffness": stiffness, "experiment.stop_time": 0.05, "solver.error_estimate": True}
    hanging = load_scene("hanging").replace(keys)
    damped = simulate(hanging.replace({"solver.method": "backward_euler", "solver.tolerance": 5e-6}))
    exact = simulate(hanging.replace({"solver.method": "dop853", "solver.tolerance": 1e-10}))
    error = np.linalg.norm(points(damped)[-1] - points(exact)[-1], axis=-1).max()
    estimate = damped.outputs["solver.error_estimate"][-1]
    print(f"{stiffness}: error {error:.1e} estimate {estimate:.1e}")
    assert error / IMPLICIT <= estimate <= error * IMPLICIT
    assert any("solver.error_estimate = " in str(warning) for warning in damped.summary["warnings"])  # above ten tolerances


@pytest.mark.short("100000.0")
@pytest.mark.parametrize("stiffness", [1e5, 1e6])
def test_a_body_that_turns_with_its_pin_does_not_vibrate_by_that(stiffness):
    """Each communication step the velocities turn by 0.01 rad; only the load's kinks set off vibrations, and the start."""
    held = HELD.replace({"material.stiffness": stiffness})
    exact, found = (
        simulate(scene, start_values={"solver.method": method, "solver.tolerance": tolerance}, inputs=carried, interpolation="linear")
        for scene, method, tolerance in ((held, "dop853", 1e-11), (held.replace(ESTIMATED), "ros34pw2", 1e-4))
    )
    error, estimate = errors_and_estimates(found, points(exact))
    assert np.all(estimate[1:] < IMPLICIT * error[1:] + FLOOR) and np.all(error[1:] < IMPLICIT * estimate[1:] + FLOOR)
    assert error[-1] < 1e-3 * error.max()


def test_a_stiff_body_in_its_own_frame_misses_the_breathing_that_its_spin_sets_off():
    flying = box(stiffness=1e7, damping=0.0, angular_velocity=[1.0, 2.0, 3.0], stop_time=0.3, communication_step=0.05)
    exact = simulate(flying, start_values={"solver.method": "dop853", "solver.tolerance": 1e-12})
    found = simulate(flying.replace({**ESTIMATED, "outputs.solver": True}))
    assert found.outputs["solver.steps"][-1] < 100
    error, estimate = errors_and_estimates(found, points(exact))
    assert np.all(estimate[1:] < IMPLICIT * error[1:]) and np.all(error[1:] < IMPLICIT * estimate[1:])


def internally_damped(ratio):
    """Stretched and turning; its fastest vibration, some 900 rad/s, has half the ratio as damping ratio."""
    moving = {"stretch": [1.05, 1.0, 1.0], "angular_velocity": [0.5, 1.0, -0.5], "stop_time": 0.2, "communication_step": 0.02}
    return box(stiffness=1e3, material={"internal_damping": ratio / 900}, **moving)


@cache
def exact_with_dashpots(ratio):
    return points(simulate(internally_damped(ratio), start_values={"solver.method": "dop853", "solver.tolerance": 1e-12}))


@pytest.mark.short("*-0.0001", "*-leapfrog-*")
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("method", ["auto", "leapfrog", "dop853", "ros34pw2"])
@pytest.mark.parametrize("ratio", [0.1, 10])
def test_the_estimate_is_close_to_the_error_with_internal_damping(ratio, method, tolerance):
    settings = {"solver.method": method, "solver.tolerance": tolerance}
    found = simulate(internally_damped(ratio).replace({"solver.error_estimate": True}), start_values=settings)
    error, estimate = (values[-1] + FLOOR for values in errors_and_estimates(found, exact_with_dashpots(ratio)))
    print(f"{ratio} {method} {tolerance}: error {error:.1e} estimate {estimate:.1e} / error {estimate / error:.3f}")
    factor = IMPLICIT if method == "ros34pw2" else EXPLICIT
    assert 1 / factor < estimate / error < factor
    assert error < tolerance


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize("method", ["auto", "sdirk2"])
def test_the_estimate_follows_the_implicit_steps_of_a_pinned_body(method, tolerance):
    held = box(
        stiffness=1e5, material={"internal_damping": 1e-3}, mass={"total": 10.0}, gravity=[0.0, 0.0, -9.81],
        pin=[{"name": "wall", "points": "x-"}], stop_time=0.5, communication_step=0.02,
    )  # fmt: skip
    exact = points(simulate(held, start_values={"solver.method": "dop853", "solver.tolerance": 1e-10}))
    found = simulate(held.replace({"solver.error_estimate": True}), start_values={"solver.method": method, "solver.tolerance": tolerance})
    error, estimate = (values.max() for values in errors_and_estimates(found, exact))
    assert 1 / IMPLICIT < estimate / error < IMPLICIT
    assert error < tolerance
