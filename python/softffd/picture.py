"""Pictures of a run: its telling moments in a row, and the curves of its reactions and energies below."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from softffd.history import energies, extents, reactions
from softffd.raster import Camera, Canvas
from softffd.raster_plane import draw_plane
from softffd.stage import round_length, stage_of
from softffd.surface import ShadingNormals, face_normals

PAINT = (0.02, 0.17, 0.42)
FREE, PINNED = (0.90, 0.42, 0.05), (0.10, 0.10, 0.12)
TINTS = ((0.63, 0.67, 0.73), (0.34, 0.71, 0.91), (0.80, 0.47, 0.65), (0.0, 0.62, 0.45), (0.90, 0.62, 0.0), (0.94, 0.89, 0.26))
CURVES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d00", "#56b4e9")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))
YAW, PITCH = -1.0, 0.27
SMOOTH_FACES = 150_000
INK, SOFT = "#1b2430", "#5b6675"


def draw_run(result, path, *, mesh=None, origin=None, size=None):
    """Draw `result` to `path` (PNG): start, first contact, largest deformation, end; and the history. Returns the path.

    mesh: the object at rest, or None for the boundary of the Bezier volume. origin, size: its box (3,) [m] if not the scene's.
    Raises SoftffdError when positions of control points were not recorded.
    """
    stage = stage_of(result, mesh=mesh, origin=origin, size=size)
    moments = telling_moments(result, stage)
    figure = _figure(13.0, 7.6)
    figure.text(0.02, 0.965, stage.title, fontsize=15, fontweight="bold", color=INK, va="center")
    shapes = [_Shape(stage, frame) for frame in moments]
    captions = [f"{what}, t = {stage.time[frame]:.4g} s" for frame, what in moments.items()]
    _draw_panels(figure, stage, shapes, captions, bottom=0.42, top=0.93)
    for axes in _draw_curves(figure, result, bottom=0.085, top=0.355):
        for frame in moments:
            axes.axvline(stage.time[frame], color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)), zorder=0)
    return _save(figure, path)


def draw_strip(result, path, *, mesh=None, moments=None, labels=None, origin=None, size=None):
    """Draw a wide strip to `path` (PNG), as the paper's figure 3: the object with its lattice at several moments.

    moments: times [s], each shown by the nearest recorded frame, or None for the shape at rest; by default rest, just before
    the first contact, the largest deformation, and the end. labels: a caption for each. Returns the path.
    """
    stage = stage_of(result, mesh=mesh, origin=origin, size=size)
    if moments is None:
        moments, labels = _four_moments(result, stage), labels or ("at rest", "before", "during", "after")
    if labels is None:
        labels = ["at rest" if t is None else f"t = {t:.4g} s" for t in moments]
    if len(labels) != len(moments):
        raise ValueError(f"labels: wanted one for each of the {len(moments)} moments, got {len(labels)}")
    shapes = [_Shape(stage, None if t is None else int(np.abs(stage.time - t).argmin())) for t in moments]
    figure = _figure(3.6 * len(shapes), 3.1)
    _draw_panels(figure, stage, shapes, labels, bottom=0.0, top=1.0, margin=0.0)
    return _save(figure, path)


def draw_history(result, path):
    """Draw the curves alone to `path` (PNG): reactions [N] and energies [J], without either the object's height [m]."""
    figure = _figure(11.0, 3.6)
    _draw_curves(figure, result, bottom=0.15, top=0.93)
    return _save(figure, path)


def telling_moments(result, stage):
    """Frames worth a picture, in the order of time, with what they show: {frame: words}."""
    found = {0: "start", len(stage.time) - 1: "end"}
    contact = first_contact(result)
    if contact is not None:
        found.setdefault(contact, "first contact")
    found.setdefault(int(deformation(stage).argmax()), "largest deformation")
    return dict(sorted(found.items()))


def first_contact(result):
    """The first frame with a reaction of a plane, or None."""
    forces = [force for name, force in reactions(result).items() if name.startswith("plane.")]
    touching = np.flatnonzero(np.any([force.any(axis=1) for force in forces], axis=0)) if forces else []
    return int(touching[0]) if len(touching) else None


def deformation(stage):
    """Root mean square distance (T,) [m] of the control points from the rest shape in its best position and orientation."""
    rest = stage.rest.reshape(-1, 3)
    moved = stage.positions.reshape(len(stage.time), -1, 3)
    rest, moved = rest - rest.mean(axis=0), moved - moved.mean(axis=1, keepdims=True)
    turned = np.einsum("na,tnb->tab", rest, moved)
    stretches = np.linalg.svd(turned, compute_uv=False)
    stretches[:, 2] *= np.where(np.linalg.det(turned) < 0, -1.0, 1.0)
    squares = (rest**2).sum() + (moved**2).sum(axis=(1, 2)) - 2 * stretches.sum(axis=1)
    return np.sqrt(squares.clip(0) / len(rest))


@dataclass(frozen=True, eq=False)
class _Shape:
    """The object in one frame; frame None: at rest, without obstacles."""

    stage: object
    frame: int | None

    @cached_property
    def points(self):
        return self.stage.rest if self.frame is None else self.stage.positions[self.frame]

    @cached_property
    def vertices(self):
        return self.stage.deformed(self.points)


def _four_moments(result, stage):
    time, contact = stage.time, first_contact(result)
    worst = int(deformation(stage).argmax())
    before = max(0, (worst // 2 if contact is None else contact) - 1)
    return None, time[before], time[worst], time[-1]


def _draw_panels(figure, stage, shapes, captions, *, bottom, top, margin=0.02):
    width = (1 - 2 * margin) / len(shapes)
    normals = ShadingNormals(stage.vertices, stage.faces) if len(stage.faces) <= SMOOTH_FACES else None
    pixels = figure.get_size_inches() * figure.dpi * (width, top - bottom)
    wide, high = (int(round(n)) for n in pixels)
    sight = _common_sight(stage, shapes, wide / high)
    for i, (shape, caption) in enumerate(zip(shapes, captions, strict=True)):
        axes = figure.add_axes((margin + i * width, bottom, width, top - bottom))
        axes.set_axis_off()
        axes.imshow(_picture(stage, shape, sight, normals, wide, high), aspect="auto", interpolation="none")
        axes.text(0.5, 0.035, caption, transform=axes.transAxes, ha="center", va="bottom", fontsize=11.5, color=INK)


def _common_sight(stage, shapes, aspect):
    """Centre [m] and distance [m] from which every frame's lattice is in the picture; the shape at rest is centred for itself."""
    back, right, above = _directions(stage)
    clouds = [shape.points.reshape(-1, 3) for shape in shapes]
    moving = [c for shape, c in zip(shapes, clouds, strict=True) if shape.frame is not None] or clouds
    low, high = np.min([c.min(axis=0) for c in moving], axis=0), np.max([c.max(axis=0) for c in moving], axis=0)
    centre = (low + high) / 2
    tall = 0.80 * 0.29
    offsets = [c - (centre if shape.frame is not None else _middle(c)) for shape, c in zip(shapes, clouds, strict=True)]
    needed = [
        c @ back + np.maximum(np.abs(c @ right) / (tall * aspect), np.abs(c @ above) / tall) for c in offsets
    ]
    return centre, max(n.max() for n in needed)


def _middle(points):
    return (points.min(axis=0) + points.max(axis=0)) / 2


def _directions(stage):
    """The view's back, right and above for the stage's up: a quarter turn to the side, from a little above."""
    up = stage.up
    east = np.cross([0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [0.0, 0.0, 1.0], up)
    east /= np.linalg.norm(east)
    back = np.cos(PITCH) * (np.cos(YAW) * east + np.sin(YAW) * np.cross(up, east)) + np.sin(PITCH) * up
    right = np.cross(up, back) / np.cos(PITCH)
    return back, right, np.cross(back, right)


def _picture(stage, shape, sight, normals, width, height):
    centre, distance = sight
    target = centre if shape.frame is not None else _middle(shape.points.reshape(-1, 3))
    canvas = Canvas(Camera(target + distance * _directions(stage)[0], target, stage.up), width, height)
    surface = shape.vertices, stage.faces
    corners = normals.corners(shape.vertices) if normals else np.repeat(face_normals(*surface)[:, None], 3, axis=1)
    canvas.triangles(*surface, corners, PAINT)
    if shape.frame is not None:
        _draw_obstacles(canvas, stage, shape.frame, centre, distance, surface)
    _draw_lattice(canvas, stage, shape.points, height)
    return canvas.image()


def _draw_obstacles(canvas, stage, frame, centre, distance, surface):
    for i, plane in enumerate(stage.planes):
        draw_plane(
            canvas, plane.points[frame], plane.normals[frame], plane.tangents[frame], centre=centre, reach=0.8 * distance,
            spacing=round_length(0.15 * distance), tint=TINTS[i % len(TINTS)], surface=surface,
        )  # fmt: skip


def _draw_lattice(canvas, stage, points, height):
    flat = points.transpose(2, 1, 0, 3).reshape(-1, 3)
    colours = np.tile(FREE, (len(flat), 1))
    colours[stage.pinned] = PINNED
    canvas.lines(flat, stage.edges, width=max(0.8, height / 500))
    canvas.balls(flat, radius=height / 90 * min(1.0, 4 / max(stage.counts)), colours=colours)


def _draw_curves(figure, result, *, bottom, top):
    """One axes per kind of curve, side by side; returns them."""
    forces = {name.split(".")[1]: np.linalg.norm(force, axis=1) for name, force in reactions(result).items()}
    kinds = [("reaction [N]", forces, "steps-pre"), ("energy [J]", energies(result), "default")]
    kinds = [kind for kind in kinds if kind[1]] or [("height of the lattice [m]", _heights(result), "default")]
    width = 0.96 / len(kinds)
    made = []
    for i, (label, curves, style) in enumerate(kinds):
        axes = figure.add_axes((0.065 + i * width, bottom, width - 0.075, top - bottom))
        for k, (name, values) in enumerate(curves.items()):
            axes.plot(
                result.time, values, label=name, drawstyle=style, linewidth=1.8,
                color=CURVES[k % len(CURVES)], linestyle=DASHES[k % len(DASHES)],
            )  # fmt: skip
        _dress(axes, result.time, label)
        made.append(axes)
    return made


def _heights(result):
    low, high = extents(result)
    up = stage_of(result).up
    return {"highest point": (high @ up), "lowest point": (low @ up)}


def _dress(axes, time, label):
    axes.set_xlabel("time [s]")
    axes.set_ylabel(label)
    axes.set_xlim(time[0], time[-1] if time[-1] > time[0] else None)
    axes.grid(color="#e3e7ed", linewidth=0.8)
    axes.legend(frameon=True, framealpha=0.9, edgecolor="none", fontsize=9.5, loc="best")
    axes.spines[["top", "right"]].set_visible(False)
    axes.ticklabel_format(axis="y", scilimits=(-3, 5))


def _figure(width, height):
    """A figure of `width` x `height` inches at 130 dots per inch, without the global state of pyplot."""
    figure = Figure(figsize=(width, height), dpi=130, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def _save(figure, path):
    figure.savefig(path, format="png")
    return Path(path)
