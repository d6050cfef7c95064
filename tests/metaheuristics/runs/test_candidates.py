"""Candidates that break a limit or fail: counted, and never in a front."""

import dataclasses
import math

import numpy as np
import pytest
from quietarm.metaheuristics import PopulationObjective
from quietarm.metaheuristics.objective.population import CANDIDATE_STEPS
from quietarm.ocp import CycloidPolynomial, Front, resimulate, rollout
from small_searches import (
    IMPOSSIBLE,
    LIMITED,
    METHODS,
    SWARMS,
    TASKS,
    assert_is_a_front,
    failing,
    found,
    one_line,
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
    for name, limit in task.limits.items():
        assert max(motion.peak(name) for motion in free) > limit  # it bites
    front = run(method, task, population=30, generations=20)
    assert len(front.points) > 3
    assert_is_a_front(front)
    for point in front.points:
        motion = rollout(task, front.profile, point.coefficients).motion
        for name, limit in task.limits.items():
            assert motion.peak(name) <= limit * (1 + 1e-6)
    for point in front.points[:: max(len(front.points) // 6, 1)]:
        independent = resimulate(task, front.profile, point.coefficients)
        for name, limit in task.limits.items():
            # a peak between two of the 420 nodes: (2 pi 5/420)^2/8 of a fifth harmonic
            assert independent.peak(name) <= limit * (1 + 7e-4)


@METHODS
def test_limits_that_nothing_keeps_leave_an_empty_front(tmp_path, method):
    task, seen = IMPOSSIBLE[method], []
    front = run(method, task, generations=3, report=seen.append)
    assert front.points == ()
    assert front.evaluations == SWARMS[method] * 60
    assert front.failed == 0
    assert front.infeasible == front.evaluations
    assert [progress.infeasible for progress in seen] == [e.evaluations for e in front.history]
    assert [entry.hypervolume for entry in front.history] == [0.0] * 3
    assert all(math.isnan(progress.residual) for progress in seen)
    words = (
        f"{front.evaluations} of {front.evaluations} candidates break the limits .*torque 0.0001"
    )
    with pytest.raises(ValueError, match=words):
        front.stillest()
    for select in (front.stillest, front.cheapest, front.knee, lambda: front.cheapest(1.0)):
        with pytest.raises(ValueError, match="the front has no point") as caught:
            select()
        one_line(caught)
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


@METHODS
def test_candidates_that_break_a_limit_are_counted(monkeypatch, method):
    counts, evaluate = [], PopulationObjective.__call__

    def counting(self, coefficients):
        values = evaluate(self, coefficients)
        if self.steps == CANDIDATE_STEPS:
            counts.append(sum(any(v > 0 for v in row) for row in values.violations.tolist()))
        return values

    monkeypatch.setattr(PopulationObjective, "__call__", counting)
    seen = []
    front = run(method, LIMITED[method], report=seen.append)
    assert 0 < front.infeasible < front.evaluations
    assert [progress.infeasible for progress in seen] == np.cumsum(counts).tolist()
    assert front.infeasible == seen[-1].infeasible
    assert found(method).infeasible == 0  # a task without limits


# -- candidates that fail --


@METHODS
@pytest.mark.parametrize(
    ("value", "column"),
    [
        (math.nan, "energy"),
        (math.nan, "residual"),
        (math.inf, "energy"),
        (-math.inf, "residual"),
        (math.nan, "violations"),
    ],
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


@METHODS
@pytest.mark.parametrize("energy", [math.inf, 1e31])
def test_when_all_candidates_fail_the_front_is_empty(monkeypatch, method, energy):
    evaluate = PopulationObjective.__call__

    def overflowing(self, coefficients):
        values = evaluate(self, coefficients)
        values.energy[:] = energy  # finite or not, it is counted
        return values

    monkeypatch.setattr(PopulationObjective, "__call__", overflowing)
    front = run(method, generations=4)
    assert front.points == ()
    assert front.failed == front.evaluations == SWARMS[method] * 80
    assert [entry.hypervolume for entry in front.history] == [0.0] * 4
    with pytest.raises(ValueError, match=r"no point; .* all \d+ .* overflow; narrow the bound"):
        front.stillest()
