"""Open what a move by hand begins with: the plan, the front or the sweep of a file."""

from __future__ import annotations

from pathlib import Path

from quietarm.ocp import Front, PointToPoint, Record, Solver, Sqp
from quietarm.ocp.checks import instance
from quietarm.ocp.objectives import refuse_peaks
from quietarm.ocp.solvers.choice import stated_solver
from quietarm.studies.answers.read_answers import format_of, load_front, load_plans
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.views.explore.by_hand import MoveByHand


def open_file(path: Path) -> MoveByHand:
    """Open what a file or a folder holds; FileFormatError where that is none of these."""
    if path.is_dir() or path.suffix == ".zarr":
        library = MoveLibrary(path)
        middle = {axis.name: axis.values[len(axis.values) // 2] for axis in library.grid.axes}
        solver = library.store.definition.settings.solver
        return MoveByHand.of_plan(library.plan(**middle), library=library, solver=solver)
    if format_of(path) == f"quietarm-{Front.kind}":
        front = load_front(path)
        instance("task", front.task, PointToPoint)  # a front of a function has none
        refuse_peaks(str(path), front.objectives)
        coefficients = front.points[0].coefficients
        begun = MoveByHand(
            front.task,
            front.profile,
            coefficients,
            bound=front.record.bound,
            solver=_solver_of(front.record),
        )
        return begun.pick(front, coefficients)
    (plan,) = load_plans([path]).values()
    return MoveByHand.of_plan(
        plan,
        residual_limit=plan.residual_limit or None,
        bound=plan.record.bound,
        solver=_solver_of(plan.record),
    )


def _solver_of(record: Record) -> Solver:
    """Return the solver that an answer was asked of, with its options; the SQP of others."""
    return stated_solver(record.settings) or Sqp()


def is_file(what: str) -> bool:
    """Return whether this names a file or a folder of answers, and no plant."""
    path = Path(what)
    machine = path.suffix == ".json" and format_of(path) == "quietarm-machine"
    return path.suffix in (".json", ".zarr") and not machine
