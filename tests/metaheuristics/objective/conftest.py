"""The tasks that the tests of the objective share."""

import pytest
from populations import ARM, SINGLE_LINK, pi
from quietarm.ocp import PointToPoint


@pytest.fixture(scope="module")
def tasks(two_links):
    """A task and its box for each plant; the two links' from docs/physics.md, 'A third plant'."""
    return {
        "single link": (PointToPoint(SINGLE_LINK, pi / 6, 0.8), 0.2),
        "arm": (PointToPoint(ARM, pi / 2, 0.8), 0.5),
        "two links": (PointToPoint(two_links, pi / 2, 0.9), 0.2),
    }
