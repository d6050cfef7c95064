"""What the tests of floors share: floors that are solved once."""

from functools import cache

import pytest

from ocp import (
    energy_floor,
)


@pytest.fixture(scope="session")
def floor_of():
    """`energy_floor` that solves nothing twice."""
    return cache(lambda task, **settings: energy_floor(task, **settings))
