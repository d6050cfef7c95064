"""What the tests of `studies` share: one reproduction of the paper, one plan."""

import math

import pytest

from models import SingleLinkManipulator
from ocp import CycloidPolynomial, PointToPoint, evaluate_coefficients, plan_move
from studies import reproduce as reproduce_module


@pytest.fixture(scope="session")
def begun():
    """The names that the one reproduction reported as it began its solves and searches."""
    return []


@pytest.fixture(scope="session")
def reproduction(begun):
    """The paper recomputed, once for all tests: twenty seconds.

    The searches are cut short: how well they find is tested where they are.
    """
    search, generations = reproduce_module.search, {"vepso": 60, "nsga2": 5}

    def short(task, method, **settings):
        return search(task, method, generations=generations[method], **settings)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reproduce_module, "search", short)
        return reproduce_module.reproduce(begun.append)


@pytest.fixture(scope="session")
def task():
    """The README's move: the first row of Table 3."""
    return PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)


@pytest.fixture(scope="session")
def plan(task):
    """A plan of two terms, at rest on arrival."""
    return plan_move(task, CycloidPolynomial(2))


@pytest.fixture(scope="session")
def cycloid(task):
    """The plain cycloid of the same task."""
    return evaluate_coefficients(task, [])
