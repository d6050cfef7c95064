"""Residuals off the model: what CVODES finds on each perturbed plant, quickly."""

import pytest
from robots import straight, ur5_with_bar

import quietarm as qa
from quietarm.ocp.off_model import off_model
from quietarm.ocp.simulation.evaluator import Evaluator


@pytest.fixture
def nothing_is_built(monkeypatch):
    """No function of fixed steps, which costs a robot more than its plan."""

    def refused(*_, **__):
        raise AssertionError("an evaluator was built")

    monkeypatch.setattr(Evaluator, "__call__", refused)


def _checked(motion, names):
    """Compare with CVODES, one perturbed plant after another; by name."""
    residuals = off_model(motion).residuals
    assert list(residuals) == names
    for name, by_share in residuals.items():
        for share, residual in by_share.items():
            worst = max(motion.perturbed({name: e}).residual for e in (share, -share))
            assert residual == pytest.approx(worst, rel=2e-3)


@pytest.mark.usefixtures("nothing_is_built")
def test_it_is_what_cvodes_finds_on_each_plant(tasks):
    _checked(qa.JudgedMotion.of_profile(tasks["arm"], qa.CycloidPolynomial(0), []), ["frequency"])


@pytest.mark.slow
@pytest.mark.usefixtures("nothing_is_built")
def test_a_robot_has_its_load_too_and_nothing_is_built_for_it():
    task = ur5_with_bar().task(straight(), duration=1.2)
    _checked(
        qa.JudgedMotion.of_profile(task, qa.CycloidPolynomial(0), []), ["frequency", "payload"]
    )
