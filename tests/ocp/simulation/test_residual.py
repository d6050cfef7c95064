"""The tip's motion after arrival, against the free decay of a damped oscillator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from quietarm.ocp.simulation.residual import (
    RADIANS_A_SAMPLE,
    extreme_rows,
    fastest_along,
    residuals_at_rest,
)

import quietarm as qa


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
            [
                (2.7244, 12.68 * 0.993, 15.49e-3 * 1.214),
                (2.7244, 10.71 * 0.993, 14.27e-3 * 1.071),
            ],
        ),
    ],
)
@pytest.mark.parametrize("window", [0.3, 1.0])
def test_every_tip_decays_freely(plant, target, modes, window):
    task = qa.PointToPoint(plant, target, 0.8, residual_window=window)
    W, dW = [0.02, -0.01][: len(modes)], [0.3, 0.1][: len(modes)]
    for matrix in (qa.residual_matrix(task), qa.residual_matrix(task, 101)):
        tips = (matrix @ [*W, *dW]).reshape(-1, len(modes))
        t = np.linspace(0.0, window, len(tips))
        for i, (phi, omega, zeta) in enumerate(modes):
            expected = phi * _decay(W[i], dW[i], omega, zeta, t)
            assert tips[:, i] == pytest.approx(expected, abs=1e-8 if len(t) == 101 else 1e-12)


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_many_moves_leave_what_each_leaves_alone(tasks, name):
    # By modal decomposition instead of the matrix of one move; both sample as closely.
    random, targets = np.random.default_rng(4), np.array([0.3, -1.2, 2.0])
    arrivals = random.uniform(-0.1, 0.1, (3, 2 * tasks[name].plant.modes))
    for one, arrival, residual in zip(
        targets, arrivals, residuals_at_rest(tasks[name], targets, arrivals), strict=True
    ):
        alone = qa.residual_matrix(replace(tasks[name], target=one)) @ arrival
        assert residual == pytest.approx(np.abs(alone).max(), rel=5e-5)


def test_the_largest_entry_is_the_amplitude():
    # Undamped: |w| peaks at phi sqrt(W^2 + (W'/omega)^2), at a phase between two samples that is
    # at most half of RADIANS_A_SAMPLE away.
    plant = qa.SingleLinkManipulator(zeta=0.0)
    matrix = qa.residual_matrix(qa.PointToPoint(plant, 1.0, 1.0))
    for phase in np.linspace(0.0, 2 * np.pi, 50):
        state = [0.01 * math.cos(phase), -0.1043 * math.sin(phase)]
        peak = np.abs(matrix @ state).max()
        assert peak <= 0.0228 * (1 + 1e-9)
        assert peak >= 0.0228 * math.cos(RADIANS_A_SAMPLE / 2) * (1 - 1e-9)


@pytest.mark.parametrize(("start", "target"), [(0.0, math.pi / 2), (math.pi / 2, 0.0)])
def test_the_arms_fastest_mode_is_at_the_angle_of_least_mass(start, target):
    # omega/sqrt(1 + alpha1 cos theta) is largest at theta = 0.
    fastest = fastest_along(qa.ArmOnFlexibleLink(), start, target)
    assert fastest == pytest.approx(7.320 / math.sqrt(1 - 1.055e-1))


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
@pytest.mark.parametrize("target", [math.pi / 6, -1.0])
def test_extreme_rows_hold_the_largest_displacement_of_any_state(plants, name, target):
    # by definition: the maximum over the kept rows against that over all rows
    plant = plants[name]
    matrix = qa.residual_matrix(qa.PointToPoint(plant, target, 0.8))
    rows = extreme_rows(matrix, plant.tips)
    states = np.random.default_rng(0).standard_normal((matrix.shape[1], 500))
    assert len(rows) < len(matrix) / 2
    peaks, kept = np.abs(matrix @ states).max(axis=0), np.abs(rows @ states).max(axis=0)
    np.testing.assert_allclose(kept, peaks, rtol=1e-13)
