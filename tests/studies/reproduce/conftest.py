"""The paper recomputed once for all tests, with short searches and few starts."""

import pytest
from quietarm.studies.reproduce.recompute import recompute_paper
from short_paper import SHORT


@pytest.fixture(scope="session")
def reproduction():
    """How well searches find is tested where they are."""
    return recompute_paper(SHORT)
