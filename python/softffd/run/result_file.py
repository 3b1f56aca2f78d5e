"""The one file of a result: an npz archive whose entry `header` says in JSON what the arrays do not.

    time, positions       as in the Result
    NAME                  an output of that name, (T,); outputs/NAME where one of these five words is its name
    inputs                all inputs, (T, m); their names are in the header
    header                format, version, names, parameters, summary, lattice, log, and the scene's keys with what its mesh was

numpy.load reads it too. Nothing in it is pickled, and every entry has its checksum.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
import zlib
from dataclasses import asdict
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from softffd import __version__
from softffd.errors import SceneError, SoftffdError
from softffd.lattice import LatticeBox
from softffd.obstacles import Obstacles, SolidShape
from softffd.scene.document import shown

if TYPE_CHECKING:
    from softffd.mesh.mesh import Mesh
    from softffd.run.result import Result
    from softffd.scene.scene import Scene

FORMAT, VERSION = "softffd result", 1
OWN = ("header", "time", "positions", "inputs", "outputs")

UNREADABLE = (OSError, ValueError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error, MemoryError)
"""What archives raise that are none, or damaged."""


def write_result(result: Result, stream: BinaryIO) -> None:
    """Writes the whole file."""
    inputs = np.stack(list(result.inputs.values()), axis=1) if result.inputs else np.zeros((len(result.time), 0))
    header = np.array(json.dumps(_header(result), default=_plain))
    arrays = {"header": header, "time": result.time, "positions": result.positions, "inputs": inputs}
    arrays |= {_entry(name): values for name, values in result.outputs.items()}
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                np.lib.format.write_array(entry, np.asanyarray(values), allow_pickle=False)


def read_result(path: Path) -> dict[str, Any]:
    """The fields of the Result that a file holds. SoftffdError for a file that is missing, damaged, too new or something else."""
    arrays = _arrays(path)
    try:
        header = json.loads(str(arrays["header"]))
        known = header["format"] == FORMAT
    except (KeyError, TypeError, ValueError):
        known = False
    if not known:
        raise SoftffdError(f"{shown(path)}: an archive of other things; wanted a result that softffd wrote (Result.save, softffd run)")
    if header["version"] > VERSION:
        raise SoftffdError(f"{shown(path)}: written by softffd {header['softffd']}, whose results this one, {__version__}, cannot read yet")
    try:
        return _fields(header, arrays, path)
    except (KeyError, TypeError, ValueError) as fault:
        raise _damaged(path, fault) from None


def _entry(name: str) -> str:
    return f"outputs/{name}" if name in OWN else name


def _plain(value: Any) -> Any:
    """What JSON has instead of a number of numpy or a path."""
    return value.item() if isinstance(value, np.generic) else str(value)


def _header(result: Result) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "version": VERSION,
        "softffd": __version__,
        "outputs": list(result.outputs),
        "inputs": list(result.inputs),
        "parameters": dict(result.parameters),
        "summary": result.summary,
        "lattice": result.lattice and asdict(result.lattice),
        "plain_names": result.plain_names,
        "obstacles": result.obstacles and asdict(result.obstacles),
        "log": [list(message) for message in result.log],
        "scene": result.scene and {
            "path": result.scene.path,
            "keys": result.scene.keys_given(),
            "mesh": result.scene.loaded_mesh and _fingerprint(result.scene.loaded_mesh),
        },
    }  # fmt: skip


def _arrays(path: Path) -> dict[str, np.ndarray]:
    try:
        with zipfile.ZipFile(path) as archive:
            entries = {name.removesuffix(".npy"): archive.read(name) for name in archive.namelist()}
        return {name: np.lib.format.read_array(BytesIO(entry), allow_pickle=False) for name, entry in entries.items()}
    except FileNotFoundError:
        raise SoftffdError(f"{shown(path)}: there is no such file; wanted a result that softffd wrote") from None
    except UNREADABLE as fault:
        raise _damaged(path, fault) from None


def _damaged(path: Path, fault: Exception) -> SoftffdError:
    return SoftffdError(f"{shown(path)}: damaged, or no result that softffd wrote ({fault})")


def _fields(header: dict[str, Any], arrays: dict[str, np.ndarray], path: Path) -> dict[str, Any]:
    from softffd.fmu.component import Message

    scene, why = _scene(header["scene"], path) if header["scene"] else (None, "")
    box = header["lattice"]
    return {
        "time": arrays["time"],
        "positions": arrays["positions"],
        "outputs": {name: arrays[_entry(name)] for name in header["outputs"]},
        "inputs": dict(zip(header["inputs"], arrays["inputs"].T, strict=True)),
        "parameters": header["parameters"],
        "summary": header["summary"],
        "scene": scene,
        "lattice": box and LatticeBox(tuple(box["points"]), tuple(box["origin"]), tuple(box["size"]), box["basis"]),
        "plain_names": header["plain_names"],
        "obstacles": _obstacles(header.get("obstacles")),
        "log": tuple(Message(*message) for message in header["log"]),
        "sceneless": why,
    }


def _obstacles(kept: dict[str, Any] | None) -> Obstacles | None:
    if kept is None:
        return None
    return Obstacles(kept["meet"], tuple(SolidShape(each["name"], each["kind"], tuple(each["size"])) for each in kept["solids"]))


def _scene(kept: dict[str, Any], path: Path) -> tuple[Scene | None, str]:
    """The scene of the keys, if its mesh is still the one of the run, at its place or beside the result; else None, and why."""
    if mesh := kept["keys"].get("mesh"):
        file = Path(mesh["file"])
        beside = path.parent / file.name
        mesh["file"] = str(beside if beside.is_file() and not file.is_file() else file)
    try:
        from softffd.scene.scene import scene_from

        scene = scene_from(kept["keys"], path=kept["path"])
    except SceneError as error:
        return None, error.problems[0]
    if scene.loaded_mesh and _fingerprint(scene.loaded_mesh) != kept["mesh"]:
        return None, f"{mesh['file']} is another mesh than at the time of the run"
    return scene, ""


def _fingerprint(mesh: Mesh) -> str:
    """Of vertices and faces."""
    return hashlib.sha256(mesh.vertices.astype("<f8").tobytes() + mesh.faces.astype("<i8").tobytes()).hexdigest()
