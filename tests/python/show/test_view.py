import base64
import html
import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

from made_up_run import ORIGIN, SIZE, made_up_run, with_mesh, with_solids
from mesh_files import GREEN, RED
from pages import decoded, page_of_two_colours, run_of, whole_run_of
from softffd.errors import SoftffdError
from softffd.mesh.mesh import Mesh
from softffd.scene.rigid import Box, Sphere
from softffd.show import view_body
from softffd.show.skin import cage_surface
from softffd.show.view import write_view, write_views


def test_page_needs_nothing_from_outside(as_shipped, tmp_path):
    page = write_view(made_up_run(), tmp_path / "view.html").read_text("utf-8")
    assert "http:" not in page and "https:" not in page and "{{" not in page
    assert not re.search(r'(src|href)="(?!data:)', page) and not re.search(r"\bimport\b|\bfetch\b|url\(", page)
    assert "default-src 'none'" in page and 'src="data:image/webp;base64,' in page


def test_page_holds_every_frame_relative_to_its_centre(tmp_path):
    result = made_up_run(counts=(3, 4, 2))
    run = run_of(write_view(result, tmp_path / "view.html"))
    held = decoded(run["positions"], "<f4", 3).reshape(41, 2, 4, 3, 3).transpose(0, 3, 2, 1, 4)
    centre = ORIGIN - run["origin"]
    assert run["counts"] == [3, 4, 2] and run["note"] == ""
    assert np.allclose(decoded(run["time"], "<f8", 1)[:, 0], result.time)
    assert np.allclose(held + centre, result.positions, atol=1e-6)


def test_planes_move_with_the_frames(tmp_path):
    run = run_of(write_view(made_up_run(), tmp_path / "view.html"))
    ground, press = (decoded(plane["poses"], "<f4", 9) for plane in run["planes"])
    assert [p["name"] for p in run["planes"]] == ["ground", "press"]
    assert np.ptp(ground, axis=0).max() == 0 and np.allclose(ground[0, 3:6], [0, 0, 1])
    assert np.isclose(np.ptp(press[:, 2]), 0.6, atol=1e-5)


def test_solids_are_held_with_their_triangles_and_poses(tmp_path):
    ball = Sphere(name="ball", radius=0.5, point=(1.0, 0.0, 0.7), velocity=(0.25, 0.0, 0.0))
    crate = Box(name="crate", size=(0.4, 0.6, 1.0), point=(-1.0, 0.0, 0.7))
    run = run_of(write_view(with_solids(made_up_run(), ball, crate), tmp_path / "view.html"))
    assert [each["name"] for each in run["planes"]] == ["ground", "press"] and [each["name"] for each in run["solids"]] == ["ball", "crate"]
    poses, centre = decoded(run["solids"][0]["poses"], "<f4", 9), ORIGIN - run["origin"]
    assert np.allclose(poses[[0, -1], :3] + centre, [[1.0, 0.0, 0.7], [1.5, 0.0, 0.7]], atol=1e-6)
    assert np.allclose(decoded(run["solids"][1]["poses"], "<f4", 9)[0, 3:], [0, 0, 1, 1, 0, 0])
    vertices, triangles = (decoded(run["solids"][1][what], kind, 3) for what, kind in (("vertices", "<f4"), ("triangles", "<u4")))
    assert np.allclose(np.abs(vertices), [0.2, 0.3, 0.5]) and len(triangles) == 12


def test_readout_has_reactions_with_their_vectors_and_energies(tmp_path):
    rows = {row["label"]: row for row in run_of(write_view(made_up_run(), tmp_path / "view.html"))["rows"]}
    assert list(rows) == ["ground", "press", "kinetic", "elastic"]
    assert np.isclose(decoded(rows["ground"]["values"], "<f4", 1).max(), 2000)
    assert np.isclose(decoded(rows["ground"]["vectors"], "<f4", 3)[:, 2].min(), -2000)
    assert rows["elastic"]["vectors"] is None and rows["elastic"]["unit"] == "J"


def test_a_page_holds_what_touches_and_the_forces_on_obstacles(tmp_path):
    result = made_up_run()
    run = run_of(write_view(result, tmp_path / "view.html"))
    touch, centre = run["touch"], ORIGIN - run["origin"]
    landed = result.time > 0.8 - 1e-9
    assert set(np.array(touch["counts"])[landed]) == {16} and touch["counts"][0] == 0
    lowest = result.positions[-1, :, :, 0].swapaxes(0, 1).reshape(16, 3)
    assert np.allclose(decoded(touch["places"], "<f4", 3)[-16:] + centre, lowest, atol=1e-6)
    starts, ways = (decoded(touch["arrows"][0][what], "<f4", 3) for what in ("starts", "ways"))
    assert np.allclose(starts + centre, [0.1, 0.05, 0.2], atol=1e-6)
    assert (ways[:, 2] < 0).tolist() == (result.outputs["plane.ground.reaction.z"] < -1e-3).tolist() and not ways[:, :2].any()


def test_a_long_run_or_a_large_lattice_is_thinned_evenly_with_its_ends_and_says_so(monkeypatch, tmp_path):
    run = run_of(write_view(made_up_run(counts=(2, 2, 2), frames=2001), tmp_path / "view.html"))
    time = decoded(run["time"], "<f8", 1)[:, 0]
    assert len(time) == 600 and time[0] == 0 and time[-1] == 2
    assert np.diff(time).max() < 0.0041 and np.diff(time).min() > 0.0029
    assert run["note"] == "600 of 2,001 recorded frames are shown"
    monkeypatch.setattr(view_body, "MOST_POINT_BYTES", 12 * 8 * 10)
    assert run_of(write_view(made_up_run(counts=(2, 2, 2)), tmp_path / "v.html"))["note"].startswith("10 of 41")


def test_a_frame_costs_only_its_control_points(tmp_path):
    sizes = [write_view(made_up_run(frames=n), tmp_path / "v.html").stat().st_size for n in (101, 201)]
    assert (sizes[1] - sizes[0]) / 100 < 4 / 3 * (64 * 12 + 2 * 36 + 8 + 6 * 12 + 2 * 2 * 12 + 16 * 12 + 2 * 2 * 27)


def test_a_title_cannot_break_the_page(tmp_path):
    title = 'Soft & "hard" </script><b>{{run}}'
    page = write_view(made_up_run(title=title), tmp_path / "view.html")
    assert run_of(page)["title"] == title
    assert f"<title>{html.escape(title)}</title>" in page.read_text("utf-8")


def test_a_texture_travels_in_the_page_no_larger_than_needed(tmp_path):
    vertices, faces = cage_surface(ORIGIN, SIZE, divisions=2)
    mesh = Mesh(vertices, faces, uv=vertices[:, :2], texture=Image.new("RGB", (3000, 10), (9, 99, 199)))
    run = run_of(write_view(with_mesh(made_up_run(), mesh), tmp_path / "view.html"))
    assert run["pictures"][0].startswith("data:image/png;base64,")
    (tmp_path / "texture.png").write_bytes(base64.b64decode(run["pictures"][0].partition(",")[2]))
    assert Image.open(tmp_path / "texture.png").width == 1024
    places = run["coordinates"] * SIZE + ORIGIN
    assert np.allclose(run["uv"], places[:, :2], atol=1e-6)


@pytest.mark.parametrize(("name", "pictures"), [("kd.obj", 0), ("pictures.obj", 2), ("vertices.glb", 0), ("faces.ply", 0)])
def test_a_page_holds_the_colours_of_the_mesh(name, pictures, tmp_path):
    run = page_of_two_colours(tmp_path, name)[0]
    assert len(run["pictures"]) == pictures
    assert run["parts"] == ([[0, 12], [1, 12]] if pictures else [[-1, 24]])
    tints, faces = run["tints"] / 255, run["triangles"]
    heights = run["coordinates"][:, 2]
    upper = heights[faces].mean(axis=1) > 0.5
    wanted = np.ones((24, 3)) if pictures else np.where(upper[:, None], GREEN, RED)
    assert np.allclose(tints[faces], wanted[:, None], atol=0.02)  # a byte of light in glTF
    assert not pictures or (upper == np.repeat([False, True], 12)).all()


def test_colour_scales_end_near_the_largest_value(tmp_path):
    result = made_up_run()
    result.positions[:] = result.positions[0] - [0, 0, 0.8]
    result.positions[20] = (result.positions[0] - ORIGIN) * [1.0, 1.0, 1.5] + ORIGIN
    largest = run_of(write_view(result, tmp_path / "view.html"))["largest"]
    assert np.isclose(largest["strain"], (1.5**2 - 1) / 2, rtol=1e-3)
    assert np.isclose(largest["displacement"], 0.5 * SIZE[2], rtol=1e-3)


def cells_of_page(page):
    return {each["name"]: each | {"values": decoded(each["values"], "u1", 2).reshape(41, 3, 3, 3, 2)} for each in run_of(page)["cells"]}


def test_a_page_holds_stress_and_stretch_of_the_cells(tmp_path):
    result = made_up_run()
    cells = cells_of_page(write_view(result, tmp_path / "view.html"))
    assert list(cells) == ["von_mises", "stretch"]
    low, high = cells["stretch"]["ends"]
    found = low + (high - low) * cells["stretch"]["values"][24, ..., 0].transpose(2, 1, 0) / 255
    wanted = np.sqrt(np.linalg.eigvalsh(2 * result.strain(24) + np.eye(3))[..., -1])
    assert np.abs(found - wanted).max() < 0.6 * (high - low) / 255
    assert cells["von_mises"]["ends"][0] == 0 and cells["von_mises"]["values"][..., 0].max() == 255
    assert not cells["von_mises"]["values"][..., 1].any()


def test_cells_turned_inside_out_are_marked(tmp_path):
    result = made_up_run()
    result.positions[20, 1:, 0, 0] -= [2 * SIZE[0], 0, 0]
    stress = cells_of_page(write_view(result, tmp_path / "view.html"))["von_mises"]["values"]
    assert set(stress[20, ..., 1].ravel()) == {0, 255} and not stress[19, ..., 1].any()


def test_a_run_without_recorded_positions_is_refused(tmp_path):
    result = made_up_run()
    result.positions[:] = np.nan
    with pytest.raises(SoftffdError, match=r'blind: The run cannot .* outputs.positions = "all"'):
        write_views({"seen": made_up_run(), "blind": result}, tmp_path / "view.html")
    assert not list(tmp_path.iterdir())


def test_the_scale_has_the_colours_of_its_map(tmp_path):
    ramp = np.array(run_of(write_view(made_up_run(), tmp_path / "view.html"))["ramp"]).reshape(-1, 3)
    wanted = 255 * colormaps["YlGnBu"](np.linspace(0.1, 1.0, len(ramp)))[:, :3]
    assert np.abs(ramp - wanted).max() < 2.3  # matplotlib has steps of 1/256 of the map, in which a channel changes by up to 2.2


def test_runs_side_by_side_have_the_same_scales(tmp_path):
    """Of the second the forces are a quarter, and the strains half."""
    one, other = made_up_run(), made_up_run()
    other = replace(other, outputs={name: values / 4 if "reaction" in name else values for name, values in other.outputs.items()})
    other.positions[:] = (other.positions + other.positions[0]) / 2
    run = whole_run_of(write_views({"a": one, "b": other}, tmp_path / "both.html"))
    alone = run_of(write_view(one, tmp_path / "one.html"))
    assert run["largest"] == alone["largest"] and run["cells"][0]["ends"] == alone["cells"][0]["ends"]
    longest = [np.abs(decoded(body["touch"]["arrows"][0]["ways"], "<f4", 3)).max() for body in run["bodies"]]
    assert np.isclose(longest[0], 2 * longest[1]) and [body["pane"] for body in run["bodies"]] == [0, 1]
    stress = [decoded(body["cells"][0], "u1", 2)[:, 0].max() for body in run["bodies"]]
    assert stress[0] == 255 and 0 < stress[1] < 200
