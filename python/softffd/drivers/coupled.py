"""A plate and a soft body as one system: an SSP 1.0 file with both FMUs, connected both ways.

    body.plane.NAME.reaction  ->  plate.reaction
    plate.point, .velocity    ->  body.plane.NAME.point, .velocity

The normal is not connected: the plate does not turn, and both FMUs start with the same normal. The plate's own start values are written
into its FMU, so a host need not read parameters. Hosts that step all components and then exchange values (Jacobi: fmpy, libcosim, Ecos
with a fixed step) run the system as it is.

fmpy's `simulate_ssp` sets every connected input to zero in its first step instead of reading start values. These zeros are right for a
plate that starts at rest with its point at the world's origin, as in the shipped scene; another start needs another host.
"""

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from softffd.drivers import build_driver
from softffd.errors import SoftffdError
from softffd.fmu.ssp import write_ssp
from softffd.scene.scene import Scene, load_scene

SCENE = Path(__file__).with_name("plate_on_box.toml")


def write_plate_ssp(
    path: str | Path, scene: Scene | str | Path | None = None, *, plane: str | None = None, plate: Mapping[str, Any] | None = None
) -> Path:
    """Writes a system of a scene's FMU (`body`) and a plate (`plate`) and returns the path of the system.

    scene: a scene, the path of its file or a shipped name; by default a box of 1 kg that the plate rests on.
    plane: the input obstacle that is the plate's surface, or a solid that moves with the plate; by default the scene's only input
        obstacle. The plate starts with the obstacle's pose and velocity.
    plate: further start values of the plate, e.g. {"mass": 2.0}; see softffd/drivers/plate.py.
    Raises SoftffdError if the scene has no such obstacle or no reactions.
    """
    scene = scene if isinstance(scene, Scene) else load_scene(scene or SCENE)
    surface = _surface(scene, plane)
    poses = ("point", "velocity") if surface in scene.solids else ("point", "velocity", "normal")
    start = {f"initial.{key}": getattr(surface, key) for key in poses} | dict(plate or {})
    moved = [name for name in surface.input_components() if name.startswith(("point", "velocity"))]
    exchanged = [*moved, *(f"reaction.{axis}" for axis in "xyz")]
    ends = [(f"plate.{name}", f"body.{surface.part}.{name}") for name in exchanged]
    with TemporaryDirectory(prefix="softffd-") as folder:
        return write_ssp(path, {"plate": build_driver("plate", folder, start_values=start), "body": scene}, ends)


def _surface(scene: Scene, name: str | None) -> Any:
    inputs = {each.name: each for each in scene.obstacles if each.motion == "input"}
    if not scene.outputs.reactions:
        raise SoftffdError(f"{scene.name}: a coupled plate needs outputs.reactions = true")
    if name is None and len(inputs) == 1:
        return next(iter(inputs.values()))
    if name not in inputs:
        raise SoftffdError(f'{scene.name}: plane: wanted one with motion = "input" ({", ".join(inputs) or "there is none"}), got {name}')
    return inputs[name]
