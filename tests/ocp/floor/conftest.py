"""What the tests of floors share: floors that are solved once."""

from functools import cache

import pytest
from quietarm.ocp import energy_floor
from quietarm.ocp.floor import search


@pytest.fixture
def coarse(monkeypatch):
    """Coarser grids, where it is not asked how low a floor is."""
    monkeypatch.setattr(search, "FIRST_INTERVALS", 24)


@pytest.fixture
def coarsest(monkeypatch):
    """The coarsest, where it is not asked what a floor is either."""
    monkeypatch.setattr(search, "FIRST_INTERVALS", 12)


@pytest.fixture(scope="session")
def coarse_of():
    """`energy_floor` on such grids, that solves nothing twice."""

    @cache
    def solve(task, **settings):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(search, "FIRST_INTERVALS", 24)
            return energy_floor(task, **settings)

    return solve
