"""Free bodies are drawn, exported and read where the outputs of the run say that they are."""

from dataclasses import replace

import numpy as np
import pytest

from exported import Glb, solids
from readings import vector
from scenes import GRAVITY, meshed
from softffd import Result, Simulation, SoftffdError, simulate
from softffd.rotation import matrices
from softffd.show.stage import stage_of
from validation import shapes

CRATE = {
    **{"name": "crate", "size": [0.3, 0.4, 0.5], "point": [1.8, 0.5, 0.5], "motion": "free", "mass": 2.0},
    **{"rotation": {"axis": [1, 2, 0], "degrees": 40.0}, "velocity": [0.0, 0.0, 2.0], "angular_velocity": [3.0, -1.0, 2.0]},
}
LOG = {
    **{"name": "log", "radius": 0.1, "length": 0.6, "normal": [1.0, 0.0, 1.0], "point": [-0.8, 0.5, 0.5], "motion": "free", "mass": 1.0},
    **{"velocity": [0.0, 0.0, 2.0], "angular_velocity": [0.0, 4.0, 0.0]},
}
BALL = {"name": "ball", "radius": 0.2, "point": [0.5, -0.8, 0.2], "motion": "free", "mass": 1.0, "guide": [0.0, 0.0, 1.0]}


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A cube that hangs by its foot, and a crate, a log and a ball that fly beside it."""
    parts = {"box": [CRATE], "cylinder": [LOG], "sphere": [BALL], "pin": [{"name": "foot", "points": "z-"}]}
    about = {"gravity": GRAVITY, "stop_time": 0.4, "communication_step": 0.02, "stiffness": 3e3}
    return meshed(tmp_path_factory.mktemp("flying"), shapes.cube(3, 0.1), **parts, **about)


@pytest.fixture(scope="module")
def run(scene) -> Result:
    return simulate(scene)


def test_the_stage_has_them_where_their_outputs_are(run):
    tracks = {solid.name: solid for solid in stage_of(run).solids}
    for name, path in (("crate", "box.crate"), ("log", "cylinder.log"), ("ball", "sphere.ball")):
        assert (tracks[name].points == vector(run, f"{path}.position")).all()
    axes = matrices(np.stack([run.outputs[f"box.crate.orientation.{c}"] for c in "wxyz"], axis=1))
    assert tracks["crate"].axes == pytest.approx(axes.swapaxes(1, 2), abs=1e-9)
    ends = run.plane("log")[1]
    assert ends[0] == pytest.approx(np.array([1.0, 0.0, 1.0]) / np.sqrt(2), abs=1e-12) and np.abs(ends[-1] - ends[0]).max() > 0.5
    assert np.linalg.norm(ends, axis=1) == pytest.approx(1.0, abs=1e-12)


def test_what_flies_past_is_in_view_as_far_as_the_lattice_is_large(run):
    stage = stage_of(run)
    low, high = stage.centre - stage.half, stage.centre + stage.half
    assert low[0] == pytest.approx((run.plane("log")[0][:, 0]).min() - 0.3, abs=0.1) and high[0] > 1.9


def test_a_run_that_did_not_record_where_they_are_says_so(run):
    kept = {name: values for name, values in run.outputs.items() if not name.startswith("box.crate.orientation")}
    with pytest.raises(
        SoftffdError, match=r"^box.crate: wanted a run whose outputs say where it is, got one without box.crate.orientation"
    ):
        stage_of(replace(run, outputs=kept))


def test_a_saved_result_has_them_too(run, tmp_path):
    run.save(tmp_path / "run.npz")
    again = Result.load(tmp_path / "run.npz")
    assert (again.plane("crate")[0] == run.plane("crate")[0]).all() and (again.edges("crate") == run.edges("crate")).all()


def test_the_page_the_picture_and_the_export_show_them(run, tmp_path):
    assert "crate" in run.view(tmp_path / "run.html", browser=False).read_text(encoding="utf-8")
    assert run.plot(tmp_path / "run.png")
    run.export(tmp_path / "run.glb")
    names = [node.get("name") for node in Glb(tmp_path / "run.glb").tree["nodes"]]
    assert {"crate", "log", "ball"} <= set(names) == set(names) and set(solids(run, 0)) == {"crate", "log", "ball"}


def test_a_simulation_has_them_by_name(scene):
    with Simulation(scene) as sim:
        crate, ball = sim.obstacle["crate"], sim.obstacle["ball"]
        assert crate.mass == 2.0 and crate.start_velocity.tolist() == [0.0, 0.0, 2.0]
        assert crate.position.tolist() == CRATE["point"] and crate.orientation.shape == (4,)
        crate.force, crate.torque = (2.0, 0.0, 0.0), (0.0, 0.1, 0.0)
        before = crate.velocity
        sim.step(0.1)
        assert crate.velocity - before == pytest.approx([0.1, 0.0, 0.1 * GRAVITY[2]], abs=1e-12)
        assert crate.reaction.tolist() == [0.0] * 3 and crate.reaction_torque.tolist() == [0.0] * 3 and ball.contacts == 0
        with pytest.raises(SoftffdError, match=r"sphere\.ball\.angular_velocity"):
            _ = ball.angular_velocity
        with pytest.raises(SoftffdError, match=r"sphere.ball.position.x: wanted an input or a parameter, got an output"):
            ball.position = (0.0, 0.0, 0.0)
