"""Surveys of contact of the surface: cases, and scenes drawn at random."""

import csv
import json

import numpy as np
import pytest

from softffd.cli.command import exit_status
from validation.shapes import KINDS, cube, sphere
from validation.stability.drawn import drawn
from validation.stability.drawn_bodies import drawn_solids, drawn_surface
from validation.stability.drawn_runs import _broken
from validation.stability.drive import DOWN, ORIGIN, Drive, Z, box, plane
from validation.stability.verdict import Findings, behind
from validation.tools import run_tool


def test_a_case_looks_at_the_vertices_and_not_at_the_control_points():
    """At rest the sphere's lattice is behind the ground; a vertex put there is found."""
    document = box(1e3, plane=[plane(friction=0.4)], environment=DOWN, initial={"offset": [0, 0, -0.1]})
    with Drive(document, surface=sphere(2)) as drive:
        drive.step(0.01)
        assert drive.touching.shape == (162, 3) and drive.x[:, 2].min() < -0.09
        findings = Findings()
        findings.sound(drive, [(ORIGIN, Z)])
        assert all(check.verdict == "right" for check in findings.checks)
        assert behind(drive, (0.0, 0.0, 0.1), Z) > 0.09


def test_seeds_mean_the_same_scenes_with_a_body_in_the_box():
    scenes = [drawn_surface(seed) for seed in range(200)]
    for seed, scene in enumerate(scenes[:40]):
        plain = drawn(seed).document
        assert scene.document | {"material": 0, "region": 0} == plain | {"material": 0, "region": 0}
        vertices, size = scene.surface[0], np.array(plain["lattice"]["size"])
        assert (vertices >= -1e-12).all() and (vertices <= size + 1e-12).all()
    assert {len(scene.surface[0]) for scene in scenes} >= {42, 162, 642, 2562, len(cube(2, 0.0)[0]), len(cube(9, 0.0)[0])}
    stiffness = [value for scene in scenes for value in scene.document["material"]["stiffness"].values()]
    assert 1e1 <= min(stiffness) < 1e3 and 1e5 < max(stiffness) <= 1e6
    assert not any("mass" in region for scene in scenes for region in scene.document["region"])


def test_seeds_mean_solids_where_planes_were():
    """Each touches what its plane touched, from below."""
    kinds = set()
    for seed in range(60):
        flat, solid = drawn_surface(seed), drawn_solids(seed)
        vertices = flat.surface[0]
        assert set(solid.planes) == set(flat.planes)
        assert all((gaps >= flat.gaps(vertices, 0.0)[name] - 1e-9).all() for name, gaps in solid.gaps(vertices, 0.0).items())
        for name, (normal, course) in flat.planes.items():
            touched = solid.gaps(course.point[None], 0.0)[name]
            assert touched >= -1e-9
            if all(each["name"] != name for each in solid.document["box"]):  # a box may touch beside it
                assert touched <= 1e-9 and solid.gaps(course.point[None] - 0.01 * normal, 0.0)[name] < 0
        kinds |= {kind for kind in KINDS if solid.document[kind]}
    assert kinds == {"sphere", "cylinder", "box"}


def test_a_vertex_behind_a_plane_is_found():
    seed = next(seed for seed in range(50) if drawn_surface(seed).planes and not drawn_surface(seed).pins)
    scene = drawn_surface(seed)
    with Drive(scene.document, surface=scene.surface) as drive:
        assert _broken(drive, scene) == ""
        (point, normal), *_ = [(course.point, normal) for normal, course in scene.planes.values()]
        point += 2.0 * drive.side * normal
        assert "of the box behind obstacle" in _broken(drive, scene)


@pytest.mark.short("surface-*", "solids-*")
@pytest.mark.parametrize(("family", "seed"), [("surface", 1), ("surface", 3), ("solids", 1), ("free", 25), ("free", 27)])
def test_command_runs_scenes_of_surfaces(family, seed, tmp_path):
    assert exit_status(lambda: run_tool(["random", "1", "--seed", str(seed), "--family", family, "-j", "1", "-o", str(tmp_path)])) == 0
    (row,) = csv.DictReader((tmp_path / "random.csv").open())
    assert row["verdict"] == "right" and " vertices, " in row["scene"]
    assert f"--family {family}" in json.loads((tmp_path / "random.json").read_text())["command"]
