"""The independent integrator: the paper's tables, many points at once, bad input."""

import math

import numpy as np
import pytest
from third_opinion import COEFFICIENTS

import quietarm as qa
from quietarm.ocp.limits import QUANTITIES, Limit
from quietarm.ocp.profiles.free_motion import FreeMotion

pi = math.pi


@pytest.fixture(scope="module")
def motion(tasks):
    """The motion of a row of Tables 1 and 4."""

    def of(name, row):
        a = COEFFICIENTS[name][row]
        return qa.JudgedMotion.of_profile(tasks[name], qa.CycloidPolynomial(len(a)), a).motion

    return of


# -- docs/physics.md, 'What the printed coefficients give': F2 [J] and max |W| [m] of an independent
# simulation; half a unit of the last digit --


@pytest.mark.parametrize(
    ("name", "row", "energy", "energy_digit", "amplitude", "amplitude_digit"),
    [
        ("single link", "cycloid", 0.09115, 1e-5, 3.382e-2, 1e-5),
        ("single link", "2", 0.06297, 1e-5, 1.12e-4, 1e-6),
        ("single link", "4", 0.05260, 1e-5, 6.98e-5, 1e-7),
        ("single link", "6", 0.05143, 1e-5, 1.58e-4, 1e-6),
        ("arm", "cycloid", 0.12457, 1e-5, 2.947e-2, 1e-5),
        ("arm", "2", 0.20855, 1e-5, 3.98e-4, 1e-6),
        ("arm", "4", 0.16525, 1e-5, 2.53e-4, 1e-6),
        ("arm", "6 as printed", 0.15465, 1e-5, 3.11e-3, 1e-5),
        ("arm", "6 mended", 0.14915, 1e-5, 6.6e-4, 1e-5),
    ],
)
def test_the_printed_coefficients_give_what_another_simulation_gave(
    tasks, motion, name, row, energy, energy_digit, amplitude, amplitude_digit
):
    found = motion(name, row)
    assert found.energy == pytest.approx(energy, abs=energy_digit / 2)
    assert found.residual / tasks[name].plant.phi == pytest.approx(
        amplitude, abs=amplitude_digit / 2
    )


def test_what_is_seen_after_arrival_reaches_the_residual(tasks):
    candidate = qa.JudgedMotion.of_profile(tasks["single link"], qa.CycloidPolynomial(0), [])
    trajectory, residual = candidate.trajectory, candidate.residual
    path = qa.CycloidPolynomial(0).path([], *tasks["single link"].move)
    assert trajectory.joint[:, 0] == pytest.approx(path(trajectory.time), abs=1e-12)
    later = trajectory.time >= tasks["single link"].duration
    seen = np.abs(trajectory.tips[later]).max()
    assert residual * (1 - 1.2e-6) <= seen <= residual * (1 + 1e-9)  # 0.003 rad apart: 0.003^2 / 8
    assert candidate.range_of(Limit.of_residual(1.0).quantity) == (-residual, residual)
    fastest = candidate.motion.peak_speed
    assert candidate.figures.range_of(QUANTITIES["speed"]) == (0.0, fastest)


@pytest.mark.parametrize(
    "times", [[-0.5, 0.2], [0.3, 0.2], [0.2, 0.2], [], [[0.1, 0.2]], [0.1, np.nan]]
)
def test_times_that_do_not_increase_from_the_start_are_refused(tasks, times):
    candidate = qa.JudgedMotion.of_profile(tasks["single link"], qa.CycloidPolynomial(0), [])
    with pytest.raises(ValueError, match="give finite ones that increase from 0 or later"):
        candidate.sample(times)


def test_there_is_a_motion_for_every_scenario_and_none_in_full_of_a_plant_that_is_no_reduction():
    plant = qa.SingleLinkManipulator()
    uncertain = qa.Uncertainty({"frequency": 0.05})
    task = qa.PointToPoint(plant, pi / 6, 0.8, uncertainty=uncertain)
    candidate = qa.evaluate_coefficients(task, []).candidate
    assert len(candidate.scenarios) == len(task.scenarios)
    assert candidate.scenarios[0] is candidate
    assert candidate.in_full is None


def test_after_arrival_alone_the_tip_swings_as_in_the_whole_motion(tasks):
    candidate = qa.evaluate_coefficients(tasks["single link"], []).candidate
    later = [0.9, 1.0]
    whole = candidate.sample([0.1, *later])
    assert candidate.sample(later).tips == pytest.approx(whole.tips[1:], rel=1e-9)


def test_a_motion_in_pieces_has_weights_of_the_whole_and_no_jerk_where_it_jumps(tasks):
    # From rest to rest by a constant acceleration and its negative: a (T/2)^2 is the angle.
    task = tasks["single link"]
    push = task.span / (task.duration / 2) ** 2
    free = FreeMotion([0.0, task.duration / 2, task.duration], [push, -push], [0.0, 0.0])
    candidate = qa.JudgedMotion.of_free_motion(task, free)
    for weighed in (candidate, qa.evaluate_coefficients(task, []).candidate):
        assert weighed.weights.sum() == pytest.approx(task.duration, rel=1e-12)
        way = weighed.weights @ np.ravel(weighed.moving.path.speed)
        assert way == pytest.approx(task.span, rel=1e-9)
    assert candidate.range_of(QUANTITIES["jerk"]) == (-math.inf, math.inf)
    with pytest.raises(ValueError, match="a free motion has samples of its own"):
        candidate.sample([0.1])
