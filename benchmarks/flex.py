"""The baseline of MuJoCo with the same equations: springs are edges of a flex of dimension 1, and each point moves on three slides."""

from __future__ import annotations

import mujoco
import numpy as np

from softffd import Scene
from validation.mechanics import Body, start
from validation.resolved import resolved

POINT = """<body name="p{name}" pos="{x} {y} {z}"><inertial pos="0 0 0" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/>
<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/></body>"""
MODEL = """<mujoco><option gravity="0 0 0" integrator="RK4"><flag contact="disable"/></option><worldbody>{points}</worldbody>
<deformable><flex name="springs" dim="1" radius="1e-3" body="{names}" element="{pairs}">
<edge stiffness="{stiffness}" damping="0"/><contact selfcollide="none"/></flex></deformable></mujoco>"""


class Flex:
    """A MuJoCo model of a scene with equal springs alone, without damping."""

    def __init__(self, scene: Scene):
        parts = resolved(scene)
        body = Body.of(parts)
        self._start, _ = start(parts)
        self._rest = np.array(parts["rest"])
        points = enumerate(zip(self._rest, body.mass, strict=True))
        text = MODEL.format(
            points="".join(POINT.format(name=p, x=x[0], y=x[1], z=x[2], mass=mass) for p, (x, mass) in points),
            names=" ".join(f"p{p}" for p in range(len(self._rest))),
            pairs=" ".join(f"{i} {j}" for i, j in body.pairs),
            stiffness=body.stiffness[0],
        )
        self._model = mujoco.MjModel.from_xml_string(text)
        self._data = mujoco.MjData(self._model)

    def run(self, times: np.ndarray, steps: int) -> np.ndarray:
        """Returns the positions (T, n, 3) [m] at equidistant times [s]. steps: number of steps between two times."""
        model, data = self._model, self._data
        model.opt.timestep = (times[1] - times[0]) / steps
        mujoco.mj_resetData(model, data)
        data.qpos[:] = (self._start - self._rest).ravel()
        rows = [self._start]
        for _ in times[1:]:
            mujoco.mj_step(model, data, nstep=steps)
            rows.append(self._rest + data.qpos.reshape(-1, 3))
        return np.array(rows)
