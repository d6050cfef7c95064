"""The population objective against the independent integrator, and the paper's own figures."""

import math

import numpy as np
import pytest
from populations import PROFILE, SINGLE_LINK, candidates, pi
from quietarm.metaheuristics import PopulationObjective
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import Candidate, PointToPoint
from quietarm.studies.reproduce.paper import CONDITIONS

FINE = 140  # ocp.simulation.grid.ROLLOUT_STEPS
EACH_CASE = pytest.mark.parametrize("case", CONDITIONS, ids=lambda case: case.name)


@EACH_CASE
def test_nine_in_ten_energies_are_within_the_error_stated(case):
    # `CANDIDATE_STEPS` states 1e-4. The reference is the finer rollout, itself within 1e-5 of
    # CVODES (docs/accuracy.md), as the next test checks on fewer candidates.
    task, X = case.task, candidates(1000, case.bound, seed=2)
    fine = PopulationObjective(task, PROFILE, steps=FINE)(X).energy
    error = np.abs(PopulationObjective(task, PROFILE)(X).energy / fine - 1)
    assert np.mean(error <= 9e-5) >= 0.9, np.quantile(error, [0.5, 0.9, 0.99, 1.0])


@EACH_CASE
def test_energy_and_residual_are_those_of_the_independent_integrator(case):
    task, X = case.task, candidates(8, case.bound, seed=4)
    values = PopulationObjective(task, PROFILE)(X)
    fine = PopulationObjective(task, PROFILE, steps=FINE)(X)
    motions = [Candidate.of_profile(task, PROFILE, x).motion for x in X]
    assert fine.energy == pytest.approx([m.energy for m in motions], rel=1e-5, abs=0)
    residuals = np.array([motion.residual for motion in motions])
    # W and W'/omega 1e-6 m off at arrival (`CANDIDATE_STEPS`), on top of the 5e-5 of a peak between
    # two samples (and 1.2e-6 of one that CVODES' own samples miss).
    allowed = 5.2e-5 * residuals + task.plant.phi * math.sqrt(2) * 1e-6
    assert np.all(np.abs(values.residual - residuals) <= allowed)


@pytest.mark.parametrize(
    ("plant", "duration", "bound"),
    [(SingleLinkManipulator(omega=30.0), 0.8, 0.2), (SINGLE_LINK, 3.0, 0.2)],
    ids=["fast link", "long move"],
)
def test_other_plants_and_durations_are_as_accurate(plant, duration, bound):
    task = PointToPoint(plant, pi / 2, duration)
    X = candidates(10, bound, seed=8)
    values = PopulationObjective(task, PROFILE)(X)
    motions = [Candidate.of_profile(task, PROFILE, x).motion for x in X]
    error = np.abs(values.energy / [motion.energy for motion in motions] - 1)
    assert np.sum(error <= 1e-4) >= 9, error  # as above
    residuals = np.array([motion.residual for motion in motions])
    allowed = 5.2e-5 * residuals + task.plant.phi * math.sqrt(2) * 1e-6
    assert np.all(np.abs(values.residual - residuals) <= allowed)
