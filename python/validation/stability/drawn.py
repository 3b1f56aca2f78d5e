"""Random scenes. A seed determines the scene, from the lattice to the trajectories of the inputs and the communication steps.

A seed gives the same scene on every platform: uniform numbers of PCG64 in a fixed order, values of four digits, and no sums by a BLAS,
which differ with the processor. A new draw must be added at the end of its function, since otherwise all scenes change.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from softffd.rotation import between_orientations, quaternion, turned
from softffd.scene.section import Rotation
from validation.shapes import KINDS, Shape, gap
from validation.stability.drive import GRAVITY, Drive

FACES = ("x-", "x+", "y-", "y+", "z-", "z+")
SHORTEST, LONGEST = 1e-3, 5e-2  # communication steps [s]


class Draws:
    """A sequence of random numbers."""

    def __init__(self, seed: int):
        self._generator = np.random.Generator(np.random.PCG64(seed))

    def share(self) -> float:
        """Returns a number in [0, 1)."""
        return float(self._generator.random())

    def chance(self, probability: float) -> bool:
        return self.share() < probability

    def between(self, low: float, high: float) -> float:
        return _four_digits(low + (high - low) * self.share())

    def log(self, low: float, high: float) -> float:
        """Returns a number from low to high whose logarithm is uniformly distributed."""
        return _four_digits(low * (high / low) ** self.share())

    def whole(self, low: int, high: int) -> int:
        """Returns an integer from low to high, both included."""
        return low + int((high - low + 1) * self.share())

    def one_of(self, choices: Sequence[Any]) -> Any:
        return choices[self.whole(0, len(choices) - 1)]

    def direction(self, most: float = math.pi) -> np.ndarray:
        """Returns a unit vector (3,) within an angle [rad] of z."""
        angle, round_z = most * self.share(), 2 * math.pi * self.share()
        return _rounded([math.sin(angle) * math.cos(round_z), math.sin(angle) * math.sin(round_z), math.cos(angle)])


def _four_digits(value: float) -> float:
    return float(f"{value:.4g}")


def _rounded(vector: Any) -> np.ndarray:
    """Returns the vector rounded to 1e-6, without negative zeros."""
    return np.round(np.asarray(vector, float), 6) + 0.0


@dataclass(frozen=True, eq=False)
class Course:
    """The trajectory of a frame in rigid motion that is uniform before and after one moment. Vectors are (3,)."""

    point: np.ndarray  # m, at the start
    turning_at: float = math.inf  # s, a communication point
    velocities: Sequence[np.ndarray] = (np.zeros(3), np.zeros(3))  # m/s
    spins: Sequence[np.ndarray] = (np.zeros(3), np.zeros(3))  # rad/s

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Returns point [m], velocity [m/s], spin [rad/s] from a time [s] on, and the rotation in each sub-interval so far (2, 3) [rad]."""
        first = min(time, self.turning_at)
        angles = np.array([first * self.spins[0], (time - first) * self.spins[1]])
        point = self.point + first * self.velocities[0] + (time - first) * self.velocities[1]
        later = int(time >= self.turning_at)
        return point, self.velocities[later], self.spins[later], angles

    def turned(self, vector: np.ndarray, time: float) -> np.ndarray:
        """Returns a vector that is fixed to the frame, at a time [s]."""
        for angle in self.at(time)[3]:
            vector = turned(vector, angle)
        return vector


@dataclass(frozen=True, eq=False)
class Ramp:
    """A load that grows linearly and then stays constant."""

    force: np.ndarray  # N (3,)
    length: float  # s; 0: the full load acts at once
    linear: bool  # set with its rate for each communication step; otherwise constant in the step

    def at(self, time: float) -> np.ndarray:
        return self.force * (min(1.0, time / self.length) if self.length > 0 else 1.0)


@dataclass(frozen=True, eq=False)
class Drawn:
    """A scene, the trajectories of its inputs, and its communication steps."""

    seed: int
    document: dict[str, Any]
    lengths: list[float]  # of the communication steps [s]
    tolerance: float  # relative to the largest side
    planes: dict[str, tuple[np.ndarray, Course]]  # normals or axes at the start, and trajectories; all but free obstacles
    pins: dict[str, Course] = field(default_factory=dict)  # pins that move
    loads: dict[str, Ramp] = field(default_factory=dict)
    surface: Shape | None = None  # surface of the object, if obstacles meet it
    body: str = ""  # description
    pushes: dict[str, Ramp] = field(default_factory=dict)  # on free bodies, by the names of their inputs

    @property
    def duration(self) -> float:
        """Duration of the run [s]"""
        return sum(self.lengths)

    def tell(self, drive: Drive, length: float) -> None:
        """Sets all inputs for the next step of this length [s]."""
        time = drive.time
        for name, (normal, course) in self.planes.items():
            point, velocity, spin, _ = course.at(time)
            pose = {"point": point, "normal": course.turned(normal, time), "velocity": velocity, "angular_velocity": spin}
            path = f"{self._kind(name)}.{name}"
            drive.set(**{f"{path}.{what}": pose[what] if what in pose else self._rotation(name, time) for what in self._inputs(name)})
        for name, course in self.pins.items():
            point, velocity, spin, (angle, _) = course.at(time)
            values: dict[str, Any] = {"position": point, "orientation": _quaternion(angle), "velocity": velocity, "angular_velocity": spin}
            drive.set(**{f"pin.{name}.{what}": value for what, value in values.items()})
        for name, ramp in ({f"load.{name}": ramp for name, ramp in self.loads.items()} | self.pushes).items():
            drive.set(**{name: ramp.at(time)})
            if ramp.linear:
                drive.set_rates(name, (ramp.at(time + length) - ramp.at(time)) / length)

    def gaps(self, places: np.ndarray, time: float) -> dict[str, np.ndarray]:
        """Returns the distances (n,) [m] of places (n, 3) [m] from every obstacle but free ones at a time [s], negative behind or in it."""
        poses = {name: (course.at(time)[0], course.turned(normal, time)) for name, (normal, course) in self.planes.items()}
        led = [(kind, each) for kind, each in self._obstacles() if each["name"] in poses]
        return {each["name"]: gap(kind, each, places, *poses[each["name"]], *self._across(each, time)) for kind, each in led}

    def gaps_of_free(self, places: np.ndarray, poses: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> dict[str, np.ndarray]:
        """Returns the distances from free obstacles as `gaps` does. poses: centres (3,) [m] and axes as rows (3, 3), by KIND.NAME."""
        free = [(kind, each) for kind, each in self._obstacles() if f"{kind}.{each['name']}" in poses]
        found = {f"{kind}.{each['name']}": (kind, each) for kind, each in free}
        return {name: gap(kind, each, places, poses[name][0], poses[name][1][2], poses[name][1][0]) for name, (kind, each) in found.items()}

    def _across(self, obstacle: dict[str, Any], time: float) -> list[np.ndarray]:
        """Returns the first axis of a box (3,) in a list, which is empty for other obstacles."""
        if "rotation" not in obstacle:
            return []
        first = turned(np.array([1.0, 0.0, 0.0]), np.array(Rotation(**obstacle["rotation"]).vector()))
        return [self.planes[obstacle["name"]][1].turned(first, time)]

    def _rotation(self, name: str, time: float) -> np.ndarray:
        """Returns the total rotation vector of a box at a time [s], (3,) [rad]."""
        obstacle = next(each for _, each in self._obstacles() if each["name"] == name)
        whole = quaternion(np.array(Rotation(**obstacle["rotation"]).vector()))
        for angle in self.planes[name][1].at(time)[3]:
            whole = _product(quaternion(angle), whole)
        return between_orientations(quaternion(np.zeros(3)), whole)

    def _obstacles(self) -> list[tuple[str, dict[str, Any]]]:
        return [(kind, each) for kind in KINDS for each in self.document.get(kind, ())]

    def _kind(self, name: str) -> str:
        """Returns the kind of an obstacle."""
        return next(kind for kind, each in self._obstacles() if each["name"] == name)

    def _inputs(self, name: str) -> list[str]:
        """Returns the inputs of an obstacle."""
        return next(each.get("inputs", []) for _, each in self._obstacles() if each["name"] == name)

    @property
    def words(self) -> str:
        """Description of the scene in a line"""
        document, lattice = self.document, self.document["lattice"]
        parts = [
            " x ".join(map(str, lattice["points"])) + (f" with {self.body}" if self.body else ""),
            *_material_words(document["material"]),
            *(_region_words(region) for region in document["region"]),
            *(f"{kind} {_motion_words(each)}, mu {each['friction']:g}" for kind, each in self._obstacles()),
            *(f"pin {_motion_words(each)}" for each in document["pin"]),
            *(f"load {np.linalg.norm(ramp.force):.1e}{' ramped' * (ramp.length > 0)}" for ramp in self.loads.values()),
            *(f"push {np.linalg.norm(ramp.force):.1e}" for ramp in self.pushes.values()),
            f"tol {self.tolerance:.1e}",
            f"H {min(self.lengths):.1e}" + f" to {max(self.lengths):.1e}" * (len(set(self.lengths)) > 1),
            f"T {self.duration:.2f}",
        ]
        return ", ".join(parts)


def _material_words(material: dict[str, Any]) -> list[str]:
    if material.get("model") == "solid":
        stiff = f"E {material['youngs_modulus']:.1e}, nu {material['poissons_ratio']:g}"
    else:
        stiff = "k " + "/".join(f"{material['stiffness'][kind]:.1e}" for kind in ("edge", "face", "body"))
    return [stiff, f"d {material['damping']:.1e}"]


def _motion_words(part: dict[str, Any]) -> str:
    return part["motion"] + (f" {part['mass']:.1e} kg{' guided' * ('guide' in part)}" if "mass" in part else "")


def _region_words(region: dict[str, Any]) -> str:
    return "region " + " ".join(f"{what} {region[what]:.1e}" for what in ("mass", "damping") if what in region)


def _quaternion(angle: np.ndarray) -> list[float]:
    size = float(np.linalg.norm(angle))
    axis = angle / size if size > 0 else angle
    return [math.cos(size / 2), *(math.sin(size / 2) * axis)]


def _product(last: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Returns the product of two quaternions: the rotation `first`, then `last`."""
    a, b = last[1:], first[1:]
    return np.array([last[0] * first[0] - a @ b, *(last[0] * b + first[0] * a + np.cross(a, b))])


def drawn(seed: int) -> Drawn:
    """Returns the scene of a seed."""
    draws = Draws(seed)
    counts = [draws.one_of((2, 2, 2, 3, 3, 4, 4, 5)) for _ in "xyz"]
    size = [1.0] * 3 if draws.chance(0.4) else [draws.between(0.3, 1.2) for _ in "xyz"]
    stiffness, total = draws.log(1e2, 1e10), draws.log(0.2, 5.0)
    kinds = [1.0, 1.0, 1.0] if draws.chance(0.7) else [draws.log(0.1, 1.0) for _ in "efb"]
    lengths, moment = _lengths(draws)
    duration = sum(lengths)
    held = draws.chance(0.2)
    initial, loose = _initial(draws, stiffness / total, held)
    damping, regions = masses_and_damping(draws, counts, total)
    resting = draws.chance(0.35) and not loose
    pull = _rounded(-GRAVITY * draws.direction(0.5 if resting else 0.0)) if draws.chance(0.9) else None
    planes, courses = _planes(draws, np.array(size) * initial["stretch"], resting, held, duration, moment)
    pins, pinned = _pins(draws, np.array(size), bool(planes), duration) if held else ([], {})
    loads, ramps = _loads(draws, stiffness, duration)
    document = {
        "lattice": {"points": counts, "size": size},
        "mass": {"total": total},
        "material": {
            "stiffness": dict(zip(("edge", "face", "body"), (_four_digits(stiffness * share) for share in kinds), strict=True)),
            "damping": damping,
        },
        "region": regions,
        "plane": planes,
        "pin": pins,
        "load": loads,
        "initial": initial,
        "environment": {} if pull is None else {"gravity": pull.tolist()},
    }
    tolerance = _four_digits(10 ** (-2 - 4 * draws.share() ** 1.5))
    return Drawn(seed, document, lengths, tolerance, courses, pinned, ramps)


def _lengths(draws: Draws) -> tuple[list[float], float]:
    """Returns the lengths of the communication steps [s], 0.3 to 1 s in total, and the time [s] of one of the communication points."""
    usual, changing, duration = draws.log(SHORTEST, LONGEST), draws.chance(0.3), 0.3 + 0.7 * draws.share() ** 2
    lengths: list[float] = []
    while sum(lengths) < duration:
        lengths.append(min(LONGEST, max(SHORTEST, _four_digits(usual * draws.between(0.3, 1.7)))) if changing else usual)
    return lengths, sum(lengths[: draws.whole(1, len(lengths))])


def _initial(draws: Draws, rate: float, held: bool) -> tuple[dict[str, Any], bool]:
    """Returns a start, and whether the body moves as a whole. rate: stiffness by mass [1/s2]; the stretch vibrates with 0.01 to 1 m/s."""
    stretch = [1.0] * 3
    if draws.chance(0.3):
        most = min(0.05, draws.log(1e-2, 1.0) / math.sqrt(rate))
        stretch = [float(np.round(1 + most * draws.between(-1, 1), 9)) for _ in "xyz"]
    loose = draws.chance(0.6)
    velocity = [draws.between(-0.7, 0.7) for _ in "xyz"]
    spin = [draws.between(-3, 3) for _ in "xyz"] if draws.chance(0.5) else [0.0] * 3
    if held:
        return {"stretch": [1.0] * 3}, False
    return {"stretch": stretch} | ({"velocity": velocity, "angular_velocity": spin} if loose else {}), loose


def masses_and_damping(draws: Draws, counts: list[int], total: float) -> tuple[float, list[dict[str, Any]]]:
    """Returns the damping of the points [N s/m] and regions with another mass or damping."""
    mass = total / math.prod(counts)
    damping = {"none": 0.0, "small": mass * draws.log(1e-2, 1.0), "large": mass * draws.log(3.0, 300.0)}
    kind = draws.one_of(("none", "small", "small", "large", "mixed"))
    regions = []
    if draws.chance(0.35):
        regions.append({"points": _some(draws, counts), "mass": _four_digits(mass / 10 ** (6 * draws.share() ** 2))})
    if kind == "mixed":
        regions.append({"points": _some(draws, counts), "damping": _four_digits(damping["large"])})
    return _four_digits(damping["small" if kind == "mixed" else kind]), regions


def _some(draws: Draws, counts: list[int]) -> Any:
    """Returns the selection of a face, a corner, or some points."""
    kind, face = draws.one_of(("face", "corner", "points")), draws.one_of(FACES)
    number = {"face": 0, "corner": 1, "points": draws.whole(2, 4)}[kind]
    ends = [[draws.whole(0, count - 1) for count in counts] for _ in range(number)]
    if kind == "corner":
        return [[0 if index < count / 2 else count - 1 for index, count in zip(ends[0], counts, strict=True)]]
    return [list(place) for place in sorted({tuple(place) for place in ends})] or face


def _planes(
    draws: Draws, size: np.ndarray, resting: bool, held: bool, duration: float, moment: float
) -> tuple[list[dict[str, Any]], dict[str, tuple[np.ndarray, Course]]]:
    """Returns planes and their trajectories: none, one below, or also a second one that leans beside the body or lies above.

    size: of the body at its start (3,) [m]. resting: the first plane touches the whole lower face. held: no second plane. A plane that
    moves towards the body comes at most 2 % of the size further than the point of contact."""
    planes: list[dict[str, Any]] = []
    courses: dict[str, tuple[np.ndarray, Course]] = {}
    number = draws.one_of((0, 1, 1, 1, 1, 1, 2, 2))
    for name in "ab"[: max(min(number, 1) if held else number, int(resting))]:
        touching = resting and name == "a"
        clearance = 0.0 if touching else draws.log(1e-4, 0.1)
        normal = np.array([0.0, 0.0, 1.0]) if touching else draws.direction(0.7)
        if name == "b" and not touching:
            lean, way = math.pi * draws.between(0.4, 1.0), 2 * math.pi * draws.share()
            normal = _rounded(turned(normal, lean * np.array([math.cos(way), math.sin(way), 0.0])))
        normal = normal / math.sqrt((normal**2).sum())
        point = _foot(size, normal, clearance)
        friction = 0.0 if draws.chance(0.3) else draws.between(0.05, 0.8)
        moving = draws.chance(0.35)
        most = (clearance + 0.02 * size.min()) / duration
        speeds = [np.round(draws.between(-1, 1) * most, 6) * normal for _ in range(2)]
        along = [np.cross(normal, draws.direction()) * draws.between(0, 0.5) * draws.chance(0.4) for _ in range(2)]
        spins = [draws.direction() * draws.between(-1, 1) * most / size.max() * draws.chance(0.5) for _ in range(2)]
        course = Course(point)
        if moving:
            course = Course(point, moment, tuple(_rounded(a + b) for a, b in zip(speeds, along, strict=True)), tuple(map(_rounded, spins)))
        planes.append({"name": name, "point": point.tolist(), "normal": normal.tolist(), "friction": friction,
                       **(_by_input("point", "normal") if moving else {"motion": "fixed"})})  # fmt: skip
        courses[name] = normal, course
    return planes, courses


def _by_input(*pose: str) -> dict[str, Any]:
    """Returns the keys of a plane or pin whose whole pose and motion are inputs."""
    return {"motion": "input", "inputs": [*pose, "velocity", "angular_velocity"]}


def _foot(size: np.ndarray, normal: np.ndarray, clearance: float) -> np.ndarray:
    """Returns the point, below the middle of a box of this size, of a plane at a clearance [m] from the nearest corner."""
    middle = size / 2
    reach = float((np.abs(normal) * middle).sum())
    return _rounded(middle - (reach + clearance) * normal)


def _pins(draws: Draws, size: np.ndarray, beside_plane: bool, duration: float) -> tuple[list[dict[str, Any]], dict[str, Course]]:
    """Returns a pin of one face, the upper one beside a plane. It is fixed or moves uniformly, not downwards, by a few per cent of size."""
    face, moving = draws.one_of(FACES), draws.chance(0.5)
    face = "z+" if beside_plane else face
    velocity = _rounded(0.05 * size.min() / duration * draws.direction(math.pi / 2))
    spin = _rounded(draws.between(0, 0.2) / duration * draws.direction() * draws.chance(0.5))
    pins = [{"name": "hold", "points": face, **(_by_input("position", "orientation") if moving else {"motion": "fixed"})}]
    centroid = size / 2
    centroid["xyz".index(face[0])] = size["xyz".index(face[0])] if face[1] == "+" else 0.0
    return pins, {"hold": Course(centroid, velocities=(velocity, velocity), spins=(spin, spin))} if moving else {}


def _loads(draws: Draws, stiffness: float, duration: float) -> tuple[list[dict[str, Any]], dict[str, Ramp]]:
    if not draws.chance(0.35):
        return [], {}
    face, size = draws.one_of(FACES), min(draws.log(0.1, 30.0), 0.02 * stiffness)
    ramp = Ramp(_rounded(size * draws.direction()), duration * draws.between(0.2, 1.0) * draws.chance(0.6), draws.chance(0.5))
    return [{"name": "push", "points": face}], {"push": ramp}
