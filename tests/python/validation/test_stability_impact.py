"""Impacts, sliding and rest of stiff bodies: the oracles agree with each other, and the component with them."""

from dataclasses import replace

import numpy as np
import pytest

from validation.stability import rebound
from validation.stability.answers import after_impact, static_sag
from validation.stability.cases_impact import SCENES
from validation.stability.cell import Cell, Panel
from validation.stability.drive import DOWN, Drive, box, plane
from validation.stability.map import run_cells


def test_the_flight_by_numpy_is_that_of_the_independent_program():
    """A1: k = 1e7 N/m, its place known to 2e-6 m."""
    scene = SCENES[0]
    flight = after_impact(scene.document, scene.duration, share=1 / 16)
    assert flight.centre[2] == pytest.approx(scene.centre["z"], abs=2e-6)
    assert flight.velocity[2] == pytest.approx(scene.velocity["z"], abs=2e-5)
    assert abs(flight.angular_momentum).max() < 1e-9


def test_a_throw_by_numpy_keeps_to_the_cone_and_is_that_of_the_components_leapfrog():
    initial = {"offset": [0.0, 0.0, 0.01], "velocity": [2.0, 0.0, 0.0]}
    document = box(1e7, points=(2, 2, 2), plane=[plane(friction=0.4)], environment=DOWN, initial=initial)
    flight = after_impact(document, 0.06)
    normal = flight.velocity[2] + 9.81 * 0.06  # kg m/s, of 1 kg; the plane has given the impulse as a force for the whole time
    assert -flight.impulse[2] == pytest.approx(normal, rel=1e-9)
    assert 0.995 * 0.4 * normal < flight.impulse[0] <= 0.4 * normal * (1 + 1e-9)  # points that vibrate sideways take a little less
    assert flight.velocity[0] == pytest.approx(2.0 - flight.impulse[0], rel=1e-9)
    with Drive(document | {"solver": {"method": "leapfrog", "step": 1e-6}}) as drive:  # 1/50 of the stable one
        drive.run(0.06, 0.01)
        assert drive.centre == pytest.approx(flight.centre, abs=1e-5)
        assert drive.angular_momentum == pytest.approx(flight.angular_momentum, abs=1e-4)


def test_a_held_face_lets_a_box_sink_less():
    with Drive(box(1e3, points=(3, 2, 4), plane=[plane()], environment=DOWN)) as drive:
        free, held = static_sag(drive), static_sag(drive, held=True)
    assert 0.8 * free < held < free


def test_the_rebound_of_a_soft_body_is_accurate():
    (judged,) = run_cells([Cell(Panel("rebound", "auto"), 1e4, 2e-3)])
    assert judged.kind == "accurate" and judged.error < rebound.RIGHT, judged


def test_a_rebound_that_misses_the_flight_by_numpy_is_wrong(monkeypatch):
    flight = rebound.after_impact(rebound.DOCUMENT | {"material": {"stiffness": 1e4, "damping": 0.0}}, rebound.FALL_TIME)
    other = replace(flight, centre=flight.centre + np.array([0.0, 0.0, 1e-2]))
    monkeypatch.setattr(rebound, "_flight", lambda stiffness, time: other)
    (judged,) = run_cells([Cell(Panel("rebound", "auto"), 1e4, 2e-3)])
    assert judged.kind == "WRONG" and judged.error == pytest.approx(1e-2, rel=0.05)


@pytest.mark.full
@pytest.mark.parametrize("stiffness", rebound.STIFFNESSES, ids="{:g}".format)
@pytest.mark.parametrize("step", rebound.STEPS, ids="{:g}".format)
def test_every_rebound_is_accurate(stiffness, step, monkeypatch):
    monkeypatch.setattr(rebound, "PATIENCE", 60.0)
    (judged,) = run_cells([Cell(Panel("rebound", "auto"), stiffness, step)])
    assert judged.kind == "accurate", judged.why
