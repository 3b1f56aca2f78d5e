"""What has to work with the oldest packages: python oldest_packages.py FOLDER, which holds a ball in every kind of mesh file."""

import sys
from pathlib import Path

import numpy as np

import softffd
from softffd.cli.command import main
from softffd.mesh.files import READ, WRITTEN


def require_every_kind(folder: Path) -> None:
    files = sorted(file for file in folder.glob("ball.*") if file.suffix in READ)
    assert {file.suffix for file in files} == set(READ), files
    for file in files:
        mesh = softffd.load_mesh(file)
        assert len(mesh.faces) == 80 and mesh.closed and np.allclose(np.linalg.norm(mesh.vertices, axis=1), 1, atol=1e-4), file
        assert main(["run", str(file), "--stop-time", "0.02", "-o", str(folder / f"run{file.suffix}")]) == 0, file
    for ending in WRITTEN:
        softffd.save_mesh(softffd.load_mesh(folder / "ball.obj"), folder / f"again{ending}")
        assert len(softffd.load_mesh(folder / f"again{ending}").faces) == 80


def require_tables(folder: Path) -> None:
    result = softffd.simulate(softffd.load_scene("press"), stop_time=0.05, inputs=softffd.load_scene("press").default_inputs)
    result.save(folder / "press.npz")
    loaded = softffd.Result.load(folder / "press.npz")
    frame, data = loaded.to_dataframe(), loaded.to_xarray()
    assert frame["plane.press.reaction.z"].iloc[-1] == data["plane.press.reaction"].values[-1, 2]
    again = softffd.simulate(softffd.load_scene("press"), stop_time=0.05, inputs=frame[["plane.press.point.z"]])
    assert np.array_equal(again.positions, result.positions)
    loaded.plot(folder / "curve.png", x="plane.press.point.z", y="plane.press.reaction")
    assert "<iframe" in loaded._repr_html_()


def require_exports(folder: Path) -> None:
    result = softffd.simulate("press", stop_time=0.05)
    for name in ("vtkhdf", "vtu", "glb", "usd", "pc2", "ply", "gif"):
        assert all(file.exists() for file in result.export(folder / name, to=name, frames=3))


def require_sweeps(folder: Path) -> None:
    from distributed import Client, LocalCluster

    asked = {"stiffness.edge": [500, 1e3], "mass": [1, 2, 3]}
    here = softffd.sweep(softffd.load_scene("press"), asked, outputs=["energy.elastic"], stop_time=0.02)
    with LocalCluster(1, processes=False, dashboard_address=None) as cluster, Client(cluster) as client:
        there = softffd.sweep(
            softffd.load_scene("press"), asked, outputs=["energy.elastic"], stop_time=0.02, executor=client.get_executor()
        )
    assert np.array_equal(here.outputs["energy.elastic"], there.outputs["energy.elastic"]) and not here.failures
    here.plot(folder / "sweep.png")
    here.to_xarray()


def require_robot() -> None:
    import mujoco

    from softffd.bridges.mujoco import couple

    slide = '<body name="hand"><joint type="slide" axis="0 0 1"/><geom size="0.1" mass="9"/></body>'
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{slide}</worldbody></mujoco>")
    data, led = mujoco.MjData(model), ["position", "orientation", "velocity", "angular_velocity"]
    scene = softffd.load_scene("hanging").replace({"pin[0].motion": "input", "pin[0].inputs": led, "material.damping": 0})
    with softffd.Simulation(scene) as body:
        bridge = couple(model, data, {body: {f"pin.{scene.pin[0].name}": "hand"}})
        for _ in range(100):
            bridge.step()
    assert abs(data.qvel[0] + 9.81 * data.time) < 0.01  # they fall together


if __name__ == "__main__":
    place = Path(sys.argv[1])
    assert main(["demo", "-o", str(place / "demo")]) == 0
    require_every_kind(place)
    require_tables(place)
    require_exports(place)
    require_sweeps(place)
    assert main(["drivers", "-o", str(place / "drivers")]) == 0
    require_robot()
