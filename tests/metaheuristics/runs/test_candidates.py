"""Candidates that break a limit or fail: counted, and never in a front."""

import dataclasses
import math

import pytest
from fixed_steps import rollout
from quietarm.ocp import Candidate, CycloidPolynomial, Front
from small_searches import (
    IMPOSSIBLE,
    LIMITED,
    METHODS,
    SWARMS,
    TASKS,
    assert_is_a_front,
    failing,
    found,
    run,
)

# -- limits --


@METHODS
def test_every_point_keeps_the_limits(method):
    free = [
        rollout(TASKS[method], CycloidPolynomial(6), point.coefficients).motion
        for point in found(method).points
    ]
    task = LIMITED[method]
    front = run(method, task, population=30, generations=20)
    assert len(front.points) > 3
    assert_is_a_front(front)
    kept = [
        Candidate.of_profile(task, front.profile, point.coefficients).motion
        for point in front.points
    ]
    for limit in task.limits:
        assert max(map(limit.peak_of, free)) > limit.size  # it bites
        # a peak between two of the 420 nodes: (2 pi 5/420)^2/8 of a fifth harmonic
        assert all(limit.keeps(limit.peak_of(motion), 7e-4) for motion in kept)


@METHODS
def test_limits_that_nothing_keeps_leave_an_empty_front(tmp_path, method):
    front = run(method, IMPOSSIBLE[method], generations=3)
    assert (front.points, front.failed) == ((), 0)
    assert front.infeasible == front.evaluations == SWARMS[method] * 60
    assert [entry.hypervolume for entry in front.history] == [0.0] * 3
    words = f"{front.evaluations} of {front.evaluations} candidates break the limits .*torque"
    with pytest.raises(ValueError, match=words):
        front.stillest()
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


# -- candidates that fail --


@METHODS
@pytest.mark.parametrize(
    ("value", "column"),
    [(math.nan, "energy"), (-math.inf, "residual"), (math.nan, "violations")],
)
def test_failed_candidates_are_counted_and_never_enter_a_front(monkeypatch, method, value, column):
    task = dataclasses.replace(LIMITED[method], torque_limit=0.4)
    counts = failing(monkeypatch, value, column)
    front = run(method, task, population=12, generations=6)
    assert front.failed == sum(counts) > 6  # more than half of the first generation's half
    assert front.evaluations == SWARMS[method] * 72
    assert len(front.points) > 0
    assert all(point.coefficients[0] <= 0 for point in front.points)
    assert_is_a_front(front)
    assert all(0 <= entry.hypervolume < 1 for entry in front.history)
