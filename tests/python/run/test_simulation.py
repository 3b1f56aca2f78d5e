"""The one host: step, set and read by name, blocks, states, log, and how it refuses."""

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from softffd import FmuError, Simulation, installed, package_fmu, simulate
from softffd.fmu.component import Component
from softffd.scene.scene import scene_from

STEP = 0.01
BOX = {
    "material": {"stiffness": 1e3, "damping": 1.0},
    "environment": {"gravity": [0.0, 0.0, -9.81]},
    "plane": [
        {"name": "ground", "point": [0.0, 0.0, 0.0], "friction": 0.4},
        {"name": "plate", "point": [0.0, 0.0, 1.2], "normal": [0.0, 0.0, -1.0], "motion": "input"},
    ],
    "load": [{"name": "push", "points": "x+"}],
    "probe": [{"name": "top", "at": [0.5, 0.5, 1.0]}],
    "inputs": {"forces": "z+"},
    "outputs": {"velocities": "all", "energy": True, "solver": True},
    "experiment": {"stop_time": 0.2, "communication_step": STEP},
}
HELD = {
    "pin": [
        {"name": "grip", "points": "z-", "motion": "input"},
        {"name": "wall", "points": "z+"},
    ],
    "lattice": {"points": [3, 4, 5]},
    "experiment": {"communication_step": STEP},
}


def scene(document=BOX, **changes):
    return scene_from({**document, **changes}, path="box.toml")


@pytest.fixture
def sim():
    with Simulation(scene()) as opened:
        yield opened


@pytest.fixture
def held():
    with Simulation(scene(HELD)) as opened:
        yield opened


def step(simulation, times=1):
    for _ in range(times):
        simulation.step(STEP)


# ---- step and time ----


def test_steps_add_up_to_the_time(sim):
    assert sim.time == 0.0
    sim.step(0.25 * STEP)
    assert sim.time == 0.25 * STEP
    sim.step()  # the scene's communication step
    assert sim.time == 1.25 * STEP
    sim.step(STEP, end=2.25 * STEP)
    assert sim.time == 2.25 * STEP


def test_stepping_gives_the_bits_of_simulate(sim):
    result = simulate(scene())
    for row, time in enumerate(result.time[1:].tolist()):
        sim.step(STEP, end=time)
        np.testing.assert_array_equal(sim.positions, result.positions[row + 1])
        assert sim["plane.ground.reaction.z"] == result.outputs["plane.ground.reaction.z"][row + 1]


def test_a_scene_and_its_fmu_give_the_same_bits_and_take_each_other_s_states(sim, tmp_path):
    with Simulation(package_fmu(scene(), tmp_path / "box.fmu")) as packed:
        for each in (sim, packed):
            each.plane["plate"].point = (0, 0, 1.1)
            step(each, 3)
        np.testing.assert_array_equal(packed.positions, sim.positions)
        state = sim.save()
        step(sim, 2)
        packed.restore(state)
        step(packed, 2)
        np.testing.assert_array_equal(packed.positions, sim.positions)
        assert packed.variables == sim.variables or [*packed.variables] == [*sim.variables]


def test_a_path_as_text_and_an_opened_component_are_taken_too(tmp_path):
    fmu = package_fmu(scene(), tmp_path / "box.fmu")
    with Simulation(str(fmu)) as opened:
        step(opened)
    component = Component(fmu)
    with Simulation(component) as opened:
        assert opened.component is component
        step(opened)
    with pytest.raises(FmuError, match="closed"):
        component.do_step(STEP, STEP)


def test_a_start_time_moves_the_clock_and_a_stop_time_ends_it():
    with Simulation(scene(), start_time=3.0, stop_time=3.0 + 2 * STEP) as late:
        assert late.time == 3.0
        step(late, 2)
        with pytest.raises(FmuError, match="stop time"):
            step(late)
        assert late.time == pytest.approx(3.0 + 2 * STEP)


def test_tolerance_and_method_are_those_asked_for():
    with Simulation(scene(), tolerance=1e-7, method="bm4") as exact, Simulation(scene(), method="leapfrog", tolerance=1e-2) as coarse:
        assert exact["solver.method"] == "bm4" and coarse["solver.method"] == "leapfrog"
        assert exact["solver.tolerance"] == 1e-7
        for each in (exact, coarse):
            step(each, 5)
        assert exact["solver.steps"] > coarse["solver.steps"]


def test_a_tolerance_that_is_none_is_refused():
    for wrong in (0.0, -1.0, float("nan")):
        with pytest.raises(FmuError, match="tolerance: wanted > 0"):
            Simulation(scene(), tolerance=wrong)


@pytest.mark.parametrize("length", [0.0, -STEP, float("nan"), float("inf")])
def test_a_length_that_is_none_is_refused_and_stepping_goes_on(sim, length):
    with pytest.raises(FmuError, match="step: wanted a length > 0 s"):
        sim.step(length)
    step(sim)
    assert sim.time == STEP


# ---- reading ----


def test_positions_and_velocities_are_grids_that_stay_as_they_were_read(held):
    before = held.positions
    kept = before.copy()
    assert before.shape == (3, 4, 5, 3)
    np.testing.assert_allclose(before[2, 3, 4], [1.0, 1.0, 1.0])
    np.testing.assert_allclose(before[1, 0, 0], [0.5, 0.0, 0.0])
    held.pin["grip"].velocity = (0, 0, -1)
    step(held)
    np.testing.assert_array_equal(before, kept)
    assert held["position[1,2,3].y"] == held.positions[1, 2, 3, 1]


def test_velocities_are_those_of_the_outputs(sim):
    step(sim)
    assert sim.velocities.shape == (4, 4, 4, 3)
    assert sim.velocities[3, 0, 3, 2] == sim["velocity[3,0,3].z"] < 0


def test_what_is_not_among_the_outputs_is_nan_or_refused(held):
    with Simulation(scene(HELD, outputs={"positions": [[2, 3, 4]]})) as one:
        assert np.isnan(one.positions[0, 0, 0]).all() and np.isfinite(one.positions[2, 3, 4]).all()
    with pytest.raises(FmuError, match=r"outputs\.velocities"):
        _ = held.velocities


def test_names_give_numbers_items_and_vectors(sim):
    assert isinstance(sim["plane.ground.contacts"], int)
    assert sim["solver.method"] == "auto"
    np.testing.assert_array_equal(sim["plane.plate.point"], [0.0, 0.0, 1.2])
    assert "energy.kinetic" in sim and "plane.plate.point" in sim and "nobody" not in sim
    assert sim.variables["mass"].unit == "kg"


def test_energies_and_reactions_balance_by_name(sim):
    start = sim["energy.kinetic"] + sim["energy.elastic"] + sim["energy.gravity"]
    step(sim, 10)
    now = sum(sim[f"energy.{kind}"] for kind in ("kinetic", "elastic", "gravity", "dissipated")) - sim["energy.work"]
    assert now == pytest.approx(start, abs=1e-4)  # J; the balance closes to the integration error
    np.testing.assert_array_equal(sim.plane["ground"].reaction, [sim[f"plane.ground.reaction.{c}"] for c in "xyz"])
    assert sim.plane["ground"].reaction[2] < 0 and sim.plane["ground"].contacts == sim["plane.ground.contacts"] == 16
    assert sim.plane["ground"].torque.shape == (3,)


def test_parts_are_listed_in_the_order_of_the_scene(sim, held):
    assert [*sim.plane] == ["ground", "plate"] and len(sim.plane) == 2
    assert [*held.pin] == ["grip", "wall"] and [*held.plane] == []
    assert [*sim.load] == ["push"] and [*sim.probe] == ["top"]
    np.testing.assert_allclose(sim.probe["top"], [0.5, 0.5, 1.0])


def test_what_is_read_is_a_number_of_the_host_s(sim):
    reaction = sim.plane["ground"].reaction
    step(sim, 2)
    assert reaction[2] == 0.0 and sim.plane["ground"].reaction[2] < 0
    doubled = 2 * sim.plane["plate"].point
    doubled[2] = 7.0
    assert sim.plane["plate"].point[2] == 1.2


# ---- setting ----


def test_scalars_vectors_and_components_are_set(sim):
    sim["plane.plate.point.z"] = 0.9
    assert sim.plane["plate"].point[2] == 0.9
    sim.plane["plate"].point[0] = 0.5
    np.testing.assert_array_equal(sim.plane["plate"].point, [0.5, 0.0, 0.9])
    sim.plane["plate"].normal = np.array([0.0, 0.6, -0.8])
    sim["plane.plate.velocity"] = (0, 0, -1)
    sim.plane["plate"].angular_velocity = [0, 0, 2]
    sim.plane["ground"].friction = 0.7
    np.testing.assert_array_equal(sim["plane.plate.normal"], [0.0, 0.6, -0.8])
    np.testing.assert_array_equal(sim.plane["plate"].velocity, [0, 0, -1])
    assert sim["plane.plate.angular_velocity.z"] == 2 and sim["plane.ground.friction"] == 0.7
    sim.plane["plate"].velocity += (1, 0, 0)
    np.testing.assert_array_equal(sim.plane["plate"].velocity, [1, 0, -1])


def test_a_plate_that_comes_down_presses(sim):
    plate = sim.plane["plate"]
    for n in range(20):
        plate.point[2], plate.velocity[2] = 1.2 - 2.0 * n * STEP, -2.0
        step(sim)
    assert plate.reaction[2] > 10 and sim.positions[..., 2].max() <= 0.8 + 1e-12


def test_pins_move_what_they_hold(held):
    grip = held.pin["grip"]
    grip.position[2] = -0.1
    grip.orientation = (np.cos(0.1), 0, 0, np.sin(0.1))
    grip.velocity, grip.angular_velocity = (0, 0, -1), (0, 0, 0.5)
    np.testing.assert_allclose(grip.orientation, [np.cos(0.1), 0, 0, np.sin(0.1)])
    step(held)
    assert held.positions[0, 0, 0, 2] == pytest.approx(-0.1 - STEP)
    assert grip.reaction[2] > 0 > held.pin["wall"].reaction[2] and grip.torque.shape == (3,)
    with pytest.raises(FmuError, match="no such variable"):
        _ = held.pin["wall"].position


def test_loads_and_forces_act_on_the_points(sim):
    sim.load["push"] = (16.0, 0, 0)
    sim.load["push"][1] = 8.0
    np.testing.assert_array_equal(sim["load.push"], [16.0, 8.0, 0.0])
    sim.force[3, 3, 3] = (0, 0, 5.0)
    assert sim["force[3,3,3].z"] == 5.0 and sim.force[3, 3, 3][2] == 5.0
    step(sim)
    v = sim.velocities
    assert v[3, 0, 0, 0] > 0.1 and v[3, 3, 3, 2] > v[0, 3, 3, 2] + 0.1


def test_forces_are_set_as_a_whole_where_they_are_inputs(sim):
    forces = np.zeros((4, 4, 4, 3))
    forces[:, :, 3, 0] = np.arange(16).reshape(4, 4)
    sim.forces = forces
    assert sim["force[2,1,3].x"] == 9.0 and np.isnan(sim.forces[0, 0, 0]).all()
    forces[0, 0, 0, 2] = 1.0
    with pytest.raises(FmuError, match="zeros or NaN"):
        sim.forces = forces


def test_everything_can_be_set_before_the_first_step_then_inputs_and_tunables(sim):
    sim["mass"] = 2.0
    sim["gravity"] = (0, 0, -1.0)
    assert sim.initializing
    step(sim)
    assert not sim.initializing and sim["mass"] == 2.0
    sim["stiffness.edge"] = 2e3
    with pytest.raises(FmuError, match="mass: a fixed parameter can be set before the first step only"):
        sim["mass"] = 3.0
    step(sim)


def test_initialize_ends_the_settings_without_a_step(sim):
    sim.initialize()
    sim.initialize()
    assert sim.time == 0.0
    with pytest.raises(FmuError, match="fixed parameter"):
        sim["mass"] = 3.0


def test_start_values_are_numbers_words_or_vectors():
    with Simulation(scene(), start_values={"mass": "2", "solver.method": "leapfrog", "plane.plate.point": (0, 0, 1.5)}) as opened:
        assert opened["mass"] == 2.0 and opened["solver.method"] == "leapfrog" and opened.plane["plate"].point[2] == 1.5
    result = simulate(scene(), stop_time=STEP, start_values={"gravity": (0, 0, -1.0), "plane.plate.point": (0, 0, 1.5)})
    assert result.parameters["gravity.z"] == -1.0 and result.inputs["plane.plate.point.z"][0] == 1.5


@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), "fast", None])
def test_what_is_no_finite_number_is_refused_and_changes_nothing(sim, wrong):
    with pytest.raises(FmuError, match=r"plane\.plate\.point\.z: wanted a"):
        sim["plane.plate.point.z"] = wrong
    with pytest.raises(FmuError, match=r"plane\.plate\.point\.y: wanted a"):
        sim.plane["plate"].point = (0, wrong, 0)
    np.testing.assert_array_equal(sim.plane["plate"].point, [0.0, 0.0, 1.2])
    step(sim)


def test_outputs_cannot_be_set(sim):
    for name, value in (("position[0,0,0].x", 1.0), ("plane.plate.reaction", (0, 0, 1)), ("energy.work", 0.0)):
        with pytest.raises(FmuError, match="wanted an input or a parameter, got an output"):
            sim[name] = value
    with pytest.raises(FmuError, match="got an output"):
        sim.plane["plate"].reaction[2] = 1.0
    with pytest.raises(FmuError, match="got an output"):
        sim.block(["energy.work"]).set()
    step(sim)


def test_a_vector_wants_its_components(sim):
    for wrong in ((1, 2), 1.0, (1, 2, 3, 4)):
        with pytest.raises(FmuError, match=r"plane\.plate\.point: wanted 3 numbers"):
            sim.plane["plate"].point = wrong


# ---- wrong names ----


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


def test_an_unknown_part_without_a_near_one_names_those_there_are(sim):
    with pytest.raises(FmuError, match="there is ground, plate"):
        sim.plane["x"]
    assert sim.plane.get("x") is None


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


# ---- blocks and derivatives ----


def test_blocks_keep_their_buffers(sim):
    moved = sim.block(["plane.plate.point.z", "plane.plate.velocity.z"])
    pressed = sim.block(["plane.plate.reaction"])
    buffer = pressed.values
    assert pressed.names == tuple(f"plane.plate.reaction.{c}" for c in "xyz") and buffer.shape == (3,)
    for n in range(15):
        moved.set([1.2 - 2.0 * n * STEP, -2.0])
        step(sim)
        assert pressed.get() is buffer
    assert buffer[2] == sim["plane.plate.reaction.z"] > 0
    counts = sim.block(["plane.ground.contacts", "solver.steps"])
    assert counts.get().dtype == np.int32 and counts.values[1] == sim["solver.steps"]
    with pytest.raises(FmuError, match="one type"):
        sim.block(["solver.steps", "mass"])


def test_derivatives_of_inputs_act_inside_the_next_step():
    """A load that grows from nought gives half the momentum of its end value held, a sixth of it by its second derivative."""
    free = {"material": {"damping": 0.0}, "load": BOX["load"], "outputs": {"velocities": "all"}, "solver": {"method": "dop853"}}

    def momentum(rates) -> float:
        with Simulation(scene(free)) as sim:
            sim.set_rates(rates)
            step(sim)
            return sim.velocities[..., 1].sum() / 64

    linear = momentum({"load.push": (0, 10.0 / STEP, 0)})
    assert linear == pytest.approx(10.0 * STEP / 2, rel=1e-9)
    assert momentum({"load.push.y": 10.0 / STEP}) == linear
    bent = momentum({"load.push": [(0, 0, 0), (0, 10.0 / STEP**2, 0)]})
    assert bent == pytest.approx(10.0 * STEP / 6, rel=1e-9)
    assert momentum({"load.push.y": [0.0, 10.0 / STEP**2]}) == bent


def test_derivatives_want_the_shape_of_their_input(sim):
    for wrong in ((1.0, 2.0), 1.0, [(1.0, 2.0)] * 3):
        with pytest.raises(FmuError, match=r"load\.push: wanted derivatives of 3 components"):
            sim.set_rates({"load.push": wrong})


# ---- states ----


def test_a_saved_moment_comes_back_with_its_time_and_continues_with_the_same_bits(sim):
    step(sim, 3)
    state = sim.save()
    ends = []
    for _ in range(3):
        step(sim, 4)
        ends.append(sim.positions)
        sim.restore(state)
        assert sim.time == state.time == pytest.approx(3 * STEP)
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_a_state_is_bytes_that_another_simulation_continues_from(sim):
    step(sim, 3)
    data = bytes(sim.save())
    step(sim, 2)
    with Simulation(scene()) as other:
        other.restore(data)
        assert other.time == pytest.approx(3 * STEP) and not other.initializing
        step(other, 2)
        np.testing.assert_array_equal(other.positions, sim.positions)


def test_a_state_s_bytes_continue_in_another_process(sim, tmp_path):
    step(sim, 3)
    package_fmu(scene(), tmp_path / "box.fmu")
    (tmp_path / "state").write_bytes(bytes(sim.save()))
    step(sim, 2)
    program = (
        "import sys, numpy, softffd\n"
        "with softffd.Simulation('box.fmu') as sim:\n"
        "    sim.restore(open('state', 'rb').read())\n"
        f"    sim.step({STEP!r}); sim.step({STEP!r})\n"
        "    numpy.save('end.npy', sim.positions)\n"
    )
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)
    np.testing.assert_array_equal(np.load(tmp_path / "end.npy"), sim.positions)


def test_a_state_before_the_first_step_leads_back_to_the_settings(sim):
    state = sim.save()
    step(sim, 2)
    sim.restore(state)
    assert sim.initializing and sim.time == 0.0
    sim["mass"] = 2.0
    step(sim)


def test_damaged_and_foreign_states_are_refused(sim, held):
    step(sim)
    data = bytes(sim.save())
    now = sim.positions
    flipped = bytearray(data)
    flipped[len(data) // 2] ^= 1
    for wrong in (b"", b"nonsense" * 9, bytes(flipped), data[:-1]):
        with pytest.raises(FmuError):
            sim.restore(wrong)
    with pytest.raises(FmuError, match="another scene"):
        held.restore(data)
    np.testing.assert_array_equal(sim.positions, now)
    step(sim)


def test_states_are_freed_with_their_last_reference_and_with_the_simulation(monkeypatch):
    freed = []
    free = Component.free_state
    monkeypatch.setattr(Component, "free_state", lambda component, handle: (freed.append(handle), free(component, handle)))
    with Simulation(scene()) as opened:
        kept, dropped = opened.save(), opened.save()
        handle = dropped.handle
        del dropped
        assert freed == [handle]
    assert freed == [handle, kept.handle]
    opened.component.free_state(kept.handle)  # which is passed over
    with pytest.raises(FmuError):
        bytes(kept)


def test_restart_begins_again_with_the_settings_given(sim):
    step(sim, 3)
    sim.restart()
    assert sim.time == 0.0 and sim.log == [] and sim.initializing
    step(sim, 3)
    fresh = sim.positions
    sim.restart(start_values={"mass": 3.0}, method="leapfrog", tolerance=1e-3, start_time=1.0)
    assert (sim["mass"], sim["solver.method"], sim["solver.tolerance"], sim.time) == (3.0, "leapfrog", 1e-3, 1.0)
    sim.restart()
    assert sim["mass"] == 1.0
    step(sim, 3)
    np.testing.assert_array_equal(sim.positions, fresh)


# ---- what it says ----


def test_the_log_has_status_category_and_text_and_is_told_at_once():
    heard = []
    with Simulation(scene(), log=heard.append, start_values={"plane.ground.point.z": 0.01}) as low:
        step(low)
        assert heard == low.log and heard
        assert {message.category for message in heard} == {"solver", "logStatusWarning"}
        warning = next(message for message in heard if message.status == 1)
        assert "start behind plane ground" in warning.text == str(warning) and low.warnings == [warning.text]


def test_a_log_that_cannot_be_called_is_refused():
    with pytest.raises(FmuError, match="log: wanted a function"):
        Simulation(scene(), log=True)


def test_methods_tells_which_took_over_and_why(sim):
    assert sim.methods() == []
    step(sim)
    assert sim.methods() == [("leapfrog", "an obstacle is within reach")]


def test_a_discarded_step_leaves_time_and_state_and_a_saved_moment_continues(sim):
    step(sim)
    before, now, time = sim.save(), sim.positions, sim.time
    sim["stiffness.edge"] = 1e18
    with pytest.raises(FmuError, match="discarded the step"):
        sim.step(0.25)
    assert sim.time == time
    np.testing.assert_array_equal(sim.positions, now)
    sim.restore(before)
    assert sim["stiffness.edge"] == 1e3
    step(sim)


def test_a_closed_simulation_answers_instead_of_crashing(sim):
    block = sim.block(["plane.plate.point"])
    sim.close()
    for call in (lambda: sim.step(STEP), lambda: sim.positions, block.get, sim.save, lambda: sim["mass"]):
        with pytest.raises(FmuError, match="closed"):
            call()
    sim.close()


def test_a_run_leaves_no_folder_behind(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with Simulation(scene()) as opened:
        step(opened)
        (folder,) = tmp_path.iterdir()
        assert {file.relative_to(folder).as_posix() for file in folder.rglob("*.*")} == {"modelDescription.xml", "resources/scene.txt"}
    assert not list(tmp_path.iterdir())
    with pytest.raises(FmuError):
        Simulation(scene(), method="fast")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "wrong, words", [(None, "wanted a Scene or the path"), (3, "wanted a Scene"), ("press", 'take load_scene("press")')]
)
def test_what_is_neither_scene_nor_fmu_is_refused(wrong, words):
    with pytest.raises(FmuError) as refused:
        Simulation(wrong)
    assert words in str(refused.value)


def test_a_run_takes_the_library_of_this_machine_alone(tmp_path, monkeypatch):
    """Whatever else is installed: libraries of other platforms are not read."""
    own = installed.host_library()
    binaries = tmp_path / "binaries"
    for name, file in installed.LIBRARY_NAME.items():
        (binaries / name).mkdir(parents=True)
        (binaries / name / file).write_bytes(b"no library")
    (binaries / own.parent.name / own.name).write_bytes(own.read_bytes())
    installed.table()  # read before, from where it is
    monkeypatch.setattr(installed, "data_folder", lambda: tmp_path)
    with Simulation(scene()) as opened:
        step(opened)


def test_the_installed_library_stays_loaded_between_runs():
    """Loading it anew would leave 70 kB each time, which its C++ runtime takes and never gives back."""
    loaded = Path("/proc/self/maps")
    if not loaded.is_file():
        pytest.skip("this system does not list what a process has loaded")
    with Simulation(scene()):
        pass
    assert str(installed.host_library().resolve()) in loaded.read_text()


def test_many_run_side_by_side_in_one_process():
    with Simulation(scene()) as one, Simulation(scene(HELD)) as two, Simulation(scene()) as three:
        for each in (one, two, three, three, one, two):
            step(each)
        np.testing.assert_array_equal(one.positions, three.positions)
