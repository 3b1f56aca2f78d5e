"""Crushed cells: what a lattice of springs does not come back from, and what [material] volume_stiffness does about it."""

import numpy as np
import pytest

from scenes import box, table_and_press
from stepping import Stepper

STIFFNESS, EDGE = 1e3, 1 / 3
ENOUGH = 3 * STIFFNESS / EDGE
"""Volume stiffness [Pa] that unfolds the box from a twentieth of its height."""

H = 0.01
CASES = [("auto", 0.0), ("leapfrog", 0.0), ("leapfrog", 1e-3), ("ros34pw2", 0.0)]
"""Methods and given internal steps that the crush of the soft box is run with; all of them step explicitly through contact."""
STIFF = [("auto", 1e6), ("backward_euler", 1e8), ("ros34pw2", 1e6), ("backward_euler", 1e9)]
"""Methods and stiffnesses [N/m]; backward_euler passes over the impacts."""


def eased(t):
    """0 before 0, 1 after 1, with two continuous derivatives."""
    u = min(max(t, 0.0), 1.0)
    return u**3 * (10 - 15 * u + 6 * u**2)


def press_height(t, share):
    """Down to a share of the box's height in 0.5 s, held until 1 s, out of the way by 1.2 s."""
    return 1 - (1 - share) * eased(t / 0.5) if t <= 1 else share + (3 - share) * eased((t - 1) / 0.2)


def corner_volumes(positions):
    """Volumes at the eight corners of every cell relative to rest, (8, 3, 3, 3), of a 4 x 4 x 4 cube of side 1."""
    grid = positions.reshape(4, 4, 4, 3)  # z, y, x
    x, y, z = (np.diff(grid, axis=axis) / EDGE for axis in (2, 1, 0))

    def volume(a, b, c):
        edges = x[c : 3 + c, b : 3 + b], y[c : 3 + c, :, a : 3 + a], z[:, b : 3 + b, a : 3 + a]
        return np.linalg.det(np.stack(edges, axis=-1))

    return np.array([volume(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)])


def crush(body, share, *, until=3.0):
    """Runs the crush; returns the number of folded cells after each communication step."""
    folded = []
    while body.time < until - 0.5 * H:
        now, after = (press_height(t, share) for t in (body.time, body.time + H))
        body.set({"plane.press.point.z": now, "plane.press.velocity.z": (after - now) / H})
        body.step(H)
        folded.append(body.number("solver.folded_cells"))
    return folded


def press(volume_stiffness, method="auto", step=0.0, stiffness=STIFFNESS):
    """The box under the press, initialized."""
    scene = box(
        stiffness=stiffness, damping=0.1, volume_stiffness=volume_stiffness, plane=table_and_press(friction=0.4), energy=True,
        outputs={"solver": True}, method=method, step=step, stop_time=3.0,
    )  # fmt: skip
    return Stepper(scene, stop_time=3.0)


@pytest.mark.short("leapfrog-*-0.2", "auto-0.0-0.05", "ros34pw2-0.0-0.4")
@pytest.mark.parametrize("share", [0.4, 0.2, 0.05])
@pytest.mark.parametrize(("method", "step"), CASES)
def test_with_volume_stiffness_a_crushed_box_comes_back(method, step, share):
    with press(ENOUGH, method, step) as body:
        crush(body, share)
        volumes = corner_volumes(body.points())
        assert volumes.min() > 0.99 and volumes.max() < 1.01
        assert body.number("solver.folded_cells") == 0


@pytest.mark.short("backward_euler-100000000.0-*")
@pytest.mark.parametrize("share", [0.4, 0.2, 0.05])
@pytest.mark.parametrize(("method", "stiffness"), STIFF)
def test_a_stiff_box_that_was_crushed_comes_back(method, stiffness, share):
    """Pressed by what moves it is loud, and buckles: explicit steps; what is left at the end is vibration, which damping takes."""
    with press(3 * stiffness / EDGE, method, stiffness=stiffness) as body:
        crush(body, share)
        if method == "backward_euler":
            assert body.methods()[0][0] == "backward Euler with contact"
        else:
            methods = body.methods()
            begun = 1 if methods[0][0] == "backward Euler with contact" else 0  # it may rest on the table before
            assert methods[begun] == ("leapfrog", "a stiff body hits an obstacle, or vibrates on one")
        volumes = corner_volumes(body.points())
        left = 1e-6 if method == "backward_euler" else 1e-4
        assert volumes.min() > 1 - left and volumes.max() < 1 + left
        assert body.number("solver.folded_cells") == 0


@pytest.mark.parametrize("share", [0.4, 0.2, 0.05])
def test_without_it_the_box_stays_folded_and_says_so_once(share):
    with press(0.0) as body:
        folded = crush(body, share)
        volumes = corner_volumes(body.points())
        assert volumes.min() == pytest.approx(-1, abs=0.01)
        assert folded[-1] == (volumes <= 0).any(axis=0).sum() > 0
        (warning,) = body.said("inverted")
        first = next(n for n, count in enumerate(folded) if count)
        cells = f"{folded[first]} of the lattice's cells {'is' if folded[first] == 1 else 'are'} inverted"
        assert f"at time {(first + 1) * H:.9g} s {cells}" in warning and "[material] volume_stiffness" in warning


def test_a_box_that_does_not_fold_gets_no_warning():
    with press(0.0) as body:
        assert not any(crush(body, 0.6))
        assert not body.said("inverted")


def test_a_box_that_starts_folded_is_warned_of_at_once_and_after_a_reset_again():
    with Stepper(box(stretch=[1.0, 1.0, -1.0])) as body:
        assert [text.split(" s ")[0] for text in body.said("inverted")] == ["at time 0"]
        body.step(H, times=3)
        assert len(body.said("inverted")) == 1
        body.restart({})
        assert len(body.said("inverted")) == 1


def test_a_restored_run_does_not_repeat_the_warning():
    with press(0.0) as body:
        crush(body, 0.2, until=0.1)
        before = body.save()
        crush(body, 0.2, until=0.5)
        assert len(body.said("inverted")) == 1
        body.restore(before)
        crush(body, 0.2, until=0.5)
        assert len(body.said("inverted")) == 1


def test_the_bound_follows_a_box_that_is_crushed():
    """The stable step shrinks while corners resist, and is what it was without the stiffness once none does."""
    with press(ENOUGH) as body, press(0.0) as springs:
        free = springs.read("solver.stable_step")
        assert body.read("solver.stable_step") == free
        crush(body, 0.2, until=0.9)
        assert body.read("solver.stable_step") < 0.75 * free
        crush(body, 0.2)
        assert body.read("solver.stable_step") == pytest.approx(free, rel=0.01)


@pytest.mark.parametrize("stiffness", [1e9, 1e10])
def test_a_stiff_box_crushed_past_buckling_is_followed(stiffness):
    """It snaps through within a millionth of a second: implicit steps become that short, and only for that moment."""
    with press(0.0, "backward_euler") as body:
        body.restart({f"stiffness.{kind}": stiffness for kind in ("edge", "face", "body")}, stop_time=3.0)
        assert crush(body, 0.4, until=0.7)[-1] > 0
        assert body.points()[:, 2].max() <= 0.4 + 1e-12
        assert body.energy("kinetic", "elastic", "dissipated") == pytest.approx(body.energy("work"), rel=1e-9)
        assert body.number("solver.steps") + body.number("solver.rejected") < 200


@pytest.mark.parametrize(("method", "step"), CASES[:1])
def test_energy_balance_closes_through_folding_and_back(method, step):
    with press(ENOUGH, method, step) as body:
        crush(body, 0.05)
        # impacts are of first order in the step
        assert body.energy("kinetic", "elastic", "dissipated") == pytest.approx(body.energy("work"), rel=2e-4)
        assert body.energy("elastic") < 1e-3


def test_a_light_deformation_is_the_same_bits_with_and_without():
    """While no corner has lost half its volume there is exactly nothing."""
    for method in ("central_difference", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2"):
        ends = []
        for volume_stiffness in (0.0, ENOUGH):
            lightly = box(volume_stiffness=volume_stiffness, stretch=[1.1, 0.9, 0.8], method=method, step=1e-3)
            with Stepper(lightly) as body:
                body.step(H, times=20)
                ends.append(body.points())
        assert np.array_equal(*ends), method


@pytest.mark.parametrize("method", ["leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "auto"])
def test_every_method_feels_the_volume_stiffness(method):
    """A flattened cube of eight points without springs, from rest: d2z/dt2 from -grad psi over the first instants."""
    flat = box(points=[2, 2, 2], stiffness=0.0, damping=0.0, volume_stiffness=800.0, stretch=[1.0, 1.0, 0.2], method=method)
    pull = 800 * (0.5 - 0.2) ** 2 / 0.5  # N on a face: -dpsi/dJ of psi = kappa V0 (J0 - J)^3 / (3 J0), J being the height
    acceleration, time = pull / 0.5, 1e-3  # a face weighs half a kilogram
    with Stepper(flat) as body:
        body.step(time)
        height = np.ptp(body.points()[:, 2])
    assert height - 0.2 == pytest.approx(2 * 0.5 * acceleration * time**2, rel=2e-3)  # both faces move; the rest is the pull's own change
