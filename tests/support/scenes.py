"""Scenes as dictionaries: `box(stiffness=2e3, plane=[{"name": "ground"}])` is what the same keys in a file would be."""

from pathlib import Path
from typing import Any

import pytest

from softffd import Scene, SceneError
from softffd.scene.scene import scene_from
from validation import shapes

GRAVITY = [0.0, 0.0, -9.81]
"""m/s2"""
SECTIONS = {
    "lattice": ("points", "origin", "size", "springs", "basis"),
    "material": ("stiffness", "damping", "volume_stiffness", "internal_damping"),
    "environment": ("gravity",),
    "inputs": ("forces",),
    "initial": ("stretch", "offset", "rotation", "velocity", "angular_velocity"),
    "outputs": ("velocities", "reactions", "energy"),
    "solver": ("method", "step", "tolerance", "error_estimate"),
    "experiment": ("stop_time", "communication_step"),
}
TETRAHEDRON = "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
"""A closed mesh as an OBJ file, in a box of 2 x 1 x 4 m"""
MOVED = {"motion": "input", "inputs": ["point", "normal", "velocity", "angular_velocity"]}
"""A plane whose whole pose and motion are inputs"""
LED = {"motion": "input", "inputs": ["position", "orientation", "velocity", "angular_velocity"]}
"""A pin of which they are"""
SECTION_OF = {key: section for section, keys in SECTIONS.items() for key in keys}


def table_and_press(*, friction: float = 0.0) -> list[dict[str, Any]]:
    """Planes below and above the unit cube; an input moves the upper one."""
    above = {"point": [0.0, 0.0, 1.0], "normal": [0.0, 0.0, -1.0], "motion": "input"}
    return [{"name": "table", "friction": friction}, {"name": "press", "friction": friction, **above}]


def box(**keys: Any) -> Scene:
    """The scene of these keys: the common ones by their own names, the rest as sections; everything else is the default, a unit cube."""
    document: dict[str, Any] = {}
    for name, value in keys.items():
        if name in SECTION_OF:
            document.setdefault(SECTION_OF[name], {})[name] = value
        elif isinstance(value, dict):
            document.setdefault(name, {}).update(value)
        else:
            document[name] = value
    return scene_from(document)


def meshed(folder: Path, shape: shapes.Shape, **keys: Any) -> Scene:
    """A body in the unit box, whose surface touches: vertices and faces, written to the folder."""
    unit = {"origin": [0.0, 0.0, 0.0], "size": [1.0, 1.0, 1.0]}
    return box(**{"mesh": {"file": shapes.write(folder / "body.obj", shape)}, "lattice": unit, "contact": {"of": "surface"}, **keys})


OBSERVED = {"velocities": "all", "energy": True, "outputs": {"solver": True}}


def damping_for(method: str) -> float:
    """rkn12 is for undamped bodies [N s/m]."""
    return 0.0 if method == "rkn12" else 0.05


def let_go(method: str, *planes: dict[str, Any]) -> Scene:
    """A box that is let go of 10 % compression, damped as the method takes it."""
    return box(stiffness=1e3, damping=damping_for(method), stretch=[0.9, 1.0, 1.0], plane=planes, **OBSERVED)


def falling(method: str, **ground: Any) -> Scene:
    """A box that falls on the ground, turning; damped likewise."""
    motion = {"offset": [0.0, 0.0, 0.2], "velocity": [0.5, 0.0, 0.0], "angular_velocity": [1.0, 2.0, 0.0], "stop_time": 0.4}
    floor = {"name": "ground", "friction": 0.4, **ground}
    return box(stiffness=1e3, damping=damping_for(method), gravity=GRAVITY, plane=[floor], **motion, **OBSERVED)


def problems(document: dict[str, Any], path: str | Path = "scene.toml") -> list[str]:
    """The lines in which a document is refused."""
    with pytest.raises(SceneError) as refused:
        scene_from(document, path=path)
    return refused.value.problems
