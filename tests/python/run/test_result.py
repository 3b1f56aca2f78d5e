"""Results: planes over time, the lattice and its mesh, files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mesh_files import ball
from scenes import box
from softffd import FmuError, MeshError, Result, SoftffdError, deform, load_scene, package_fmu, save_mesh, simulate, sweep
from softffd.installed import host_library
from softffd.show.stage import stage_of

PRESS = load_scene("press")
TURNING = box(
    plane=[
        {"name": "left", "point": [-5.0, 0.0, 0.0], "normal": [1.0, 0.0, 0.0], "motion": "input"},
        {"name": "mill", "point": [0.5, 0.5, -3.0], "normal": [0, 0.6, 0.8], "velocity": [0, 0, 0.1], "angular_velocity": [0, 0, 2]},
        {"name": "hand", "point": [0.0, 0.0, -5.0], "motion": "input"},
        {"name": "right", "point": [5.0, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]},
    ],
    stop_time=0.5,
)  # fmt: skip


@pytest.fixture(scope="module")
def result() -> Result:
    return simulate(TURNING, inputs=lambda t: {"plane.hand.point.z": -5.0 + t})


def test_planes_are_in_the_order_of_the_scene_and_go_on_from_their_start_or_are_where_inputs_put_them(result):
    assert result.plane_names() == ["left", "mill", "hand", "right"]
    points, normals = result.plane("mill")
    np.testing.assert_allclose(points[-1], [0.5, 0.5, -2.95], atol=1e-15)
    np.testing.assert_allclose(normals[-1], [-0.6 * np.sin(1.0), 0.6 * np.cos(1.0), 0.8], atol=1e-15)
    points, normals = result.plane("hand")
    np.testing.assert_allclose(points[:, 2], -5.0 + result.time)
    np.testing.assert_allclose(normals, np.tile([0.0, 0.0, 1.0], (len(result.time), 1)))
    np.testing.assert_allclose(result.inputs["plane.hand.velocity.z"][:-1], 1.0)  # derived from the course of the point


@pytest.mark.parametrize("interpolation", ["held", "linear"])
@pytest.mark.parametrize("jump", [0.06, 0.1])
def test_a_plane_that_jumps_at_a_communication_point_has_no_velocity(result, jump, interpolation):
    rows = [(0.0, -5.0), (jump, -5.0), (jump, -4.0)]
    course = np.array(rows, dtype=[("time", float), ("plane.hand.point.z", float)])
    after = simulate(result.scene, inputs=course, interpolation=interpolation)
    np.testing.assert_array_equal(after.inputs["plane.hand.velocity.z"], 0.0)
    np.testing.assert_array_equal(after.inputs["plane.hand.point.z"], np.where(after.time < jump - 1e-9, -5.0, -4.0))


def margin(folder, positions="all"):
    """A B-spline lattice around a ball with a probe in one of its vertices."""
    save_mesh(ball(), folder / "ball.obj")
    lattice = {"points": [7, 5, 5], "margin": 0.1, "basis": "bspline"}
    probe = [{"name": "vertex", "at": ball().vertices[7].round(4).tolist()}]
    about = {"angular_velocity": [0.0, 0.0, 3.0], "outputs": {"positions": positions}, "stop_time": 0.05}
    return box(mesh={"file": folder / "ball.obj"}, lattice=lattice, probe=probe, **about)


def test_the_deformed_mesh_goes_with_the_probe_in_the_scene_s_own_box_and_basis(tmp_path):
    result = simulate(margin(tmp_path))
    probe = np.stack([result.outputs[f"probe.vertex.{c}"] for c in "xyz"], axis=1)
    np.testing.assert_allclose(result.deformed()[7], probe[-1], atol=2e-4)
    np.testing.assert_allclose(result.deformed(row=slice(None))[:, 7], probe, atol=2e-4)
    # a vertex is a sum of 175 products, in an order that BLAS picks by the number of vertices
    rounding = 175 * np.finfo(float).eps
    np.testing.assert_allclose(result.deformed(ball().vertices[:9], row=2), result.deformed(ball(), row=2)[:9], rtol=0, atol=rounding)
    lattice = result.scene.lattice
    given = deform(result.scene.loaded_mesh, result.positions[-1], origin=lattice.origin, size=lattice.size, basis="bspline")
    np.testing.assert_array_equal(result.deformed(), given)


def test_points_that_are_not_in_the_lattice_are_told_with_the_first_and_the_box(tmp_path):
    result = simulate(margin(tmp_path), stop_time=0.01)
    inside = result.lattice.rest()[1, 1, 1]
    with pytest.raises(
        MeshError, match=r"^deformed: 1 of the 2 points lie outside .* box, which spans .*first is number 1 .*, \[0, 0, 99\] m"
    ):
        result.deformed(np.array([inside, [0, 0, 99]]))
    with pytest.raises(MeshError, match=r"^deformed: 1 of the 1 points are not finite; the first is number 0"):
        result.deformed(np.array([[0, 0, np.nan]]))
    with pytest.raises(MeshError, match="load_mesh reads a mesh with the scene's scale and up"):
        result.deformed(replace(ball(), vertices=100 * ball().vertices))


@pytest.mark.parametrize("positions", ["all", "x-", {"i": [0, 2]}, "none"])
def test_an_fmu_gives_the_same_lattice_as_its_scene(tmp_path, positions):
    scene = margin(tmp_path, positions)
    from_scene, from_fmu = simulate(scene), simulate(package_fmu(scene, tmp_path / "margin.fmu"))
    np.testing.assert_array_equal(from_fmu.positions, from_scene.positions)
    assert from_fmu.positions.shape == (6, 7, 5, 5, 3) and from_fmu.lattice == from_scene.lattice
    if positions == "all":
        stage = stage_of(from_fmu)
        assert stage.basis == "bspline" and stage.size == pytest.approx(scene.lattice.size)
    else:
        for shown in (stage_of, lambda result: result.deformed(ball())):
            with pytest.raises(SoftffdError, match=r'outputs\.positions = "all"'):
                shown(from_fmu)


@pytest.mark.parametrize("ending", [{"step": 1e-12}, {"step": 1e-300}, {"stop_time": 1e15}, {"stop_time": 1e300}])
def test_more_communication_points_than_memory_are_refused_in_words(ending, result):
    with pytest.raises(FmuError, match=r"make \S+ communication points, whose result would take \S+ GB; wanted at most"):
        simulate(result.scene, **ending)


@pytest.mark.parametrize(
    "given, message",
    [
        ("box.toml", "no such file or shipped scene"),
        (Path("pres"), 'did you mean "press"'),
        (None, "wanted a Scene, the path or name of one, or the path of an FMU, got None"),
    ],
)
def test_what_is_neither_scene_nor_fmu_is_refused(given, message):
    with pytest.raises(SoftffdError, match=message):
        simulate(given)
    with pytest.raises(SoftffdError, match=message if given else "package_fmu: wanted a Scene, or the path or name of one, got None"):
        package_fmu(given, "x.fmu")


def test_a_scene_goes_by_its_name_and_is_driven_by_its_own_inputs(tmp_path):
    own, same, none = (simulate("press", stop_time=0.02, **inputs) for inputs in ({}, {"inputs": PRESS.default_inputs}, {"inputs": {}}))
    np.testing.assert_array_equal(own.positions, same.positions)
    assert own.scene == PRESS and np.ptp(own.inputs["plane.press.point.z"]) > 0 == np.ptp(none.inputs["plane.press.point.z"])
    made = sweep("press", {"mass": [PRESS.mass.total]}, outputs="position[0,0,1].z", stop_time=0.02)
    assert made.outputs["position[0,0,1].z"].item() == own.positions[-1, 0, 0, 1, 2]
    one, other = package_fmu("press", tmp_path / "a.fmu", platforms=host_library().parent.name), package_fmu(PRESS, tmp_path / "b.fmu")
    assert one.read_bytes() == other.read_bytes()
