"""Wherever numbers are taken, something else is refused in one line of quietarm's own."""

import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp import Evaluator, JudgedMotion, ModalState
from quietarm.ocp.simulation.free_vibration import FreeVibration

LINK = qa.SingleLinkManipulator()
TASK = qa.PointToPoint(LINK, 0.5236, 0.8)
TWO = qa.CycloidPolynomial(2)


class Breaks:
    """An object that says that it is an array, and is none."""

    def __array__(self, *args, **kwargs):
        raise RuntimeError("no array")


NOTHING_OF_NUMBERS = {
    "text": "x",
    "texts": ["1", "2"],
    "bytes": b"ab",
    "ragged": [[1, 2], [3]],
    "complex": [1j, 2j],
    "truth values": [True, False],
    "nones": [None, None],
    "objects": [object(), object()],
    "one object": object(),
    "breaks": Breaks(),
    "set": {1.0, 2.0},
    "mapping": {"a": 1},
    "dates": np.array(["2026-01-01", "2026-01-02"], dtype="datetime64[D]"),
    "records": np.zeros(2, dtype=[("a", float)]),
    "masked": np.ma.masked_array([1.0, 2.0], [True, False]),
    "beyond floats": [10**400, 1],
}
DOORS = {
    "evaluate_coefficients": lambda _, wrong: qa.evaluate_coefficients(TASK, wrong),
    "evaluate_coefficients of a profile": lambda _, wrong: qa.evaluate_coefficients(
        TASK, wrong, profile=TWO
    ),
    "guess": lambda _, wrong: qa.plan_move(TASK, guess=wrong),
    "guess of a profile": lambda _, wrong: qa.plan_move(TASK, TWO, guess=wrong),
    "plan.path": lambda made, wrong: made.plan.path(wrong),
    "order of plan.path": lambda made, wrong: made.plan.path(0.1, wrong),
    "plan.sampled": lambda made, wrong: made.plan.sampled(wrong),
    "candidate.sample": lambda made, wrong: made.plan.candidate.sample(wrong),
    "candidate.perturbed": lambda made, wrong: made.plan.candidate.perturbed(wrong).energy,
    "JudgedMotion.of_profile": lambda _, wrong: JudgedMotion.of_profile(TASK, TWO, wrong),
    "profile.checked": lambda _, wrong: TWO.checked(wrong),
    "coefficients of a path": lambda _, wrong: TWO.path(wrong, 0, 1, 1),
    "start of a path": lambda _, wrong: TWO.path([0, 0], wrong, 1, 1),
    "target of a path": lambda _, wrong: TWO.path([0, 0], 0, wrong, 1),
    "duration of a path": lambda _, wrong: TWO.path([0, 0], 0, 1, wrong),
    "evaluator": lambda made, wrong: made.evaluator(wrong),
    "errors of an evaluator": lambda made, wrong: made.evaluator([[0.1, 0.1]], wrong),
    "angle of a vibration": lambda _, wrong: FreeVibration(LINK, wrong),
    "window of a vibration": lambda _, wrong: FreeVibration(LINK, 0.5, wrong),
    "states of a vibration": lambda made, wrong: made.vibration.peak(wrong),
    "state after arrival": lambda made, wrong: made.vibration.states(wrong, [0.1]),
    "times after arrival": lambda made, wrong: made.vibration.states([0.1, 0.1], wrong),
    "task.missed": lambda _, wrong: TASK.missed(wrong),
    "samples": lambda _, wrong: qa.Uncertainty({"frequency": 0.1}, wrong),
    "modal state": lambda _, wrong: ModalState(wrong, [0.0]),
    "knots": lambda _, wrong: qa.JointSpline(wrong),
    "residuals of a front": lambda _, wrong: qa.epsilon_front(TASK, TWO, at=wrong),
    "weights of a front": lambda _, wrong: qa.weighted_front(TASK, TWO, weights=wrong),
    "MoveFunction": lambda made, wrong: made.function(wrong),
    "torque limit": lambda _, wrong: qa.PointToPoint(LINK, 0.5, 0.8, torque_limit=wrong),
    "torque-speed": lambda _, wrong: qa.PointToPoint(LINK, 0.5, 0.8, torque_speed=wrong),
    "target": lambda _, wrong: qa.PointToPoint(LINK, wrong, 0.8),
    "start": lambda _, wrong: qa.PointToPoint(LINK, 0.5, 0.8, wrong),
    "tolerance": lambda _, wrong: qa.Sqp(tolerance=wrong),
}  # fmt: skip


@pytest.fixture(scope="module")
def made():
    """Return what has methods that take numbers."""
    return SimpleNamespace(
        plan=qa.evaluate_coefficients(TASK, [0.1, 0.1]),
        evaluator=Evaluator(TASK, TWO, 60),
        vibration=FreeVibration(LINK, 0.5, 1.0),
        function=qa.metaheuristics.MoveFunction(TASK, TWO, bound=0.5),
    )


@pytest.mark.parametrize("wrong", NOTHING_OF_NUMBERS)
@pytest.mark.parametrize("door", DOORS)
def test_what_is_no_number_is_refused_in_one_line(made, door, wrong):
    if door in ("candidate.perturbed", "torque limit") and wrong == "mapping":
        pytest.skip("they are given by name")
    with pytest.raises((TypeError, ValueError), match=r"^[^\n]*; give [^\n]*$") as error:
        DOORS[door](made, NOTHING_OF_NUMBERS[wrong])
    assert len(str(error.value)) < 300


@pytest.mark.parametrize("wrong", [math.nan, math.inf, [math.nan, 1.0]])
@pytest.mark.parametrize(
    "door", ["plan.path", "candidate.sample", "profile.checked", "angle of a vibration", "target"]
)
def test_numbers_are_finite(made, door, wrong):
    with pytest.raises(ValueError, match=r"^[^\n]*; give [^\n]*$"):
        DOORS[door](made, wrong)


def test_numbers_of_other_kinds_are_numbers(made):
    plan = made.plan
    expected = plan.path([0.25, 0.5])
    for times in ((0.25, 0.5), np.float32([0.25, 0.5]), [Fraction(1, 4), Fraction(1, 2)]):
        assert plan.path(times).tolist() == expected.tolist()
    assert plan.path(0).shape == ()
