"""The jerk of a motion, by both integrators: closed forms and differences of the acceleration."""

import math

import pytest
from fixed_steps import rollout
from quietarm.ocp import Candidate, CycloidPolynomial


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_plain_cycloids_peak_is_its_closed_form(tasks, name):
    # Eq (1) with U = t/T: theta' = span/T (1 - cos(2 pi t/T)), so that theta''' is
    # 4 pi^2 span/T^3 cos(2 pi t/T): largest at both ends and half-way.
    task, plain = tasks[name], CycloidPolynomial(0)
    peak = 4 * math.pi**2 * abs(task.span) / task.duration**3
    assert Candidate.of_profile(task, plain, []).motion.peak_jerk == pytest.approx(peak, rel=1e-12)
    assert rollout(task, plain, []).motion.peak_jerk == pytest.approx(peak, rel=1e-12)
