"""What the tests of `ocp` share: the plants, and plans that are solved once."""

import math
from functools import cache

import pytest
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, plan_move


@pytest.fixture(scope="session")
def plants(two_links):
    """The plants of the package, by a short name."""
    return {
        "single link": SingleLinkManipulator(),
        "arm": ArmOnFlexibleLink(),
        "two links": two_links,
    }


@pytest.fixture(scope="session")
def tasks(plants):
    """A task for each plant: the first rows of Tables 3 and 6; docs/physics.md, 'A third plant'."""
    return {
        "single link": PointToPoint(plants["single link"], math.pi / 6, 0.8),
        "arm": PointToPoint(plants["arm"], math.pi / 2, 0.8),
        "two links": PointToPoint(plants["two links"], math.pi / 2, 0.9),
    }


@pytest.fixture(scope="session")
def solved():
    """`plan_move` that solves nothing twice, from one start unless more are asked for."""

    @cache
    def solve(task, terms=6, starts=1, **settings):
        return plan_move(task, CycloidPolynomial(terms), starts=starts, **settings)

    return solve
