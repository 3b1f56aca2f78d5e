"""A body that starts turned moves as the turned motion of the one that does not; one that spins does so about its box or its mass."""

import re

import numpy as np
import pytest

from readings import points, vector
from scenes import GRAVITY, LED, box
from softffd import Simulation, simulate
from softffd.fmu.notes import spin_note
from softffd.fmu.package import package_fmu, scene_masses
from softffd.rotation import quaternion, turned
from stepping import require_same_continuation

ROTATION = {"axis": [1.0, -2.0, 0.5], "degrees": 35.0}
TURN = np.radians(35.0) * np.array(ROTATION["axis"]) / np.linalg.norm(ROTATION["axis"])
PLACED = {"origin": [0.2, -0.3, 0.4], "size": [0.6, 0.9, 1.2], "points": [4, 3, 4]}
OFFSET = np.array([0.1, 0.2, -0.3])
CENTRE = np.array(PLACED["origin"]) + np.array(PLACED["size"]) / 2
NAMES = [f"initial.rotation.{axis}" for axis in "xyz"]


def turned_list(vector):
    return turned(np.array(vector, float), TURN).tolist()


def body(rotation=None, *, keep=list, **keys):
    """A body in free flight; `keep` turns the vectors of its surroundings."""
    start = {"rotation": rotation} if rotation else {}
    motion = {"velocity": keep([1.0, 0.0, 0.5]), "angular_velocity": keep([0.5, 2.0, 1.0])}
    return box(
        lattice=PLACED, stiffness=500.0, damping=0.05, gravity=keep(GRAVITY), method="leapfrog", step=1e-3, stop_time=0.3,
        **motion, **start, **keys,
    )  # fmt: skip


@pytest.mark.parametrize("method", ["leapfrog", "auto"])
def test_a_turned_body_moves_as_the_turned_solution(method):
    keys = {"stretch": [1.1, 1.0, 0.9], "offset": OFFSET.tolist(), "solver": {"method": method}}
    upright, tilted = simulate(body(**keys)), simulate(body(ROTATION, keep=turned_list, **keys))
    centre = np.array(PLACED["origin"]) + np.array(keys["stretch"]) * np.array(PLACED["size"]) / 2 + OFFSET
    wanted = centre + turned(points(upright) - centre, TURN)
    assert np.abs(points(upright)[-1] - points(upright)[0]).max() > 0.2
    np.testing.assert_allclose(points(tilted), wanted, rtol=0, atol=1e-12)


def test_velocities_are_those_of_the_world():
    flight = box(rotation=ROTATION, velocity=[1.0, 2.0, 3.0], velocities="all", stop_time=0.01)
    with Simulation(flight) as simulation:
        np.testing.assert_allclose(simulation.velocities.reshape(-1, 3), np.broadcast_to([1.0, 2.0, 3.0], (64, 3)))


def test_the_rotation_is_a_parameter_where_the_scene_has_one_and_only_there(tmp_path):
    with Simulation(box()) as plain:
        assert not [name for name in plain.component.by_name if name.startswith("initial")]
    path = package_fmu(body({"axis": [0, 1, 0], "degrees": 0.0}), tmp_path / "body.fmu")
    given = simulate(path, start_values=dict(zip(NAMES, TURN, strict=True)))
    np.testing.assert_array_equal(
        points(given), points(simulate(body({"axis": TURN.tolist(), "degrees": np.degrees(np.linalg.norm(TURN))})))
    )


@pytest.mark.parametrize("motion", [{}, LED], ids=["fixed", "led"])
def test_pins_hold_the_turned_points(motion):
    hook = {"name": "hook", "points": "z+", "origin": [0.3, 0.2, 1.9], **motion}
    upright, tilted = (
        simulate(body(rotation, keep=keep, pin=[hook])) for rotation, keep in ((None, list), (ROTATION, turned_list))
    )  # fmt: skip
    np.testing.assert_allclose(points(tilted), CENTRE + turned(points(upright) - CENTRE, TURN), rtol=0, atol=1e-12)
    for what in ("reaction", "torque"):
        wanted = turned(vector(upright, f"pin.hook.{what}"), TURN)
        np.testing.assert_allclose(vector(tilted, f"pin.hook.{what}"), wanted, rtol=0, atol=1e-8 * np.abs(wanted).max())
    held = points(tilted)[:, body().select("z+")]
    np.testing.assert_allclose(held, np.broadcast_to(held[0], held.shape), rtol=0, atol=1e-15)


def test_the_frame_of_a_led_pin_starts_turned():
    hand = {"name": "hand", "points": "x-", **LED}
    scene = body(ROTATION, pin=[hand])
    with Simulation(scene) as simulation:
        found = [simulation[f"pin.hand.position.{axis}"] for axis in "xyz"]
        np.testing.assert_allclose(found, CENTRE + turned(np.array(scene.pin_origin(scene.pin[0])) - CENTRE, TURN), rtol=1e-14)
        np.testing.assert_allclose([simulation[f"pin.hand.orientation.{c}"] for c in "wxyz"], quaternion(TURN), rtol=1e-14)


def test_a_fixed_pin_stays_turned_in_a_state_that_another_component_continues():
    require_same_continuation(body(ROTATION, pin=[{"name": "hook", "points": "z+"}]))


def test_a_start_behind_a_plane_is_told_of_the_turned_body():
    corner = np.sqrt(0.5) - 0.5
    with Simulation(box(rotation={"axis": [0, 1, 0], "degrees": 45.0}, plane=[{"name": "ground"}])) as simulation:
        simulation.initialize()
        (warning,) = simulation.warnings
    assert f"start behind plane ground, by up to {corner:.2g} m" in warning


VELOCITY = np.array([0.1, 0.0, -0.2])


def uneven(**start):
    """A body of which one side is heavy, in free flight."""
    heavy = {"points": "x+", "mass": 0.2}
    motion = {"velocity": VELOCITY.tolist(), "angular_velocity": [1.0, 0.5, 3.0], "stretch": [1.2, 1.0, 0.9], "offset": [0.5, 0.0, 0.2]}
    return box(region=[heavy], stiffness=500.0, damping=0.0, stop_time=0.2, method="leapfrog", step=1e-3, initial=motion | start)


def speed_of_the_centre(scene):
    """Of mass, over the run [m/s]."""
    result = simulate(scene)
    centre = np.einsum("p,tpa->ta", scene_masses(scene).mass / scene_masses(scene).mass.sum(), points(result))
    assert np.abs(np.diff(centre, n=2, axis=0)).max() < 1e-12
    return (centre[-1] - centre[0]) / result.time[-1]


@pytest.mark.parametrize("rotation", [{}, {"rotation": ROTATION}], ids=["upright", "turned"])
def test_about_its_centre_of_mass_a_body_goes_where_its_velocity_says(rotation):
    scene = uneven(spin_about="mass", **rotation)
    np.testing.assert_allclose(speed_of_the_centre(scene), VELOCITY, rtol=0, atol=1e-12)
    assert spin_note(scene, scene_masses(scene)) is None


@pytest.mark.parametrize("rotation", [{}, {"rotation": ROTATION}], ids=["upright", "turned"])
def test_about_its_box_the_centre_of_mass_has_a_velocity_too_which_is_told(rotation):
    scene = uneven(**rotation)
    told = spin_note(scene, scene_masses(scene))
    given = np.array(re.search(r"which adds \((.*)\) m/s to initial.velocity", told)[1].split(","), float)
    np.testing.assert_allclose(speed_of_the_centre(scene) - VELOCITY, given, rtol=0, atol=0.005 * np.linalg.norm(given))
    assert np.linalg.norm(given) > 0.1
    assert spin_note(box(angular_velocity=[0.0, 0.0, 3.0]), scene_masses(box())) is None
