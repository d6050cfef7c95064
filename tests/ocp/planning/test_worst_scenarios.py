"""Worst cases become scenarios of a task: the corners stay, and what is near is replaced."""

import pytest

import quietarm as qa
from quietarm.ocp.planning.worst_scenarios import new_scenarios, with_moved_scenarios


@pytest.fixture
def task():
    ranges = qa.Uncertainty({"frequency": 0.1, "damping": 0.4})
    return qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8, uncertainty=ranges)


def test_a_worst_case_replaces_one_that_is_near_and_no_corner(task):
    corners = task.scenarios[1:]
    first = with_moved_scenarios(task, [[0.02, 0.1]])
    assert first.scenarios[1:] == (*corners, (0.02, 0.1))
    # by a tenth and by a quarter of the ranges beside it; then far from it; then near a corner
    assert with_moved_scenarios(first, [[0.03, 0.2]]).scenarios[1:] == (*corners, (0.03, 0.2))
    far = [-0.06, 0.1]
    assert with_moved_scenarios(first, [far]).scenarios[1:] == (*corners, (0.02, 0.1), tuple(far))
    assert corners == with_moved_scenarios(task, [[0.099, 0.39]]).scenarios[1:5]


def test_what_is_a_scenario_is_none_again(task):
    motion = qa.JudgedMotion.of_profile(task, qa.CycloidPolynomial(0), [])
    at_corner = motion.perturbed({"frequency": 0.1, "damping": -0.4})
    new = motion.perturbed({"frequency": 0.01, "damping": 0.0})
    assert new_scenarios(task, [at_corner, new]) == [[0.01, 0.0]]
