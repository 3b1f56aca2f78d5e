"""A wrong name is answered with the nearest one there is."""

import pickle

import pytest

from host_scenes import STEP, scene
from softffd import FmuError, simulate


@pytest.mark.parametrize(
    "wrong, nearest",
    [
        (lambda sim: sim["plane.plat.point.z"], "plane.plate.point.z"),
        (lambda sim: sim["plane.plate.piont"], "plane.plate.point"),
        (lambda sim: sim.plane["palte"], "plate"),
        (lambda sim: sim.load["psuh"], "push"),
        (lambda sim: sim.probe["tip"], "top"),
        (lambda sim: sim.plane["plate"].raection, "reaction"),
        (lambda sim: sim.plane["plate"].raection[2], "reaction"),
        (lambda sim: setattr(sim.plane["plate"], "poitn", (0, 0, 1)), "point"),
        (lambda sim: setattr(sim, "forcs", 1), "forces"),
        (lambda sim: setattr(sim, "force", (0, 0, 1)), "forces"),
        (lambda sim: sim.load.__setitem__("puhs", (0, 0, 1)), "push"),
        (lambda sim: sim.force[3, 3, 4], "force[3,3,3]"),
        (lambda sim: sim.block(["plane.plate.point.zz"]), "plane.plate.point.z"),
        (lambda sim: sim.set_rates({"laod.push": (0, 0, 1)}), "load.push"),
        (lambda sim: sim.restart(start_values={"mas": 1.0}), "mass"),
        (lambda sim: sim.restart(method="leapfrogg"), "leapfrog"),
    ],
)
def test_a_wrong_name_is_answered_with_the_nearest_one(sim, wrong, nearest):
    with pytest.raises(FmuError) as refused:
        wrong(sim)
    assert f'did you mean "{nearest}' in str(refused.value)


def test_the_parts_are_not_replaced_as_a_whole_and_an_unknown_one_without_a_near_one_names_those_there_are(sim):
    with pytest.raises(FmuError, match=r'load: a Simulation has no such attribute to assign; values are set by name, sim\["mass"\] = 2'):
        sim.load = {"push": (0, 0, 1)}
    assert set(sim.load) == {"push"} and sim.plane.get("x") is None
    with pytest.raises(FmuError, match="there is ground, plate"):
        sim.plane["x"]


def test_a_result_answers_wrong_names_with_the_nearest_one():
    result = simulate(scene(), stop_time=STEP)
    for wrong, nearest in (
        (lambda: result.outputs["energy.kinetik"], "energy.kinetic"),
        (lambda: result.inputs["load.psuh.x"], "load.push.x"),
        (lambda: result.parameters["masss"], "mass"),
        (lambda: result.plane("palte"), "plate"),
    ):
        with pytest.raises(FmuError, match=f'did you mean "{nearest}"'):
            wrong()
        with pytest.raises(KeyError):
            wrong()
    assert result.outputs.get("nothing") is None and "nothing" not in result.outputs
    assert pickle.loads(pickle.dumps(result.outputs)).keys() == result.outputs.keys()
