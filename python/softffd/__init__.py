"""softffd: a soft object (mass-spring Bezier free-form deformation) as an FMI 2.0 co-simulation component."""

__version__ = "0.1.0"

from softffd.deform import deform
from softffd.errors import FmuError, MeshError, SceneError, SoftffdError
from softffd.mesh import load_mesh, save_mesh
from softffd.package import package_fmu
from softffd.result import Result
from softffd.scene import Scene, load_scene
from softffd.simulate import simulate

__all__ = [
    "FmuError",
    "MeshError",
    "Result",
    "Scene",
    "SceneError",
    "SoftffdError",
    "deform",
    "load_mesh",
    "load_scene",
    "package_fmu",
    "save_mesh",
    "simulate",
]
