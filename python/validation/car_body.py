"""The body of the demonstration car: a loft made of formulas.

The loft is a grid of stations and rows, with one closed loop of points at each station x along the car. Half a loop runs
from the middle of the floor outwards, up the inner wall of the wheel arch, out under the roof of the arch, up the side to the
belt line, past the window to the rail of the roof and inwards to the middle of the roof. The other half is the mirror
image:

            rail .---------------. rail      rows   0- 2  floor
                /     window      \\                 3- 5  wheel arch (a low step between the wheels)
          belt |                   |                6-11  side
               |       side        |               12-17  window (folded flat beside bonnet and boot)
               |__   _________   __|               18-23  roof, bonnet, boot
             arch |__|  floor |__|

Stations lie where the shape changes: on the circles of the wheel arches, at the edges of the windows, and close together
at both ends of the car, which are rounded off to a flat bumper. All lengths are in m and hold before the car is fitted to
its bounding box.
"""

import numpy as np

AXLE_X, AXLE_Z, ARCH = 1.24, 0.31, 0.375
"""Position of the wheel axles and radius of the wheel arches."""

_TIP, _END = 1.80, 2.0
_FLOOR = np.array([0.0, 0.5, 1.0])
_SIDE_LOW = np.array([0.0, 0.15, 0.45, 0.75])
_SIDE_HIGH = np.array([0.0, 0.5])
_WINDOW = np.array([0.0, 0.10, 0.16, 0.50, 0.86, 0.92])
_ROOF = np.array([1.0, 0.93, 0.87, 0.60, 0.30, 0.0])
_ROWS = 24

_UNDERSIDE_ROWS, _PANE_ROWS, _SCREEN_ROWS = 5, (13, 17), (19, 23)
_SIDE_PANES = [(-1.13, -0.445), (-0.355, 0.58)]
_SCREENS = [(-1.44, -0.88), (0.09, 0.76)]
_SINK = 0.014
_ACROSS, _BOW = np.array([1.0, 0.78, 0.5, 0.2, -0.2, -0.5, -0.78, -1.0]), 0.02
"""Columns of the panels at both ends (fractions of the half width), and the bulge of the panels (fraction of the length)."""


def body() -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Returns the vertices (V, 3), the faces (F, 3) and the colour name of each face."""
    half = _rounded_ends(_half_grid())
    panes = _pane_cells(half)
    half = _sunk(half, panes)
    loops = np.concatenate([half, half[:, -2:0:-1] * [1, -1, 1]], axis=1)
    index = np.arange(loops.shape[0] * loops.shape[1]).reshape(loops.shape[:2])
    colours = _half_colours(panes)
    shell = cells(index, np.concatenate([colours, colours[:, ::-1]], axis=1), closed=True)
    vertices = loops.reshape(-1, 3)
    vertices, front = _end(vertices, index[-1], half.shape[1], _front_colours())
    vertices, rear = _end(vertices, index[0], half.shape[1], _rear_colours())
    faces = [shell[0], front[0], rear[0][:, ::-1]]
    return vertices, np.vstack(faces), [*shell[1], *front[1], *rear[1]]


def _course(x: np.ndarray, knots: dict[float, float], rounding: float = 0.09) -> np.ndarray:
    """Returns the values at x of straight lines between the knots {x: value}, with corners rounded over +-`rounding`."""
    offsets = np.linspace(-1, 1, 41)
    bell = (1 - offsets**2) ** 2
    values = np.interp(np.asarray(x)[..., None] + rounding * offsets, list(knots), list(knots.values()))
    return values @ bell / bell.sum()


def _belt(x: np.ndarray) -> np.ndarray:
    height = {-2.0: 0.80, -1.7: 0.87, -1.2: 0.89, -0.4: 0.875, 0.85: 0.86, 1.3: 0.815, 1.8: 0.71, 2.0: 0.64}
    return _course(x, height, 0.15)


def _rail(x: np.ndarray) -> np.ndarray:
    """Returns the height of the roof rail, or on bonnet and boot the height of the edge between side and top."""
    lift = {-2.0: 0.03, -1.5: 0.04, -0.83: 0.405, -0.35: 0.44, 0.08: 0.425, 0.82: 0.04, 1.4: 0.03, 2.0: 0.025}
    return _belt(x) + _course(x, lift)


def _rail_y(x: np.ndarray) -> np.ndarray:
    return _course(x, {-2.0: 0.66, -1.50: 0.69, -0.83: 0.56, 0.08: 0.57, 0.82: 0.69, 1.4: 0.67, 2.0: 0.60})


def _crown(x: np.ndarray) -> np.ndarray:
    """Returns the height of the middle of the roof above the rail."""
    return _course(x, {-2.0: 0.03, -1.50: 0.045, -0.83: 0.065, 0.08: 0.07, 0.82: 0.075, 1.6: 0.06, 2.0: 0.04})


def _side_y(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Returns half the width at height z. The body is widest at 0.58, drawn in at both ends, and has a lip round the arches."""
    half = _course(x, {-2.0: 0.765, -1.6: 0.80, -1.0: 0.825, 1.0: 0.825, 1.6: 0.80, 2.0: 0.74}, 0.25)
    lean = np.where(z > 0.58, 0.35, 0.55) * (z - 0.58) ** 2
    ring = np.hypot(np.abs(x) - AXLE_X, z - AXLE_Z) - ARCH
    return half - lean + 0.03 * np.exp(-((ring / 0.06) ** 2))


def _lower_edge(x: np.ndarray) -> np.ndarray:
    """Returns the height of the lower edge of the side: the sill, or the circle over a wheel."""
    inside = ARCH**2 - (np.abs(x) - AXLE_X) ** 2
    sill = _course(x, {-2.0: 0.25, -1.5: 0.185, 1.5: 0.185, 2.0: 0.24})
    return np.where(inside > -1e-9, AXLE_Z + np.sqrt(np.maximum(inside, 0)), sill)


def _stations() -> np.ndarray:
    """Returns the positions x of the loops, from the rear to the front."""
    arch = ARCH * np.cos(np.radians([0, 15, 31, 47, 62, 76, 90, 104, 118, 133, 149, 165, 180]))
    arch = np.concatenate([[-ARCH - 0.004], arch, [ARCH + 0.004]])
    end = _TIP + (_END - _TIP) * np.sin(np.radians([0, 25, 48, 70, 90]))
    rear_doors, pillar = [-0.80, -0.62, -0.475], [-0.44, -0.36]
    front_doors, screen = [-0.325, -0.12, 0.05], [0.085, 0.24, 0.41, 0.575, 0.73, 0.765, 0.82]
    cabin = np.concatenate([rear_doors, pillar, front_doors, screen])
    return np.sort(np.concatenate([-end, [-1.71], arch - AXLE_X, cabin, arch + AXLE_X, [1.71], end]))


def _half_grid() -> np.ndarray:
    """Returns the left half of the loops (stations, rows, 3), before the ends of the car are rounded."""
    x = _stations()[:, None]
    floor = _course(x, {-2.0: 0.30, -1.5: 0.215, 1.5: 0.215, 2.0: 0.28})
    low, belt, rail, inner = _lower_edge(x), _belt(x), _rail(x), 0.54
    crease = belt - 0.085
    side = np.hstack([low + 0.006 + (crease - low) * _SIDE_LOW, crease + (belt - crease) * _SIDE_HIGH])
    belt_y, rail_y, bulge = _side_y(x, belt), _rail_y(x), 0.02 * np.sin(np.pi * _WINDOW)
    bands = [
        (inner * _FLOOR, floor),
        (inner, (floor + low) / 2),
        (inner, low),
        (_side_y(x, low) - 0.02, low),
        (_side_y(x, side), side),
        (belt_y + (rail_y - belt_y) * _WINDOW + bulge, belt + (rail - belt) * _WINDOW),
        (rail_y * _ROOF, rail + _crown(x) * (1 - _ROOF**2)),
    ]
    return np.concatenate([np.stack(np.broadcast_arrays(x, y, z), axis=-1) for y, z in bands], axis=1)


def _rounded_ends(half: np.ndarray) -> np.ndarray:
    """Returns the loops with those beyond the tip drawn towards a flat bumper, along a quarter of an ellipse."""
    x, rows = half[:, :1, 0], np.linspace(0, 1, half.shape[1])
    width = 0.64 * (1 - np.abs(2 * rows - 1) ** 6) ** 0.5
    height = np.where(x > 0, 0.34 + 0.27 * rows, 0.34 + 0.41 * rows)
    bumper = np.stack(np.broadcast_arrays(width, height), axis=-1)
    depth = np.clip((np.abs(x) - _TIP) / (_END - _TIP), 0, 1)
    rounded = half.copy()
    rounded[..., 1:] = bumper + np.sqrt(1 - depth**2)[..., None] * (half[..., 1:] - bumper)
    return rounded


def _pane_cells(half: np.ndarray) -> np.ndarray:
    """Returns a mask (stations - 1, rows - 1) of the cells of the half grid that are glass."""
    x = half[:, 0, 0]
    middle = (x[1:] + x[:-1]) / 2
    glass = np.zeros((half.shape[0] - 1, half.shape[1] - 1), dtype=bool)
    for panes, (low, high) in ((_SIDE_PANES, _PANE_ROWS), (_SCREENS, _SCREEN_ROWS)):
        for rear, front in panes:
            glass[(middle > rear) & (middle < front), low:high] = True
    return glass


def _sunk(half: np.ndarray, panes: np.ndarray) -> np.ndarray:
    """Returns the half grid with the inner points of the panes moved inwards, so that each pane lies in a frame."""
    around = np.pad(panes, ((1, 1), (1, 1)))
    around[:, -1] = around[:, -2]
    inner = around[1:, 1:] & around[:-1, 1:] & around[1:, :-1] & around[:-1, :-1]
    normal = np.cross(np.gradient(half, axis=1), np.gradient(half, axis=0))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True) + 1e-12
    normal[:, -1, 1] = 0.0
    return half - _SINK * inner[..., None] * normal


def _half_colours(panes: np.ndarray) -> np.ndarray:
    colours = np.full(panes.shape, "paint", dtype=object)
    colours[:, :_UNDERSIDE_ROWS] = "trim"
    colours[panes] = "glass"
    return colours


def _front_colours() -> np.ndarray:
    colours = np.full((_ROWS - 1, len(_ACROSS) - 1), "paint", dtype=object)
    colours[6:13, 1:-1] = "trim"
    return colours


def _rear_colours() -> np.ndarray:
    colours = np.full((_ROWS - 1, len(_ACROSS) - 1), "paint", dtype=object)
    colours[15:20, :2] = colours[15:20, -2:] = "tail"
    colours[9:14, 3:-3] = "lamp"
    return colours


def _end(vertices: np.ndarray, loop: np.ndarray, rows: int, colours: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, list[str]]]:
    """Returns the vertices extended by a bowed panel that closes the loop, and the faces (facing +x) and colours of the panel."""
    left, right = loop[:rows], np.roll(loop[::-1], 1)[:rows]
    across = _ACROSS[1:-1]
    shape = np.stack([1 + _BOW * (1 - across**2), across, np.ones_like(across)], axis=1)
    inner = vertices[left[1:-1], None] * shape
    index = np.repeat(left[:, None], len(_ACROSS), axis=1)
    index[:, -1] = right
    index[1:-1, 1:-1] = len(vertices) + np.arange(inner[..., 0].size).reshape(inner.shape[:2])
    return np.vstack([vertices, inner.reshape(-1, 3)]), cells(index.T, colours.T, closed=False)


def cells(index: np.ndarray, colours: np.ndarray, *, closed: bool) -> tuple[np.ndarray, list[str]]:
    """Returns two triangles for each cell of a grid, and their colours. Triangles with coincident corners are left out.

    index: numbers of the vertices (a, b); first axis x second axis points inwards. closed: the second axis is a
    loop. colours: names, (a - 1, b) if closed, else (a - 1, b - 1).
    """
    upwards = np.roll(index, -1, axis=1) if closed else index[:, 1:]
    index = index if closed else index[:, :-1]
    quads = np.stack([index[:-1], upwards[:-1], upwards[1:], index[1:]], axis=-1).reshape(-1, 4)
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return faces[whole], list(np.repeat(colours.reshape(-1), 2)[whole])
