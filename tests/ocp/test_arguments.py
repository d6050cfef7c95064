"""What every function asks of its arguments first."""

import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    PointToPoint,
    epsilon_front,
    resimulate,
    rollout,
    sample_trajectory,
    shaped_cycloid,
    weighted_front,
)


@pytest.mark.parametrize(
    "asked",
    [
        lambda task: resimulate(task, None, [0.1, 0.2]),
        lambda task: rollout(task, None, [0.1, 0.2]),
        lambda task: sample_trajectory(task, None, [0.1, 0.2], [0.1]),
        lambda task: resimulate(None, CycloidPolynomial(2), [0.1, 0.2]),
        lambda task: shaped_cycloid("x", "zv"),
        lambda task: Front.from_coefficients("x", [[0.1]], method="m"),
    ],
)
def test_what_is_no_task_or_profile_is_named(asked):
    with pytest.raises(ValueError, match=r"(task|profile) is .*; give a (PointToPoint|JointProf)"):
        asked(PointToPoint(SingleLinkManipulator(), 1.0, 0.8))


@pytest.mark.parametrize("work", [epsilon_front, weighted_front])
def test_a_report_that_cannot_be_called_is_refused_first(work):
    with pytest.raises(ValueError, match="report is 3; give a function, or leave it out"):
        work(PointToPoint(SingleLinkManipulator(), 1.0, 0.8), report=3)
