"""Changes of a plan with each parameter of the plant."""

from dataclasses import replace
from math import pi

import pytest

from quietarm.models import SingleLinkManipulator
from quietarm.ocp import PointToPoint, evaluate_coefficients, plan_move
from quietarm.ocp.uncertainty import perturb_plant

LINK = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8)


@pytest.fixture(scope="module")
def plan():
    return plan_move(LINK)


def on_another(plan, **errors):
    """The plan's motion on a plant with errors."""
    task = replace(plan.task, plant=perturb_plant(plan.task.plant, errors))
    return evaluate_coefficients(task, plan.coefficients, profile=plan.profile)


@pytest.mark.slow
def test_a_small_error_does_what_the_derivatives_say(plan):
    of = {one.parameter: one for one in plan.sensitivities}
    for name in ("omega", "zeta", "alpha1", "beta2"):
        wrong, less = (on_another(plan, **{name: error}) for error in (1e-3, -1e-3))
        change = (wrong.energy - less.energy) / 2e-3
        assert change == pytest.approx(of[name].energy, rel=0.01, abs=1e-6)
        # at rest all that is left comes of the error; the integrator leaves some 1e-9 m
        assert wrong.residual / 1e-3 == pytest.approx(of[name].residual, rel=0.01, abs=2e-5)


def test_frequency_is_what_matters_and_inertia_leaves_nothing(plan):
    first, *_ = plan.sensitivities
    of = {one.parameter: one for one in plan.sensitivities}
    assert first.parameter in ("frequency", "omega")
    # the single link has one mode: its frequency is omega
    assert of["frequency"].residual == pytest.approx(of["omega"].residual, rel=1e-5)
    # eq (9) does not know the hub: alpha1 and friction change the torque alone
    assert of["alpha1"].residual == of["c"].residual == 0
    assert of["c"].energy > 0
    assert [one.residual for one in plan.sensitivities] == sorted(
        (one.residual for one in plan.sensitivities), reverse=True
    )
