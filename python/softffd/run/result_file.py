"""The one file of a result: an NPZ archive whose entry `header` says in JSON what the arrays do not.

    time, positions       as in the Result
    NAME                  an output of that name, (T,); outputs/NAME where one of these five words is its name
    inputs                all inputs, (T, m); their names are in the header
    header                format, version, names, parameters, summary, lattice, log, and the scene's keys with what its mesh was

numpy.load reads it too. Nothing in it is pickled, and every entry has its checksum.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from softffd import __version__
from softffd.embedding.deform import BASES
from softffd.errors import SceneError, SoftffdError
from softffd.files import replacing, require_writable
from softffd.fmu.component import Message
from softffd.lattice import LatticeBox
from softffd.obstacles import Obstacles
from softffd.run.npz import UNREADABLE, damaged, read_arrays, write_arrays
from softffd.scene.document import SHIPPED, shown
from softffd.taxels import TaxelGrid

if TYPE_CHECKING:
    from softffd.mesh.mesh import Mesh
    from softffd.scene.scene import Scene

FORMAT, VERSION = "softffd result", 1
OWN = ("header", "time", "positions", "inputs", "outputs")
KEPT = "result.npz"
"""What the file of a result is called in a folder."""


@dataclass(frozen=True)
class KeptScene:
    """What the header says of a run's scene."""

    path: Any
    keys: dict[str, Any]
    mesh: str | None
    """Fingerprint of the mesh that was read"""


@dataclass(frozen=True)
class Header:
    """What the header says: all but the arrays, as the Result has it."""

    version: int
    outputs: list[str]
    inputs: list[str]
    parameters: dict[str, bool | int | float]
    summary: dict[str, Any]
    lattice: LatticeBox | None
    flat_names: bool
    log: tuple[Message, ...]
    scene: KeptScene | None
    obstacles: Obstacles | None = None
    taxels: tuple[TaxelGrid, ...] = ()


def write_files(path: Path, fields: Mapping[str, Any], columns: Mapping[str, np.ndarray]) -> list[Path]:
    """Writes NAME.npz, or a folder of result.npz, result.csv and summary.json, and returns the paths of the files.

    fields: of the Result, by name. columns: of the CSV file, (T,) each.
    """
    one = path.suffix.lower() == ".npz"
    folder = path.parent if one else path
    require_writable(folder)
    folder.mkdir(parents=True, exist_ok=True)
    files: dict[str, Callable[[BinaryIO], None]] = {path.name if one else KEPT: partial(_write_result, fields)}
    if not one:
        files |= {"result.csv": partial(_write_csv, columns), "summary.json": partial(_write_summary, fields["summary"])}
    for name, write in files.items():
        with replacing(folder / name) as stream:
            write(stream)
    return [folder / name for name in files]


def _write_result(fields: Mapping[str, Any], stream: BinaryIO) -> None:
    time, inputs = fields["time"], fields["inputs"]
    rows = np.stack(list(inputs.values()), axis=1) if inputs else np.zeros((len(time), 0))
    header = np.array(json.dumps(_header(**fields), default=_plain))
    arrays = {"header": header, "time": time, "positions": fields["positions"], "inputs": rows}
    write_arrays(stream, arrays | {_entry(name): values for name, values in fields["outputs"].items()})


def _header(
    *, outputs: Mapping[str, Any], inputs: Mapping[str, Any], lattice: LatticeBox | None, obstacles: Obstacles | None,
    log: tuple[Message, ...], scene: Scene | None, taxels: tuple[TaxelGrid, ...], **others: Any,
) -> dict[str, Any]:  # fmt: skip
    kept = scene and KeptScene(scene.path, scene.keys_given(), _fingerprint(scene.loaded_mesh) if scene.loaded_mesh else None)
    return {
        "format": FORMAT, "version": VERSION, "softffd": __version__,
        **{key: others[key] for key in ("parameters", "summary", "flat_names")},
        "outputs": list(outputs), "inputs": list(inputs), "log": [list(message) for message in log],
        "lattice": lattice and asdict(lattice), "obstacles": obstacles and asdict(obstacles), "scene": kept and vars(kept),
        **({"taxels": [asdict(grid) for grid in taxels]} if taxels else {}),
    }  # fmt: skip


def _write_csv(columns: Mapping[str, np.ndarray], stream: BinaryIO) -> None:
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(columns)
    stream.write(header.getvalue().encode())
    np.savetxt(stream, np.stack(list(columns.values()), axis=1), fmt="%.17g", delimiter=",")


def _write_summary(summary: Mapping[str, Any], stream: BinaryIO) -> None:
    stream.write((json.dumps(summary, indent=2) + "\n").encode())


def read_result(path: Path, mesh: Path | None) -> dict[str, Any]:
    """The fields of the Result that a file or a folder holds. mesh: the file of its scene's mesh, where it is known.

    SoftffdError for a file that is missing, damaged, too new or something else.
    """
    path = path / KEPT if path.is_dir() else path
    arrays = read_arrays(path, "result")
    try:
        said = json.loads(str(arrays["header"]))
        known = said["format"] == FORMAT
    except (KeyError, TypeError, *UNREADABLE):
        known = False
    if not known:
        raise SoftffdError(f"{shown(path)}: an archive of other things; wanted a result that softffd wrote (Result.save, softffd run)")
    if isinstance(said.get("version"), int) and said["version"] > VERSION:
        by = f"softffd {said.get('softffd', 'of a later version')}"
        raise SoftffdError(f"{shown(path)}: written by {by}, whose results this one, {__version__}, cannot read yet")
    try:
        header = _read_header(said)
        fields: dict[str, Any] = {
            "time": arrays["time"],
            "positions": arrays["positions"],
            "outputs": {name: arrays[_entry(name)] for name in header.outputs},
            "inputs": dict(zip(header.inputs, arrays["inputs"].T, strict=True)),
        }
        _require_one_run(header, **fields)
    except (KeyError, TypeError, *UNREADABLE) as fault:
        raise damaged(path, "result", fault) from None
    scene, why = (None, "") if header.scene is None else _scene(header.scene, header.lattice, path.absolute().parent, mesh)
    told = {name: getattr(header, name) for name in ("parameters", "summary", "lattice", "flat_names", "obstacles", "log", "taxels")}
    return fields | told | {"scene": scene, "sceneless": why}


def _read_header(said: dict[str, Any]) -> Header:
    """The header from its JSON, each part of the kind that it should be; ValueError that tells what is not."""
    from pydantic import TypeAdapter, ValidationError  # only here it is needed

    try:
        return TypeAdapter(Header).validate_python(said)
    except ValidationError as error:
        fault = error.errors()[0]
        raise ValueError(f"header, {'.'.join(map(str, fault['loc']))}: {fault['msg']}") from None


def _entry(name: str) -> str:
    return f"outputs/{name}" if name in OWN else name


def _plain(value: Any) -> Any:
    """What JSON has instead of a number of numpy or a path."""
    return value.item() if isinstance(value, np.generic) else str(value)


def _require_one_run(
    header: Header, *, time: np.ndarray, positions: np.ndarray, outputs: dict[str, np.ndarray], inputs: dict[str, np.ndarray]
) -> None:
    """ValueError where the arrays and numbers are not those of one run."""
    lattice = header.lattice
    if lattice and (positions.shape[1:4] != lattice.points or lattice.basis not in BASES):
        raise ValueError(f"positions of shape {positions.shape} of {lattice}")
    shapes = [array.shape for array in (time, *outputs.values(), *inputs.values())]
    if positions.ndim != 5 or positions.shape[4] != 3 or any(shape != (len(positions),) for shape in shapes):
        raise ValueError("its arrays have not the shapes of one run")
    kinds = [(array, "fiub") for array in (*outputs.values(), *inputs.values(), *map(np.asarray, header.parameters.values()))]
    if other := [array.dtype for array, allowed in [(time, "f"), (positions, "f"), *kinds] if array.dtype.kind not in allowed]:
        raise ValueError(f"wanted numbers, got {other[0]}")
    if not isinstance(header.summary.get("warnings", []), list):
        raise ValueError(f"header, summary.warnings: wanted a list, got {header.summary['warnings']!r:.70}")


def _scene(kept: KeptScene, lattice: LatticeBox | None, folder: Path, given: Path | None) -> tuple[Scene | None, str]:
    """The scene of the keys, if its mesh is found and still the one of the run; else None, and why."""
    from softffd.scene.scene import scene_from

    keys = dict(kept.keys)
    if (named := keys.get("mesh")) and isinstance(named, dict):
        file = given or _mesh_file(str(named.get("file", "")), folder)
        if file is None:
            why = f"its mesh, {named.get('file')}, is not beside it nor below its folder: load(..., mesh=FILE) takes it from elsewhere"
            return None, why
        keys["mesh"] = {**named, "file": str(file.absolute())}
    try:
        scene = scene_from(keys, path=str(kept.path))
    except (SceneError, OSError, ValueError) as error:
        return None, error.problems[0] if isinstance(error, SceneError) else str(error)
    if lattice and scene.lattice_box.points != lattice.points:
        return None, f"its scene has a lattice of {scene.lattice_box.points}, the run one of {lattice.points}"
    if scene.loaded_mesh and _fingerprint(scene.loaded_mesh) != kept.mesh:
        return None, f"{scene.mesh.file if scene.mesh else ''} is another mesh than at the time of the run"
    return scene, ""


def _mesh_file(name: str, folder: Path) -> Path | None:
    """Where the mesh is looked for: beside the result, else where it was if that is below the result's folder, below the working one, or
    comes with the package. Of any other place that a file names not even its being there is asked."""
    beside = folder / (re.split(r"[\\/]", name)[-1] or "-")
    if beside.is_file():
        return beside
    was = Path(os.path.normpath(folder / name))
    return was if any(was.is_relative_to(place) for place in (folder, Path.cwd(), SHIPPED)) else None


def _fingerprint(mesh: Mesh) -> str:
    """Of vertices and faces."""
    return hashlib.sha256(mesh.vertices.astype("<f8").tobytes() + mesh.faces.astype("<i8").tobytes()).hexdigest()
