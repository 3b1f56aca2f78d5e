"""Wavefront OBJ, read record by record.

Read here and not by trimesh, which takes index 0 for vertex 1, counts relative indices from the end of the file,
passes over faces of two corners and lines it does not know, and splits vertices by their normals.
"""

from codecs import BOM_UTF8
from pathlib import Path

import numpy as np

from softffd.files import replacing, write_text
from softffd.mesh.polygons import Triangles, assemble, damaged, first_outside, open_texture


def read_obj(path: Path, data: bytes) -> Triangles:
    """Return the triangles of an OBJ file; all objects, groups and materials in one.

    Corners without texture coordinates in a file that has some get (0, 0). The texture is kept where the file
    uses exactly one. Raises MeshError with the line of the fault.
    """
    records = _Records(path)
    data = data.removeprefix(BOM_UTF8)
    for number, line in enumerate(data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines(), 1):
        words = line.partition(b"#")[0].split()
        if words:
            records.read(number, words)
    return records.triangles()


def write_obj(path: Path, vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray | None, *, texture, decimals: int) -> None:
    """Write an OBJ file; a texture goes beside it, as NAME.mtl and NAME.png."""
    lines = []
    if texture is not None:
        with replacing(path.with_suffix(".png")) as stream:
            texture.save(stream, "PNG")
        write_text(path.with_suffix(".mtl"), f"newmtl surface\nmap_Kd {path.with_suffix('.png').name}\n")
        lines += [f"mtllib {path.with_suffix('.mtl').name}", "usemtl surface"]
    lines += _rows("v", vertices, decimals)
    corners = [f"{i}" for i in range(1, len(vertices) + 1)]
    if uv is not None:
        texels, texel = np.unique(np.round(uv, decimals), axis=0, return_inverse=True)
        lines += _rows("vt", texels, decimals)
        corners = [f"{corner}/{t}" for corner, t in zip(corners, texel.reshape(-1) + 1, strict=True)]
    lines += [f"f {corners[a]} {corners[b]} {corners[c]}" for a, b, c in faces.tolist()]
    write_text(path, "\n".join(lines) + "\n")


def _rows(key: str, rows: np.ndarray, decimals: int) -> list[str]:
    return [" ".join([key, *(f"{value:.{decimals}f}" for value in row)]) for row in (rows + 0.0).tolist()]


class _Records:
    """The records met so far. Indices are kept from 0; a corner without texture coordinate has -1."""

    def __init__(self, path: Path):
        self.path = path
        self.vertices: list[list[float]] = []
        self.texels: list[list[float]] = []
        self.corners: list[int] = []
        self.texel_corners: list[int] = []
        self.counts: list[int] = []
        self.face_lines: list[int] = []
        self.libraries: list[str] = []
        self.materials: set[str] = set()

    def read(self, number: int, words: list[bytes]) -> None:
        key = words[0]
        try:
            if key == b"v":
                self.vertices.append(_numbers(words[1:4], 3))
            elif key == b"f":
                self._read_face(number, words[1:])
            elif key == b"vt":
                self.texels.append([*_numbers(words[1:3], 1), 0.0][:2])
            elif key == b"mtllib":
                self.libraries.append(b" ".join(words[1:]).decode(errors="replace"))
            elif key == b"usemtl":
                self.materials.add(b" ".join(words[1:]).decode(errors="replace"))
            elif not key.replace(b"_", b"").isalnum() or key[:1].isdigit():
                raise ValueError("no record of an OBJ file starts like this")
        except (ValueError, OverflowError) as fault:
            text = b" ".join(words)[:60].decode(errors="replace")
            raise damaged(self.path, f"line {number}, {text!r}: {fault}") from None

    def _read_face(self, number: int, words: list[bytes]) -> None:
        if len(words) < 3:
            raise ValueError(f"a face needs at least 3 corners, this one has {len(words)}")
        for word in words:
            vertex, _, rest = word.partition(b"/")
            texel = rest.partition(b"/")[0]
            self.corners.append(_from_zero(vertex, len(self.vertices)))
            self.texel_corners.append(_from_zero(texel, len(self.texels)) if texel else -1)
        self.counts.append(len(words))
        self.face_lines.append(number)

    def triangles(self) -> Triangles:
        positions = np.array(self.vertices, dtype=float).reshape(-1, 3)
        corners = self._checked("vertex", self.corners, len(positions))
        if not self.texels:
            return assemble(positions, corners, self.counts)
        texels, texel_corners = np.array(self.texels), np.array(self.texel_corners, dtype=np.int64)
        if (texel_corners < 0).any():
            texel_corners[texel_corners < 0] = len(texels)
            texels = np.vstack([texels, [0.0, 0.0]])
        self._checked("texture coordinate", texel_corners, len(texels))
        return assemble(
            positions,
            corners,
            self.counts,
            texels=texels,
            texel_corners=texel_corners,
            texture=self._texture(),
        )

    def _checked(self, what: str, indices, count: int) -> np.ndarray:
        """The corners' indices as an array; none points outside the `count` records of its kind."""
        try:
            indices = np.array(indices, dtype=np.int64)
        except OverflowError:
            raise damaged(self.path, f"a face refers to a {what} beyond all files") from None
        place = first_outside(indices, count)
        if place >= 0:
            line = self.face_lines[np.searchsorted(np.cumsum(self.counts), place, side="right")]
            fault = f"line {line}: a face refers to {what} {indices[place] + 1}, but the file has {count}"
            raise damaged(self.path, fault)
        return indices

    def _texture(self):
        """The image of the one textured material in use, or None."""
        files = {}
        for library in self.libraries:
            files |= _texture_files(self.path.parent / library)
        used = {file for material, file in files.items() if material in self.materials}
        return open_texture(used.pop()) if len(used) == 1 else None


def _texture_files(library: Path) -> dict[str, Path]:
    """The image file of each material of an MTL file that has one; nothing where the file is missing."""
    files: dict[str, Path] = {}
    material = ""
    try:
        lines = library.read_text(errors="replace").splitlines()
    except (OSError, ValueError):
        return files
    for line in lines:
        key, _, value = line.strip().partition(" ")
        if key == "newmtl":
            material = value.strip()
        elif key.lower() == "map_kd" and value.strip():
            name = value.split()[-1] if value.strip().startswith("-") else value.strip()
            files[material] = library.parent / name.replace("\\", "/")
    return files


def _numbers(words: list[bytes], least: int) -> list[float]:
    if len(words) < least:
        raise ValueError(f"wanted {least} numbers, got {len(words)}")
    try:
        return [float(word) for word in words]
    except ValueError:
        raise ValueError("wanted numbers") from None


def _from_zero(word: bytes, count: int) -> int:
    """The index from 0 of a reference that counts from 1, or backwards from the `count` records so far."""
    try:
        index = int(word)
    except ValueError:
        raise ValueError("wanted corners as in 'f 1 2 3' or 'f 1/1 2/2 3/3'") from None
    if index == 0 or index < -count:
        raise ValueError(f"a face refers to record {index}; wanted 1 and up, or -1 down to -{count}")
    return index - 1 if index > 0 else count + index
