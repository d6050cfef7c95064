"""Plans of many moves at once are those of each alone."""

from dataclasses import replace

import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp import SolverFailedError, SolveStatus
from quietarm.ocp.planning import many

DURATIONS = np.linspace(0.7, 1.2, 4)


@pytest.fixture(params=["single link", "arm"])
def moves(request, plants):
    plant = plants[request.param]
    return [qa.PointToPoint(plant, 0.5 + 0.2 * k, one) for k, one in enumerate(DURATIONS)]


@pytest.mark.slow_after(1)
def test_moves_at_rest_are_planned_as_alone(moves):
    found = qa.plan_moves(moves, bound=0.3)
    assert found.tasks == tuple(moves)
    assert set(found.status) == {SolveStatus.OPTIMAL}
    assert (found.residual <= 1e-8).all()
    assert found.by_cvodes.any()
    for task, energy, coefficients in zip(moves, found.energy, found.coefficients, strict=True):
        alone = qa.plan_move(task, bound=0.3)
        assert energy == pytest.approx(alone.energy, rel=1e-5)
        exact = qa.JudgedMotion.of_profile(task, found.profile, coefficients).motion
        assert energy == pytest.approx(exact.energy, rel=1e-5)
        assert exact.residual < 2e-8
        assert np.abs(coefficients).max() <= 0.3 * (1 + 1e-7)


@pytest.mark.slow_after(1)
def test_moves_with_limits_are_certified_by_cvodes(moves):
    limited = [replace(task, speed_limit=4.0) for task in moves]
    found = qa.plan_moves(limited, qa.CycloidPolynomial(6), residual_limit=1e-3)
    assert found.by_cvodes.all()
    assert (found.residual <= 1e-3 * (1 + 1e-6)).all()
    for task, coefficients in zip(limited, found.coefficients, strict=True):
        assert qa.JudgedMotion.of_profile(
            task, found.profile, coefficients
        ).motion.peak_speed <= 4.0 * (1 + 1e-6)


def test_a_move_without_a_plan_does_not_stop_the_others(plants):
    # pi/2 in 0.8 s is 1.96 rad/s at least; the other moves are far slower.
    moves = [qa.PointToPoint(plants["arm"], target, 0.8, speed_limit=1.9) for target in (0.3, 1.57)]
    found = qa.plan_moves(moves, qa.CycloidPolynomial(4))
    assert [status.solved for status in found.status] == [True, False]
    assert np.isfinite(found.energy[0])
    assert np.isnan([found.energy[1], found.residual[1], *found.coefficients[1]]).all()


@pytest.mark.slow_after(1)
def test_a_move_that_cvodes_does_not_confirm_has_a_status_and_no_figures(moves, monkeypatch):
    def refuse(problems, *others):
        targets = [problem.task.target for problem in problems]
        return [SolverFailedError(f"refused at {target:.3g} rad") for target in targets]

    limited = [replace(task, speed_limit=4.0) for task in moves[:2]]
    monkeypatch.setattr(many, "certify", refuse)
    found = qa.plan_moves(limited, qa.CycloidPolynomial(6))
    assert set(found.status) == {SolveStatus.NOT_CERTIFIED}
    assert not any(status.solved for status in found.status)
    assert all(reason.startswith("refused at") for reason in found.reasons)
    assert found.shadow_prices == ({}, {})
    for values in (found.energy, found.residual, found.coefficients, *found.peaks.values()):
        assert np.isnan(values).all()
