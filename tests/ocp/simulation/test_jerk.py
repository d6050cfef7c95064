"""The jerk of a motion, by both integrators: closed forms and differences of the acceleration."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from quietarm.ocp import CycloidPolynomial, JointProfile, resimulate, rollout


@dataclass(frozen=True)
class _Quintic(JointProfile):
    """theta from rest to rest along 10 x^3 - 15 x^4 + 6 x^5, x = t/T; no third derivative given."""

    @property
    def size(self):
        return 0

    def derivatives(self, coefficients, fraction, start, target, duration):
        x, span = fraction, target - start
        return (
            start + span * x * x * x * (10 - 15 * x + 6 * x * x),
            span / duration * 30 * x * x * (1 - x) * (1 - x),
            span / duration**2 * 60 * x * (1 - x) * (1 - 2 * x),
        )


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_plain_cycloids_peak_is_its_closed_form(tasks, name):
    # Eq (1) with U = t/T: theta' = span/T (1 - cos(2 pi t/T)), so that theta''' is
    # 4 pi^2 span/T^3 cos(2 pi t/T): largest at both ends and half-way.
    task, plain = tasks[name], CycloidPolynomial(0)
    peak = 4 * math.pi**2 * abs(task.span) / task.duration**3
    assert resimulate(task, plain, []).peak_jerk == pytest.approx(peak, rel=1e-12)
    assert rollout(task, plain, []).motion.peak_jerk == pytest.approx(peak, rel=1e-12)


def test_a_profile_that_gives_no_third_derivative_has_a_jerk(tasks):
    # The quintic's third derivative is 60 span/T^3 (1 - 6 x + 6 x^2): 60 at both ends.
    task = tasks["arm"]
    peak = 60 * task.span / task.duration**3
    assert resimulate(task, _Quintic(), []).peak_jerk == pytest.approx(peak, rel=1e-12)
    x = np.linspace(0.0, 1.0, 11)
    jerk = _Quintic().path([], *task.move)(x * task.duration, 3)
    assert jerk == pytest.approx(peak * (1 - 6 * x + 6 * x**2), rel=1e-9, abs=1e-9 * peak)
