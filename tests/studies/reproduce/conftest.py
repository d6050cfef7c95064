"""The paper recomputed once for all tests, with short searches and few starts."""

import pytest
from quietarm.studies.reproduce.recompute import Effort, recompute_paper

SHORT = Effort(
    full=True,
    searches={
        "vepso": {"population": 20, "generations": 40},
        "nsga2": {"population": 20, "generations": 3},
    },
    starts=1,
    other_starts=1,
    points=3,
    free_motion={"starts": 1, "tolerance": 0.05},
)


@pytest.fixture(scope="session")
def reproduction():
    """How well searches find is tested where they are."""
    return recompute_paper(SHORT)
