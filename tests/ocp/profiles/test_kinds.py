"""What is no task, profile or list of numbers is told in words that are not Python's own."""

import math

import numpy as np
import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    PointToPoint,
    energy_floor,
    epsilon_front,
    evaluate_coefficients,
    evaluate_robustness,
    plan_move,
    weighted_front,
)

TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
ASKS = {
    "plan_move": plan_move,
    "epsilon_front": lambda task, profile: epsilon_front(task, profile, bound=0.2),
    "weighted_front": lambda task, profile: weighted_front(task, profile, bound=0.2),
    "evaluate_coefficients": lambda task, profile: evaluate_coefficients(task, [], profile=profile),
    "evaluate_robustness": lambda task, profile: evaluate_robustness(task, profile, [], {}),
}


@pytest.mark.parametrize("ask", ASKS.values(), ids=ASKS)
def test_what_is_no_task_is_told(ask):
    with pytest.raises(ValueError, match=r"^task is 5; give a PointToPoint$"):
        ask(5, CycloidPolynomial(0))


def test_a_floor_of_no_task_is_told():
    with pytest.raises(ValueError, match=r"^task is 5; give a PointToPoint$"):
        energy_floor(5)


@pytest.mark.parametrize("ask", ASKS.values(), ids=ASKS)
@pytest.mark.parametrize("profile", ["polynomial", CycloidPolynomial], ids=["name", "class"])
def test_what_is_no_profile_is_told(ask, profile):
    with pytest.raises(ValueError, match=r"^profile is .*; give a JointProfile, such as Cycloid"):
        ask(TASK, profile)


@pytest.mark.parametrize(
    "given",
    ["abc", None, {1: 2}, [1j], (0.1 for _ in range(2)), [[1], [1, 2]]],
    ids=["word", "nothing", "mapping", "complex", "generator", "ragged"],
)
@pytest.mark.parametrize("profile", [None, CycloidPolynomial(2)], ids=["none", "two terms"])
def test_coefficients_that_are_no_numbers_are_told(given, profile):
    with pytest.raises(ValueError, match=r"^coefficients are .*; give a list of numbers$"):
        evaluate_coefficients(TASK, given, profile=profile)


def test_coefficients_in_a_table_are_told():
    with pytest.raises(ValueError, match=r"^coefficients have shape \(1, 2\); give one row of num"):
        evaluate_coefficients(TASK, [[0.1, 0.2]])


def test_ranges_that_have_no_names_are_told():
    with pytest.raises(ValueError, match=r"^ranges is 0\.1; give errors by name"):
        evaluate_robustness(TASK, CycloidPolynomial(0), [], 0.1)


def test_a_percentile_that_there_is_not_is_told():
    found = evaluate_robustness(TASK, CycloidPolynomial(0), [], {"frequency": 0.1}, samples=2)
    with pytest.raises(ValueError, match="'torque'; give one of residual, energy, peak_torque"):
        found.percentile("torque", 5)
    with pytest.raises(ValueError, match="percentage is 101; give 0 to 100"):
        found.percentile("energy", 101)
    with pytest.raises(ValueError, match="percentage is -1; give 0 or more"):
        found.percentile("energy", -1)


def test_the_least_energy_within_no_number_is_told():
    front = Front.from_coefficients(TASK, np.zeros((1, 2)), method="mine")
    with pytest.raises(ValueError, match=r"^residual limit is '1mm'; give a number in m$"):
        front.cheapest("1mm")


def test_a_front_of_a_nameless_method_is_refused():
    with pytest.raises(ValueError, match=r"^method is ' '; give the name of what found"):
        Front.from_coefficients(TASK, np.zeros((1, 2)), method=" ")


def test_a_parameter_beyond_double_precision_is_told():
    with pytest.raises(ValueError, match=r"parameter omega is 100.*\.\.\..*; give a finite number"):
        SingleLinkManipulator(omega=10**400)
