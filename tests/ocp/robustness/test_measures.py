"""Sweeps and samples against single evaluations by CVODES and against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import quietarm as qa
from quietarm.ocp import perturb_plant

LINEAR = qa.SingleLinkManipulator(beta2=0.0, zeta=0.0)
RANGES = {
    "single link": {"frequency": 0.2, "damping": 0.5, "beta2": 0.3, "c": 0.1, "phi": 0.05},
    "arm": {"frequency": 0.2, "alpha1": 0.5, "alpha3": 0.1, "beta2": 0.3, "c": 0.2},
    "two links": {"omega1": 0.15, "omega2": 0.15, "c": 0.1, "b1": 0.9, "a2": 0.01},
}


def of_plan(plan, ranges, **settings):
    return qa.evaluate_robustness(plan.candidate, ranges, **settings)


def alone(plan, errors):
    """The figures of a plan on one plant with errors, by CVODES."""
    task = replace(plan.task, plant=perturb_plant(plan.task.plant, errors))
    return qa.JudgedMotion.of_profile(task, plan.profile, plan.coefficients).motion


@pytest.fixture(scope="module")
def plans(tasks, solved):
    return {name: solved(task, bound=0.5) for name, task in tasks.items()}


@pytest.fixture(scope="module", params=RANGES)
def evaluated(request, plans):
    """A plan, its ranges, and its robustness with samples in two blocks, the last not full."""
    plan, ranges = plans[request.param], RANGES[request.param]
    return plan, ranges, of_plan(plan, ranges, samples=150, seed=4)


@pytest.mark.slow_after(1)
def test_samples_are_what_cvodes_finds_one_by_one(evaluated):
    plan, ranges, found = evaluated
    scale = found.samples.residual.max()
    for i in (0, 99, 100, 149):
        single = alone(plan, dict(zip(ranges, found.errors[i].tolist(), strict=True)))
        # The residual misses 5e-5 of a peak by its samples in time (`RADIANS_A_SAMPLE`); the peak
        # torque is that at the nodes.
        assert found.samples.residual[i] == pytest.approx(
            single.residual, rel=6e-5, abs=1e-6 * scale
        )
        assert found.samples.energy[i] == pytest.approx(single.energy, rel=1e-6)
        assert found.samples.peak_torque[i] == pytest.approx(single.peak_torque, rel=1e-3)


@pytest.mark.slow_after(1)
def test_sweeps_change_one_thing_alone(evaluated):
    plan, ranges, found = evaluated
    assert [sweep.name for sweep in found.sweeps] == list(ranges)
    for sweep in found.sweeps:
        assert sweep.errors[[0, 100, -1]] == pytest.approx(
            [-ranges[sweep.name], 0, ranges[sweep.name]]
        )
        single = alone(plan, {sweep.name: float(sweep.errors[-1])})
        assert sweep.figures.residual[-1] == pytest.approx(single.residual, rel=6e-5, abs=1e-7)
        assert sweep.figures.energy[-1] == pytest.approx(single.energy, rel=1e-6)
        assert sweep.figures.residual[100] == pytest.approx(found.assumed.residual[0], rel=1e-7)


def plain_residual(r, task, length):
    """Return the residual of a cycloid of this length, undamped, at r times the frequency [m].

    W'' + w^2 W = -b theta'' is left with b / w |integral of theta'' exp(j w t)|, where
    theta'' = span turn / length sin(turn t).
    """
    plant, turn, w = task.plant, 2 * math.pi / length, r * task.plant.omega
    integral = 2 * turn * math.sin(w * length / 2) / (turn**2 - w**2)
    return abs(plant.phi * plant.beta1 / w * task.span * turn / length * integral)


def left(shaper, r, task, profile):
    """Return the residual of a shaped cycloid: docs/physics.md, 'Input shaping', has the curves."""
    share = {
        "zv": abs(math.cos(math.pi * r / 2)),
        "zvd": math.cos(math.pi * r / 2) ** 2,
        "ei": abs(1.05 / 2 * math.cos(math.pi * r) + 0.95 / 2),
    }[shaper]
    return share * plain_residual(r, task, task.duration - profile.length)


def ends(excess, step=1e-3):
    """Where an excess below 0 at r = 1 is first 0 on either side, as errors."""
    found = []
    for side in (-step, step):
        r = 1.0
        while excess(r + side) <= 0:
            r += side
        found.append(brentq(excess, *sorted((r, r + side))) - 1)
    return found


@pytest.mark.parametrize(("shaper", "duration"), [("zv", 0.9), ("zvd", 0.9)])
def test_the_insensitivity_of_shapers_is_that_of_the_closed_form(shaper, duration):
    task = qa.PointToPoint(LINEAR, 1.0, duration)
    profile = qa.shaped_cycloid(task, shaper)
    candidate = qa.JudgedMotion.of_profile(task, profile, [])
    found = qa.evaluate_robustness(candidate, {"frequency": 0.6}, samples=1)
    sweep, plain = found.sweeps[0], plain_residual(1.0, task, duration)
    assert found.cycloid == pytest.approx(plain, rel=1e-5)
    expected = [left(shaper, 1 + error, task, profile) for error in sweep.errors]
    # The steps do not end where a cycloid begins, whose jerk jumps.
    assert sweep.figures.residual == pytest.approx(expected, rel=1e-3, abs=1e-4 * max(expected))
    closed = ends(lambda r: left(shaper, r, task, profile) - 0.05 * plain)
    assert sweep.insensitivity == pytest.approx(closed, abs=1e-3)  # by errors 0.006 apart
    assert sweep.open_ends == (False, False)


def test_samples_come_from_the_seed_and_fill_the_ranges(plans):
    ranges = {"frequency": 0.1, "beta1": 0.3}
    one, same, other = (
        of_plan(plans["single link"], ranges, samples=500, seed=s) for s in (1, 1, 2)
    )
    assert np.array_equal(one.errors, same.errors)
    assert np.array_equal(one.samples.residual, same.samples.residual)
    assert not np.array_equal(one.errors, other.errors)
    # Uniform: of 500, the least and the largest are within 4 % of the ends, but for 2e-9.
    for column, size in zip(one.errors.T, ranges.values(), strict=True):
        assert -size <= column.min() < -0.92 * size
        assert 0.92 * size < column.max() <= size
    assert one.seed == 1
    assert one.percentile("residual", 100) == one.samples.residual.max()
    assert one.percentile("energy", 50) == pytest.approx(np.median(one.samples.energy))
