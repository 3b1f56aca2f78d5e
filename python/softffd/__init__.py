"""softffd: a soft object (mass-spring Bezier free-form deformation) as an FMI 2.0 co-simulation component."""

__version__ = "0.1.0"

from softffd.embedding.deform import deform
from softffd.errors import FmuError, MeshError, SceneError, SoftffdError
from softffd.fmu.package import package_fmu
from softffd.mesh.mesh import load_mesh, save_mesh
from softffd.run.result import Result
from softffd.run.simulate import simulate
from softffd.run.simulation import Simulation
from softffd.scene.scene import Scene, load_scene

__all__ = [
    "FmuError",
    "MeshError",
    "Result",
    "Scene",
    "SceneError",
    "Simulation",
    "SoftffdError",
    "deform",
    "load_mesh",
    "load_scene",
    "package_fmu",
    "save_mesh",
    "simulate",
]
