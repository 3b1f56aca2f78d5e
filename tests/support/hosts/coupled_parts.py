"""A plate and a soft body, their names and numbers, and a host that steps them in turn."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from softffd import load_scene, package_fmu
from softffd.fmu.component import Component

pytest.importorskip("pythonfmu", reason="the driver FMUs are made with pythonfmu")
from softffd.drivers.coupled import SCENE

PLANE = "plane.plate."
MOTION = [f"{family}.{axis}" for family in ("point", "velocity") for axis in "xyz"]
FORCE = [f"reaction.{axis}" for axis in "xyz"]
MECHANICAL = ["energy.kinetic", "energy.elastic", "energy.gravity"]
GRAVITY, BODY_MASS = 9.81, 1.0
REST_ENERGY = -0.5 * BODY_MASS * GRAVITY  # of the body at rest, its centre 0.5 m below the origin


def body_fmu(folder: Path, *changes: tuple[str, str], step: float = 1e-4, more: str = "") -> Path:
    """The shipped box with pieces of its text replaced."""
    text = SCENE.read_text()
    for old, new in (("step = 1e-4", f"step = {step}"), *changes):
        assert old in text
        text = text.replace(old, new)
    (folder / "body.toml").write_text(text + more)
    return package_fmu(load_scene(folder / "body.toml"), folder / "body.fmu")


@dataclass
class Run:
    """What an explicit run left behind, a row per communication point after a step."""

    rows: list[np.ndarray] = field(default_factory=list)

    def column(self, n: int) -> np.ndarray:
        return np.array(self.rows)[:, n]


def run_explicitly(folder, body_path, step, steps, *, body_start=None, plate_start=None, read=(), plate_name=PLANE) -> Run:
    """Rows: plate's momentum (3), reaction (3), then the body's variables `read`. plate_name: how names of the plate in the body begin."""
    run = Run()
    with Component(body_path) as body, Component(folder / "plate.fmu") as plate:
        motion, moved = plate.block(MOTION), body.block([plate_name + name for name in MOTION])
        reaction, pushed = body.block([plate_name + name for name in FORCE]), plate.block(FORCE)
        momentum, observed = plate.block([f"momentum.{axis}" for axis in "xyz"]), body.block(list(read))
        for part, start in ((body, body_start), (plate, plate_start)):
            part.initialize(start or {})
            part.exit_initialization()
        for n in range(steps):
            for out, into in ((motion, moved), (reaction, pushed)):
                into.set(out.get())
            for part in (plate, body):
                part.do_step(n * step, step)
            for block in (momentum, reaction, observed):
                block.get()
            run.rows.append(np.concatenate([momentum.values, reaction.values, observed.values]))
    return run
