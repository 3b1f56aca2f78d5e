"""A run that nothing simulated: a box that falls, turns, is squashed between two planes and springs back."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from softffd.lattice import LatticeBox, rest_grid
from softffd.obstacles import Obstacles
from softffd.run.result import Result
from softffd.scene.rigid import Box

ORIGIN, SIZE = np.array([-1.0, -0.5, 0.2]), np.array([2.0, 1.0, 0.8])
PRESS = {"velocity": (0.0, 0.0, -1.0), "angular_velocity": (0.0, 0.0, 0.0), "normal": (0.0, 0.0, -1.0)}


def made_up_run(*, counts=(4, 4, 4), frames=41, title="A soft box under a press", pins=()):
    """A Result of 2 s with the planes "ground" (fixed) and "press" (moving), reactions, energies and a scene."""
    time = np.linspace(0.0, 2.0, frames)
    squash = np.sin(np.pi * (time - 0.8).clip(0, 0.8) / 0.8) ** 2
    drops = (0.8 - time).clip(0)
    positions = [squashed(rest_points(counts), s, drop) for s, drop in zip(squash, drops, strict=True)]
    return Result(
        time=time,
        positions=np.stack(positions),
        outputs=_outputs(squash) | _centres(squash),
        inputs=_vectors("plane.press", PRESS) | _point("press", 1.6 - 0.6 * squash),
        parameters=_vectors(
            "plane.ground", {"velocity": (0, 0, 0), "angular_velocity": (0, 0, 0), "normal": (0, 0, 2.0), "point": (0, 0, 0.2)}
        ),
        summary={"title": title},
        scene=_scene(title, pins, counts),
        lattice=LatticeBox(counts, tuple(ORIGIN), tuple(SIZE), "bezier"),
        obstacles=Obstacles("lattice"),
    )


def at_rest_about(mesh):
    """The run with all frames at rest, in the box of a mesh."""
    origin, size, run = mesh.bounds[0], np.ptp(mesh.bounds, axis=0), made_up_run()
    positions = np.tile(rest_grid((4, 4, 4), origin, size), (len(run.time), 1, 1, 1, 1))
    return with_mesh(replace(run, positions=positions, lattice=LatticeBox((4, 4, 4), tuple(origin), tuple(size), "bezier")), mesh)


def with_mesh(result, mesh):
    """The run with a mesh as its object."""
    result.scene.loaded_mesh = mesh
    return result


def with_solids(result, *solids):
    """The run with solid obstacles of these sections, which move as these say, and touch nothing."""
    values = {}
    for solid in solids:
        pose = {"rotation": solid.rotation_vector()} if isinstance(solid, Box) else {"normal": solid.normal}
        pose |= {what: getattr(solid, what) for what in ("point", "velocity", "angular_velocity")}
        values |= _vectors(str(solid.part), pose)
    return replace(result, parameters=result.parameters | values, obstacles=Obstacles("lattice", tuple(solid.shape() for solid in solids)))


def rest_points(counts):
    """The regular lattice in the box, (nx, ny, nz, 3) m."""
    return rest_grid(counts, ORIGIN, SIZE)


def squashed(points, share, drop):
    """Flatter and wider by `share` with a barrel's bulge, twisted, and `drop` m higher."""
    x, y, z = np.moveaxis((points - ORIGIN - SIZE * [0.5, 0.5, 0.0]) / SIZE, -1, 0)
    wide = 1 + share * (0.2 + z * (1 - z))
    angle = 0.6 * share * z
    moved = np.stack([wide * (x * np.cos(angle) - y * np.sin(angle)), wide * (x * np.sin(angle) + y * np.cos(angle))])
    return ORIGIN + SIZE * [0.5, 0.5, 0.0] + SIZE * np.stack([*moved, z * (1 - 0.45 * share)], axis=-1) + [0, 0, drop]


def _outputs(squash):
    forces = {"plane.ground.reaction": -2e3 * squash, "plane.press.reaction": 2e3 * squash}
    outputs = {f"{name}.{a}": force * (a == "z") for name, force in forces.items() for a in "xyz"}
    return outputs | {"energy.kinetic": 5 * (1 - squash), "energy.elastic": 300 * squash**2}


def _centres(squash):
    """Of pressure, to the side of the middle."""
    places = {"ground": (0.1, 0.05, 0.2 + 0 * squash), "press": (-0.1, 0.0, 1.6 - 0.6 * squash)}
    return {f"plane.{name}.centre.{a}": value + 0 * squash for name, at in places.items() for a, value in zip("xyz", at, strict=True)}


def _vectors(name, values):
    return {f"{name}.{what}.{a}": float(vector["xyz".index(a)]) for what, vector in values.items() for a in "xyz"}


def _point(name, height):
    return {f"plane.{name}.point.x": 0.3, f"plane.{name}.point.y": 0.0, f"plane.{name}.point.z": height}


def _scene(title, pins, counts):
    return SimpleNamespace(
        title=title,
        loaded_mesh=None,
        lattice=SimpleNamespace(points=counts),
        lattice_box=SimpleNamespace(size=tuple(SIZE)),
        material=SimpleNamespace(youngs_modulus=1e4, poissons_ratio=0.25),
        region=(),
        environment=SimpleNamespace(gravity=(0.0, 0.0, -9.81)),
        solids=(),
        pin=tuple(SimpleNamespace(name=f"pin{n}", points=n) for n in range(len(pins))),
        select=lambda points: np.asarray(pins[points]),
    )
