"""softffd: a soft object (mass-spring Bezier free-form deformation) as a co-simulation component of FMI 2 and FMI 3."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softffd.embedding.deform import deform
    from softffd.errors import FmuError, MeshError, SceneError, SoftffdError
    from softffd.fitting.fit import fit
    from softffd.fitting.result import Fit
    from softffd.fmu.package import package_fmu
    from softffd.fmu.ssp import write_ssp
    from softffd.mesh.files import load_mesh, save_mesh
    from softffd.run.replay import replay
    from softffd.run.result import Result
    from softffd.run.simulate import simulate
    from softffd.run.simulation import Simulation
    from softffd.run.sweep import Sweep, sweep
    from softffd.scene.scene import Scene, load_scene

__version__ = "0.1.0"
__all__ = [
    "Fit", "FmuError", "MeshError", "Result", "Scene", "SceneError", "Simulation", "SoftffdError", "Sweep", "deform", "fit", "load_mesh",
    "load_scene", "package_fmu", "replay", "save_mesh", "simulate", "sweep", "write_ssp",
]  # fmt: skip

HOMES = {
    "embedding.deform": ["deform"], "errors": ["FmuError", "MeshError", "SceneError", "SoftffdError"], "fitting.fit": ["fit"],
    "fitting.result": ["Fit"], "fmu.package": ["package_fmu"], "fmu.ssp": ["write_ssp"], "mesh.files": ["load_mesh", "save_mesh"],
    "run.replay": ["replay"], "run.result": ["Result"], "run.simulate": ["simulate"], "run.simulation": ["Simulation"],
    "run.sweep": ["Sweep", "sweep"], "scene.scene": ["Scene", "load_scene"],
}  # fmt: skip
"""The public names by module. A module is imported when a name is first used, since numpy, pydantic and fmpy take most of a second."""

if not TYPE_CHECKING:  # a type checker knows the names from above; with __getattr__ it would accept wrong names too

    def __getattr__(name):
        home = next((module for module, names in HOMES.items() if name in names), None)
        if home is None:
            from softffd.spelling import did_you_mean, nearest_of

            raise AttributeError(f"softffd has no {name!r}{did_you_mean(nearest_of(name, __all__))}", name=name, obj=None)
        globals()[name] = value = getattr(import_module(f"softffd.{home}"), name)
        return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
