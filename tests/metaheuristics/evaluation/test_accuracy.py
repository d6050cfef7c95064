"""The population objective against the independent integrator, and the paper's own figures."""

import math

import numpy as np
import pytest
from populations import PROFILE, candidates, pi

from quietarm.metaheuristics.evaluation.population import search_evaluator
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import JudgedMotion, PointToPoint
from quietarm.studies.reproduce.paper import CONDITIONS

FINE = 140  # ocp.simulation.mesh.ROLLOUT_STEPS
EACH_CASE = pytest.mark.parametrize("case", CONDITIONS, ids=lambda case: case.name)


@EACH_CASE
def test_nine_in_ten_energies_are_within_the_error_stated(case):
    # `CANDIDATE_STEPS` states 1e-4. The reference is the finer rollout, itself within 1e-5 of
    # CVODES (docs/accuracy.md), as the next test checks on fewer candidates.
    task, X = case.task, candidates(1000, case.bound, seed=2)
    fine = search_evaluator(task, PROFILE, FINE)(X).energy
    error = np.abs(search_evaluator(task, PROFILE)(X).energy / fine - 1)
    assert np.mean(error <= 9e-5) >= 0.9, np.quantile(error, [0.5, 0.9, 0.99, 1.0])


OTHERS = [
    PointToPoint(SingleLinkManipulator(omega=30.0), pi / 2, 0.8),
    PointToPoint(SingleLinkManipulator(), pi / 2, 3.0),
]


@pytest.mark.parametrize(
    ("task", "bound"),
    [*((one.task, one.bound) for one in CONDITIONS), *((one, 0.2) for one in OTHERS)],
)
def test_energy_and_residual_are_those_of_the_independent_integrator(task, bound):
    X = candidates(8, bound, seed=4)
    values = search_evaluator(task, PROFILE)(X)
    fine = search_evaluator(task, PROFILE, FINE)(X)
    motions = [JudgedMotion.of_profile(task, PROFILE, x).motion for x in X]
    assert fine.energy[:, 0] == pytest.approx([m.energy for m in motions], rel=1e-5, abs=0)
    residuals = np.array([motion.residual for motion in motions])
    # W and W'/omega 1e-6 m off at arrival (`CANDIDATE_STEPS`), on top of the 5e-5 of a peak between
    # two samples (and 1.2e-6 of one that CVODES' own samples miss).
    allowed = 5.2e-5 * residuals + task.plant.phi * math.sqrt(2) * 1e-6
    assert np.all(np.abs(values.sampled_residual[:, 0] - residuals) <= allowed)
