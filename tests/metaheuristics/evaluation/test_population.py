"""The population objective: the same F1, F2 and peaks as the one rollout, for many at once."""

import dataclasses
import math

import numpy as np
import pytest
from fixed_steps import rollout
from populations import PLANTS, PROFILE, candidates, same_bits

from quietarm.metaheuristics.evaluation.population import search_evaluator
from quietarm.ocp import CycloidGaussians, CycloidNetwork, CycloidSpline
from quietarm.ocp.limits import QUANTITIES

LIMITS = tuple(QUANTITIES)

# -- the same quantities as the rollout --


@pytest.mark.slow_after(7)
@PLANTS
@pytest.mark.parametrize(
    "profile", [PROFILE, CycloidGaussians(3), CycloidNetwork(3), CycloidSpline(5)]
)
def test_energy_and_residual_are_those_of_the_rollout_at_the_same_steps(tasks, name, profile):
    task, bound = tasks[name]
    random = np.random.default_rng(1)
    X = random.uniform(*profile.start_box(bound), size=(20, profile.size))
    objective = search_evaluator(task, profile)
    values = objective(X)
    motions = [rollout(task, profile, x, objective.steps).motion for x in X]
    assert values.energy[:, 0] == pytest.approx([m.energy for m in motions], rel=1e-12, abs=0)
    # Both watch the tip at times of their own, that miss a peak by 5e-5 of it at most
    # (`FreeVibration.rows`).
    residuals = [m.residual for m in motions]
    assert values.sampled_residual[:, 0] == pytest.approx(residuals, rel=5e-5, abs=0)


# -- limits --


@pytest.mark.slow_after(2)
@PLANTS
def test_violations_are_the_rollouts_peaks_over_the_limits(tasks, name):
    task, bound = tasks[name]
    X = candidates(30, bound)
    steps = 40
    motions = [rollout(task, PROFILE, x, steps).motion for x in X]
    peaks = np.array([[motion.peak(limit) for limit in LIMITS] for motion in motions])
    limits = np.median(peaks, axis=0)  # half of the candidates break each
    limited = dataclasses.replace(
        task, **{f"{name}_limit": float(v) for name, v in zip(LIMITS, limits, strict=True)}
    )
    values = search_evaluator(limited, PROFILE, steps)(X)
    assert values.violations.shape == (30, len(LIMITS))
    assert values.violations == pytest.approx(peaks / limits - 1, rel=0, abs=1e-12)
    assert np.array_equal(values.violations > 0, peaks > limits)
    assert np.all((values.violations > 0).sum(axis=0) == 15)
    without = search_evaluator(task, PROFILE, steps)(X)
    assert without.violations.shape == (30, 0)
    assert values.energy == pytest.approx(without.energy, rel=1e-12, abs=0)


# -- populations --


def test_a_candidate_costs_the_same_bits_wherever_it_stands(tasks):
    task, bound = tasks["arm"]
    objective, X = search_evaluator(task, PROFILE), candidates(450, bound)
    order = np.random.default_rng(5).permutation(450)
    values, shuffled = objective(X), objective(X[order])
    assert np.array_equal(values.energy[order], shuffled.energy)
    assert np.array_equal(values.sampled_residual[order], shuffled.sampled_residual)
    assert len(np.unique(values.energy)) == 450


@PLANTS
def test_two_threads_give_identical_bits(tasks, name):
    task, bound = tasks[name]
    task = dataclasses.replace(task, torque_limit=0.1)
    X = candidates(1050, bound)
    one, two = (search_evaluator(task, PROFILE, threads=threads)(X) for threads in (1, 2))
    assert same_bits(one, two)


@PLANTS
@pytest.mark.parametrize("bad", [math.nan, 1e200])
def test_a_candidate_that_is_not_finite_spoils_only_its_own_row(tasks, name, bad):
    task, bound = tasks[name]
    task = dataclasses.replace(task, torque_limit=0.1, deflection_limit=0.01)
    objective, X = search_evaluator(task, PROFILE), candidates(250, bound)
    expected, spoilt = objective(X), X.copy()
    spoilt[[3, 199, 249], [0, 2, 5]] = bad
    values = objective(spoilt)
    rows = np.column_stack([values.sampled_residual, values.energy, values.violations])
    bad_rows = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    assert bad_rows.tolist() == [3, 199, 249]
    kept = np.setdiff1d(np.arange(250), bad_rows)
    for attribute in ("sampled_residual", "energy", "violations"):
        assert np.array_equal(getattr(values, attribute)[kept], getattr(expected, attribute)[kept])
