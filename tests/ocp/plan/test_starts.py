"""How many of the starts are solved."""

from dataclasses import replace

import pytest

from ocp import CycloidGaussians, CycloidPolynomial, plan_move
from ocp.program.problem import Problem

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
