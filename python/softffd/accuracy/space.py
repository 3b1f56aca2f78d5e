"""Error against run time over lattices and tolerances: a scene on finer and finer lattices, against the continuum that they tend to.

The lattice k has 3 k c + 1 points along an axis, where c are the cells of the scene's own lattice divided by their greatest common
divisor: whole patches of a solid, and the same lattices for springs. If the error of an output is C k^-p, three successive lattices give
p, and Richardson's extrapolation gives the continuum's answer. The outputs that all lattices have are compared: probes (the scene's own,
and 27 at the corners and middles of its box), reactions, energies. An error is the largest over a kind of outputs and all communication
points, relative to the largest change of that kind. Scenes with the same answer, such as a body of springs and one of finite elements,
are compared with the same continuum.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np

from softffd.accuracy.records import Record, Records
from softffd.accuracy.reference import Reference
from softffd.accuracy.rig import NOTHING_MOVES, Rig, Setting
from softffd.errors import FmuError, SceneError
from softffd.run.progress import Note, silent
from softffd.scene.scene import Scene

KINDS = {"places": r"^probe\.\w+\.[xyz]$", "reactions": r"\.reaction\.[xyz]$", "energies": r"^energy\.\w+$"}
"""Kinds of outputs that are compared, with the patterns of their names."""
MOST_LATTICES, MOST_POINTS = 4, 31
FINER = (1.0, 0.1, 0.01)  # tolerances of the runs on a lattice, relative to the scene's
BUDGET, QUICK_BUDGET = 200.0, 15.0  # a lattice's tolerances end at a run of more CPU time [s], and the lattices if that is the first one
ORDERS = (0.3, 8.0)  # range of credible orders


@dataclass(frozen=True, eq=False)
class Continuum:
    """The limit of the lattices, for one kind of outputs."""

    course: np.ndarray  # (T, w)
    order: float  # as measured; NaN if the lattices show no limit yet, or are only two: then `course` is the finest lattice's
    uncertainty: float  # relative to the largest change
    change: float  # largest change of an output since the start

    def error(self, course: np.ndarray) -> float:
        """Returns the largest difference from the continuum, relative to the largest change."""
        return float(np.abs(course - self.course).max()) / self.change


def continuum(courses: Sequence[np.ndarray]) -> Continuum:
    """Returns the continuum of the lattices 1, 2, .. m in this order, m >= 2, each (T, w). The uncertainty is the whole extrapolation
    beyond the finest lattice; without an order, the difference of the last two lattices."""
    finest = courses[-1]
    order, course = _extrapolated(courses)
    change = float(np.abs(finest - finest[0]).max())
    return Continuum(course, order, float(np.abs(course - (courses[-2] if math.isnan(order) else finest)).max()) / change, change)


def _extrapolated(courses: Sequence[np.ndarray]) -> tuple[float, np.ndarray]:
    """Returns the order by the last three lattices and Richardson's extrapolation of the last two; NaN and the last one without an
    order."""
    k, finest = len(courses), courses[-1]
    if k < 3:
        return math.nan, finest
    coarse, fine = (float(np.abs(courses[n] - courses[n - 1]).max()) for n in (k - 2, k - 1))

    def excess(order: float) -> float:
        """Returns the ratio of differences at this order, which grows with it, less the measured ratio, times a factor > 0."""
        return ((k - 2) ** -order - (k - 1) ** -order) * fine - ((k - 1) ** -order - k**-order) * coarse

    low, high = ORDERS
    if not excess(low) < 0 < excess(high):
        return math.nan, finest
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) < 0 else (low, middle)
    return low, finest + (finest - courses[-2]) / ((k / (k - 1)) ** low - 1)


def lattices(scene: Scene) -> list[tuple[int, ...]]:
    """Returns the points along each axis of the lattices 1, 2, .. m. Raises SceneError if there are not two, or if keys belong to one
    lattice."""
    keys = _of_one_lattice(scene)
    cells = [points - 1 for points in scene.lattice.points]
    all_points = (tuple(3 * k * cell // math.gcd(*cells) + 1 for cell in cells) for k in range(1, MOST_LATTICES + 1))
    found = [points for points in all_points if max(points) <= MOST_POINTS]
    if len(found) < 2:
        keys.append(f"lattice.points: wanted cells with a larger common divisor along the axes, got {list(scene.lattice.points)}")
    if keys:
        raise SceneError(f"{scene.name}, over lattices", keys)
    return found


def _of_one_lattice(scene: Scene) -> list[str]:
    wrong = [] if scene.material.youngs_modulus else ["material.stiffness: belongs to one lattice; wanted material.youngs_modulus"]
    selections = {f"pin.{pin.name}.points": pin.points for pin in scene.pin} | {
        f"load.{load.name}.points": load.points for load in scene.load
    }
    wrong += [
        f"{key}: points by their numbers belong to one lattice; wanted a face" for key, of in selections.items() if not isinstance(of, str)
    ]
    if scene.inputs.forces != "none":
        wrong.append("inputs.forces: belong to one lattice; wanted loads")
    return wrong + ["region: belongs to one lattice; wanted none"] * bool(scene.region)


def on_lattice(scene: Scene, points: Sequence[int]) -> Scene:
    """Returns the scene on another lattice, with probes on its box. The sum of nodal viscous drag over the points stays the same."""
    given, box = scene.keys_given(), scene.lattice_box
    grid = product((0.0, 0.5, 1.0), repeat=3)
    places = [[float(o + s * share) for o, s, share in zip(box.origin, box.size, at, strict=True)] for at in grid]
    lattice = {key: value for key, value in given.get("lattice", {}).items() if key not in ("cells", "spacing")}
    changes: dict[str, Any] = {
        "lattice": lattice | {"points": list(points)},
        "probe": [*given.get("probe", []), *({"name": f"on_box_{n}", "at": at} for n, at in enumerate(places))],
        "outputs.positions": "none",
        "outputs.velocities": "none",
        "outputs.solver": True,
        "solver.error_estimate": False,
    }
    if scene.material.damping:
        changes["material.damping"] = scene.material.damping * math.prod(scene.lattice.points) / math.prod(points)
    return scene.replace(changes)


def _rounding(rig: Rig) -> dict[str, float]:
    """Returns how far rounding alone can change each of KINDS: coordinates [m], and the force [N] and energy [J] of a strain rounding /
    side."""
    energy = (rig.scene.material.youngs_modulus or 0.0) * math.prod(rig.scene.lattice_box.size) * rig.rounding / rig.side
    return {"places": rig.rounding, "reactions": energy / rig.side, "energies": energy}


@dataclass(eq=False)
class Measured:
    """A scene on its lattices."""

    records: Records  # errors are those of KINDS that change, relative to the continuum of the scene `against`
    names: list[str]  # the outputs that are compared
    courses: Sequence[Mapping[str, np.ndarray] | None]  # outputs of each run, (T, w) by kind; None if it failed
    own: Mapping[str, Continuum]  # the continuum of its own lattices, by kind
    against: str = ""
    apart: dict[str, dict[str, float]] = field(default_factory=dict)
    """Difference of its continuum from that of other scenes with the same outputs, by scene and kind, relative to the largest change"""

    @property
    def uncertainty(self) -> float:
        """Largest uncertainty of its continuum over all kinds."""
        return max(each.uncertainty for each in self.own.values())

    def judge(self, by: Measured) -> None:
        """Computes the errors of its runs relative to the continuum of a scene, itself or another."""
        self.against = by.records.scene
        words = "Richardson's extrapolation over the lattices", "its last change"
        self.records.reference = Reference(np.empty((0, 0, 3)), by.uncertainty, *words, independent=False)
        self.records.runs = [
            replace(run, errors=None if course is None else np.array([each.error(course[kind]) for kind, each in by.own.items()]))
            for run, course in zip(self.records.runs, self.courses, strict=True)
        ]


def judge_all(measured: Sequence[Measured]) -> None:
    """Computes the errors of all scenes: each relative to its own continuum, or to that of a scene with the same outputs whose continuum
    is less uncertain and differs by no more than both uncertainties together."""
    for each in measured:
        same = [each]
        for other in measured:
            alike = each.names == other.names and each.own.keys() == other.own.keys()
            if other is each or not (alike and np.array_equal(each.records.times, other.records.times)):
                continue
            name = other.records.scene
            each.apart[name] = {kind: continuum.error(each.own[kind].course) for kind, continuum in other.own.items()}
            if all(apart <= each.own[kind].uncertainty + other.own[kind].uncertainty for kind, apart in each.apart[name].items()):
                same.append(other)
        each.judge(min(same, key=lambda scene: scene.uncertainty))


def measure_space(scene: Scene, *, step: float | None = None, quick: bool = False, note: Note = silent) -> Measured:
    """Runs a scene on its lattices at its tolerance, a tenth and a hundredth of it. Errors are relative to its own continuum.

    step: communication step [s], by default the scene's own. quick: fewer lattices. A kind that changes by rounding alone is left out.
    Raises SceneError as `lattices`, and FmuError if fewer than two lattices can be run or nothing moves.
    """
    runs: list[tuple[Record, np.ndarray | None]] = []
    finest: list[np.ndarray] = []
    for points in lattices(scene):
        with Rig(on_lattice(scene, points), step=step, watched="|".join(KINDS.values())) as rig:
            made = list(_runs(rig, points, scene, QUICK_BUDGET if quick else BUDGET, note))
        runs += made
        finest += [course for _, course in made if course is not None][-1:]
        if made[0][1] is None:
            break
    if len(finest) < 2:
        raise FmuError(f"{scene.name}: wanted runs on two lattices, got {len(finest)}: {runs[-1][0].failure}")
    kinds = {kind: [n for n, name in enumerate(rig.names) if re.search(pattern, name)] for kind, pattern in KINDS.items()}
    rounding = _rounding(rig)
    own = {
        kind: continuum([course[:, which] for course in finest])
        for kind, which in kinds.items()
        if (np.abs(finest[-1][:, which] - finest[-1][0, which]) > rounding[kind]).any()
    }
    if not own:
        raise FmuError(f"{scene.name}: {NOTHING_MOVES}")
    records = Records(
        scene.name, scene.title, rig.communication_step, rig.stop_time, rig.times, len(scene.rest_positions()), scene.solver.tolerance,
        runs=[record for record, _ in runs], complete=True,
    )  # fmt: skip
    courses = [None if course is None else {kind: course[:, kinds[kind]] for kind in own} for _, course in runs]
    measured = Measured(records, rig.names, courses, own)
    measured.judge(measured)
    return measured


def _runs(rig: Rig, points: tuple[int, ...], scene: Scene, budget: float, note: Note) -> Iterator[tuple[Record, np.ndarray | None]]:
    """Yields a record for each of FINER with its outputs, until a run fails or takes too long."""
    for share in FINER:
        setting = Setting(scene.solver.method, tolerance=share * scene.solver.tolerance)
        note(f"{scene.name}: {' x '.join(map(str, points))} points, {setting}")
        try:
            run = rig.run(setting, repeats=3, most=budget)
        except FmuError as error:
            yield Record(setting, failure=str(error), lattice=points), None
            return
        yield Record(setting, "softffd", run.cpu_time, run.repeats, run.steps, run.rejected, lattice=points), run.positions
