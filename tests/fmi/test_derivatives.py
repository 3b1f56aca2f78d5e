"""Derivatives of inputs (they act inside the step) and of outputs; what is refused is in test_illegal_calls.py."""

import math
from ctypes import byref, c_double, c_int, c_uint, c_void_p

import numpy as np
import pytest

from scenes import LED, MOVED, box
from softffd import FmuError, Scene
from stepping import Stepper


def driven_box(*, floor=0.0, **keys):
    """A box between a piston and a floor at this height, which a load and a force push."""
    return box(
        stiffness=1e3,
        damping=0.0,
        plane=[
            {"name": "piston", "point": [0.0, 0.0, 1.0], "normal": [0.0, 0.0, -1.0], **MOVED},
            {"name": "floor", "point": [0.0, 0.0, floor]},
        ],
        load=[{"name": "push", "points": "all"}],
        forces=[[3, 3, 3]],
        probe=[{"name": "centre", "at": [0.5, 0.5, 0.5]}],
        velocities="all",
        energy=True,
        **keys,
    )


FREE, DEEP = driven_box(), driven_box(floor=-9.0)
HELD = driven_box(pin=[{"name": "grip", "points": [[0, 0, 0], [3, 0, 0], [0, 3, 0]], **LED}])


class Driven(Stepper):
    """With derivatives of outputs."""

    def __init__(self, scene: Scene, **start_values: float | str):
        super().__init__(scene, start_values=start_values)

    def rate(self, name: str) -> float:
        component, value = self.component, c_double()
        reference, order = c_uint(component.variable(name).reference), c_int(1)
        call = component._library.fmi2GetRealOutputDerivatives
        assert call(c_void_p(component._slave.component), byref(reference), 1, byref(order), byref(value)) == 0
        return value.value

    def rates(self) -> list[float]:
        """Of all outputs."""
        return [self.rate(variable.name) for variable in self.component.variables("output")]


def test_interpolated_inputs_are_second_order_and_held_ones_first():
    def error(steps: int, interpolate: bool) -> float:
        with Driven(FREE, **{"solver.step": 1e-4, "plane.piston.point.z": 9.0}) as driven:
            length = 0.4 / steps
            for n in range(steps):
                t = n * length
                driven.set({"force[3,3,3].x": np.sin(20 * t)})
                if interpolate:
                    driven.set_rates({"force[3,3,3].x": (np.sin(20 * (t + length)) - np.sin(20 * t)) / length})
                driven.step(length)
            return driven.read("position[3,3,3].x")[0]

    exact = error(4000, True)
    held = [abs(error(n, False) - exact) for n in (20, 40)]
    ramped = [abs(error(n, True) - exact) for n in (20, 40)]
    assert 1.6 < held[0] / held[1] < 2.6
    assert 3.2 < ramped[0] / ramped[1] < 5.0


@pytest.mark.parametrize(("method", "rates", "rel"), [("leapfrog", (6.0,), 1e-12), ("dop853", (6.0, -30.0, 120.0), 1e-10)])
def test_a_load_that_changes_gives_the_polynomial_of_its_velocity_and_for_one_step_only(method, rates, rel):
    """rel: with dop853 the springs' rounding makes them tremble."""
    with Driven(DEEP, **{"solver.method": method, "plane.piston.point.z": 9.0}) as driven:
        driven.set_rates({"load.push.x": list(rates)})
        wanted = sum(value * 0.5 ** (n + 2) / math.factorial(n + 2) for n, value in enumerate(rates))
        for _ in range(2):  # in the second step the load's value is 0 again
            driven.step(0.5)
            assert driven.read("velocity[1,2,0].x")[0] == pytest.approx(wanted, rel=rel)


@pytest.mark.parametrize(("velocity", "rates"), [(5.0, {"plane.piston.point.z": -0.5}), (-0.5, {})], ids=["with one", "without"])
def test_a_derivative_of_the_point_moves_the_plane_instead_of_its_velocity(velocity, rates):
    with Driven(FREE, **{"plane.piston.velocity.z": velocity}) as driven:
        if rates:
            driven.set_rates(rates)
        driven.step(0.1)
        np.testing.assert_allclose(driven.read("position[1,1,3].z", "velocity[1,1,3].z"), [0.95, -0.5], atol=1e-12)


def test_a_derivative_of_the_normal_ends_at_the_interpolated_normal():
    with Driven(FREE, **{"plane.piston.point.x": 0.5}) as driven:
        driven.set_rates({"plane.piston.normal.x": 2.0})
        driven.step(0.1)
        normal = np.array([0.2, 0.0, -1.0]) / np.hypot(0.2, 1.0)
        corners = [[f"position[{i},{j},3].{c}" for c in "xyz"] for i in (0, 3) for j in (0, 3)]
        gaps = [normal @ (driven.read(*names) - [0.5, 0.0, 1.0]) for names in corners]
        assert min(gaps) == pytest.approx(0.0, abs=1e-14)


def test_derivatives_of_a_pins_pose_take_it_to_the_interpolated_pose():
    with Driven(HELD, **{"pin.grip.velocity.x": 9.0, "plane.piston.point.z": 9.0}) as driven:
        driven.set_rates({"pin.grip.position.x": 1.0, "pin.grip.orientation.z": 0.5})
        before = driven.read("position[3,0,0].x", "position[3,0,0].y")
        driven.step(0.1)
        after = driven.read("position[3,0,0].x", "position[3,0,0].y")
        origin = np.array([1 / 3, 1 / 3])
        angle = 2 * np.arctan2(0.05, 1.0)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        np.testing.assert_allclose(after, origin + [0.1, 0.0] + turn @ (before - origin), atol=1e-14)


def test_the_energy_balance_holds_with_ramped_forces():
    with Driven(FREE, **{"solver.step": 1e-4, "plane.piston.point.z": 9.0}) as driven:
        for n in range(20):
            driven.set_rates({"force[3,3,3].x": 50.0 * (-1) ** n, "load.push.z": 3.0})
            driven.step(0.01)
        kinetic, elastic, lost, work = driven.read(*(f"energy.{kind}" for kind in ("kinetic", "elastic", "dissipated", "work")))
        assert kinetic + elastic + lost == pytest.approx(work, rel=1e-3)
        assert work > 1e-4


def test_output_derivatives_are_velocities():
    with Driven(FREE, **{"load.push.x": 1.0, "force[3,3,3].y": 2.0}) as driven:
        driven.step(0.05)
        assert driven.rate("position[3,3,3].y") == driven.read("velocity[3,3,3].y")[0]
        before = driven.read("probe.centre.y")[0]
        rate = driven.rate("probe.centre.y")
        driven.step(1e-6)
        assert (driven.read("probe.centre.y")[0] - before) / 1e-6 == pytest.approx(rate, rel=1e-3)


FULL = driven_box(
    gravity=[0.0, 0.0, -9.81],
    outputs={"solver": True},
    error_estimate=True,
    pin=[{"name": "grip", "points": [[0, 0, 0]], "motion": "input"}],
)


def test_every_real_output_has_a_derivative_0_before_the_first_step_and_then_its_change_by_the_step_s_length():
    with Driven(FULL, **{"load.push.x": 1.0, "force[3,3,3].y": 2.0}) as driven:
        exact = ("position", "probe")
        others = [v.name for v in driven.component.variables("output") if not v.name.startswith((*exact, "solver.stable_step"))]
        assert {name.split("[")[0].split(".")[0] for name in others} == {"velocity", "plane", "pin", "energy", "solver"}
        assert all(driven.rate(name) == 0 for name in others)
        before = driven.read(*others)
        for length in (0.05, 0.02, 0.07):
            driven.step(length)
            now = driven.read(*others)
            np.testing.assert_array_equal([driven.rate(name) for name in others], (now - before) / length)
            before = now
        assert np.count_nonzero([driven.rate(name) for name in others]) > len(others) / 2
        assert driven.rate("solver.stable_step") == 0


def test_the_derivative_of_the_work_is_the_power_of_a_force():
    """A body that flies freely under a load F of its own, from rest: P = F v, on average F v / 2 where v grows with time."""
    with Driven(DEEP, **{"load.push.x": 6.0, "plane.piston.point.z": 9.0}) as driven:
        driven.step(0.1)
        speed = driven.read("velocity[1,2,0].x")[0]
        assert driven.rate("energy.work") == pytest.approx(6.0 * speed / 2, rel=1e-9)
        assert driven.rate("velocity[1,2,0].x") == pytest.approx(6.0, rel=1e-9)


def test_derivatives_of_outputs_are_part_of_the_state_and_a_discarded_step_leaves_them():
    with Driven(FULL) as driven, Driven(FULL) as other:
        driven.step(0.01, times=3)
        wanted, state = driven.rates(), driven.save()
        driven.step(0.05)
        assert driven.rates() != wanted
        driven.restore(state)
        assert driven.rates() == wanted
        driven.set({"stiffness.edge": 1e19})
        with pytest.raises(FmuError, match="discarded"):
            driven.step(1.0)
        assert driven.rates() == wanted
        other.restore(bytes(state))
        assert other.rates() == wanted
        other.restart({})
        assert other.rate("energy.kinetic") == other.rate("plane.floor.reaction.z") == 0
