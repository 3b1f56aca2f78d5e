"""The file of a result: an NPZ archive whose entry `header` holds in JSON what the arrays do not.

    time, positions       as in the Result
    NAME                  an output of that name, (T,); outputs/NAME if one of these five words is its name
    inputs                all inputs, (T, m); their names are in the header
    header                format, version, names, parameters, summary, lattice, log, and the scene's keys with a fingerprint of its mesh

numpy.load reads the file too. Nothing in the file is pickled, and every entry has its checksum.
"""

import json
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, is_dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from softffd import __version__
from softffd.embedding.deform import BASES
from softffd.errors import SoftffdError
from softffd.files import replacing, table_text
from softffd.fmu.instance import Message
from softffd.lattice import LatticeBox
from softffd.obstacles import Obstacles
from softffd.run.drive import memory
from softffd.scene.document import shown
from softffd.scene.kept import KeptScene
from softffd.taxels import TaxelGrid

FORMAT, VERSION = "softffd result", 1
OWN = ("header", "time", "positions", "inputs", "outputs")
TOLD = ("parameters", "summary", "lattice", "flat_names", "obstacles", "log", "taxels")
"""Fields of the Result that the header holds unchanged"""
KEPT = "result.npz"  # name of the result's file in a folder


@dataclass(frozen=True)
class Header:
    """The content of the header: all fields of the Result except the arrays."""

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

    fields: fields of the Result by name. columns: columns of the CSV file by name, (T,) each.
    """
    one = path.suffix.lower() == ".npz"
    folder = path.parent if one else path
    files: dict[str, Callable[[BinaryIO], object]] = {path.name if one else KEPT: partial(_write_result, fields)}
    if not one:
        summary = json.dumps(fields["summary"], indent=2) + "\n"
        files |= {"result.csv": partial(_write_csv, columns), "summary.json": lambda stream: stream.write(summary.encode())}
    for name, write in files.items():
        with replacing(folder / name) as stream:
            write(stream)
    return [folder / name for name in files]


def _write_result(fields: Mapping[str, Any], stream: BinaryIO) -> None:
    time, inputs = fields["time"], fields["inputs"]
    rows = np.stack(list(inputs.values()), axis=1) if inputs else np.zeros((len(time), 0))
    scene = fields["scene"] and KeptScene.of(fields["scene"])
    header = {"format": FORMAT, "version": VERSION, "softffd": __version__, "outputs": list(fields["outputs"]), "inputs": list(inputs)}
    header |= {"scene": scene} | {key: fields[key] for key in TOLD}
    arrays = {"header": np.array(json.dumps(header, default=_plain)), "time": time, "positions": fields["positions"], "inputs": rows}
    write_arrays(stream, arrays | {_entry(name): values for name, values in fields["outputs"].items()})


def _write_csv(columns: Mapping[str, np.ndarray], stream: BinaryIO) -> None:
    stream.write(table_text(columns, []).encode())
    np.savetxt(stream, np.stack(list(columns.values()), axis=1), fmt="%.17g", delimiter=",")


def read_result(path: Path, mesh: Path | None) -> dict[str, Any]:
    """Returns the fields of the Result that a file or a folder holds. mesh: the file of the scene's mesh, if it is known.

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
        outputs = {name: arrays[_entry(name)] for name in header.outputs}
        inputs = dict(zip(header.inputs, arrays["inputs"].T, strict=True))
        fields: dict[str, Any] = {"time": arrays["time"], "positions": arrays["positions"], "outputs": outputs, "inputs": inputs}
        _require_one_run(header, **fields)
    except (KeyError, TypeError, *UNREADABLE) as fault:
        raise damaged(path, "result", fault) from None
    if mesh is not None and not (header.scene and header.scene.keys.get("mesh")):
        raise SoftffdError(f"mesh: wanted none for {shown(path)}, whose run has no mesh, got {mesh}")
    scene, why = (None, "") if header.scene is None else header.scene.found(header.lattice, path.absolute().parent, mesh)
    return fields | {name: getattr(header, name) for name in TOLD} | {"scene": scene, "sceneless": why}


def _read_header(said: dict[str, Any]) -> Header:
    """Returns the header from its JSON, with the type of each entry checked; ValueError says which entry is wrong."""
    from pydantic import TypeAdapter, ValidationError  # needed only here

    try:
        return TypeAdapter(Header).validate_python(said)
    except ValidationError as error:
        fault = error.errors()[0]
        raise ValueError(f"header, {'.'.join(map(str, fault['loc']))}: {fault['msg']}") from None


def _entry(name: str) -> str:
    return f"outputs/{name}" if name in OWN else name


def _plain(value: Any) -> Any:
    """Returns what JSON holds instead of a numpy number, a dataclass or a path."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    return value.item() if isinstance(value, np.generic) else str(value)


def _require_one_run(
    header: Header, *, time: np.ndarray, positions: np.ndarray, outputs: dict[str, np.ndarray], inputs: dict[str, np.ndarray]
) -> None:
    """Raises ValueError if the arrays and numbers are not those of one run."""
    lattice = header.lattice
    if lattice and (positions.shape[1:4] != lattice.points or lattice.basis not in BASES):
        raise ValueError(f"positions of shape {positions.shape} of {lattice}")
    if lattice and not all(0 < side < np.inf for side in lattice.size):
        raise ValueError(f"header, lattice.size: wanted lengths above 0 m, got {list(lattice.size)}")
    shapes = [array.shape for array in (time, *outputs.values(), *inputs.values())]
    if positions.ndim != 5 or positions.shape[4] != 3 or any(shape != (len(positions),) for shape in shapes):
        raise ValueError("its arrays have not the shapes of one run")
    kinds = [(array, "fiub") for array in (*outputs.values(), *inputs.values(), *map(np.asarray, header.parameters.values()))]
    if other := [array.dtype for array, allowed in [(time, "f"), (positions, "f"), *kinds] if array.dtype.kind not in allowed]:
        raise ValueError(f"wanted numbers, got {other[0]}")
    if not isinstance(header.summary.get("warnings", []), list):
        raise ValueError(f"header, summary.warnings: wanted a list, got {header.summary['warnings']!r:.70}")


# ---- arrays by name in one file; numpy's own savez would not write every name ----

UNREADABLE = (OSError, ValueError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error, MemoryError, OverflowError)
"""Errors raised by a file that is damaged or no archive."""


def write_arrays(stream: BinaryIO, arrays: Mapping[str, Any]) -> None:
    """Writes the whole archive, compressed, and each entry with its checksum. Nothing is pickled: ValueError for arrays of objects."""
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                np.lib.format.write_array(entry, np.asanyarray(values), allow_pickle=False)


def read_arrays(path: Path, what: str) -> dict[str, np.ndarray]:
    """Returns all arrays of a file that should be a `what`, "sweep"; SoftffdError if it is missing, damaged, or larger than the memory."""
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            if size > memory():
                raise SoftffdError(
                    f"{shown(path)}: its arrays take {size / 1e9:.3g} GB; wanted at most {memory() / 1e9:.3g} GB, this machine's memory"
                )
            entries = {name.removesuffix(".npy"): archive.read(name) for name in archive.namelist()}
        return {name: np.lib.format.read_array(BytesIO(entry), allow_pickle=False) for name, entry in entries.items()}
    except FileNotFoundError:
        raise SoftffdError(f"{shown(path)}: there is no such file; wanted a {what} that softffd wrote") from None
    except UNREADABLE as fault:
        raise damaged(path, what, fault) from None


def damaged(path: Path, what: str, fault: object) -> SoftffdError:
    """Returns the error for a damaged file that should be a `what`."""
    return SoftffdError(f"{shown(path)}: damaged, or no {what} that softffd wrote ({fault})")
