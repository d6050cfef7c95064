"""A solver is a value: what every verb passes on, and what is stated of it."""

from dataclasses import replace

import pytest

import quietarm as qa
from quietarm.metaheuristics.methods.gradient_methods import multistart_front
from quietarm.ocp import cross_check
from quietarm.ocp.front.polish import polish_front
from quietarm.ocp.solvers.choice import other_solver, stand_in, stated_solver

TWO = qa.CycloidPolynomial(2)
TASK = qa.PointToPoint(qa.SingleLinkManipulator(), target=qa.deg(30), duration=0.8)
OWN = qa.Sqp(tolerance=1e-7, iterations=400)


@pytest.fixture
def solvers(monkeypatch):
    """The options of all solvers that solve anything, as they are used."""
    seen = set()
    for kind in (qa.Sqp, qa.Ipopt):
        solve = kind.solve

        def noted(self, *args, solve=solve, **settings):
            seen.add((self.tolerance, self.iterations))
            return solve(self, *args, **settings)

        monkeypatch.setattr(kind, "solve", noted)
    return seen


def infeasible(solver):
    """Least peaks, what stands in for a solver, and what would be feasible."""
    with pytest.raises(qa.InfeasibleTaskError):
        qa.plan_move(replace(TASK, torque_limit=0.01), TWO, starts=1, solver=solver)


def robust(solver):
    task = replace(TASK, uncertainty=qa.Uncertainty({"frequency": 0.05}))
    return qa.plan_move(task, TWO, starts=1, solver=solver)


def checked(solver):
    """The record of a front says by which solver it was found."""
    front = qa.epsilon_front(TASK, TWO, bound=0.3, points=3, starts=1, solver=solver)
    return cross_check(front, checked_points=2)


def polished(solver):
    front = qa.epsilon_front(TASK, TWO, bound=0.3, points=3, starts=1, solver=solver)
    return polish_front(front, solver=solver)


def fastest(solver):
    task = replace(TASK, acceleration_limit=40.0)
    return qa.fastest_move(task, TWO, solver=solver, duration_tolerance=0.2)


VERBS = {
    "plan_move": lambda solver: qa.plan_move(replace(TASK, torque_limit=0.2), solver=solver),
    "an infeasible task": infeasible,
    "a robust plan": robust,
    "plan_moves": lambda solver: qa.plan_moves([TASK, replace(TASK, target=1.0)], solver=solver),
    "fastest_move": fastest,
    "weighted_front": lambda solver: qa.weighted_front(TASK, TWO, bound=0.3, points=3,
                                                       starts=1, solver=solver),
    "cross_check": checked,
    "polish_front": polished,
    "energy_floor": lambda solver: qa.energy_floor(TASK, starts=2, energy_tolerance=0.5,
                                                   solver=solver),
    "multistart": lambda solver: multistart_front(TASK, TWO, bound=0.3, starts=3, solver=solver),
}  # fmt: skip


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("verb", VERBS)
def test_every_solve_of_a_verb_has_the_options_that_were_given(solvers, verb):
    VERBS[verb](OWN)
    assert solvers == {(OWN.tolerance, OWN.iterations)}


def test_a_larger_tolerance_ends_earlier_and_within_it():
    rough = qa.plan_move(TASK, starts=1, solver=qa.Sqp(tolerance=1e-3))
    fine = qa.plan_move(TASK, starts=1)
    assert rough.record.iterations < fine.record.iterations
    assert rough.energy == pytest.approx(fine.energy, rel=1e-3)
    assert rough.residual < 1e-8  # rest on arrival does not depend on it


def test_a_record_states_a_solver_and_what_is_not_the_default(tmp_path):
    plan = qa.plan_move(TASK, TWO, starts=1, solver=OWN)
    assert plan.record.method == "sqp"
    assert plan.record.settings == {
        "starts": 1, "steps": None, "solver": "sqp", "solver_tolerance": 1e-7,
        "solver_iterations": 400,
    }  # fmt: skip
    plan.save(tmp_path / "plan.json")
    assert stated_solver(qa.Plan.load(tmp_path / "plan.json").record.settings) == OWN
    # as files of before state it
    assert stated_solver({"starts": 4, "steps": None, "solver": "ipopt"}) == qa.Ipopt()
    assert stated_solver({"population": 100}) is None


def test_what_stands_in_for_a_solver_has_its_options():
    assert stand_in(OWN) == qa.Ipopt(1e-7, 400)
    assert stand_in(qa.Ipopt()) is None
    assert other_solver(qa.Ipopt(log=True)) == qa.Sqp(log=True)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"tolerance": 0}, "tolerance of the solver is 0; give a positive number"),
        ({"tolerance": 0.5}, "tolerance of the solver is 0.5; give at most 0.01"),
        ({"tolerance": "fine"}, "tolerance of the solver is 'fine'; give a number"),
        ({"iterations": 0}, "iterations of the solver is 0; give a whole number from 1 up"),
    ],
)
@pytest.mark.parametrize("kind", [qa.Sqp, qa.Ipopt])
def test_options_out_of_range_are_refused(kind, options, told):
    with pytest.raises(ValueError, match=told):
        kind(**options)
