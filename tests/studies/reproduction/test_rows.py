"""The paper recomputed: its rows, the gradient's answers, its own searches."""

import pytest
from quietarm.ocp import CycloidPolynomial, plan_move
from quietarm.studies.paper import (
    ARM_HALF,
    ARM_THREE_QUARTERS,
    ARM_WHOLE,
    COEFFICIENTS,
    SINGLE_LINK_HALF_1_0,
    SINGLE_LINK_HALF_1_1,
    SINGLE_LINK_SIXTH,
)

ROUNDED = 1 + 1e-6
"""Room for two solves of one problem to end at the same optimum."""


# docs/physics.md, 'The published optima are not optimal': what N = 6 must reach in the paper's box
# and without one [J], as another optimiser did; rounded up.
GRADIENT = {
    SINGLE_LINK_SIXTH: (0.0445, 0.02375),
    SINGLE_LINK_HALF_1_0: (0.2199, 0.1425),
    SINGLE_LINK_HALF_1_1: (0.1591, 0.1215),
    ARM_HALF: (0.1316, 0.1245),
    ARM_THREE_QUARTERS: (0.1379, 0.1365),
    ARM_WHOLE: (0.1954, 0.1935),
}


# What is computed


def test_both_solvers_find_the_fronts_of_all_conditions(reproduction):
    # docs/accuracy.md: 1.3e-8, but for a point that lies 1.1e-5 above what IPOPT finds
    differences = sorted(check.largest for check in reproduction.checks.values())
    assert [len(check.points) for check in reproduction.checks.values()] == [3] * 6
    assert differences[2] < 1e-6
    assert differences[-1] < 1e-4


# The gradient answer


def test_the_gradient_answers_are_at_rest_on_arrival_and_verified(reproduction):
    plans = [plan for result in reproduction.rows for plan in (result.in_box, result.free)]
    plans += reproduction.more_terms.values()
    for plan in plans:
        assert plan.status.solved
        assert plan.residual < 1e-8  # docs/accuracy.md
        assert abs(plan.verification.energy_difference) < 1e-3 * plan.energy


@pytest.mark.parametrize("condition", GRADIENT, ids=lambda value: value.label)
def test_the_gradient_reaches_the_energies_asked_for(reproduction, condition):
    in_box, free = GRADIENT[condition]
    result = reproduction.result(condition, 6)
    assert result.in_box.energy <= in_box
    assert result.free.energy <= free
    assert result.free.energy < result.in_box.energy


@pytest.mark.parametrize(
    ("condition", "terms"), COEFFICIENTS, ids=lambda value: getattr(value, "label", value)
)
def test_with_the_printed_residual_the_gradient_is_never_dearer(reproduction, condition, terms):
    # At rest on arrival two terms leave nothing to choose, and cost a little more than the printed
    # two, which are not at rest (0.06307 J against 0.06297 J with 0.26 mm). With the residual that
    # the printed coefficients leave, the same box and the same integrator, they are one point of
    # the gradient's search, which must then find no worse.
    printed = reproduction.result(condition, terms).printed
    fair = plan_move(
        condition.task,
        CycloidPolynomial(terms),
        residual_limit=printed.residual,
        bound=condition.bound,
    )
    assert fair.residual <= printed.residual * ROUNDED
    assert fair.energy <= printed.energy * ROUNDED


# The paper's own searches
