"""Robust plans: the residual limit holds between the samples, whatever the error."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from models import SingleLinkManipulator
from ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    Plan,
    PointToPoint,
    SolverFailedError,
    UncertainPlant,
    evaluate_coefficients,
    evaluate_robustness,
    plan_move,
    resimulate,
    with_errors,
)
from ocp.plan import robust
from ocp.robustness.uncertain import on_assumed
from ocp.robustness.worst import peaks_between

RANGE = 0.1


@pytest.fixture(scope="module")
def task():
    plant = UncertainPlant(SingleLinkManipulator(), {"frequency": RANGE})
    return PointToPoint(plant, target=pi / 6, duration=0.8)


@pytest.fixture(scope="module")
def rounds():
    """Every plan on the way to the one below."""
    return []


@pytest.fixture(scope="module")
def plan(task, rounds):
    checked = robust._checked

    def noted(plan):
        found = checked(plan)
        rounds.append(found[0])
        return found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(robust, "_checked", noted)
        return plan_move(task, starts=1)


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


def test_the_limit_is_five_percent_of_what_the_cycloid_leaves(task, plan):
    cycloid = evaluate_coefficients(on_assumed(task), []).residual
    assert plan.provenance.settings.residual_limit == pytest.approx(0.05 * cycloid)


def test_the_limit_holds_between_the_samples(plan):
    limit = plan.provenance.settings.residual_limit
    assert plan.excess <= 0
    # none of these is a sample, or a point of the grid on which the worst was looked for
    errors = RANGE * np.array([-0.937, -0.613, -0.337, -0.113, 0.113, 0.187, 0.263, 0.613, 0.937])
    assert max(residuals(plan, errors)) <= plan.worst.residual * (1 + 1e-4) <= limit * (1 + 1e-4)
    found = evaluate_robustness(
        plan.task, plan.profile, plan.coefficients, {"frequency": RANGE}, samples=1
    )
    assert found.sweeps[0].insensitivity == (-RANGE, RANGE)


def test_samples_were_added_where_the_limit_was_passed(task, plan, rounds):
    first = rounds[0]
    assert first.task == task
    assert first.excess > robust.EXCESS  # else nothing here is tested
    assert residuals(first, [first.worst.errors["frequency"]]) == [first.worst.residual]
    assert len(plan.task.plant.samples) > len(task.plant.samples)
    assert all(abs(error) <= RANGE for (error,) in plan.task.plant.samples)
    assert plan.energy >= first.energy


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


def test_ctrl_c_keeps_the_last_round(task, plan, rounds, monkeypatch):
    monkeypatch.setattr(robust, "_checked", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
    found = robust._held_between(rounds[0], plan.provenance.settings, lambda *_: None)
    assert not found.complete
    assert "before the residual was held between the samples" in found.provenance.stopped
    assert found.coefficients == rounds[0].coefficients


@pytest.fixture(scope="module")
def at_rest(task):
    return plan_move(on_assumed(task), CycloidPolynomial(2), starts=1)


@pytest.mark.parametrize("complete", [True, False])
def test_it_begins_with_the_assumed_plant_s_plan_and_ctrl_c_keeps_it(task, plan, at_rest, complete):
    settings, asked = plan.provenance.settings, []
    stopped = replace(at_rest.provenance, stopped=None if complete else "1 of 4 starts")

    def interrupted(task, profile, settings):
        asked.append((task, settings.residual_limit, settings.guess))
        if len(asked) == 2:
            raise KeyboardInterrupt
        return replace(at_rest, provenance=stopped)

    found = robust.robust_plan(task, at_rest.profile, settings, interrupted)
    first = [(on_assumed(task), 0.0, None)]
    then = [(task, settings.residual_limit, at_rest.coefficients)] * complete
    assert asked == first + then
    assert not found.complete
    assert found.provenance.stopped == "the assumed plant's plan, before there was a robust one"
    assert (found.task, found.coefficients) == (task, at_rest.coefficients)
    assert found.worst == evaluate_coefficients(task, at_rest.coefficients).worst
    assert found.excess > robust.EXCESS
    assert found.provenance.settings == settings


def test_ctrl_c_before_there_is_any_plan_is_told(task, plan):
    def interrupted(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        robust.robust_plan(task, plan.profile, plan.provenance.settings, interrupted)


def test_peaks_are_judged_by_one_integrator(plan):
    worst, peaks = peaks_between(plan.task, plan.profile, plan.coefficients, 4)
    assert len(peaks) > 1
    assert residuals(plan, peaks[:, 1]) == peaks[:, 0].tolist()
    assert peaks[0].tolist() == [worst.residual, worst.errors["frequency"]]
    assert peaks[:, 0].tolist() == sorted(peaks[:, 0], reverse=True)


def test_a_sample_that_is_there_is_not_added_again(task):
    beside = np.array([[-RANGE], [0.5 * RANGE], [RANGE * (1 - 1e-9)]])
    assert robust._new_samples(task, beside) == [[0.5 * RANGE]]


# -- bad input --


def test_rest_is_not_asked_for(task):
    with pytest.raises(ValueError, match="no motion arrives at rest whatever the errors"):
        plan_move(task, residual_limit=0.0)


def test_what_cannot_be_met_says_what_can(task):
    with pytest.raises(InfeasibleTaskError, match="feasible with the rest kept: residual limit"):
        plan_move(task, CycloidPolynomial(1), bound=0.2, starts=1)


def test_where_the_solver_fails_it_starts_again_with_samples_between(task, plan):
    asked = []

    def fails_at_first(task, profile, settings):
        asked.append(task.plant.samples)
        if len(asked) == 1:
            raise SolverFailedError("none of 3 starts was solved")
        return replace(plan, task=task)

    settings = replace(plan.provenance.settings, guess=plan.coefficients)
    found = robust.robust_plan(task, plan.profile, settings, fails_at_first)
    assert asked[:2] == [((-RANGE,), (RANGE,)), ((-RANGE,), (RANGE,), (-RANGE / 2,), (RANGE / 2,))]
    assert found.excess <= robust.EXCESS


def test_where_no_motion_is_there_it_does_not_start_again(task, plan):
    asked = []

    def infeasible(task, profile, settings):
        asked.append(task)
        raise InfeasibleTaskError("no motion")

    with pytest.raises(InfeasibleTaskError, match="no motion"):
        robust.robust_plan(task, plan.profile, plan.provenance.settings, infeasible)
    assert [one.plant for one in asked] == [task.plant.assumed, task.plant]
