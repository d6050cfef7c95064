"""Searches: what they find, what a front is, and what is refused."""

import math

import pytest
from fixed_steps import rollout
from small_searches import BOUNDS, METHODS, TASKS, found, run

from quietarm.metaheuristics import search
from quietarm.ocp import CycloidPolynomial, JudgedMotion

# -- what a front is --


@METHODS
def test_figures_are_those_of_the_finer_rollout_and_of_the_independent_integrator(method):
    front = found(method)
    for point in front.points:
        motion = rollout(front.task, front.profile, point.coefficients).motion
        assert point.energy == pytest.approx(motion.energy, rel=1e-7)
        assert point.residual == pytest.approx(motion.residual, rel=1e-4)
    for point in (front.points[0], front.points[-1]):
        motion = JudgedMotion.of_profile(front.task, front.profile, point.coefficients).motion
        assert point.energy == pytest.approx(motion.energy, rel=1e-5)
        assert point.residual == pytest.approx(motion.residual, rel=1e-4, abs=1e-6)


@METHODS
def test_provenance(method):
    front = found(method)
    assert (front.task, front.profile) == (TASKS[method], CycloidPolynomial(6))
    assert (front.record.method, front.record.seed, front.record.bound) == (
        method,
        0,
        BOUNDS[method],
    )
    asked = {"population": 20, "generations": 15}
    assert asked.items() <= dict(front.record.settings).items()
    assert front.failed == 0
    assert front.record.seconds > 0
    # what a result depends on; 'versions: of what computed it'
    assert {"quietarm", "casadi", "numpy", "python", "pymoo"} <= front.record.versions.keys()


# -- bad input --


@METHODS
def test_a_missing_bound_names_the_papers(method):
    # Eqs (12) and (17).
    with pytest.raises(ValueError, match="bound") as caught:
        search(TASKS[method], algorithm=method)
    assert "0.2 for single-link" in str(caught.value)
    assert "0.5 for arm-on-flexible-link" in str(caught.value)


@METHODS
@pytest.mark.parametrize(
    ("name", "value"),
    [("population", 0), ("generations", -1), ("seed", 1.5), ("bound", math.nan), ("threads", 0)],
)
def test_odd_settings_are_named_with_a_remedy(method, name, value):
    settings = {"population": 4, "generations": 2, name: value}
    with pytest.raises(ValueError, match=f"{name}.* is .*; give ") as caught:
        run(method, **settings)
    assert str(value) in str(caught.value)
