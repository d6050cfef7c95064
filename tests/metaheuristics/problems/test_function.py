"""A move as a function of arrays."""

import dataclasses

import numpy as np
import pytest
from small_searches import HALF, SIXTH

from quietarm.metaheuristics import MoveFunction, problem_of
from quietarm.ocp import CycloidPolynomial, Front, evaluate_coefficients

LIMITED = dataclasses.replace(SIXTH, torque_limit=0.16, acceleration_limit=60.0)
THREE = ("residual", "energy", "peak_torque")
RANDOM = np.random.default_rng(4).uniform(-0.2, 0.2, (7, 3))


def test_it_says_what_goes_in_and_what_comes_out():
    function = MoveFunction(
        LIMITED, CycloidPolynomial(3), bound=0.2, objectives=[*THREE, "peak-speed"], steps=10
    )
    assert function.variables == ("a_1", "a_2", "a_3")
    assert function.lower.tolist() == [-0.2] * 3
    assert function.upper.tolist() == [0.2] * 3
    assert function.objectives == ("residual", "energy", "peak_torque", "peak_speed")
    assert function.units == ("m", "J", "N m", "rad/s")
    assert function.constraints == ("torque_limit", "acceleration_limit")
    objectives, violations = function(RANDOM)
    assert (objectives.shape, violations.shape) == ((7, 4), (7, 2))
    assert [part.shape for part in function(RANDOM[:0])] == [(0, 4), (0, 2)]


@pytest.mark.parametrize("task", [HALF, LIMITED])
def test_the_figures_are_those_of_cvodes(task):
    # the README's table: energy within 1e-5 relative; a peak between samples is a little higher
    function = MoveFunction(task, CycloidPolynomial(3), bound=0.2, objectives=THREE)
    objectives, violations = function(RANDOM)
    for row, found, broken in zip(RANDOM, objectives, violations, strict=True):
        exact = evaluate_coefficients(task, row)
        assert found[0] == pytest.approx(exact.residual, rel=1e-4, abs=1e-7)
        assert found[1] == pytest.approx(exact.energy, rel=1e-5)
        assert found[2] == pytest.approx(exact.motion.peak_torque, rel=2e-3)
        for limit, passed in zip(task.limits, broken, strict=True):
            assert passed == pytest.approx(limit.peak_of(exact.motion) / limit.size - 1, abs=1e-2)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (RANDOM[0], r"have shape \(3,\); give \(motions, 3\)"),
        (RANDOM[None], r"have shape \(1, 7, 3\); give"),
        (RANDOM + 0j, "give a row of numbers"),
        ([["a", "b", "c"]], "give a row of numbers"),
        ([[1.0, 2.0], [3.0]], "give a row of numbers"),
        (np.ma.masked_array(RANDOM, mask=RANDOM > 0), "masked array; give plain numbers"),
    ],
)
def test_what_is_no_table_of_numbers_is_refused_in_one_line(rows, words):
    profile = CycloidPolynomial(3)
    with pytest.raises(ValueError, match=words):
        MoveFunction(HALF, profile, bound=0.2)(rows)
    with pytest.raises(ValueError, match=r"coefficients (are|have)"):
        Front.from_coefficients(HALF, rows, method="mine", profile=profile)


@pytest.mark.parametrize(("value", "words"), [(np.nan, "nan"), (0.3, r"0\.3"), (-np.inf, "-inf")])
def test_a_recording_takes_nothing_beyond_the_box_and_goes_on(value, words):
    recorded = problem_of("single-link-30deg-0.8s-4-terms").recorded()
    rows = np.zeros((3, 4))
    recorded(rows)
    rows[1, 2] = value
    with pytest.raises(ValueError, match=f"a_3 of candidate 5 is {words}, not from .*; clip"):
        recorded(rows)
    recorded([recorded.upper * (1 + 1e-12)])  # as scaling from another box leaves it
    found = recorded.front("mine")
    assert found.record.evaluations == 4
    assert (np.abs(found.coefficients) <= 0.2).all()
    with pytest.raises(ValueError, match="seed is -1"):
        recorded.front("mine", seed=-1)
