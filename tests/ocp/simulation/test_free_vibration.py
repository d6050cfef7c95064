"""The tip's motion after arrival, against the free decay of a damped oscillator."""

import math
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest
from sound_plant import Sound

import quietarm as qa
from quietarm.ocp import FreeVibration, perturb_plant
from quietarm.ocp.simulation.free_vibration import extreme_rows, fastest_along, outermost


def _decay(W, dW, omega, zeta, t):
    """Free decay of W'' + 2 zeta omega W' + omega^2 W = 0 in closed form."""
    damped = omega * math.sqrt(1 - zeta**2)
    sine = (dW + zeta * omega * W) / damped
    return np.exp(-zeta * omega * t) * (W * np.cos(damped * t) + sine * np.sin(damped * t))


def _arm(target):
    """Eq (13) at rest: (1 + alpha1 cos theta_E) W'' + 2 zeta omega W' + omega^2 W = 0."""
    root = math.sqrt(1 - 1.055e-1 * math.cos(target))
    return qa.ArmOnFlexibleLink(), target, [(0.508, 7.320 / root, 1.500e-3 / root)]


@pytest.mark.parametrize(
    ("plant", "target", "modes"),  # each with its tip's phi, frequency and damping ratio
    [
        (qa.SingleLinkManipulator(), math.pi / 6, [(2.28, 10.43, 9.636e-3)]),  # eqs (9), (10)
        *(_arm(target) for target in (math.pi / 2, 0.3, -2.0)),
        (
            qa.DualLinkManipulator(),  # docs/physics.md
            math.pi / 2,
            [(2.7244, 12.68 * 0.993, 15.49e-3 * 1.214), (2.7244, 10.71 * 0.993, 14.27e-3 * 1.071)],
        ),
    ],
)
def test_every_tip_decays_freely(plant, target, modes):
    W, dW = [0.02, -0.01][: len(modes)], [0.3, 0.1][: len(modes)]
    times, vibration = np.linspace(0.0, 30.0, 5001), FreeVibration(plant, target)
    tips = vibration.states([*W, *dW], times) @ vibration.tips.T
    for i, (phi, omega, zeta) in enumerate(modes):
        expected = phi * _decay(W[i], dW[i], omega, zeta, times)
        assert tips[:, i] == pytest.approx(expected, abs=1e-12)
        assert vibration.modes[::-1][i] == pytest.approx((omega, zeta), rel=1e-9)


def test_a_tip_that_does_not_swing_creeps_back():
    # Critical damping: W = (W0 + (W'0 + omega W0) t) exp(-omega t); its equations have one
    # eigenvector, so that they fall apart into no modes.
    plant = qa.SingleLinkManipulator(omega=5.0, zeta=1.0)
    vibration, t = FreeVibration(plant, 0.0, 2.0), np.linspace(0.0, 2.0, 101)
    expected = (0.01 + (0.2 + 0.05) * t) * np.exp(-5 * t)
    assert vibration.states([0.01, 0.2], t)[:, 0] == pytest.approx(expected, abs=1e-13)
    # The largest where the rate is zero: t = 1/omega - W0/(W'0 + omega W0).
    top = 1 / 5 - 0.01 / 0.25
    peak = 2.28 * (0.01 + 0.25 * top) * math.exp(-5 * top)
    assert vibration.peak([0.01, 0.2]) == pytest.approx(peak, rel=3e-8)


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_many_vibrations_at_once_are_each_alone(plants, name):
    plant, targets = plants[name], np.array([0.3, -1.2, 2.0])
    states = np.random.default_rng(4).uniform(-0.1, 0.1, (3, 2 * plant.modes))
    together = FreeVibration(plant, targets, 1.0).peak(states)
    for i, target in enumerate(targets):
        alone = FreeVibration(plant, target, 1.0).peak(states[i])
        assert together[i] == pytest.approx(float(alone), rel=5e-8)
    errors = np.array([-0.1, 0.0, 0.2])
    perturbed = perturb_plant(plant, {"frequency": ca.DM(errors)})
    together = FreeVibration(perturbed, targets, 1.0).peak(states)
    for i, error in enumerate(errors):
        other = perturb_plant(plant, {"frequency": error})
        alone = FreeVibration(other, targets[i], 1.0).peak(states[i])
        assert together[i] == pytest.approx(float(alone), rel=1e-7)


def test_the_peak_is_the_amplitude():
    # Undamped: |w| peaks at phi sqrt(W^2 + (W'/omega)^2), wherever between two samples; the rows
    # are at most 0.01 radians of it.
    vibration = FreeVibration(qa.SingleLinkManipulator(zeta=0.0), 1.0, 1.0)
    phases = np.linspace(0.0, 2 * np.pi, 50)
    states = np.column_stack([0.01 * np.cos(phases), -0.1043 * np.sin(phases)])
    assert vibration.peak(states) == pytest.approx(0.0228, rel=5e-8)
    rows = np.abs(states @ vibration.rows.T).max(axis=1)
    assert rows.max() <= 0.0228 * (1 + 1e-9)
    assert rows.min() >= 0.0228 * math.cos(0.01) * (1 - 1e-9)


def test_a_peak_at_an_end_of_the_window_counts():
    # In a fiftieth of a period the tip moves outwards only, or inwards only.
    vibration = FreeVibration(qa.SingleLinkManipulator(zeta=0.0), 1.0, 0.012)
    after = vibration.states([0.01, 0.05], 0.012)[0, 0]
    assert vibration.peak([0.01, 0.05]) == pytest.approx(2.28 * after, rel=1e-12)
    assert vibration.peak([0.01, -0.05]) == pytest.approx(0.0228, rel=1e-12)
    assert np.abs(vibration.rows @ [0.01, 0.05]).max() == pytest.approx(2.28 * after, rel=1e-12)


def test_a_window_that_cannot_be_resolved_is_refused():
    with pytest.raises(ValueError, match=r"residual window 1000 s .* give at most 384 s"):
        FreeVibration(qa.SingleLinkManipulator(), 1.0, 1000.0)


@pytest.mark.parametrize(("start", "target"), [(0.0, math.pi / 2), (math.pi / 2, 0.0)])
def test_the_arms_fastest_mode_is_at_the_angle_of_least_mass(start, target):
    # omega/sqrt(1 + alpha1 cos theta) is largest at theta = 0.
    fastest = fastest_along(qa.ArmOnFlexibleLink(), start, target)
    assert fastest == pytest.approx(7.320 / math.sqrt(1 - 1.055e-1))


@pytest.mark.parametrize("name", ["single link", "arm", "two links", "damped link"])
@pytest.mark.parametrize("target", [math.pi / 6, -1.0])
def test_the_rows_hold_the_largest_displacement_of_any_state(plants, name, target):
    plant = {**plants, "damped link": qa.SingleLinkManipulator(zeta=0.1)}[name]
    vibration = FreeVibration(plant, target, 1.0)
    states = np.random.default_rng(0).standard_normal((500, 2 * plant.modes))
    kept = np.abs(states @ vibration.rows.T).max(axis=1)
    np.testing.assert_allclose(kept, vibration.peak(states), rtol=6e-5)
    assert len(vibration.rows) < vibration.fastest / 0.02


def test_in_a_window_of_no_length_the_displacement_on_arrival_counts():
    vibration = FreeVibration(qa.SingleLinkManipulator(), 1.0)
    assert vibration.peak([0.01, 5.0]) == pytest.approx(2.28 * 0.01, rel=1e-12)
    assert np.abs(vibration.rows @ [0.01, 5.0]).max() == pytest.approx(2.28 * 0.01, rel=1e-12)


def test_modes_are_those_that_swing_be_they_slow():
    assert FreeVibration(qa.SingleLinkManipulator(omega=5.0, zeta=1.2), 0.0).modes == []
    slow = FreeVibration(qa.SingleLinkManipulator(omega=0.5, zeta=0.1), 0.0)
    assert slow.modes == [pytest.approx((0.5, 0.1), rel=1e-9)]


@dataclass(frozen=True)
class Swung(Sound):
    """A mode that the joint's acceleration stiffens, as of a pendulum that is swung."""

    name: ClassVar[str] = "swung-probe"

    def modal_accelerations(self, joint, W, dW):
        return [-(self.omega**2 + 50 * joint.acceleration) * W[0] - joint.acceleration]


@pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")
def test_after_arrival_the_joint_neither_moves_nor_accelerates():
    vibration = FreeVibration(Swung(), 0.0, 1.0)
    assert vibration.modes == [(pytest.approx(10.0), pytest.approx(0.0, abs=1e-12))]
    with pytest.raises(ValueError, match="read-only"):
        vibration.rows[0] = 0.0


@dataclass(frozen=True)
class AcrossAndAlong(qa.DualLinkManipulator):
    """One tip that moves in a plane, whose displacements count along sixteen lines."""

    name: ClassVar[str] = "across-and-along-probe"

    @property
    def tip_lines(self):
        turned = np.arange(16) * np.pi / 16
        return np.column_stack([np.cos(turned), np.sin(turned)])


@pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")
def test_rows_along_lines_miss_a_thousandth_of_a_peak():
    vibration = FreeVibration(AcrossAndAlong(), 1.0, 1.0)
    states = np.random.default_rng(0).standard_normal((300, 4))
    kept = np.abs(states @ vibration.rows.T).max(axis=1)
    # 0.1 radians apart, half of them from the peak: 0.05^2 / 2
    np.testing.assert_allclose(kept, vibration.peak(states), rtol=1.3e-3)


@pytest.mark.parametrize("unit", [1e-7, 1.0, 1e7])
@pytest.mark.parametrize("dimensions", [3, 4])
def test_rows_that_are_not_in_a_plane_are_all_kept_in_any_unit(unit, dimensions):
    directions = np.eye(4)[:dimensions]
    assert extreme_rows(unit * directions, 1).tolist() == (unit * directions).tolist()


def farthest(rows):
    """Rows, and their negatives, that are the farthest in one of many directions of a plane."""
    both = np.vstack([rows, -rows])
    turned = np.arange(0.5e-3, 2 * np.pi, 1e-3)
    return {*map(tuple, both[np.argmax(both @ [np.cos(turned), np.sin(turned)], axis=0)])}


def test_of_rows_in_a_plane_the_farthest_are_kept():
    # Every second row of a spiral inwards is within the line between its neighbours.
    angle = np.arange(0.0, 4.0, 0.1)
    spiral = np.exp(-0.1 * angle)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    spiral[1::2] *= 0.99
    kept = extreme_rows(spiral, 1)
    assert {*map(tuple, kept), *map(tuple, -kept)} == farthest(spiral)
    assert 10 < len(kept) < 20


@pytest.mark.parametrize("seed", range(20))
def test_directions_that_are_kept_are_the_corners_of_the_hull(seed):
    # Points of a grid, none the negative of another, that lie often on one line.
    random = np.random.default_rng(seed)
    half = [(x, y) for x in range(-3, 4) for y in range(4) if (y, x) > (0, 0)]
    points = random.permutation(half)[:9] * random.choice([-1.0, 1.0], (9, 1))
    kept = points[outermost([points])]
    assert {*map(tuple, kept), *map(tuple, -kept)} == farthest(points)
    assert 2 * len(kept) == len(farthest(points))


def test_only_outermost_directions_are_kept():
    """Rows of which none has the largest product with any vector, in one table of two, are not."""
    random = np.random.default_rng(0)
    tables = [random.normal(size=(40, 2)) for _ in range(2)]
    kept = outermost(tables)
    vectors = random.normal(size=(2000, 2))
    for table in tables:
        most = np.abs(vectors @ table.T).max(axis=1)
        assert np.abs(vectors @ table[kept].T).max(axis=1) == pytest.approx(most, rel=1e-12)
    assert len(kept) < 20
    assert outermost([np.array([[1.0], [-3.0], [2.0]])]) == [1]
    assert outermost([np.ones((4, 3))]) == [0, 1, 2, 3]
