"""The certificates of the exact fronts."""

from dataclasses import replace

import pytest
from quietarm.metaheuristics import PROBLEMS, problem_of
from quietarm.metaheuristics.problems import catalogue, certificate
from quietarm.metaheuristics.problems.certificate import Certificates, certified, checksum

KEPT = Certificates.kept()
NAME = "single-link-30deg-0.8s-2-terms"


@pytest.mark.parametrize("name", PROBLEMS)
def test_every_front_is_the_one_that_was_certified(name):
    problem = problem_of(name)
    for front_name, front in zip(problem.tasks(), problem.fronts(), strict=True):
        assert KEPT[front_name].checksum == checksum(front)
        assert KEPT[front_name].holds
        assert len(KEPT[front_name].prices) == len(front.points) == KEPT[front_name].confirmed


@pytest.mark.parametrize("one", KEPT.values(), ids=list(KEPT))
def test_the_figures_of_cvodes_are_held_against_another_integrator(one):
    assert 0 < one.energy_by_steps < 1e-7  # not against itself; docs/problems.md has the figures
    assert 0 < one.residual_by_steps < 1e-4


def test_a_certificate_does_not_hold_where_integrators_differ(monkeypatch):
    monkeypatch.setattr(certificate, "FIXED_STEPS", 8)
    (coarse,) = certified(problem_of(NAME))
    assert coarse.energy_difference < 1e-6
    assert not coarse.holds


def test_a_dearer_front_is_beaten(monkeypatch):
    (front,) = problem_of(NAME).fronts()
    dearer = tuple(replace(point, energy=point.energy * 1.001) for point in front.points)
    monkeypatch.setattr(catalogue, "_loaded", lambda path: replace(front, points=dearer))
    (worse,) = certified(problem_of(NAME))
    assert worse.gained == pytest.approx(1e-3, rel=0.01)
    assert not worse.holds
    assert certificate.BEATEN == 1e-4  # docs/problems.md states what was measured
