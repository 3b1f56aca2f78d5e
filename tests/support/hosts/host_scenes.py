"""Two scenes with a part of every kind, which the tests of the host step."""

from scenes import LED, MOVED
from softffd.scene.scene import scene_from

STEP = 0.01
BOX = {
    "material": {"stiffness": 1e3, "damping": 1.0},
    "environment": {"gravity": [0.0, 0.0, -9.81]},
    "plane": [
        {"name": "ground", "point": [0.0, 0.0, 0.0], "friction": 0.4},
        {"name": "plate", "point": [0.0, 0.0, 1.2], "normal": [0.0, 0.0, -1.0], **MOVED},
    ],
    "load": [{"name": "push", "points": "x+"}],
    "probe": [{"name": "top", "at": [0.5, 0.5, 1.0]}],
    "inputs": {"forces": "z+"},
    "outputs": {"velocities": "all", "energy": True, "solver": True},
    "experiment": {"stop_time": 0.2, "communication_step": STEP},
}
HELD = {
    "pin": [{"name": "grip", "points": "z-", **LED}, {"name": "wall", "points": "z+"}],
    "lattice": {"points": [3, 4, 5]},
    "experiment": {"communication_step": STEP},
}


def scene(document=BOX, **changes):
    return scene_from({**document, **changes}, path="box.toml")


def step(simulation, times=1):
    for _ in range(times):
        simulation.step(STEP)
