"""3MF: trimesh reads the bodies; the archive is first searched for parts that trimesh would assemble wrongly or leave out."""

import zlib
from io import BytesIO
from pathlib import Path
from xml.etree import ElementTree
from zipfile import BadZipFile, ZipFile

from softffd.errors import MeshError
from softffd.mesh.bodies import read_bodies, require_package
from softffd.mesh.polygons import Triangles, damaged
from softffd.spelling import few

_MOST, _RATIO = 100_000_000, 100
"""Bytes, and multiple of the size of the archive: an archive that unpacks to more than both is refused."""

_EXTENSIONS = ("/production/", "/material/", "/trianglesets/")
"""Parts of the names of extensions that are read, or that change no shape."""


def read_3mf(path: Path, data: bytes) -> Triangles:
    """Like read_bodies; notes report unread colours and missing bodies. Raises MeshError also for content that is not read."""
    require_package(path)
    try:
        with ZipFile(BytesIO(data)) as archive:
            return _read(path, data, archive)
    except (BadZipFile, zlib.error, EOFError, OSError, ElementTree.ParseError, ValueError, LookupError) as fault:
        raise damaged(path, f"its parts cannot be unpacked or read ({fault})") from None
    except RuntimeError as fault:  # raised by zipfile for passwords and unknown packing methods
        raise MeshError(f"{path}: is packed in a way that is not read ({fault}); wanted a plain archive") from None


def _read(path: Path, data: bytes, archive: ZipFile) -> Triangles:
    size = sum(member.file_size for member in archive.infolist())
    if size > max(_MOST, _RATIO * len(data)):
        raise MeshError(f"{path}: unpacks to {size:,} bytes, over {_RATIO} times its own {len(data):,}; wanted a mesh of a sensible size")
    names = [name for name in archive.namelist() if name.lower().endswith(".model")]
    main = next((name for name in names if "3d/3dmodel.model" in name.lower()), None)
    if main is None:
        raise damaged(path, "it has no part 3D/3dmodel.model")
    _require_extensions(path, archive, main)
    objects, references, _ = _parts(archive, main)
    _require_own_parts(path, archive, references)
    lost = sorted({f"object {number}" for number, file in references if not file and number not in objects})
    triangles = read_bodies(path, data)
    if lost and not len(triangles.faces):
        raise MeshError(f"{path}: none of its bodies can be read: broken references ({few(lost)})")
    coloured = any(_parts(archive, name)[2] for name in names)
    return triangles.and_notes(
        f"broken references ({few(lost)})" if lost else "",
        "colours of a 3MF file are not read; OBJ, PLY and GLB keep theirs" if coloured else "",
    )


def _require_extensions(path: Path, archive: ZipFile, main: str) -> None:
    spaces: dict[str, str] = {}
    with archive.open(main) as stream:
        for event, item in ElementTree.iterparse(stream, ("start-ns", "start")):
            if event == "start":
                required = item.attrib.get("requiredextensions", "").split()
                break
            spaces[item[0]] = item[1]
        else:
            required = []
    unknown = [spaces.get(prefix, prefix) for prefix in required if not any(part in spaces.get(prefix, "") for part in _EXTENSIONS)]
    if unknown:
        raise MeshError(f"{path}: requires {', '.join(unknown)}, which is not read. Wanted plain meshes; export it without.")


def _parts(archive: ZipFile, name: str) -> tuple[list[str], list[tuple[str, str]], bool]:
    """Returns the object numbers of a model, its references to objects (number, other file or ""), and whether it has colours."""
    objects, references, coloured = [], [], False
    with archive.open(name) as stream:
        for _, element in ElementTree.iterparse(stream):
            kind = element.tag.rpartition("}")[2]
            if kind == "object":
                objects.append(element.attrib.get("id", ""))
            elif kind in ("component", "item"):
                file = next((value for key, value in element.attrib.items() if key.rpartition("}")[2] == "path"), "")
                references.append((element.attrib.get("objectid", ""), file.strip("/")))
            elif kind in ("basematerials", "colorgroup", "texture2d"):
                coloured = True
            elif kind == "mesh":
                element.clear()
    return objects, references, coloured


def _require_own_parts(path: Path, archive: ZipFile, references: list[tuple[str, str]]) -> None:
    """Refuses parts in other files, unless trimesh reads them correctly: one object a file, used once, with a number of its own."""
    outer = [(number, file) for number, file in references if file]
    files, numbers = ([each[place] for each in outer] for place in (1, 0))
    plain = len(set(files)) == len(files) and len(set(numbers)) == len(numbers)
    if outer and not (plain and all(file in archive.namelist() and len(_parts(archive, file)[0]) == 1 for file in files)):
        listed = few(sorted(set(files)))
        raise MeshError(
            f"{path}: has parts in other files of its archive ({listed}), which are not read. Wanted one model; export it as one."
        )
