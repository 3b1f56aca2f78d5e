import numpy as np
import pytest

from softffd.show.raster import Camera, Canvas, edge_functions, fragments, shares
from softffd.show.raster_plane import Patch, draw_plane

EAST, NORTH, UP = np.eye(3)
GROUND = Patch(np.zeros(3), UP, EAST, np.zeros(3), 6.0, 100.0, (0.6, 0.6, 0.6))


def canvas(*, eye=(0.0, -10.0, 0.0), size=100):
    return Canvas(Camera(np.array(eye), np.zeros(3), UP), size, size, top=(1, 1, 1), bottom=(1, 1, 1))


def plain(*colour):
    return lambda face, _share: np.tile(np.float32(colour)[:, None], len(face))


def square(y, half=1.0):
    points = np.array([[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]])
    return points, np.array([[0, 1, 2], [0, 2, 3]]), np.tile([0.0, -1.0, 0.0], (2, 3, 1))


def test_two_triangles_cover_each_pixel_of_a_rectangle_once():
    corners = np.array([[3.2, 4.3, 1], [17.7, 4.3, 1], [17.7, 9.9, 1], [3.2, 9.9, 1]])
    pixels = np.concatenate([p for p, *_ in fragments(corners, np.array([[0, 1, 2], [0, 2, 3]]), 20, 12)])
    wanted = [20 * row + column for row in range(4, 10) for column in range(3, 18)]
    assert sorted(set(pixels)) == wanted
    assert len(pixels) - len(wanted) <= 1


def test_shares_reproduce_the_place_of_the_pixel():
    corners = np.array([[1.0, 2.0, 0.3], [60.0, 7.0, 0.5], [20.0, 50.0, 0.9]])
    faces = np.array([[2, 1, 0]])
    for pixel, face, depth in fragments(corners, faces, 64, 64):
        place = shares(edge_functions(*corners[faces.T].transpose(2, 0, 1)[:2]), pixel, face, 64).T @ corners[[2, 1, 0]]
        assert np.allclose(place[:, 0], pixel % 64 + 0.5) and np.allclose(place[:, 1], pixel // 64 + 0.5)
        assert np.allclose(depth, place[:, 2], atol=1e-6)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_the_nearer_square_hides_the_farther_whatever_the_order(order):
    drawn = canvas()
    for which in order:
        drawn.triangles(*square((-1.0, 1.0)[which]), plain(*[(1, 0, 0), (0, 0, 1)][which]))
    red, _, blue = drawn.image()[50, 50]
    assert red > blue


def test_a_surface_is_lit_alike_whichever_way_its_normals_point():
    points, faces, normals = square(0.0)
    images = []
    for turned in (normals, -normals):
        drawn = canvas()
        drawn.triangles(points, faces, turned, plain(0.2, 0.4, 0.6))
        images.append(drawn.image())
    assert np.array_equal(*images)


def test_a_square_covers_its_share_of_the_picture():
    drawn = canvas(size=200)
    drawn.triangles(*square(0.0), plain(0, 0, 0))
    covered = (drawn.image()[..., 0] < 0.99).sum()
    side = 200 * 2.0 / (2 * 0.29 * 10)
    assert abs(covered - side**2) < 4 * side


def test_lines_behind_something_are_fainter():
    drawn = canvas()
    drawn.triangles(*square(0.0), plain(1, 1, 1))
    shaded = drawn.image()
    drawn.lines(np.array([[-3.0, 2, 0], [3.0, 2, 0]]), np.array([[0, 1]]), colour=(0, 0, 0))
    change = (shaded - drawn.image())[49:51].max(axis=(0, 2))
    assert 0 < change[50] < 0.5 * change[10]


def test_a_plane_darkens_under_the_object_and_not_far_from_it():
    drawn = canvas(eye=(0.0, -10.0, 6.0))
    box = np.array([[-1, -1, 0.2], [1, -1, 0.2], [1, 1, 0.2], [-1, 1, 0.2]], float), np.array([[0, 1, 2], [0, 2, 3]])
    ground = Patch(np.array([50.0, 50.0, 0]), UP, EAST, np.zeros(3), 6.0, 100.0, (0.6, 0.6, 0.6))
    draw_plane(drawn, ground, surfaces=[box])
    places = np.array([[0.0, 0.0, 0.0], [2.5, 0.0, 0.0]])
    under, beside = (drawn.image()[int(y) // 2, int(x) // 2].mean() for x, y, _ in drawn.project(places))
    assert under < 0.7 * beside


def test_the_solid_side_of_a_plane_is_hatched_and_hides_little():
    """By stripes on a fifth of it; black, so that what is seen is how much it covers."""
    images = []
    for height in (6.0, -6.0):
        drawn = canvas(eye=(0.0, -10.0, height))
        draw_plane(drawn, Patch(np.zeros(3), UP, EAST, np.array([0.0, 0.0, 0.0]), 6.0, 2.0, (0.0, 0.0, 0.0)))
        at = drawn.project(np.column_stack([np.linspace(-1.9, 1.9, 200), np.full((200, 2), [0.3, 0.0])]))
        images.append(1 - drawn.image()[(at[:, 1] / 2).astype(int), (at[:, 0] / 2).astype(int)].mean(axis=1) / 0.94)
    front, back = images
    assert np.median(front) > 0.55 and np.quantile(back, 0.3) < 0.15 and np.quantile(back, 0.95) > 0.28


def test_each_surface_above_a_plane_casts_a_shadow_and_none_below_it():
    faces, places = np.array([[0, 1, 2], [0, 2, 3]]), np.array([[-3.0, 0.0, 0.0], [0.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
    surfaces = [(np.array([[x - 1, -1, z], [x + 1, -1, z], [x + 1, 1, z], [x - 1, 1, z]], float), faces) for x, z in ((-3, 0.2), (3, -0.2))]
    drawn = canvas(eye=(0.0, -10.0, 6.0))
    draw_plane(drawn, GROUND, surfaces=surfaces)
    first, middle, last = (drawn.image()[int(y) // 2, int(x) // 2].mean() for x, y, _ in drawn.project(places))
    assert first < 0.7 * last and abs(middle - last) < 0.1


def test_a_very_fine_mesh_casts_the_shadow_of_a_coarse_one():
    images = []
    for cells in (4, 300):
        x, y = (v.ravel() for v in np.meshgrid(*[np.linspace(-1, 1, cells + 1)] * 2, indexing="ij"))
        corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
        faces = np.concatenate([corner[:, None] + step for step in ([0, cells + 1, 1], [1, cells + 1, cells + 2])])
        drawn = canvas(eye=(0.0, -10.0, 6.0))
        draw_plane(drawn, GROUND, surfaces=[(np.stack([x, y, 0 * x + 0.5], axis=1), faces)])
        images.append(drawn.image())
    assert np.abs(images[0] - images[1]).max() < 0.05


def test_an_object_before_a_plane_is_not_tinted():
    drawn = canvas()
    drawn.triangles(*square(-1.0), plain(0.1, 0.5, 0.1))
    before = drawn.image()[50, 50]
    draw_plane(drawn, Patch(np.zeros(3), -NORTH, EAST, np.zeros(3), 5.0, 1.0, (1, 0, 0)))
    assert np.array_equal(drawn.image()[50, 50], before)
    assert not np.allclose(drawn.image()[20, 50], 1.0)


def test_a_plate_ends_at_its_edge_and_at_the_floor():
    drawn = canvas(size=200)
    floor = (np.array([0.0, 0.0, -0.5]), UP)
    plate = Patch(np.zeros(3), -NORTH, EAST, np.zeros(3), 2.0, 9.0, (1, 0, 0), np.array([2.0, 1.0]), (floor,))
    draw_plane(drawn, plate)
    rows, columns = np.nonzero(drawn.image()[..., 1] < 0.95)
    pixels_per_metre = 200 / (2 * 0.29 * 10)
    assert np.isclose(np.ptp(columns), 4.0 * pixels_per_metre, atol=2)
    assert np.isclose(rows.min(), 100 - 1.0 * pixels_per_metre, atol=2)
    assert np.isclose(rows.max(), 100 + 0.5 * pixels_per_metre, atol=2)


def test_a_plate_covers_its_exact_part_of_the_pixels_at_its_edge():
    def covered(half):
        drawn = canvas(size=200)
        draw_plane(drawn, Patch(np.zeros(3), -NORTH, EAST, np.zeros(3), 2.0, 90.0, (1, 0, 0), np.array([half, 1.0])))
        return (1 - drawn.image()[100, :, 1]).sum()

    pixel = 2 * 0.29 * 10 / 200
    grown = [covered((30 + (n + 1) / 8) * pixel) - covered((30 + n / 8) * pixel) for n in range(8)]
    exact = 2 / 8 * 0.45  # two edges, an eighth of a pixel each
    assert 0.5 * exact < min(grown) and max(grown) < 2 * exact
