"""A search spends what CVODES finds, whatever counts as energy."""

from dataclasses import replace

import numpy as np
import pytest

import quietarm as qa
from quietarm.metaheuristics.evaluation.population import search_evaluator
from quietarm.ocp import PositivePower
from quietarm.ocp.simulation.evaluator import Evaluator


@pytest.fixture(
    params=[PositivePower(), qa.CopperLoss(0.12), qa.AbsolutePower() + qa.CopperLoss(0.3)],
    ids=lambda energy: energy.label,
)
def energy(request):
    return request.param


@pytest.mark.slow_after(2)
@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_a_population_spends_what_cvodes_finds(tasks, name, energy):
    task, bound = tasks[name]
    task, profile = replace(task, energy=energy), qa.CycloidPolynomial(4)
    X = np.random.default_rng(3).uniform(-bound, bound, (6, 4))
    expected = [qa.JudgedMotion.of_profile(task, profile, x).energy for x in X]
    fine = Evaluator(task, profile)(X).energy[:, 0]
    assert fine == pytest.approx(expected, rel=1e-5)
    assert search_evaluator(task, profile)(X).energy[:, 0] == pytest.approx(expected, rel=3e-3)


@pytest.mark.slow_after(1)
def test_a_search_states_what_cvodes_finds(tasks, energy):
    task = replace(tasks["single link"][0], energy=energy)
    front = qa.search(task, algorithm="nsga2", bound=0.2, population=20, generations=10)
    for point in (front.points[0], front.points[-1]):
        motion = qa.JudgedMotion.of_profile(task, front.profile, point.coefficients).motion
        assert point.energy == pytest.approx(motion.energy, rel=1e-5)
