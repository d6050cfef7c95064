"""What every function asks of its arguments first."""

import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    PointToPoint,
    epsilon_front,
    weighted_front,
)


@pytest.mark.parametrize("work", [epsilon_front, weighted_front])
def test_a_report_that_cannot_be_called_is_refused_first(work):
    with pytest.raises(ValueError, match="report is 3; give a function, or leave it out"):
        work(PointToPoint(SingleLinkManipulator(), 1.0, 0.8), report=3)
