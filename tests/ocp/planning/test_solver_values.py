"""A solver is a value: what every verb passes on, and what is stated of it."""

import ast
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pages import ROOT
from robots import straight, ur5_with_bar

import quietarm as qa
from quietarm.metaheuristics import Job
from quietarm.metaheuristics.methods.gradient_methods import multistart_front
from quietarm.ocp import SolveStatus, correct_in_full, cross_check
from quietarm.ocp.front.polish import polish_front
from quietarm.ocp.solvers.choice import SOLVERS, other_solver, stand_in, stated_solver
from quietarm.studies.answers.open_by_hand import open_file
from quietarm.studies.sweep.store import Store

NAMED = "single-link-30deg-0.8s-2-terms"
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


def surface(solver):
    objectives = ("residual", "energy", "peak_torque")
    return qa.epsilon_front(
        TASK, TWO, bound=0.3, points=9, starts=1, objectives=objectives, solver=solver
    )


def swept(solver):
    """A sweep with fronts, of certain plants and of uncertain ones."""
    for task in (TASK, replace(TASK, uncertainty=qa.Uncertainty({"frequency": 0.05}))):
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/moves.zarr"
            axes = {"target": [0.4, 0.5]}
            front = 0 if task.uncertainty else 3
            qa.sweep(task, TWO, axes=axes, path=path, solver=solver, front_points=front)


def by_hand(solver):
    """A plan that is opened on the page alive."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "plan.json")
        qa.plan_move(TASK, TWO, starts=1, bound=0.3, solver=solver).save(path)
        move = open_file(path)
        move.solve()
        move.find_front()


def in_full(solver):
    """A robot's plan, which is corrected for what its modes leave out."""
    task = ur5_with_bar().task(straight(), duration=0.6)
    plan = qa.plan_move(task, qa.CycloidPolynomial(6), starts=1, solver=solver)
    corrected = correct_in_full(plan, left=0.1 * plan.candidate.in_full.residual, solver=solver)
    assert corrected is not plan


def job(method, budget=None, **settings):
    options = {name: value for name, value in OWN.stated.items() if name != "solver"}
    return lambda _: Job(NAMED, method, 0, budget, settings | options).run()


def memetic(solver):
    """Steps of the gradient within a search; how many iterations they have is the method's."""
    settings = {"solver_tolerance": solver.tolerance, "gradient_iterations": solver.iterations}
    Job(NAMED, "memetic", 0, 400, settings | {"population": 20}).run()


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
    "peaks as objectives": surface,
    "sweep": swept,
    "explore": by_hand,
    "correct_in_full": in_full,
    "a job of the gradient": job("epsilon", points=3),
    "a job of IPOPT": job("weighted:ipopt", points=3),
    "a polished job": job("nsga2+polish", 200),
    "a memetic job": memetic,
}  # fmt: skip


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("verb", VERBS)
def test_every_solve_of_a_verb_has_the_options_that_were_given(solvers, verb):
    VERBS[verb](OWN)
    assert solvers == {(OWN.tolerance, OWN.iterations)}


WITHOUT_A_CHOICE = {
    ("studies/reproduce/recompute.py", "epsilon_front"): "the paper's claims, by the usual solver",
    ("studies/reproduce/recompute.py", "plan_move"): "the same",
    ("studies/reproduce/recompute.py", "cross_check"): "by the other solver of its front",
    ("studies/cli/commands/front_command.py", "cross_check"): "the same",
    ("studies/trajectory_messages.py", "plan_move"): "a message of ROS names no solver",
    ("studies/trajectory_messages.py", "correct_in_full"): "the same",
    ("ocp/planning/as_timed.py", "plan_move"): "a plan beside a trajectory that is diagnosed",
    ("metaheuristics/problems/catalogue.py", "epsilon_front"): "the reference front of a problem",
}
"""Calls that leave the solver out, since nobody could have chosen one."""


@pytest.mark.slow
def test_whoever_calls_what_takes_a_solver_passes_one():
    packages = ("ocp", "metaheuristics", "machine", "views", "studies")
    files = [path for package in packages for path in (ROOT / package).rglob("*.py")]
    trees = {str(path.relative_to(ROOT)): ast.parse(path.read_text()) for path in files}
    places = {}
    for file, tree in trees.items():
        for node in tree.body:
            if isinstance(node, ast.FunctionDef):
                given = (*node.args.args, *node.args.kwonlyargs)
                kinds = {arg.arg: ast.unparse(arg.annotation) for arg in given if arg.annotation}
                if "Solver" in kinds.get("solver", ""):
                    positional = [arg.arg for arg in node.args.args]
                    at = positional.index("solver") if "solver" in positional else None
                    places[file if node.name.startswith("_") else "", node.name] = at
    left_out = set()
    for file, tree in trees.items():
        for node in ast.walk(tree):
            name = getattr(node.func, "id", "") if isinstance(node, ast.Call) else ""
            known = file if name.startswith("_") else "", name
            if known in places:
                keywords = {keyword.arg for keyword in node.keywords}  # None of **settings
                at = places[known]
                if not keywords & {"solver", None} and (at is None or len(node.args) <= at):
                    left_out.add((file, name))
    assert left_out == {*WITHOUT_A_CHOICE}


class Helpless(qa.Sqp):
    """An SQP that finds no motion by itself."""

    def solve(self, problems, starts, *, warm=False, groups=None):
        solutions = super().solve(problems, starts, warm=warm, groups=groups)
        failed = SolveStatus.ITERATION_LIMIT
        return solutions if warm else [replace(one, status=failed) for one in solutions]


HELPLESS = Helpless(tolerance=1e-7)


def test_a_record_says_what_stood_in_and_with_which_options():
    plan = qa.plan_move(TASK, TWO, starts=1, solver=HELPLESS)
    assert plan.record.method == "ipopt"
    asked = {"solver": "sqp", "solver_tolerance": 1e-7}
    found_by = {"stand_in": "ipopt", "stand_in_tolerance": 1e-7}
    assert plan.record.settings == {"starts": 1, "steps": None, **asked, **found_by}
    assert stated_solver(plan.record.settings) == qa.Sqp(tolerance=1e-7)
    moves = qa.plan_moves([TASK], TWO, solver=HELPLESS)
    assert moves.solved_by[0] == {"solver": "ipopt", "solver_tolerance": 1e-7}


@pytest.mark.slow
def test_fronts_sweeps_and_floors_say_it_as_well(monkeypatch, tmp_path):
    front = qa.epsilon_front(TASK, TWO, bound=0.3, points=3, starts=1, solver=HELPLESS)
    assert front.record.settings["stand_in"] == "ipopt"
    assert front.record.settings["solver"] == "sqp"
    floor = qa.energy_floor(TASK, starts=2, energy_tolerance=0.5, solver=HELPLESS)
    assert floor.record.settings == {
        "starts": 2, "solver": "ipopt", "solver_tolerance": 1e-7, "first_plan": "sqp",
        "first_plan_tolerance": 1e-7,
    }  # fmt: skip
    monkeypatch.setitem(SOLVERS, "sqp", Helpless)
    qa.sweep(TASK, TWO, axes={"target": [0.4, 0.5]}, path=tmp_path / "m.zarr", solver=HELPLESS)
    store = Store(tmp_path / "m.zarr")
    assert np.array_equal(store.read("solved_by"), [1, 1])
    assert store.dataset["solved_by"].attrs["flag_meanings"] == "sqp ipopt"


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
