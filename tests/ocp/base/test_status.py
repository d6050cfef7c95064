"""How a solve ended, in words."""

import pytest
from quietarm.ocp import SolveStatus


@pytest.mark.parametrize("status", SolveStatus)
def test_a_status_is_found_again_by_its_word_in_a_file(status):
    assert SolveStatus(status.value) is status
