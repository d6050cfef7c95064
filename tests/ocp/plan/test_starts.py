"""How many of the starts are solved."""

from dataclasses import replace

import pytest

from ocp import CycloidGaussians, CycloidPolynomial, SolverFailedError, SolveStatus, plan_move
from ocp.plan import solver
from ocp.program.problem import Problem
from ocp.program.transcription import RESIDUAL

ENOUGH = CycloidPolynomial(6)
"""Four coefficients beyond the two that rest takes for one mode."""


@pytest.fixture
def energies(monkeypatch):
    """Let the starts end at these energies [J]; what is left of the list is not solved."""

    def put(left):
        known = Problem.solve

        def solve(*given, **settings):
            return replace(known(*given, **settings), energy=left.pop(0))

        monkeypatch.setattr(Problem, "solve", solve)
        return left

    return put


@pytest.mark.parametrize(
    ("starts", "at", "solved"),
    [
        (1, [2.0], 1),
        (2, [2.0, 2.0], 2),
        (4, [2.0, 2.0, 1.0, 1.0], 2),
        (4, [2.0, 2.1, 2.0, 1.0], 3),  # one more minimum
        (4, [2.1, 2.0, 1.0, 1.5], 4),
        (4, [2.0, 1.0, 2.0, 1.0], 4),  # two agree, but not at the least
        (6, [2.0, 2.0, 2.000001, 1.0, 1.0, 1.0], 3),  # half of them, within the solver's tolerance
    ],
)
def test_starts_end_when_half_of_them_agree_at_the_least_energy(
    tasks, energies, starts, at, solved
):
    left = energies(list(at))
    plan_move(tasks["single link"], ENOUGH, starts=starts)
    assert len(at) - len(left) == solved


@pytest.mark.parametrize(
    ("of", "profile"),
    [
        ("single link", CycloidPolynomial(5)),  # a few still motions may lie apart
        ("two links", CycloidPolynomial(6)),  # rest of two modes takes four
        ("single link", CycloidGaussians(2)),  # not linear in the coefficients
    ],
)
def test_where_agreement_says_little_all_are_solved(tasks, energies, of, profile):
    left = energies([2.0] * 4)
    plan_move(tasks[of], profile, starts=4)
    assert left == []


@pytest.mark.parametrize(
    ("residuals", "solved"),
    [
        ([2e-3, 2.01e-3, 1e-3, 1e-3], 2),  # the same motion, within 1 %
        ([2e-3, 2.1e-3, 2e-3, 1e-3], 3),
        ([1e-3, 2e-3, 3e-3, 4e-3], 4),
    ],
)
def test_starts_end_when_half_of_them_break_a_limit_at_the_same_motion(
    tasks, monkeypatch, residuals, solved
):
    known, left, ended = Problem.solve, list(residuals), []

    def solve(*given, **settings):
        peaks = {RESIDUAL: left.pop(0)}
        return replace(known(*given, **settings), status=SolveStatus.INFEASIBLE, peaks=peaks)

    def note(solutions, *rest):
        ended.extend(solutions)
        raise SolverFailedError("enough is known")

    monkeypatch.setattr(Problem, "solve", solve)
    monkeypatch.setattr(solver, "rescued", note)
    with pytest.raises(SolverFailedError, match="enough"):
        plan_move(tasks["single link"], ENOUGH, starts=4)
    assert len(ended) == solved
