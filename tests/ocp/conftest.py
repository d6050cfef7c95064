"""Fixtures that the tests of `ocp` share: the plants, and plans that are solved once."""

import math
from functools import cache

import pytest

import quietarm as qa


@pytest.fixture(scope="session")
def plants(two_links):
    """The plants of the package, by a short name."""
    return {
        "single link": qa.SingleLinkManipulator(),
        "arm": qa.ArmOnFlexibleLink(),
        "two links": two_links,
    }


@pytest.fixture(scope="session")
def tasks(plants):
    """A task for each plant: the first rows of Tables 3 and 6; docs/physics.md, 'A third plant'."""
    return {
        "single link": qa.PointToPoint(plants["single link"], math.pi / 6, 0.8),
        "arm": qa.PointToPoint(plants["arm"], math.pi / 2, 0.8),
        "two links": qa.PointToPoint(plants["two links"], math.pi / 2, 0.9),
    }


@pytest.fixture(scope="session")
def solved():
    """`plan_move` that solves nothing twice, from one start unless more are asked for."""

    @cache
    def solve(task, terms=6, starts=1, **settings):
        return qa.plan_move(task, qa.CycloidPolynomial(terms), starts=starts, **settings)

    return solve
