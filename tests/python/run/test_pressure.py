"""Contact pressure of taxels: forces by areas, the weight of a block on its foot, the surface between taxels, and what is kept of it."""

import numpy as np
import pytest

from scenes import GRAVITY
from softffd import Result, Scene, SoftffdError, package_fmu, simulate
from softffd.mesh.files import save_mesh
from softffd.mesh.looks import Group, Looks
from softffd.mesh.mesh import Mesh
from softffd.show.stage import surface_of
from softffd.taxels import TaxelGrid
from solids import solid
from validation import shapes

SIDE, WEIGHT = 0.1, 9.81
"""Of a block of 1 kg [m, N]"""
FOOT = {"name": "foot", "on": "z-", "taxels": [3, 2]}
EVERYWHERE = {"name": "all", "on": {"box": [[-1, -1, -1], [1, 1, 1]]}, "taxels": [2, 2]}


def block(**keys) -> Scene:
    """A solid on the ground, at rest after its fall."""
    given = {"gravity": GRAVITY, "internal_damping": 5e-3, "ratio": 0.0, "plane": [{"name": "ground"}], "sensor": [FOOT, EVERYWHERE]} | keys
    return solid(modulus=1e5, density=1000.0, size=[SIDE] * 3, stop_time=0.5, communication_step=0.05, **given)


@pytest.fixture(scope="module")
def rested() -> Result:
    return simulate(block())


def test_a_pressure_is_the_force_towards_the_object_by_the_area():
    grid = TaxelGrid("foot", 0, -1, (0.0, 0.0), (1.0, 2.0), ((0.5, 0.25), (0.0, 0.5)))
    assert grid.counts == (2, 2) and grid.along == [1, 2]
    assert grid.pressures(np.array([[2.0, 1.0], [0.0, -1.0]])).tolist() == [[4.0, 4.0], [0.0, -2.0]]
    assert grid.shares(np.array([[7.0, 0.5, 0.5]])).tolist() == [[0.5, 0.25]]


def test_pressures_by_areas_sum_to_the_force_and_are_even_at_rest(rested):
    pressure, areas = rested.taxel_pressure("foot"), np.array(rested.taxels[0].areas)
    assert pressure.shape == (len(rested.time), 3, 2) and areas.sum() == pytest.approx(SIDE**2, rel=1e-12)
    assert (pressure * areas).sum(axis=(1, 2)) == pytest.approx(rested.outputs["sensor.foot.force.z"], abs=1e-12 * WEIGHT)
    assert pressure[-1] == pytest.approx(np.full((3, 2), WEIGHT / SIDE**2), rel=0.05)


def test_the_surface_has_the_pressure_where_taxels_are_and_none_elsewhere(rested):
    pressure, surface = rested.contact_pressure(), surface_of(rested)
    assert pressure.shape == (len(surface.vertices),) and np.isfinite(rested.contact_pressure(slice(None))).all()
    foot = np.unique(
        surface.faces[np.ptp(surface.vertices[surface.faces][..., 2], axis=1) + surface.vertices[surface.faces][:, 0, 2] < 1e-12]
    )
    assert pressure[foot] == pytest.approx(WEIGHT / SIDE**2, rel=0.05)
    assert not np.delete(pressure, foot).any()


def test_between_the_centres_of_taxels_it_is_linear_and_beyond_them_that_of_the_nearest(rested):
    (foot,), surface = rested.covered_by_taxels(surface_of(rested)), surface_of(rested)
    at = surface.vertices[foot.inside]
    found = foot.at_vertices(np.array([[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]]))[foot.inside]
    wanted = np.interp(at[:, 0], SIDE * np.array([1, 3, 5]) / 6, [0, 1, 2]) + np.interp(at[:, 1], SIDE * np.array([1, 3]) / 4, [0, 1])
    assert found == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("place", ["run", "run.npz"])
def test_a_kept_result_has_the_same_pressures(rested, place, tmp_path):
    rested.save(tmp_path / place)
    again = Result.load(tmp_path / place)
    assert again.taxels == rested.taxels
    assert np.array_equal(again.taxel_pressure("foot"), rested.taxel_pressure("foot"))
    assert np.array_equal(again.contact_pressure(), rested.contact_pressure())


def test_a_run_of_the_fmu_alone_has_the_same_pressures(rested, tmp_path):
    fmu = package_fmu(block(), tmp_path / "block.fmu")
    result = simulate(fmu, stop_time=0.5, step=0.05)
    assert result.scene is None and result.taxels == rested.taxels
    assert result.contact_pressure() == pytest.approx(rested.contact_pressure(), rel=1e-9)


def test_of_a_mesh_only_the_group_of_the_sensor_has_pressure(tmp_path):
    vertices, faces = shapes.cube(9, 0.0)
    left = (vertices[faces][..., 2] == 0).all(axis=1) & (vertices[faces][..., 0].mean(axis=1) < 0.5)
    looks = Looks(groups=(Group("", "rest"), Group("", "heel")), group_of=left.astype(np.int64))
    save_mesh(Mesh(SIDE * vertices, faces, looks=looks), tmp_path / "block.obj")
    heel = {"name": "heel", "on": "heel", "taxels": [2, 2]}
    result = simulate(block(sensor=[heel], mesh={"file": tmp_path / "block.obj"}, contact={"of": "surface"}))
    pressure, mesh = result.contact_pressure(), result.loaded_mesh
    inside = np.isin(np.arange(len(mesh.vertices)), mesh.faces[(mesh.vertices[mesh.faces][..., 2] == 0).all(axis=1)])
    inside &= mesh.vertices[:, 0] <= 0.5 * SIDE + 1e-9
    assert pressure[inside] == pytest.approx(WEIGHT / SIDE**2, rel=0.05) and not pressure[~inside].any()


@pytest.mark.parametrize(
    "ask, said",
    [
        (lambda result: result.taxel_pressure("food"), 'sensor with taxels food: there is no such sensor with taxels, did you mean "foot"'),
        (lambda result: result.taxel_pressure("all"), "the patch of sensor all faces both ways"),
        (lambda result: result.contact_pressure(99), "contact_pressure: wanted a row of 11"),
    ],
    ids=["name", "closed", "row"],
)
def test_what_has_no_pressure_is_refused_in_words(rested, ask, said):
    with pytest.raises(SoftffdError, match=said):
        ask(rested)


def test_without_taxels_there_is_no_contact_pressure():
    result = simulate(block(sensor=[{"name": "foot", "on": "z-"}]), stop_time=0.05)
    assert result.taxels == ()
    for ask in (result.contact_pressure, lambda: result.plot(colour="contact_pressure")):
        with pytest.raises(SoftffdError, match="contact pressure: wanted a run with all taxels of a"):
            ask()
