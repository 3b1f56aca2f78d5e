"""Inputs that move inside the step."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from scenes import box
from softffd import FmuError, Simulation, package_fmu, simulate
from softffd.cli.command import main
from softffd.run.inputs import Inputs

FREE = box(damping=0.0, load=[{"name": "push", "points": "all"}], velocities="all", stop_time=1.0, communication_step=0.25)
COURSE = np.array([(0.0, 0.0), (1.0, 6.0)], dtype=[("time", float), ("load.push.x", float)])


def test_interpolated_inputs_are_exact_where_the_force_is_linear():
    linear, held = (simulate(FREE, inputs=COURSE, interpolation=each, method="dop853") for each in ("linear", "held"))
    t = linear.time
    np.testing.assert_allclose(linear.outputs["velocity[1,2,3].x"], 3 * t**2, atol=1e-12)  # of 6 t N on 1 kg
    np.testing.assert_allclose(linear.positions.mean(axis=(1, 2, 3))[:, 0] - 0.5, t**3, atol=1e-12)
    assert held.outputs["velocity[1,2,3].x"][-1] == pytest.approx(0.25 * (0 + 1.5 + 3 + 4.5))


def test_cubic_inputs_have_the_order_of_cubics_and_do_not_overshoot():
    def swing(time):
        return {"load.push.x": np.sin(time), "plane.wall.point.x": np.sin(time)}

    def error(step, name):
        source, worst = Inputs(swing), 0.0
        column = source.names.index(name)
        for begin in np.arange(0.2, 1.2, step):
            s = step * np.linspace(0, 1, 9)
            first, second, third = source.bends(begin, begin + step)[:, column]
            worst = max(worst, np.abs(np.sin(begin) + s * (first + s * (second / 2 + s * third / 6)) - np.sin(begin + s)).max())
        return worst

    assert 12 < error(0.1, "load.push.x") / error(0.05, "load.push.x") < 20
    assert 3.5 < error(0.1, "plane.wall.point.x") / error(0.05, "plane.wall.point.x") < 4.5

    jump = Inputs(lambda time: {"load.push.x": 1.0 if time > 0.55 else 0.0})
    for begin in 0.1 * np.arange(10):
        s = 0.1 * np.linspace(0, 1, 101)
        first, second, third = jump.bends(begin, begin + 0.1)[:, 0]
        course = jump.values(begin, begin + 0.1)[0] + s * (first + s * (second / 2 + s * third / 6))
        assert -1e-14 <= course.min() <= course.max() <= 1 + 1e-14


def test_an_fmu_that_does_not_interpolate_says_so(folder):
    package_fmu(FREE, "free.fmu")
    with zipfile.ZipFile("free.fmu") as whole, zipfile.ZipFile("poor.fmu", "w") as poor:
        for name in whole.namelist():
            poor.writestr(name, whole.read(name).replace(b'canInterpolateInputs="true"', b'canInterpolateInputs="false"'))
    with pytest.raises(FmuError, match="does not interpolate"):
        simulate("poor.fmu", inputs=COURSE, interpolation="linear")
    assert simulate("poor.fmu", inputs=COURSE).time[-1] == 1.0


def test_the_run_command_interpolates_as_it_is_told(folder, capsys):
    package_fmu(FREE, "free.fmu")
    Path("push.csv").write_text("time,load.push.x\n0,0\n1,6\n")
    for how, speed in (("linear", 3.0), ("held", 2.25)):  # of 6 t N on 1 kg
        assert main(["run", "free.fmu", "--input", "push.csv", "--interpolation", how, "-o", how, "--no-pictures"]) == 0
        assert np.load(f"{how}/result.npz")["velocity[1,2,3].x"][-1] == pytest.approx(speed)
    assert main(["run", "free.fmu", "--interpolation", "cubics"]) != 0
    assert 'did you mean "cubic"' in capsys.readouterr().err


MOVED = ["position", "orientation", "velocity", "angular_velocity"]
TURNED = box(
    pin=[{"name": "hand", "points": "z-", "motion": "input", "inputs": MOVED}], energy=True, stop_time=2.0, communication_step=0.02
)


@pytest.mark.short("table-0.2-*", "function-0.02-*")
@pytest.mark.parametrize("interpolation", ["held", "linear", "cubic"])
@pytest.mark.parametrize("way, row", [("table", 0.2), ("table", 0.02), ("function", 0.02)])
def test_a_quaternion_means_the_same_with_either_sign(way, row, interpolation):
    """Turned about z at 2 rad/s: with the sign as it follows, with w >= 0, and with one that alternates."""
    names = [f"pin.hand.orientation.{c}" for c in "wxyz"]
    times = np.arange(0, 2 + row / 2, row)
    positions = []
    for sign in (lambda n, w: 1, lambda n, w: -1 if w < 0 else 1, lambda n, w: (-1) ** n):

        def course(time, sign=sign):
            quaternion = np.array([np.cos(time), 0, 0, np.sin(time)])
            return dict(zip(names, sign(round(time / row), quaternion[0]) * quaternion, strict=True))

        table = np.array([(time, *course(time).values()) for time in times], [(name, float) for name in ("time", *names)])
        positions.append(simulate(TURNED, inputs=table if way == "table" else course, interpolation=interpolation).positions)
    for other in positions[1:]:
        np.testing.assert_allclose(other, positions[0], atol=1e-12)


def test_a_step_with_the_other_sign_of_a_quaternion_has_the_same_bits():
    """In the FMU itself, with a rate and without."""
    ends = []
    for sign in (1, -1):
        with Simulation(TURNED) as sim:
            for n in range(20):
                angle, way = 0.02 * n, sign**n
                sim.pin["hand"].orientation = way * np.array([np.cos(angle), 0, 0, np.sin(angle)])
                sim.pin["hand"].angular_velocity = (0, 0, 2)
                if n % 2:
                    sim.set_rates({"pin.hand.orientation": way * np.array([-np.sin(angle), 0, 0, np.cos(angle)])})
                sim.step(0.02)
            ends.append(sim.positions)
    np.testing.assert_array_equal(*ends)
