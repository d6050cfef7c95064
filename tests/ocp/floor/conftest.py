"""What the tests of floors share: floors that are solved once."""

from functools import cache

import pytest
from quietarm.ocp import energy_floor
from quietarm.ocp.floor import search


@pytest.fixture(scope="session")
def coarse_of():
    """`energy_floor` from one start and on coarse grids, that solves nothing twice."""

    @cache
    def solve(task, starts=1, **settings):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(search, "FIRST_INTERVALS", 24)
            return energy_floor(task, starts=starts, **settings)

    return solve
