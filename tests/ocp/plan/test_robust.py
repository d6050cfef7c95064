"""Robust plans: the residual limit holds between the samples, whatever the error."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    Plan,
    PointToPoint,
    SolverFailedError,
    UncertainPlant,
    evaluate_coefficients,
    plan_move,
    resimulate,
    with_errors,
)
from quietarm.ocp.plan import robust
from quietarm.ocp.plan.solver import plan_at_samples
from quietarm.ocp.robustness.uncertain import on_assumed
from quietarm.ocp.robustness.worst import peaks_between

RANGE = 0.1


@pytest.fixture(scope="module")
def task():
    plant = UncertainPlant(SingleLinkManipulator(), {"frequency": RANGE})
    return PointToPoint(plant, target=pi / 6, duration=0.8)


@pytest.fixture(scope="module")
def plan(task):
    return plan_move(task, starts=1)


@pytest.fixture(scope="module")
def at_samples(task, plan):
    """The plan before the limit is held between the samples."""
    return plan_at_samples(task, plan.profile, plan.provenance.settings)


def residuals(plan, errors):
    """By CVODES, of the motion on plants with these errors."""
    task = on_assumed(plan.task)
    return [
        resimulate(
            replace(task, plant=with_errors(task.plant, {"frequency": error})),
            plan.profile,
            plan.coefficients,
        ).residual
        for error in errors
    ]


def test_the_limit_holds_between_the_samples(plan):
    limit = plan.provenance.settings.residual_limit
    assert plan.excess <= 0
    # none of these is a sample, or a point of the grid on which the worst was looked for
    errors = RANGE * np.array([-0.937, -0.613, -0.337, -0.113, 0.113, 0.187, 0.263, 0.613, 0.937])
    assert max(residuals(plan, errors)) <= plan.worst.residual * (1 + 1e-4) <= limit * (1 + 1e-4)


def test_samples_are_added_where_the_limit_is_passed_between_them(task, plan, at_samples):
    assert at_samples.task == task
    worst, _ = peaks_between(task, plan.profile, at_samples.coefficients, 4)
    limit = plan.provenance.settings.residual_limit
    assert worst.residual > (1 + robust.EXCESS) * limit  # else nothing here is tested
    assert len(plan.task.plant.samples) > len(task.plant.samples)
    assert all(abs(error) <= RANGE for (error,) in plan.task.plant.samples)
    assert plan.energy >= at_samples.energy


def test_residual_and_energy_are_those_of_samples_and_assumed_plant(plan):
    samples = [0.0, *(error for (error,) in plan.task.plant.samples)]
    assert plan.residual == pytest.approx(max(residuals(plan, samples)), rel=1e-6)
    alone = evaluate_coefficients(on_assumed(plan.task), plan.coefficients)
    assert plan.energy == pytest.approx(alone.energy, rel=1e-8)


def test_it_saves_and_loads_equal(plan, tmp_path):
    plan.save(tmp_path / "plan.json")
    loaded = Plan.load(tmp_path / "plan.json")
    assert loaded == plan
    assert loaded.excess == plan.excess


def test_ctrl_c_keeps_the_last_round(task, plan, at_samples):
    asked = []

    def interrupted(task, profile, settings, starts):
        asked.append([list(start) for start in starts])
        if len(asked) == 2:
            raise KeyboardInterrupt
        return at_samples, [np.array(at_samples.coefficients)]

    settings = plan.provenance.settings
    found = robust.robust_plan(task, plan.profile, settings, interrupted)
    assert asked[0] == [[0.0] * 6]
    assert list(at_samples.coefficients) in asked[1]
    assert not found.complete
    assert "before the residual was held between the samples" in found.provenance.stopped
    assert found.coefficients == at_samples.coefficients
    assert found.excess > robust.EXCESS
    assert found.provenance.settings == settings


def test_a_round_that_ctrl_c_ended_is_the_last(task, plan, at_samples):
    stopped = replace(at_samples.provenance, stopped="1 of 4 starts")

    def once(*_):
        return replace(at_samples, provenance=stopped), []

    found = robust.robust_plan(task, plan.profile, plan.provenance.settings, once)
    assert found.provenance.stopped == "1 of 4 starts"
    assert found.coefficients == at_samples.coefficients


def test_peaks_are_judged_by_one_integrator(plan):
    worst, peaks = peaks_between(plan.task, plan.profile, plan.coefficients, 4)
    assert len(peaks) > 1
    assert residuals(plan, peaks[:, 1]) == pytest.approx(peaks[:, 0].tolist(), rel=1e-5)
    assert peaks[0].tolist() == [worst.residual, worst.errors["frequency"]]
    assert peaks[:, 0].tolist() == sorted(peaks[:, 0], reverse=True)


# -- bad input --


def test_rest_is_not_asked_for(task):
    with pytest.raises(ValueError, match="no motion arrives at rest whatever the errors"):
        plan_move(task, residual_limit=0.0)


def test_what_cannot_be_met_says_what_can(task):
    with pytest.raises(InfeasibleTaskError, match="feasible with the rest kept: residual limit"):
        plan_move(task, CycloidPolynomial(1), bound=0.2, starts=1)


def test_a_limit_that_cannot_be_tightened_keeps_the_plan(task, plan, at_samples):
    # What comes after the first plan fails: it stands, and its excess says by how much it passes.
    asked = []

    def fails_when_tighter(task, profile, settings, starts):
        if settings.residual_limit < plan.provenance.settings.residual_limit:
            raise SolverFailedError("none of 1 starts was solved")
        asked.append(task)
        return replace(at_samples, task=task), []

    found = robust.robust_plan(task, plan.profile, plan.provenance.settings, fails_when_tighter)
    assert found.excess > 0
    assert len(asked[-1].plant.samples) > len(asked[0].plant.samples)
    assert found.coefficients == at_samples.coefficients


def test_where_no_motion_is_there_it_does_not_start_again(task, plan):
    asked = []

    def infeasible(task, *_):
        asked.append(task)
        raise InfeasibleTaskError("no motion")

    with pytest.raises(InfeasibleTaskError, match="no motion"):
        robust.robust_plan(task, plan.profile, plan.provenance.settings, infeasible)
    assert asked == [task]


def test_ipopt_finds_the_same(task, plan):
    other = plan_move(task, starts=1, solver="ipopt")
    assert other.provenance.method == "ipopt"
    assert other.excess <= robust.EXCESS
    assert other.energy == pytest.approx(plan.energy, rel=1e-2)
