"""Solid obstacles in pictures: their surfaces, their places, what touches them, and what is seen of them."""

import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import bodies
from made_up_run import made_up_run
from readings import vector
from scenes import GRAVITY, box
from softffd import simulate
from softffd.scene.obstacle import gap
from softffd.show.picture import draw_run
from softffd.show.solid import MOST_SIDES, solid_surface
from softffd.show.stage import OBSTACLES, stage_of
from softffd.show.touch import touch_of
from softffd.show.view import page_text

BALL = {"name": "ball", "radius": 0.3, "point": [0.3, 0.5, -0.3]}
CRATE = {"name": "crate", "size": [0.5, 0.4, 0.3], "point": [0.5, 0.5, -1.0], "rotation": {"axis": [1.0, 0.0, 0.0], "degrees": 30.0}}
LOG = {"name": "log", "radius": 0.2, "length": 2.0, "point": [0.8, 0.5, -0.2], "normal": [0.0, 1.0, 0.0]}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A cube on a ball and a log that moves away."""
    path = bodies.write(tmp_path_factory.mktemp("solid") / "cube.obj", bodies.cube(9, 0.0))
    log = {**LOG, "velocity": [0.1, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 0.5]}
    crate = {**CRATE, "angular_velocity": [0.0, 0.4, 0.0]}
    unit = {"origin": [0.0, 0.0, 0.0], "size": [1.0, 1.0, 1.0]}
    keys = {"gravity": GRAVITY, "damping": 0.5, "stop_time": 0.5, "lattice": unit}
    return simulate(
        box(mesh={"file": path}, sphere=[BALL], cylinder=[log], box=[crate], outputs={"positions": "all", "reactions": True}, **keys)
    )


@pytest.mark.parametrize(("kind", "keys"), [("sphere", BALL), ("cylinder", LOG), ("box", CRATE)])
def test_a_surface_is_closed_and_that_of_the_solid(kind, keys):
    vertices, normals, faces = solid_surface(kind, keys, 1.0)
    pose = np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    assert np.abs(gap(kind, keys, vertices, *pose)).max() <= 1e-12
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    volume = abs(np.einsum("fa,fa->", a, np.cross(b, c))) / 6
    r = keys.get("radius", 0.0)
    whole = {"sphere": 4 / 3 * np.pi * r**3, "cylinder": np.pi * r**2 * keys.get("length", 0.0), "box": np.prod(CRATE["size"])}[kind]
    assert 0.99 * whole < volume < (1 + 1e-12) * whole
    assert (gap(kind, keys, vertices + 1e-3 * normals, *pose) > 5e-4).all()


def test_large_solids_have_finer_sides_up_to_a_limit():
    counts = [len(solid_surface("sphere", {"radius": radius}, 1.0)[2]) for radius in (0.1, 1.0, 10.0, 1e6)]
    assert counts[0] < counts[1] < counts[2] <= counts[3] == MOST_SIDES**2


def test_solids_are_where_the_run_has_them(run):
    stage = stage_of(run)
    assert stage.planes == () and [solid.name for solid in stage.solids] == ["ball", "log", "crate"]
    ball, log, crate = stage.solids
    for solid in stage.solids:
        vertices, normals = solid.placed(-1)
        assert np.abs(solid.gap(vertices, -1)).max() <= 1e-12
        assert (solid.gap(vertices + 1e-3 * normals, -1) > 5e-4).all()
    np.testing.assert_allclose(ball.points[-1], BALL["point"])
    np.testing.assert_allclose(log.points[-1], np.add(LOG["point"], [0.05, 0.0, 0.0]))
    np.testing.assert_allclose(log.axes[-1], [-np.sin(0.25), np.cos(0.25), 0.0], atol=1e-12)
    np.testing.assert_allclose(crate.axes[0], [0.0, -0.5, np.sqrt(0.75)])
    np.testing.assert_allclose(crate.tangents[-1], [np.cos(0.2), 0.0, -np.sin(0.2)], atol=1e-12)


def test_vertices_on_solids_are_marked_with_arrows_of_their_forces(run):
    stage = stage_of(run, mesh=run.scene.loaded_mesh)
    touch = touch_of(run, stage)
    frame = int(np.abs(vector(run, "plane.ball.reaction")[:, 2]).argmax())
    points, vertices = touch.places(frame)
    assert len(points) == 0 and len(vertices) > 0
    assert all(min(abs(solid.gap(vertex[None], frame)[0]) for solid in stage.solids) < 1e-6 for vertex in vertices)
    start, end = touch.arrows(frame)[0]
    way, force = end - start, vector(run, "plane.ball.reaction")[frame]
    assert way @ force == pytest.approx(np.linalg.norm(way) * np.linalg.norm(force))
    np.testing.assert_allclose(start, vector(run, "plane.ball.centre")[frame])


def test_a_picture_shows_both(run, tmp_path):
    image = np.asarray(Image.open(draw_run(run, tmp_path / "run.png", mesh=run.scene.loaded_mesh)).convert("RGB")) / 255.0
    for tint in OBSTACLES[:3]:
        hue = image - image.mean(axis=-1, keepdims=True)
        wanted = np.array(tint) - np.mean(tint)
        alike = np.linalg.norm(hue - wanted, axis=-1) < 0.06
        assert alike[80:520].sum() > 1000, tint


def test_a_page_carries_their_surfaces_and_poses(run):
    solids, none = (json.loads(re.search(r'id="run">(.*?)</script>', page_text(each), re.S)[1])["solids"] for each in (run, made_up_run()))
    assert [solid["tint"] for solid in solids] == [list(tint) for tint in OBSTACLES[:3]]
    assert none == []
    for solid, track in zip(solids, stage_of(run).solids, strict=True):
        vertices, poses = (np.frombuffer(base64.b64decode(solid[what]), "<f4") for what in ("vertices", "poses"))
        np.testing.assert_allclose(vertices.reshape(-1, 3), track.vertices, atol=1e-6)
        np.testing.assert_allclose(poses.reshape(-1, 9)[-1, 3:6], track.axes[-1], atol=1e-6)


def test_without_its_scene_a_run_tells_of_planes_alone(run):
    stage = stage_of(replace(run, scene=None))
    assert stage.solids == () and len(stage.planes) == 3
