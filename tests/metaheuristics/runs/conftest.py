"""The checkpoint that the tests of its format share."""

import pytest
from quietarm.metaheuristics.runs.checkpoint import save_checkpoint
from states import HEADER, state


@pytest.fixture
def path(tmp_path):
    return tmp_path / "checkpoint"


@pytest.fixture
def good(path):
    """The bytes of a good checkpoint."""
    save_checkpoint(path, HEADER, state())
    return path.read_bytes()
