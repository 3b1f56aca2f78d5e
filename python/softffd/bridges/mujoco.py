"""Soft bodies on a robot of MuJoCo: `bridge = couple(model, data, {pad: {"pin.back": "finger", "box.part": "part"}})`, `bridge.step()`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from softffd.bridges.coupled import Bridge, Part, Push
from softffd.errors import FmuError, SoftffdError
from softffd.names import OBSTACLES, parts_of
from softffd.rotation import matrix_of
from softffd.run.simulation import Simulation
from softffd.spelling import did_you_mean, nearest_of, wanted_one_of

try:
    import mujoco
except ImportError:
    raise SoftffdError("a coupling with MuJoCo needs mujoco, which is not installed here: pip install 'softffd[mujoco]'") from None

SHAPES = {"plane": ["plane"], "sphere": ["sphere"], "cylinder": ["cylinder"], "box": ["box"], "capsule": ["cylinder", "sphere", "sphere"]}
"""The obstacles that represent a geom, by its type"""
NEAREST = {"ellipsoid": "sphere", "hfield": "plane"}  # the nearest obstacle for types that no obstacle represents; for other types a box


def couple(
    model: mujoco.MjModel, data: mujoco.MjData, parts: Mapping[Simulation, Mapping[str, str]], *, step: float | None = None,
    tolerance: float = 1e-3, trials: int = 8,
) -> Bridge:  # fmt: skip
    """Returns a bridge that steps `data` and soft bodies together. Controls and other forces that the caller sets in `data` hold over its
    step.

    parts: what moves the parts of each simulation: for a pin, "pin.NAME", the name of a body, to which the pin is attached as both lie
        now; for an obstacle, "box.NAME", the name of a geom of its shape and size. A capsule is a cylinder and two spheres, its upper end
        first.
    step: communication step [s]; by default the model's timestep. step, tolerance, trials: as for Bridge.
    FmuError names everything that does not fit.
    """
    engine, found, problems = MuJoCo(model, data), dict[Simulation, list[Part]](), list[str]()
    for simulation, names in parts.items():
        found[simulation], there = [], [str(part) for part in parts_of(simulation.variables, "pin", *OBSTACLES)]
        for path in sorted(names, key=lambda path: path.startswith("pin.")):  # obstacles first: where pins start clear of them
            try:
                if path not in there:
                    raise FmuError(f"{path}: the scene has no such part; {wanted_one_of(there, path)}")
                leader = engine.body(names[path]) if path.startswith("pin.") else engine.geom(path, names, simulation)
                found[simulation].append(Part(simulation, path, engine, *leader))
            except FmuError as problem:
                problems.append(str(problem))
    if problems:
        raise FmuError("\n  ".join([f"the coupling has {len(problems)} problem{'s' * (len(problems) > 1)}", *problems]))
    return Bridge(engine, found, model.opt.timestep if step is None else step, tolerance, trials)


class MuJoCo:
    """The engine, and all code that depends on MuJoCo.

    Its integrators except RK4 move positions by the velocities at a step's end. The pose half a step back moves by the mean of the
    velocities before and after a step.
    """

    KEPT = mujoco.mjtState.mjSTATE_INTEGRATION
    BAD = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData):
        self.model, self.data, self.step = model, data, float(model.opt.timestep)
        self.shift = 0.0 if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else -self.step / 2

    @property
    def time(self) -> float:
        return float(self.data.time)

    def pose(self, body: int) -> np.ndarray:
        here = self.data.qpos.copy()
        mujoco.mj_integratePos(self.model, self.data.qpos, self.data.qvel, self.shift)
        mujoco.mj_kinematics(self.model, self.data)
        self.data.qpos[:] = here
        return _frame(self.data.xpos[body], self.data.xmat[body])

    def advance(self, pushes: Sequence[Push]) -> None:
        data, own, before = self.data, self.data.xfrc_applied.copy(), self.data.time
        for bad in self.BAD:
            data.warning[bad].number = 0
        mujoco.mj_kinematics(self.model, data)
        for body, point, wrench in pushes:
            arm = data.xpos[body] + data.xmat[body].reshape(3, 3) @ point - data.xipos[body]  # MuJoCo's force acts at the centre of mass
            data.xfrc_applied[body] += wrench + np.append(np.zeros(3), np.cross(arm, wrench[:3]))
        mujoco.mj_step(self.model, data)
        data.xfrc_applied[:] = own
        if any(data.warning[bad].number for bad in self.BAD):
            raise FmuError(f"MuJoCo found its state unstable at {before:g} s and began anew: take a shorter timestep")

    def save(self) -> np.ndarray:
        state = np.empty(mujoco.mj_stateSize(self.model, self.KEPT))
        mujoco.mj_getState(self.model, self.data, state, self.KEPT)
        return state

    def restore(self, state: np.ndarray) -> None:
        mujoco.mj_setState(self.model, self.data, state, self.KEPT)

    def body(self, name: str) -> tuple[int, None]:
        """Returns the number of a body, and None for the part's frame in that body."""
        return self._number("body", name), None

    def geom(self, path: str, names: Mapping[str, str], simulation: Simulation) -> tuple[int, np.ndarray]:
        """Returns the body of the geom that an obstacle represents, and the pose in the body; FmuError if shape or size differs."""
        name, kind = names[path], path.partition(".")[0]
        geom = self.model.geom(self._number("geom", name))
        shape = mujoco.mjtGeom(geom.type[0]).name.removeprefix("mjGEOM_").lower()
        if shape not in SHAPES:
            raise FmuError(f"geom {name}: wanted one of {', '.join(SHAPES)}, got {shape}; the nearest is a {NEAREST.get(shape, 'box')}")
        alike = [each for each, other in names.items() if other == name and not each.startswith("pin.")]
        if sorted(kinds := [each.partition(".")[0] for each in alike]) != SHAPES[shape]:
            raise FmuError(f"geom {name}: wanted {', '.join(SHAPES[shape])} of the scene for a {shape}, got {', '.join(kinds)}")
        radius, half = geom.size[:2]
        size = {"sphere": np.full(3, 2 * radius), "cylinder": 2 * np.array([radius, radius, half]), "box": 2 * geom.size}.get(kind, ())
        solids = simulation.component.obstacles.solids if simulation.component.obstacles else ()
        solid = next((each for each in solids if f"{each.kind}.{each.name}" == path), None)
        if solid and not np.allclose(solid.size, size, rtol=1e-6, atol=0):
            raise FmuError(f"{path}: wanted {' x '.join(f'{edge:g}' for edge in size)} m as of geom {name}, got {solid}")
        at = _frame(geom.pos, matrix_of(geom.quat))
        if shape == "capsule" and kind == "sphere":
            at[:3, 3] += half * at[:3, 2] * (1 - 2 * [each for each in alike if each.startswith("sphere.")].index(path))
        return int(geom.bodyid[0]), at

    def _number(self, kind: str, name: str) -> int:
        number = mujoco.mj_name2id(self.model, getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), str(name))
        if number < 0:
            there = [getattr(self.model, kind)(n).name for n in range(getattr(self.model, f"n{kind}"))]
            raise FmuError(f"{kind} {name}: the model has no such {kind}{did_you_mean(nearest_of(str(name), filter(None, there)))}")
        return number


def _frame(place: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Returns the pose (4, 4) of an origin (3,) and axes in columns (3, 3) or (9,)."""
    return np.block([[np.reshape(turn, (3, 3)), np.reshape(place, (3, 1))], [np.eye(4)[3:]]])
