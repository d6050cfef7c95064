"""`quietarm reproduce` as typed, what it refuses."""

import pytest
from quietarm.studies.reproduce.recompute import Effort, number_of_pieces


@pytest.mark.parametrize(
    ("line", "words"),
    [("reproduce --seeds 0", "seeds is 0"), ("reproduce --workers 0", "workers is 0")],
)
def test_numbers_that_cannot_be_are_refused_in_a_line(call, line, words):
    code, out, err = call(line)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err


def test_full_effort_searches_more_from_every_seed():
    few, full = (Effort(full=full, seeds=2) for full in (False, True))
    assert set(few.searched) < set(full.searched)
    assert number_of_pieces(full) > 2 * number_of_pieces(few)
