"""The figures of many points: by finer steps where CVODES agrees, else by CVODES."""

from dataclasses import replace

import pytest
from front_moves import CASES
from quietarm.ocp import CycloidPolynomial, SolverFailedError, resimulate
from quietarm.ocp.answers.provenance import SolveSettings
from quietarm.ocp.front import checking
from quietarm.ocp.front.sweep import Sweep
from quietarm.ocp.program.solution import STILL


@pytest.fixture(scope="module", params=CASES)
def solved(request):
    """A sweep, and what it finds at twelve limits with what was asked."""
    task, bound = CASES[request.param]
    sweep = Sweep(task, CycloidPolynomial(4), SolveSettings(bound=bound))
    limits = [k * 2e-4 for k in range(1, 13)]
    found = sweep.solve([(sweep.guesses[0], sweep.ask(limit)) for limit in limits])
    assert all(one.status.solved for one in found)
    return sweep, [(one, {"residual_limit": k}) for one, k in zip(found, limits, strict=True)]


def test_finer_steps_give_the_figures_of_cvodes(solved, monkeypatch):
    sweep, found = solved

    def failing(*_, **__):
        raise SolverFailedError("no point is left for CVODES alone")

    monkeypatch.setattr(checking, "verified", failing)
    points, whole = checking.all_checked(sweep, found)
    assert whole
    assert len(points) == len(found)
    for point in points:
        motion = resimulate(sweep.task, sweep.profile, point.coefficients)
        assert point.energy == pytest.approx(motion.energy, rel=1e-6)
        assert point.residual == pytest.approx(motion.residual, rel=1e-6, abs=STILL)


@pytest.mark.parametrize("what", ["energy", "residual"])
def test_where_cvodes_differs_it_is_believed(solved, monkeypatch, what):
    """The difference is twice what is tolerated; docs/accuracy.md."""
    sweep, found = solved
    whole = checking.resimulate

    def differing(*arguments):
        motion = whole(*arguments)
        return replace(motion, **{what: getattr(motion, what) * (1 + 2e-6) + 2 * STILL})

    monkeypatch.setattr(checking, "resimulate", differing)
    points, _ = checking.all_checked(sweep, found)
    for point in points:
        motion = resimulate(sweep.task, sweep.profile, point.coefficients)
        assert (point.residual, point.energy) == (motion.residual, motion.energy)
