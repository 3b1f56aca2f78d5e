"""What objects say of themselves: a few lines, whatever they hold."""

import numpy as np
import pytest

from made_up_run import made_up_run
from mesh_files import ball
from scenes import box, table_and_press
from softffd import Simulation, load_scene, simulate


@pytest.fixture(scope="module")
def scene():
    return box(plane=table_and_press(), probe=[{"name": "top", "at": [0.5, 0.5, 1.0]}], velocities="all", stop_time=0.1)


def lines_of(thing) -> list[str]:
    said = repr(thing)
    assert str(thing) == said and len(said) < 800
    return said.splitlines()


def test_a_scene_says_its_box_its_parts_and_its_run(scene):
    lines = lines_of(scene)
    assert lines[0].startswith("Scene scene: ") and len(lines) == 4
    assert "4 × 4 × 4 control points (bezier) in a box of 1 × 1 × 1 m" in lines[1]
    assert lines[2].strip() == "plane table, press; probe top"
    assert lines[3].strip() == "method auto, tolerance 0.0001, 0.1 s in communication steps of 0.01 s"
    assert "mesh car.obj" in repr(load_scene("car_drop"))


def test_a_mesh_says_how_large_it_is():
    mesh = ball()
    sides = " × ".join(f"{side:.4g}" for side in np.ptp(mesh.vertices, axis=0))
    assert lines_of(mesh) == [f"Mesh {mesh.name}: {len(mesh.vertices):,} vertices, {len(mesh.faces):,} faces, {sides} m"]


def test_a_simulation_and_its_blocks_say_what_they_are_of(scene):
    with Simulation(scene) as sim:
        sim.step(0.05)
        assert lines_of(sim) == [f"Simulation of {scene.title} at 0.05 s: 4 x 4 x 4 control points", "  plane table, press", "  probe top"]
        block = sim.block(["position[0,0,0]", "position[1,0,0]", "plane.press.reaction"])
        assert lines_of(block) == ["Block of 9 numbers: position[i,j,k], plane.press.reaction"]
    assert "Simulation of" in repr(sim)  # closed


def test_a_result_says_what_it_has(scene):
    lines = lines_of(simulate(scene))
    assert lines[0] == f"Result of {scene.title}: 0 to 0.1 s in 11 rows"
    assert "positions (11, 4, 4, 4, 3) m, largest deformation " in lines[1]
    assert lines[2].startswith("  outputs: velocity[i,j,k], probe.top, plane.table.reaction, ") and lines[2].endswith(" more")
    assert lines[3].strip().startswith("inputs: plane.press.point, ")
    assert lines[4].strip().startswith("parameters: ")


def test_a_result_without_positions_or_with_warnings_says_so():
    run = made_up_run()
    run.positions[3] = np.nan
    run.summary["warnings"] = ["gains energy"]
    lines = lines_of(run)
    assert lines[1] == "  positions (41, 4, 4, 4, 3) m, not all recorded" and lines[-1] == "  1 warning, the first: gains energy"
