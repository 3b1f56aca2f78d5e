"""Triangles of polygons that a fan about the first corner would not cover: ears are cut off one after another."""

import numpy as np

SMALL = 1e-9
"""An area that is less, as a share of the polygon's, is none."""


def cut_concave(positions: np.ndarray, counts: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the triangles (T, 3) of all polygons, and the number of polygons that no cutting covers: they cross themselves.

    positions: (C, 3) of the corners, one polygon after another. counts: (F,) corners of each. triangles: (T, 3) numbers of corners,
    the fans. They are kept where all triangles of a fan look the way of their polygon, which then are as large as it; so are fans of
    polygons that have no area or are not finite. Others are cut into ears, which may be slow: n^2 for n corners.
    """
    each = counts - 2
    many = np.flatnonzero(np.repeat(each > 1, each))
    a, b, c = positions[triangles[many]].transpose(1, 0, 2)
    owner, areas = np.repeat(np.arange(len(counts)), each)[many], np.cross(b - a, c - a)
    whole = np.stack([np.bincount(owner, axis, len(counts)) for axis in areas.T], axis=1)
    against = np.einsum("ij,ij->i", areas, whole[owner]) < -SMALL * np.einsum("ij,ij->i", whole, whole)[owner]
    first, begins, crossed = np.cumsum(counts) - counts, np.cumsum(each) - each, 0
    for polygon in np.unique(owner[against]):
        corners = positions[first[polygon] : first[polygon] + counts[polygon]]
        ears, sound = _ears(_seen_along(whole[polygon], corners))
        crossed += not sound
        triangles[begins[polygon] : begins[polygon] + each[polygon]] = first[polygon] + np.array(ears)
    return triangles, crossed


def _seen_along(normal: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The corners in a plane, (n, 2), in which they run counter-clockwise; sides of the order of 1."""
    normal = normal / np.linalg.norm(normal)
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    across /= np.linalg.norm(across)
    places = (corners - corners[0]) @ np.stack([across, np.cross(normal, across)], axis=1)
    return places / np.abs(places).max()


def _ears(places: np.ndarray) -> tuple[list[tuple[int, int, int]], bool]:
    """Triangles of the polygon, and whether each was an ear: it turns left and nothing lies in it.

    Where no ear is left, corners without area go first (spikes, and the ends of bridges to holes), then what turns left the most.
    """
    n = len(places)
    after, before, here = [*range(1, n), 0], [n - 1, *range(n - 1)], np.ones(n, dtype=bool)
    turn = _turns(places[before], places, places[after])
    least = SMALL * np.abs(turn).sum()
    ears = {i for i in range(n) if _is_ear(i, before, after, places, turn, here, least)}
    triangles: list[tuple[int, int, int]] = []
    sound, corner = True, 0
    while len(triangles) < n - 2:
        if ears:
            while corner not in ears:
                corner = (corner + 1) % n
        else:
            left = np.flatnonzero(here)
            flat = left[np.abs(turn[left]) <= least]
            corner = int(flat[0]) if len(flat) else int(left[turn[left].argmax()])
            sound &= len(flat) > 0
        a, c = before[corner], after[corner]
        triangles.append((a, corner, c))
        here[corner], after[a], before[c] = False, c, a
        ears.discard(corner)
        for end in (a, c):
            turn[end] = _turns(places[before[end]], places[end], places[after[end]])
        for end in (a, c):
            (ears.add if _is_ear(end, before, after, places, turn, here, least) else ears.discard)(end)
        corner = after[c]  # not the neighbour, or a circle would become a fan of slivers
    return triangles, sound


def _is_ear(corner: int, before: list[int], after: list[int], places: np.ndarray, turn: np.ndarray, here: np.ndarray, least: float) -> bool:
    a, b, c = places[before[corner]], places[corner], places[after[corner]]
    if turn[corner] <= least:
        return False
    other = here & (places != a).any(axis=1) & (places != b).any(axis=1) & (places != c).any(axis=1)
    points, straight = places[other], turn[other] <= least
    inside = np.minimum(np.minimum(_turns(a, b, points), _turns(b, c, points)), _turns(c, a, points))
    return not ((inside > least) | (straight & (inside >= -least))).any()


def _turns(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the areas of the triangles, > 0 where they turn left."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
