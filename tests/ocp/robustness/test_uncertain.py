"""An uncertain task: what it computes, and where a motion leaves most."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from fixed_steps import rollout

import quietarm as qa
from quietarm.ocp import perturb_plant
from quietarm.ocp.robustness import worst_of, worst_of_rows
from quietarm.ocp.simulation.evaluator import Evaluator

MOVE = [0.003347, -0.1697]  # the paper's, N = 2


@pytest.fixture(scope="module")
def task():
    uncertainty = qa.Uncertainty({"frequency": 0.1, "phi": 0.05})
    return qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8, uncertainty=uncertainty)


@pytest.fixture(scope="module")
def two_links_task():
    uncertainty = qa.Uncertainty({"frequency": 0.2}, ((0.2,),))
    return qa.PointToPoint(qa.DualLinkManipulator(), pi / 2, 0.9, uncertainty=uncertainty)


@pytest.fixture(scope="module")
def evaluated(task):
    return qa.evaluate_coefficients(task, MOVE)


@pytest.mark.parametrize("of", ["task", "two_links_task"])
def test_figures_are_the_worst_of_the_parts_alone(of, request):
    task = request.getfixturevalue(of)
    profile = qa.CycloidPolynomial(len(MOVE))
    alone = [
        qa.JudgedMotion.of_profile(replace(task.certain, plant=plant), profile, MOVE).motion
        for plant in (
            perturb_plant(task.plant, dict(zip(task.error_names, errors, strict=True)))
            for errors in task.scenarios
        )
    ]
    together, fixed = (
        qa.JudgedMotion.of_profile(task, profile, MOVE).motion,
        rollout(task, profile, MOVE).motion,
    )
    for found, tolerance in ((together, 1e-6), (fixed, 1e-2)):  # fixed steps: peaks at the nodes
        for name in ("residual", "peak_deflection"):
            largest = max(getattr(one, name) for one in alone)
            assert getattr(found, name) == pytest.approx(largest, rel=tolerance)
        assert found.energy == pytest.approx(alone[0].energy, rel=tolerance)
        assert found.peak_torque == pytest.approx(alone[0].peak_torque, rel=tolerance)


def test_worst_is_what_a_dense_search_finds(task, evaluated):
    grid = np.meshgrid(np.linspace(-0.1, 0.1, 60), np.linspace(-0.05, 0.05, 60))
    errors = np.reshape(grid, (2, -1)).T
    largest = Evaluator(task, evaluated.profile, 160)([MOVE], errors).residual.max()
    assert evaluated.worst.residual == pytest.approx(largest, rel=1e-3)
    there = perturb_plant(task.plant, evaluated.worst.errors)
    again = qa.JudgedMotion.of_profile(
        replace(task.certain, plant=there), evaluated.profile, MOVE
    ).motion
    # With the errors as parameters CVODES takes other steps: within its tolerance the same.
    assert evaluated.worst.residual == pytest.approx(again.residual, rel=1e-5)


def test_many_motions_are_looked_at_within_their_range_at_once():
    """The paper's two terms leave most between the ends, the plain cycloid at one of them."""
    uncertainty = qa.Uncertainty({"frequency": 0.05})
    task = qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8, uncertainty=uncertainty)
    profile, rows = qa.CycloidPolynomial(2), [MOVE, [0.0, 0.0]]
    worst = worst_of_rows(task, profile, rows)
    motions = [qa.JudgedMotion.of_profile(task, profile, row) for row in rows]
    expected = [worst_of(motion).residual for motion in motions]
    assert worst == pytest.approx(expected, rel=2e-3)
