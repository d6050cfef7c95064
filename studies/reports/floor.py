"""A floor on the screen, with the plan of six terms beside it."""

from __future__ import annotations

from quietarm.ocp import CycloidPolynomial, Floor, Plan, SolverFailedError, plan_move
from quietarm.studies.document.blocks import Document, Facts
from quietarm.studies.reports.plan import figure_rows, move_rows

TERMS = 6
"""Terms of the plan that a floor is compared with."""


def plan_beside(floor: Floor) -> Plan | None:
    """The gradient's plan for the same task; None where its limits allow no such plan."""
    try:
        return plan_move(floor.task, CycloidPolynomial(TERMS))
    except SolverFailedError:
        return None


def floor_document(floor: Floor, plan: Plan | None) -> Document:
    """A floor: its energy, what finer grids would save, how it was found."""
    motion, check = floor.motion, floor.verification
    kind = "smooth (jerk free)" if floor.smooth else "acceleration free"
    beside = "none within these limits"
    if plan is not None:
        beside = f"{plan.energy:.6g} J, {plan.energy / floor.energy:.3g} times the floor"
    grids = ", ".join(f"{level.steps}: {level.energy:.6g} J" for level in floor.levels)
    worst = max(floor.starts) / min(floor.starts) - 1
    unsettled = "" if floor.settled else " On a finer grid it failed."
    rows = [
        *move_rows(floor.task, motion),
        ("least energy", f"{motion.energy:.6g} J  over all motions, {kind}"),
        ("left", _left(floor)),
        (f"plan, {TERMS} terms", beside),
        ("intervals", grids),
        (
            "starts",
            f"{floor.agreeing()} of {len(floor.starts)} end within 0.5 % of the best"
            f"{f', the worst {worst:.1%} above it' if worst > 0.005 else ''}{_unsolved(floor)}",
        ),
        *figure_rows(floor.task, motion),
        ("status", floor.status.text + unsettled),
        (
            "verified",
            f"by CVODES, restarted at every jump: {check.steps} intervals differ by "
            f"{abs(check.energy_difference) / motion.energy:.0e} in energy",
        ),
        ("time", f"{floor.provenance.seconds:.2f} s"),
    ]
    return Document("", [Facts(rows)])


def _unsolved(floor: Floor) -> str:
    missing = floor.provenance.settings.starts - len(floor.starts)
    return f"; {missing} not solved" if missing > 0 else ""


def _left(floor: Floor) -> str:
    falls = ""
    if floor.change < 0:
        falls = "; on the last grid the energy rose"
    elif floor.ratio is not None:
        falls = f"; the last grid gained {floor.ratio:.2f} of what the one before gained"
    return (
        f"about {floor.left:.2g} J ({floor.left / floor.energy:.2%}) that finer grids would save"
        f"{falls}"
    )
