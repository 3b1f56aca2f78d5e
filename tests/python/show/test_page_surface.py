"""The surface as a page holds it: what it loses, and what it takes."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from scipy.spatial import cKDTree

from made_up_run import ORIGIN, SIZE, made_up_run, with_mesh
from pages import opened
from softffd.mesh.mesh import Mesh
from softffd.show.skin import cage_surface
from softffd.show.stage import stage_of
from softffd.show.surface import surface
from softffd.show.view import write_view


def bumpy(around: int, down: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed band in the box, its vertices and faces in no order."""
    random = np.random.default_rng(0)
    turn, polar = np.meshgrid(np.linspace(0, 2 * np.pi, around, endpoint=False), np.linspace(0.02, np.pi - 0.02, down), indexing="ij")
    radius = 1 + 0.05 * np.sin(9 * turn) * np.sin(7 * polar) + 5e-4 * random.standard_normal(turn.shape)
    points = (radius * [np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)]).reshape(3, -1).T
    points = (points - points.min(axis=0)) / np.ptp(points, axis=0) * SIZE + ORIGIN
    i, j = np.arange(around)[:, None], np.arange(down - 1)
    a, b = i * down + j, (i + 1) % around * down + j
    faces = np.concatenate([np.stack([a, b, a + 1], axis=-1), np.stack([a + 1, b, b + 1], axis=-1)]).reshape(-1, 3)
    order = random.permutation(len(points))
    return points[order], random.permutation(np.argsort(order)[faces])


def test_places_normals_colours_and_triangles_come_back_within_what_is_said():
    vertices, faces = bumpy(60, 40)
    stage = stage_of(with_mesh(made_up_run(), Mesh(vertices, faces)))
    stage = replace(stage, skin=replace(stage.skin, tints=np.random.default_rng(1).random((len(vertices), 3)).round(1)))
    held = opened(surface(stage))
    apart, number = cKDTree(vertices).query(held["coordinates"] * SIZE + ORIGIN)
    assert (apart < 5.1e-7 * np.linalg.norm(SIZE)).all()
    assert np.abs(held["tints"] / 255 - stage.skin.tints[number]).max() < 0.5 / 255 + 1e-9

    def turned(triangles):
        least = triangles.argmin(axis=1)[:, None]
        return np.unique(np.take_along_axis(triangles, (least + np.arange(3)) % 3, axis=1), axis=0)

    assert (turned(number[held["triangles"]]) == turned(faces)).all() and held["parts"] == [[-1, len(faces)]]
    corners = vertices[number[held["triangles"]]]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("fa,fka->fk", flat, held["normals"][held["triangles"]]) > 0).mean() > 0.99


def test_normals_along_the_axes_are_exact():
    stage = stage_of(made_up_run())
    assert stage.is_cage and set(np.abs(opened(surface(stage))["normals"]).ravel()) == {0.0, 1.0}
    assert len(opened(surface(stage))["triangles"]) == len(cage_surface(ORIGIN, SIZE)[1])


@pytest.mark.full
@pytest.mark.parametrize("skin", ["bare", "picture", "vertices"])
def test_a_page_of_more_than_a_million_faces_has_at_most_15_megabytes(tmp_path, skin):
    vertices, faces = bumpy(742, 742)
    assert len(faces) > 1.09e6
    uv = (vertices[:, :2] - ORIGIN[:2]) / SIZE[:2] if skin == "picture" else None
    mesh = Mesh(vertices, faces, uv=uv, texture=Image.new("RGB", (64, 64), (9, 99, 199)) if skin == "picture" else None)
    if skin == "vertices":
        mesh = replace(mesh, looks=replace(mesh.looks, colours=(vertices - ORIGIN) / SIZE))
    assert write_view(with_mesh(made_up_run(), mesh), tmp_path / "view.html").stat().st_size < 15e6
