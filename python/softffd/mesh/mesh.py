"""A triangle mesh."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from softffd.lattice import bounding_box
from softffd.mesh.looks import PLAIN, Looks, Material, Picture
from softffd.mesh.normals import merge_by_position


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """Triangles in space.

    vertices: (V, 3) [m]. faces: (F, 3) indices of vertices, counter-clockwise seen from outside.
    uv: (V, 2) texture coordinates, with (0, 0) at the lower left corner of the image, or None. A vertex on a seam of the texture exists
    once for each side. texture: the only image of the mesh, or None. name: for messages and file names.
    doubt: unit and scale that are more likely than metres, or ""; printed with the mesh. Raises ValueError for arrays of wrong shapes.
    """

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None = None
    name: str = "mesh"
    texture: Picture | None = None
    looks: Looks = PLAIN
    doubt: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", np.asarray(self.vertices, dtype=np.float64))
        object.__setattr__(self, "faces", np.asarray(self.faces, dtype=np.int64))
        if self.uv is not None:
            object.__setattr__(self, "uv", np.asarray(self.uv, dtype=np.float64))
        if self.texture is not None and not self.looks.materials:
            surface, all_faces = Material("surface", None, self.texture), np.zeros(len(self.faces), dtype=np.int64)
            object.__setattr__(self, "looks", replace(self.looks, materials=(surface,), material_of=all_faces))
        textures = self.looks.textures
        object.__setattr__(self, "texture", textures[0] if len(textures) == 1 else None)
        shapes = [
            ("vertices", self.vertices, (None, 3)),
            ("faces", self.faces, (None, 3)),
            ("uv", self.uv, (len(self.vertices), 2)),
            ("looks.colours", self.looks.colours, (len(self.vertices), 3)),
        ]
        for what, array, (rows, columns) in shapes:
            if array is not None and (array.ndim != 2 or array.shape[1] != columns or rows not in (None, len(array))):
                raise ValueError(f"{what}: wanted the shape ({rows or 'any'}, {columns}), got {array.shape}")
        if len(self.faces) and not 0 <= self.faces.min() <= self.faces.max() < len(self.vertices):
            raise ValueError(f"faces: wanted indices of {len(self.vertices)} vertices, got {self.faces.min()} to {self.faces.max()}")
        for what, index in (("material_of", self.looks.material_of), ("group_of", self.looks.group_of)):
            if index is not None and index.shape != (len(self.faces),):
                raise ValueError(f"looks.{what}: wanted the shape ({len(self.faces)},), got {index.shape}")

    def __repr__(self) -> str:
        sides = " × ".join(f"{side:.4g}" for side in np.ptp(self.bounds, axis=0)) if len(self.vertices) else "0"
        doubt = f" ({self.doubt})" if self.doubt else ""
        return f"Mesh {self.name}: {len(self.vertices):,} vertices, {len(self.faces):,} faces, {sides} m{doubt}"

    @property
    def bounds(self) -> np.ndarray:
        """Lower and upper corner of the bounding box, (2, 3) [m]."""
        return np.stack(bounding_box(self.vertices))

    @property
    def closed(self) -> bool:
        """True if the surface encloses a volume: the faces pass every edge equally often in both directions.

        Vertices at equal positions count as one, so seams of the texture leave no gap.
        """
        return self.open_edges == 0

    @cached_property
    def open_edges(self) -> int:
        """Number of edges that the faces do not pass equally often in both directions; 0 for a closed surface."""
        index, _ = merge_by_position(self.vertices)
        return _unbalanced_edges(index[self.faces])


def _unbalanced_edges(faces: np.ndarray) -> int:
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    if not len(edges):
        return 0
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, edge = np.unique(low * (high.max() + 1) + high, return_inverse=True)
    balance = np.bincount(edge, weights=np.where(edges[:, 0] == low, 1.0, -1.0))
    return int(np.count_nonzero(balance))
