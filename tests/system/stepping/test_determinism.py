"""The same inputs give the same bits, however the run is cut, whatever runs beside it, and from saved states."""

import numpy as np
import pytest

from readings import points, vector
from scenes import GRAVITY, OBSERVED, box, damping_for, falling, let_go
from softffd import simulate
from stepping import Stepper

METHODS = ["leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "auto", "central_difference"]

GROUND = {"name": "ground", "velocity": [0.1, 0.0, 0.05], "angular_velocity": [0.02, 0.01, 0.3], "friction": 0.4}
WALL = {"name": "wall", "point": [1.3, 0.0, 0.0], "normal": [-1.0, 0.0, 0.2], "velocity": [-0.3, 0.0, 0.0], "friction": 0.2}
CORNER = {"name": "corner", "points": [[0, 0, 3]]}


def lively(method="leapfrog", *, step=2.5e-4, planes=(GROUND, WALL), pins=(CORNER,)):
    """Between planes that move, held at a corner and pushed."""
    parts = {"plane": planes, "pin": pins, "load": [{"name": "push", "points": "y+"}]}
    motion = {"gravity": GRAVITY, "offset": [0.0, 0.0, 0.1], "velocity": [0.8, 0.3, 0.0]}
    return box(stiffness=2e3, damping=damping_for(method), method=method, step=step, stop_time=0.6, **motion, **parts, **OBSERVED)


SCENES = {"free": let_go, "falling": falling, "lively": lambda method: lively(method, pins=())}


def state_of(stepper):
    """All outputs and the counts."""
    return [*stepper.outputs(), *(stepper.number(f"solver.{what}") for what in ("steps", "rejected"))]


def settings(method, step=0.0):
    """With a tolerance small enough for several internal steps per communication step; ros34pw2 takes very many where something swings."""
    return {"solver.method": method, "solver.step": step, "solver.tolerance": 1e-3 if method == "ros34pw2" else 1e-5}


@pytest.mark.short("*-automatic step-falling", "*-fixed step-free")
@pytest.mark.parametrize("scene", ["free", "falling"])
@pytest.mark.parametrize("step", [0.0, 3e-4], ids=["automatic step", "fixed step"])
@pytest.mark.parametrize("method", METHODS[:-1])
def test_a_run_goes_on_from_a_saved_state_with_the_same_bits(method, step, scene):
    """From every fifth communication point, so that the state is saved between races and calibrations too."""
    with Stepper(SCENES[scene](method), start_values=settings(method, step), stop_time=1.0) as stepper:
        saved, ends = [], []
        for number in range(40):
            if number % 5 == 0:
                saved.append((number, stepper.save()))
            stepper.step(0.007)
        end = state_of(stepper)
        for number, state in reversed(saved):
            stepper.restore(state)
            stepper.step(0.007, times=40 - number)
            ends.append(state_of(stepper))
    assert all(again == end for again in ends)


@pytest.mark.short("*-automatic step-falling", "auto-automatic step-*", "leapfrog-fixed step-*", "central_difference-*-lively")
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("step", [0.0, 2.5e-4], ids=["automatic step", "fixed step"])
@pytest.mark.parametrize("method", METHODS)
def test_the_same_calls_give_the_same_bits(method, step, scene):
    courses = []
    for _ in range(2):
        with Stepper(SCENES[scene](method), start_values=settings(method, step)) as stepper:
            course = []
            for number in range(80 if scene == "lively" else 40):
                stepper.step(0.01 if number % 3 else 0.003)
                course.append(state_of(stepper))
            courses.append(course)
    assert courses[0] == courses[1]


def landing(method, **keys):
    """On a plane that comes within reach on the way."""
    motion = {"gravity": GRAVITY, "velocity": [0.5, 0.0, 0.0], "stretch": [1.05, 1.0, 1.0], "stop_time": 0.4}
    ground = {"name": "ground", "friction": 0.4, "point": [0.0, 0.0, -0.1]}
    return box(**{"stiffness": 1e3, "damping": damping_for(method), "plane": [ground], **motion, "method": method, "step": 5e-4, **keys})


CUT = {
    "landing": landing,
    "in contact": lambda method: lively(method, pins=()),
    "pinned": lambda method: lively(method, planes=()),
    "free": lambda method: lively(method, planes=(), pins=()),
    "undamped": lambda method: landing(method, damping=0.0),
}
CUTS = [("landing", method) for method in METHODS] + [
    (name, method) for name in list(CUT)[1:] for method in ("leapfrog", "auto", "central_difference")
]


@pytest.mark.short("landing-*", "in contact-auto", "pinned-leapfrog", "free-central_difference", "undamped-leapfrog")
@pytest.mark.parametrize(("name", "method"), CUTS)
def test_cutting_the_communication_step_changes_no_bit_with_a_fixed_step(name, method):
    """Down to one internal step each."""
    scene, h = CUT[name](method), CUT[name](method).solver.step
    push = {"load.push.y": 3.0} if scene.load else {}
    fine = points(simulate(scene, step=h, start_values=push))
    for every in (10, 20, 40, 160, len(fine) - 1):
        assert np.array_equal(points(simulate(scene, step=every * h, start_values=push)), fine[::every])


def test_uneven_communication_steps_change_no_bit_with_a_fixed_step():
    body = lively()
    expected = points(simulate(body))[-1]
    with Stepper(body) as stepper:
        for count in (1, 7, 300, 2, 90, 800, 1200):
            stepper.step(count * 2.5e-4)
        assert np.array_equal(stepper.points(), expected)


def test_cutting_changes_no_bit_where_stability_shortens_the_given_step():
    """A step just below the limit at rest is too long for the stretched box, which goes to and fro between both."""
    swinging = box(stiffness=1e3, damping=0.0, stretch=[1.2, 1.0, 1.0], outputs={"solver": True}, step=1.7e-3, stop_time=0.816)
    coarse, fine = (simulate(swinging, step=length) for length in (0.0204, 0.0017))
    assert 480 < fine.outputs["solver.steps"][-1] < 960  # shortened at times, not always
    assert np.array_equal(points(coarse), points(fine)[::12])


def test_reactions_and_energies_do_not_depend_on_how_the_run_is_cut():
    coarse, fine = (simulate(lively(), step=length) for length in (0.02, 0.005))
    for name in ("plane.ground.reaction", "plane.ground.torque", "plane.wall.reaction", "pin.corner.reaction"):
        mean = vector(fine, name)[1:].reshape(-1, 4, 3).mean(axis=1)
        assert vector(coarse, name)[1:] == pytest.approx(mean, abs=1e-9), name
    for name in ("energy.kinetic", "energy.elastic", "energy.gravity", "energy.dissipated", "energy.work"):
        assert coarse.outputs[name] == pytest.approx(fine.outputs[name][::4], abs=1e-9), name


def test_looking_at_outputs_changes_nothing():
    body = lively(step=0.0, pins=())
    with Stepper(body) as looked, Stepper(body) as alone:
        for _ in range(30):
            looked.step(0.01)
            looked.read("solver.stable_step", "energy.elastic", "plane.ground.reaction.z")
            alone.step(0.01)
        assert np.array_equal(looked.points(), alone.points())
