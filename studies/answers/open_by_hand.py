"""What a move by hand begins with: the plan, the front or the sweep of a file."""

from __future__ import annotations

from pathlib import Path

from quietarm.ocp import Front
from quietarm.ocp.objectives import refuse_peaks
from quietarm.studies.answers.read_answers import format_of, load_front, load_plans
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.views.explore.by_hand import MoveByHand


def open_file(path: Path) -> MoveByHand:
    """Open what a file or a folder holds; FileFormatError where that is none of these."""
    if path.is_dir() or path.suffix == ".zarr":
        library = MoveLibrary(path)
        middle = {axis.name: axis.values[len(axis.values) // 2] for axis in library.grid.axes}
        return MoveByHand.of_plan(library.plan(**middle), library=library)
    if format_of(path) == f"quietarm-{Front.kind}":
        front = load_front(path)
        refuse_peaks(str(path), front.objectives)
        coefficients = front.points[0].coefficients
        begun = MoveByHand(front.task, front.profile, coefficients, bound=front.record.bound)
        return begun.pick(front, coefficients)
    (plan,) = load_plans([path]).values()
    limit = plan.residual_limit or None
    return MoveByHand.of_plan(plan, residual_limit=limit, bound=plan.record.bound)


def is_file(what: str) -> bool:
    """Whether this names a file or a folder of answers, and no plant."""
    path = Path(what)
    machine = path.suffix == ".json" and format_of(path) == "quietarm-machine"
    return path.suffix in (".json", ".zarr") and not machine
