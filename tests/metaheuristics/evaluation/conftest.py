"""The tasks that the tests of the objective share."""

import pytest
from moves import CASES
from populations import pi

from quietarm.ocp import PointToPoint


@pytest.fixture(scope="module")
def tasks(two_links):
    """A task and its box for each plant; the two links' from docs/physics.md, 'A third plant'."""
    return {**CASES, "two links": (PointToPoint(two_links, pi / 2, 0.9), 0.2)}
