"""A small renderer in numpy: shaded triangles, lines and balls with a depth buffer.

Pictures are drawn twice as large in each direction, in fine pixels, and averaged. Depth is 1 / distance along the view, which is linear
on the screen: the largest depth is the nearest, and 0 is infinitely far.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from softffd.mesh.normals import unit
from softffd.show.skin import Painter, single

Tint = tuple[float, float, float]  # a colour, 0 .. 1

FIELD = 0.29
FAINT = 0.12
"""Opacity of the lattice behind other things"""
FACES = 1 << 12
FRAGMENTS = 1 << 17
"""Faces and fragments per block: few enough to rarely request memory from the system, enough that calls cost little in a fine mesh."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A view from `eye` to `target` (3,) [m] with `up` (3,) upwards; half the height of the view is FIELD times the view's distance."""

    eye: np.ndarray
    target: np.ndarray
    up: np.ndarray

    @cached_property
    def axes(self) -> np.ndarray:
        """Rows right, above, back (3, 3) of an orthonormal frame; back points from target to eye."""
        back = (self.eye - self.target) / np.linalg.norm(self.eye - self.target)
        right = np.cross(self.up, back)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(back, right), back])


class Canvas:
    """A picture of `width` x `height` pixels seen by `camera`, on a vertical gradient between the colours `top` and `bottom`.

    The attributes `width`, `height`, `focal` [fine pixels] and `depth` (height * width,) describe the fine picture.
    """

    def __init__(self, camera: Camera, width: int, height: int, *, top: Tint = (0.985, 0.99, 1.0), bottom: Tint = (0.88, 0.90, 0.93)):
        self.camera, self.width, self.height = camera, 2 * width, 2 * height
        share = np.linspace(0.0, 1.0, self.height, dtype=np.float32)[:, None]
        rows = [(1 - share) * single(high) + share * single(low) for high, low in zip(top, bottom, strict=True)]
        self._colour = np.repeat(rows, self.width, axis=2).reshape(3, -1)
        self.depth = np.zeros(self.width * self.height, dtype=np.float32)
        self.focal = self.height / (2 * FIELD)
        self._key = unit(camera.axes.T @ [-0.45, 0.35, 0.55] + 0.6 * np.asarray(camera.up))

    def image(self) -> np.ndarray:
        """Returns the picture (height, width, 3), values 0 .. 1."""
        fine = self._colour.reshape(3, self.height // 2, 2, self.width // 2, 2)
        mean = (fine[:, :, 0, :, 0] + fine[:, :, 0, :, 1] + fine[:, :, 1, :, 0] + fine[:, :, 1, :, 1]) / 4
        return np.moveaxis(mean.clip(0, 1), 0, -1)

    def project(self, points: np.ndarray) -> np.ndarray:
        """Returns the screen positions (N, 3) of points (N, 3) [m]: x, y in fine pixels from the upper left corner, and depth."""
        seen = (points - self.camera.eye) @ self.camera.axes.T
        depth = 1.0 / np.maximum(-seen[:, 2], 1e-9)
        x = self.width / 2 + self.focal * seen[:, 0] * depth
        return np.stack([x, self.height / 2 - self.focal * seen[:, 1] * depth, depth], axis=1)

    def triangles(self, points: np.ndarray, faces: np.ndarray, normals: np.ndarray, paint: Painter) -> None:
        """Draws `faces` (F, 3) of `points` (V, 3) [m].

        normals: at the corners of the faces, (F, 3, 3), with either sign. paint: returns the colours (3, P), 0 .. 1, at places on the
        surface, given by face (P,) and barycentric coordinates (3, P).
        """
        screen = self.project(points)
        shown, nearest = self._nearest(screen, faces)
        seen, number = np.unique(nearest, return_inverse=True)  # per-face data only for visible faces, often few of many
        corners = faces[seen].T
        facets = self._facets(*(points[each].T for each in corners))
        normals = single(normals[seen]).transpose(2, 1, 0).copy()
        edges = edge_functions(*screen[corners].transpose(2, 0, 1)[:2])
        for low in range(0, len(shown), FRAGMENTS):
            pixel, face, here = (each[low : low + FRAGMENTS] for each in (shown, nearest, number))
            share = single(shares(edges, pixel, here, self.width))
            normal = np.einsum("kp,akp->ap", share, normals.take(here, axis=2))
            length = np.sqrt(_dot(normal, normal))
            length[length == 0] = 1
            length[_dot(normal, facets.take(here, axis=1)) < 0] *= -1
            self._colour[:, pixel] = self._lit(normal, length, single(paint(face, share)) ** 2.2)

    def _nearest(self, screen: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Returns the pixels (P,) where one of the faces is the nearest thing, and these faces (P,); stores their depths."""
        nearest = np.full(len(self.depth), -1, dtype=np.int32)
        for pixel, face, depth in fragments(screen, faces, self.width, self.height):
            near = np.flatnonzero(depth >= self.depth[pixel])
            pixel, face, depth = pixel[near], face[near], depth[near]
            np.maximum.at(self.depth, pixel, depth)
            won = depth == self.depth[pixel]
            nearest[pixel[won]] = face[won]
        shown = np.flatnonzero(nearest >= 0)
        return shown, nearest[shown]

    def _facets(self, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Returns the normals (3, F), towards the eye, of triangles with these corners (3, F)."""
        facets = np.cross(b - a, c - a, axis=0)
        return facets * np.where(_dot(facets, self.camera.eye[:, None] - a) < 0, -1.0, 1.0)

    def _lit(self, normal: np.ndarray, length: np.ndarray, colour: np.ndarray) -> np.ndarray:
        """Returns lit screen colours (3, P) from linear colours (3, P) and normals (3, P). length: of the normals (P,), negative for a
        normal that has to be reversed to point to the eye's side."""
        key, up, back = single([self._key, self.camera.up, self.camera.axes[2]])

        def along(direction: np.ndarray) -> np.ndarray:
            return _dot(direction[:, None], normal) / length

        diffuse = ((along(key) + 0.15) / 1.15).clip(0, None)
        sky = 0.5 + 0.5 * along(up)
        gloss = along(unit(key + back)).clip(0.5, None) ** 70  # below 0.5 the power is negligible, but slow to compute
        rim = np.square(np.square(1 - along(back).clip(0, 1)))
        light = colour * (0.12 + 0.26 * sky + 0.80 * diffuse) + 0.28 * gloss + 0.14 * rim * sky
        return light.clip(0, 1) ** (1 / 2.2)

    def lines(self, points: np.ndarray, ends: np.ndarray, *, width: float = 1.0, colour: Tint = (0.1, 0.12, 0.16)) -> None:
        """Draws the segments points[ends], ends (E, 2), `width` pixels wide; parts behind other things are faint."""
        screen = self.project(points)
        a, b = screen[ends[:, 0]], screen[ends[:, 1]]
        along = unit((b - a)[:, :2] + [1e-9, 0.0])
        side = np.hstack([along[:, 1:], -along[:, :1], np.zeros((len(a), 1))]) * width
        corners = np.stack([a - side, a + side, b - side, b + side], axis=1).reshape(-1, 3)
        quads = 4 * np.arange(len(a))[:, None, None] + np.array([[0, 1, 2], [1, 3, 2]])
        for pixel, _, depth in fragments(corners, quads.reshape(-1, 3), self.width, self.height):
            self.blend(pixel, colour, np.where(depth >= 0.999 * self.depth[pixel], 0.75, FAINT))

    def balls(self, points: np.ndarray, *, radius: float, colours: np.ndarray) -> None:
        """Draws balls of `radius` pixels, colours (N, 3), at points (N, 3) [m], in front of what they touch; hidden balls are faint."""
        screen, reach = self.project(points), 2 * radius
        for (x, y, depth), colour in sorted(zip(screen, colours, strict=True), key=lambda ball: ball[0][2]):
            columns = np.arange(max(0, int(x - reach)), min(self.width, int(x + reach) + 2))
            rows = np.arange(max(0, int(y - reach)), min(self.height, int(y + reach) + 2))[:, None]
            right, above = (columns + 0.5 - x) / reach, (y - rows - 0.5) / reach
            inside = right**2 + above**2 < 1
            pixel = (rows * self.width + columns)[inside]
            right, above = (np.broadcast_to(v, inside.shape)[inside] for v in (right, above))
            front = np.sqrt(1 - right**2 - above**2)
            light = 0.55 + 0.5 * (-0.4 * right + 0.7 * above + 0.6 * front).clip(0)
            seen = depth >= 0.99 * self.depth[pixel]
            self.depth[pixel[seen]] = depth
            self.blend(pixel, np.multiply.outer(colour, light), np.where(seen, 1.0, FAINT))

    def sight(self) -> tuple[np.ndarray, np.ndarray]:
        """Returns the slopes of the rays through the fine pixels relative to the view: rightwards (width,), upwards (height,)."""
        x = np.arange(self.width, dtype=np.float32) + 0.5 - self.width / 2
        y = self.height / 2 - np.arange(self.height, dtype=np.float32) - 0.5
        return x / self.focal, y / self.focal

    def in_pixels(self, held: np.ndarray) -> np.ndarray:
        """Packs a mask `held` (height, width) of fine pixels by pixel (P,): four bytes of a number, left to right, then down."""
        pairs = held.view(np.uint16)
        return np.stack([pairs[::2], pairs[1::2]], axis=-1).view(np.uint32).ravel()

    def lay(self, pixel: np.ndarray, shown: np.ndarray, colour: np.ndarray, opacity: np.ndarray) -> None:
        """Blends colours (3, P) with opacity (P,) over the fine pixels of pixels `pixel` (P,) that `shown` (P,) of `in_pixels` marks."""
        row, column = np.divmod(pixel, self.width // 2)
        first = 2 * (row * self.width + column)
        for fine, here in zip((0, 1, self.width, self.width + 1), shown.view(bool).reshape(-1, 4).T, strict=True):
            self.blend(first + fine, colour, opacity * here)

    def blend(self, pixel: np.ndarray, colour: Tint | np.ndarray, opacity: np.ndarray) -> None:
        """Blends `colour` (3,) or (3, P) with `opacity` (P,) over the fine pixels `pixel` (P,)."""
        for channel, over in zip(self._colour, colour, strict=True):
            under = channel[pixel]
            channel[pixel] = under + single(opacity) * (single(over) - under)


def fragments(screen: np.ndarray, faces: np.ndarray, width: int, height: int) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Rasterises triangles: yields the covered pixels (P,), their faces (P,) and depths (P,), in blocks.

    screen: (V, 3) as from `Canvas.project`. A pixel is covered if its centre is inside the triangle or on its edge.
    """
    places = np.ascontiguousarray(screen.T)  # `take` would copy a non-contiguous array whole at each call
    for start in range(0, len(faces), FACES):
        corners = places.take(faces[start : start + FACES].T, axis=1)  # (coordinate, corner, face); `take` returns it contiguous
        edge = edge_functions(*corners[:2])
        row, face = _rows(corners[1], edge[2].sum(axis=0) > 0, height)
        slope, constant = edge[0].take(face, axis=1), (edge[1].take(face, axis=1) * (row + 0.5) + edge[2].take(face, axis=1))
        first, last = _span(slope, constant, width)
        begin = row * width
        constant += slope * (0.5 - begin)  # slope now multiplies a pixel's number, not its column's centre
        heights = corners[2].take(face, axis=1)  # depths of the corners
        depths = [_dot(each, heights) for each in (slope, constant)]
        count = np.maximum(last - first + 1, 0)
        ends = np.cumsum(count)
        every = np.arange(FRAGMENTS, ends[-1] + FRAGMENTS, FRAGMENTS) if len(ends) else np.zeros(0)
        cuts = np.searchsorted(ends, every) + 1
        for low, high in zip([0, *cuts[:-1]], cuts, strict=False):
            n = count[low:high]
            pixel = np.repeat((begin + first)[low:high] - np.cumsum(n) + n, n)
            pixel += np.arange(len(pixel))
            depth, at_zero = (np.repeat(each[low:high], n) for each in depths)
            depth *= pixel
            depth += at_zero
            yield pixel, start + np.repeat(face[low:high], n), single(depth)


def edge_functions(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Returns the edge functions (3, 3, F) of triangles with corners x, y (3, F); 0 for a triangle without area.

    The products of a face's edge functions (first axis) with (x, y, 1) are the barycentric coordinates of its corners (second axis).
    """
    nx, ny, px, py = x[[1, 2, 0]], y[[1, 2, 0]], x[[2, 0, 1]], y[[2, 0, 1]]
    edge = np.stack([ny - py, px - nx, nx * py - px * ny])
    area = edge[2].sum(axis=0)
    return edge / np.where(area == 0, np.inf, area)


def shares(edges: np.ndarray, pixel: np.ndarray, face: np.ndarray, width: int) -> np.ndarray:
    """Returns the barycentric coordinates (3, P) of the centres of pixels (P,) in faces (P,) with the edge functions `edges`."""
    row, column = np.divmod(pixel, width)
    x, y, constant = (each.take(face, axis=1) for each in edges)
    return x * (column + 0.5) + y * (row + 0.5) + constant


def _rows(y: np.ndarray, real: np.ndarray, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns all pairs of a row (R,) and a face (R,) that may overlap, for those faces with corners at y (3, F) that are `real` (F,)."""
    low = np.ceil(y.min(axis=0) - 0.5).clip(0, height).astype(np.int64)
    high = np.floor(y.max(axis=0) - 0.5).clip(-1, height - 1).astype(np.int64)
    count = np.where(real, np.maximum(high - low + 1, 0), 0)
    face = np.repeat(np.arange(len(real)), count)
    return np.repeat(low - np.cumsum(count) + count, count) + np.arange(count.sum()), face


def _span(slope: np.ndarray, constant: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns the first and last column of each row whose centres have slope * x + constant >= 0 for all three edges."""
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = -constant / slope
    low = np.where(slope > 0, bound, np.where((slope == 0) & (constant < 0), np.inf, -np.inf)).max(axis=0)
    high = np.where(slope < 0, bound, np.inf).min(axis=0)
    return np.ceil(low - 0.5).clip(0, width).astype(np.int64), np.floor(high - 0.5).clip(-1, width - 1).astype(np.int64)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Returns the dot products (P,) of vectors (3, P), without the linear algebra library, whose threads go on spinning after each call."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
