"""Several starts of one plan: what they share, and what is tried where none is solved."""

import numpy as np
import pytest
from quietarm.ocp import CycloidPolynomial, InfeasibleTaskError, PointToPoint, SolveSettings
from quietarm.ocp.plan.starts import (
    FINER_STEPS,
    PLAN_STEPS,
    first_steps,
    from_starts,
    start_coefficients,
)
from quietarm.ocp.program.program import Program
from quietarm.ocp.program.solution import RESIDUAL, Ask

PROFILE = CycloidPolynomial(6)
AT_REST = Ask({RESIDUAL: 0.0})


@pytest.fixture(scope="module")
def starts():
    return start_coefficients(PROFILE, SolveSettings(starts=6))


@pytest.mark.parametrize("solver", ["sqp", "ipopt"])
def test_the_best_of_several_starts_is_the_cheapest(tasks, starts, solver):
    program = Program(tasks["arm"], PROFILE, PLAN_STEPS)
    found = from_starts(program, AT_REST, starts, solver)
    assert found.stopped is None
    energies = [one.energy for one in found.solved]
    assert energies == sorted(energies)
    assert found.solution.energy == energies[0]
    alone = from_starts(program, AT_REST, starts[:1], solver)
    assert found.solution.energy == pytest.approx(alone.solution.energy, rel=1e-6)
    assert found.solution.iterations > alone.solution.iterations  # those of all


def test_no_start_is_solved_where_there_is_no_motion(tasks, starts):
    task = PointToPoint(tasks["arm"].plant, np.pi / 2, 0.8, torque_limit=0.05)
    ask = Ask({RESIDUAL: 0.0, "torque": 0.05})
    with pytest.raises(InfeasibleTaskError, match=r"torque limit 0\.198"):  # 0.1983, and 0.1 %
        from_starts(Program(task, PROFILE, FINER_STEPS), ask, starts[:2])


@pytest.mark.parametrize(
    ("terms", "limits", "steps"),
    [
        (6, {}, PLAN_STEPS),
        (9, {}, 56),
        (30, {}, FINER_STEPS),
        (6, {"torque_limit": 1.0}, FINER_STEPS),
    ],
)
def test_more_terms_and_limits_take_more_steps(tasks, terms, limits, steps):
    task = PointToPoint(tasks["arm"].plant, np.pi / 2, 0.8, **limits)
    assert first_steps(task, CycloidPolynomial(terms), SolveSettings()) == steps
    assert first_steps(task, CycloidPolynomial(terms), SolveSettings(steps=33)) == 33
