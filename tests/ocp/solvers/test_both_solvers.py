"""Two ways through the same problem: sequential quadratic programs, and IPOPT."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp import SolveStatus
from quietarm.ocp.limits import QUANTITIES, RESIDUAL, Limit, TorqueSpeedLine
from quietarm.ocp.simulation.evaluator import Evaluation
from quietarm.ocp.solvers import ipopt as ipopt_module
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.problem import LEAST_ENERGY
from quietarm.ocp.solvers.sqp import Sqp

TERMS = 6
PROFILE = qa.CycloidPolynomial(TERMS)
AT_REST = {RESIDUAL: 0.0}
LINE = TorqueSpeedLine(((0.4, 0.0), (0.2, 3.5)))


def _ask(limits, bound=None, minimise=LEAST_ENERGY):
    """Make a request with limits by name."""
    made = [
        Limit.of_residual(size) if name == RESIDUAL else Limit(QUANTITIES[name], -size, size)
        for name, size in limits.items()
    ]
    return _asked(*made, bound=bound, minimise=minimise)


def _asked(*limits, bound=None, minimise=LEAST_ENERGY):
    return {"limits": limits, "bound": bound, "minimise": minimise}


LIMITED = _ask({RESIDUAL: 2e-3})
SOLVERS = Sqp(), Ipopt()


def _solved(program, asked, solver=SOLVERS[0], start=PROFILE.plain, **settings):
    (found,) = solver.solve([program.asking(**asked)], [np.array(start)], **settings)
    return found


def _true(steps, found):
    """The energy by CVODES: IPOPT's takes in what neighbouring steps say, the SQP's does not."""
    return qa.JudgedMotion.of_profile(steps.task.certain, steps.profile, found.coefficients).energy


@pytest.fixture(scope="module")
def link_and_arm(tasks, transcribe):
    """Both tasks with the paper's box, and with a limit of the torque; their energies agree."""
    made = {"single link": 0.2, "arm": 0.5}
    limited = {name: replace(tasks[name], torque_limit=1.0) for name in made}
    return {
        name: (transcribe(tasks[name], steps=96), transcribe(limited[name], steps=96), box)
        for name, box in made.items()
    }


@pytest.mark.slow_after(2)
@pytest.mark.parametrize("name", ["single link", "arm"])
@pytest.mark.parametrize("what", ["rest", "residual", "box", "torque", "peak"])
def test_both_solvers_agree(link_and_arm, name, what):
    free, limited, box = link_and_arm[name]
    torque = _solved(limited, _ask(AT_REST)).peaks["torque"]
    steps, ask = {
        "rest": (free, _ask(AT_REST)),
        "residual": (free, LIMITED),
        "box": (free, _ask(AT_REST, box)),
        "torque": (limited, _ask({**AT_REST, "torque": 0.9 * torque})),
        "peak": (limited, _ask(AT_REST, None, {"torque": 1.0})),
    }[what]
    sqp, ipopt = (_solved(steps, ask, solver) for solver in SOLVERS)
    assert sqp.status is SolveStatus.OPTIMAL
    assert ipopt.status.solved
    if what == "peak":  # of several motions of the same peak, hardly of the same energy
        assert ipopt.peaks["torque"] == pytest.approx(sqp.peaks["torque"], rel=1e-6)
        assert sqp.peaks["torque"] < torque
    else:
        assert _true(steps, ipopt) == pytest.approx(_true(steps, sqp), rel=1e-6)
    for found in (sqp, ipopt):
        assert np.abs(found.coefficients).max() <= (ask["bound"] or np.inf)
        for limit in ask["limits"]:
            assert limit.keeps(found.peaks[limit.name], 1e-6)
    for quantity, price in sqp.shadow_prices.items():
        assert ipopt.shadow_prices[quantity] == pytest.approx(price, rel=1e-3)


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(
    ("given", "name"),
    [({"acceleration_limit": (-60.0, 35.0)}, "acceleration"),
     ({"torque_limit": (-0.3, 0.25)}, "torque"),
     ({"torque_speed": LINE.points}, "torque_speed")],
    ids=["acceleration", "torque", "torque by speed"],
)  # fmt: skip
def test_both_solvers_keep_limits_that_differ_by_direction_or_speed(tasks, transcribe, given, name):
    task = replace(tasks["arm"], **given)
    (limit,) = task.limits
    steps, rest = transcribe(task, steps=96), Limit.of_residual(0.0)
    free = _solved(steps, _asked(rest))
    sqp, ipopt = (_solved(steps, _asked(rest, limit), one) for one in SOLVERS)
    assert not limit.keeps(free.peaks[name])
    assert _true(steps, ipopt) == pytest.approx(_true(steps, sqp), rel=1e-6)
    for found in (sqp, ipopt):
        assert found.peaks[name] == pytest.approx(limit.size, rel=1e-6)
        assert found.energy > free.energy
    assert ipopt.shadow_prices[name] == pytest.approx(sqp.shadow_prices[name], rel=1e-3)
    wider = _solved(steps, _asked(rest, limit.tightened(1 / 1.005)))
    price = (sqp.energy - wider.energy) / (0.005 * limit.size)
    assert sqp.shadow_prices[name] == pytest.approx(price, rel=0.05)
    least = [_solved(steps, _asked(rest, minimise={name: 1.0}), one) for one in SOLVERS]
    assert least[1].peaks[name] == pytest.approx(least[0].peaks[name], rel=1e-6)
    assert least[0].peaks[name] < limit.size


def test_rows_of_many_kinds_are_solved_as_alone(link_and_arm):
    free, limited, box = link_and_arm["arm"]
    asks = [
        (free, _ask(AT_REST)),
        (limited, _ask({**AT_REST, "torque": 0.33})),
        (free, LIMITED),
        (free, _ask(AT_REST, box)),
        (limited, _ask(AT_REST, None, {"torque": 1.0})),
        (free, _ask({RESIDUAL: 5e-3}, box)),
    ]
    problems = [program.asking(**asked) for program, asked in asks]
    together = Sqp().solve(problems, [PROFILE.plain] * len(problems))
    for one, found in zip(asks, together, strict=True):
        alone = _solved(*one)
        assert found.status is alone.status
        assert found.energy == pytest.approx(alone.energy, rel=1e-9)


def _corrupt_derivatives(function):
    """Return the function with the first entry of every gradient lost."""

    def corrupted(*arguments):
        found = function(*arguments)
        gradient = found.gradient.copy()
        gradient[:, 0] = 0.0
        return replace(found, gradient=gradient)

    return corrupted


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", ["single link", "arm"])
def test_a_wrong_derivative_of_the_sqp_does_not_reach_ipopt(link_and_arm, name, monkeypatch):
    steps, _, box = link_and_arm[name]
    asked = _ask({RESIDUAL: 2e-3}, box)
    right = [_solved(steps, asked, solver) for solver in SOLVERS]
    monkeypatch.setattr(steps.batch, "derivatives", _corrupt_derivatives(steps.batch.derivatives))
    sqp, ipopt = (_solved(steps, asked, solver) for solver in SOLVERS)
    assert ipopt.energy == right[1].energy
    assert _true(steps, ipopt) == pytest.approx(_true(steps, right[0]), rel=1e-6)
    assert sqp.energy > right[0].energy * (1 + 1e-4)  # else the SQP would not tell either


def test_what_the_sqp_misreads_of_a_motion_does_not_reach_ipopt(link_and_arm, monkeypatch):
    steps, _, box = link_and_arm["arm"]
    asked = _ask({RESIDUAL: 2e-3}, box)
    right = [_solved(steps, asked, solver) for solver in SOLVERS]
    peaks = Evaluation.peaks_of
    monkeypatch.setattr(Evaluation, "peaks_of", lambda *given: _halved(peaks(*given)))
    sqp, ipopt = (_solved(steps, asked, solver) for solver in SOLVERS)
    assert sqp.residual == right[0].residual / 2
    assert (ipopt.energy, ipopt.peaks) == (right[1].energy, right[1].peaks)


def _halved(peaks):
    return {name: peak / 2 for name, peak in peaks.items()}


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", ["single link", "arm"])
def test_a_wrong_derivative_of_ipopt_does_not_reach_the_sqp(link_and_arm, name, monkeypatch):
    steps, _, box = link_and_arm[name]
    asked = _ask({RESIDUAL: 2e-3}, box)
    right = [_solved(steps, asked, solver) for solver in SOLVERS]
    monkeypatch.setattr(ipopt_module, "compile_nlp", _compile_with_wrong_gradient)
    ipopt_module.compile_program.cache_clear()
    sqp, ipopt = (_solved(steps, asked, solver) for solver in SOLVERS)
    ipopt_module.compile_program.cache_clear()
    assert sqp.energy == right[0].energy
    assert not ipopt.status.solved or ipopt.energy > right[1].energy * (1 + 1e-4)


def _compile_with_wrong_gradient(nlp, options):
    """IPOPT with the first entry of the objective's gradient lost."""
    x, p, f = nlp["x"], nlp["p"], nlp["f"]
    gradient = ca.gradient(f, x)
    gradient[0] = 0.0
    wrong = ca.Function("wrong", [x, p], [f, ca.densify(gradient)])
    chosen = {"grad_f": wrong, "print_time": False, "no_nlp_grad": True, "calc_lam_p": False}
    return ca.nlpsol("wrong", "ipopt", nlp, {**chosen, "ipopt": dict(options)})


@pytest.mark.parametrize(
    ("solver", "column"), [(Sqp(), "violation"), (Ipopt(), "inf_pr")], ids=["sqp", "ipopt"]
)
def test_the_log_of_either_solver_can_be_shown(link_and_arm, capfd, solver, column):
    task = link_and_arm["arm"][0].task
    quiet = qa.plan_move(task, bound=0.5, starts=1, solver=solver)
    assert capfd.readouterr().out == ""
    shown = qa.plan_move(task, bound=0.5, starts=1, solver=replace(solver, log=True))
    assert column in capfd.readouterr().out
    assert shown.energy == quiet.energy


def test_how_a_start_ended_is_said_truly(link_and_arm):
    steps, _, box = link_and_arm["arm"]
    problem = steps.asking(**_ask(AT_REST, box))
    found = Sqp().solve([problem] * 4, [PROFILE.plain] * 4, groups=[0] * 4)
    assert [one.status for one in found].count(SolveStatus.SUPERSEDED) == 3
    assert all("another start" in one.reason for one in found if not one.status.solved)
