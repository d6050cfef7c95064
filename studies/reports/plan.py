"""A plan on the screen, and the lines that it shares with a floor."""

from __future__ import annotations

import math
from collections.abc import Sequence

from quietarm.models import joint_unit
from quietarm.ocp import CycloidPolynomial, Motion, Plan, PointToPoint, ShapedCycloid, Worst
from quietarm.ocp.planning.fastest import DURATION_OF_SIX
from quietarm.ocp.planning.robust import EXCESS
from quietarm.ocp.planning.terms import CHOSEN, OF_SIX
from quietarm.ocp.record import AGREEMENT
from quietarm.ocp.task import QUANTITIES
from quietarm.studies.display.words import REST, millimetres, move_of, moved, state_words
from quietarm.studies.document.blocks import Document, Facts, Lines
from quietarm.studies.document.table import Column, Table

Row = tuple[str, str]
_HARD = 5
"""Times the plain cycloid's acceleration from which on a plan without limits is warned of."""
HARD_REMEDY = "give what the drive can do, as --acceleration-limit or --torque-limit"
_SEEN = 1e-6
"""A joint turns back where it does so by more than this [rad]."""
_ROUNDING = 1e-12
"""Angles below this [rad] are rounding errors."""


def plan_document(plan: Plan, notes: Sequence[str] = (), sensitive: bool = False) -> Document:
    """A plan's coefficients, figures and verification; where asked for, its sensitivities."""
    motion, back = plan.motion, plan.turns_back
    rows = [
        *move_rows(plan.task, motion, _residual_limit(plan)),
        _choice(plan),
        *_terms_rows(plan),
        ("energy (F2)", f"{motion.energy:.6g} J  (net work {motion.net_work:.4g} J)"),
        *figure_rows(plan.task, motion),
        *([("turns back", f"by {back:.3g} rad on the way")] if back > _SEEN else []),
        *_worst_rows(plan),
        ("status", plan.status.text),
        _verified_row(plan),
        ("time", f"{plan.provenance.seconds:.2f} s"),
    ]
    table = [_sensitivities(plan)] if sensitive else []
    return Document("", [Facts(rows), *table, Lines(notes)])


def _sensitivities(plan: Plan) -> Table:
    """What a parameter that is 1 % larger changes, a row each."""
    heads = ("parameter 1 % larger", "adds to the residual [mm]", "changes the energy by [%]")
    rows = [
        [one.parameter, f"{10 * one.residual:.3g}", f"{one.energy / plan.energy:+.3g}"]
        for one in plan.sensitivities
    ]
    return Table("Sensitivities", [Column(head) for head in heads], rows).turned()


def worst_in_words(worst: Worst) -> str:
    """The largest residual within the errors of a plant, and the errors that it comes with."""
    errors = ", ".join(f"{name} {100 * error:+.3g} %" for name, error in worst.errors.items())
    return f"{millimetres(worst.residual)} with {errors}"


def _worst_rows(plan: Plan) -> list[Row]:
    """Where within the errors of its plant a plan leaves most; none where it has no errors."""
    if plan.worst is None:
        return []
    words = worst_in_words(plan.worst)
    if plan.excess is not None:
        side = "above" if plan.excess > 0 else "below"
        share = f"{100 * abs(plan.excess):.1f} %"
        where = "at" if share == "0.0 %" else f"{share} {side}"
        words += f", {where} the limit{_not_held(plan)}"
    return [("at worst", words)]


def _not_held(plan: Plan) -> str:
    """That a robust plan passes its residual limit between the samples, and what would help."""
    if plan.excess is None or plan.excess <= EXCESS:
        return ""
    remedy = "give a larger --residual-limit, more --terms or a smaller --robust error"
    return f"; not robust enough: more than {EXCESS:.0%} above; {remedy}"


def _verified_row(plan: Plan) -> Row:
    """How far the two integrators agree; the word `verified` only where that is near enough."""
    check = plan.verification
    differ = f"{check.energy_share:.0e} in energy and {millimetres(abs(check.residual_difference))}"
    if check.agrees:
        return "verified", f"by CVODES, which differs by {differ}"
    remedy = "smaller coefficients" if plan.profile.size else "a longer duration"
    return "not verified", (
        f"the figures are by CVODES; {check.steps} fixed steps differ by {differ} in residual, "
        f"where {AGREEMENT:g} of each is agreement; give {remedy}"
    )


def _residual_limit(plan: Plan) -> float:
    """What a plan was allowed to leave [m]; 0 at rest, and where that was not asked."""
    settings, search = plan.provenance.settings, plan.provenance.search
    return settings.residual_limit if settings else float(search.get("residual_limit") or 0)


def move_rows(task: PointToPoint, motion: Motion, residual_limit: float = 0.0) -> list[Row]:
    """The move and its limits, and where the motion breaks one."""
    limits = [f"residual {millimetres(residual_limit)}"] * (residual_limit > 0)
    limits += [
        _limit(name, most, motion.peak(name), task.plant.joint)
        for name, most in task.limits.items()
    ]
    return [
        ("move", f"{moved(task)}, {move_of(task)}"),
        *([("at the start", state_words(task.initial))] if task.initial else []),
        *([("wanted", f"{state_words(task.final)} on arrival")] if task.final else []),
        *([("limits", ", ".join(limits))] if limits else []),
    ]


def figure_rows(task: PointToPoint, motion: Motion) -> list[Row]:
    """A motion's residual, peaks and overshoot."""
    known = [name for name in QUANTITIES if motion.peak(name) < math.inf]  # a jump has no jerk
    return [
        (
            "residual (F1)",
            f"{_left(task, motion.residual)} at the {_tip(task)} within {task.residual_window:g} s",
        ),
        *((f"peak {name}", _peak(name, task, motion)) for name in known),
        ("overshoot", f"{motion.overshoot:.3g} rad" if motion.overshoot > _ROUNDING else "none"),
    ]


def _left(task: PointToPoint, residual: float) -> str:
    """What is left after arrival; below a thousandth of a millimetre nobody sees a difference."""
    still = "as wanted" if task.final else "at rest"
    return f"{still} (below {millimetres(REST)})" if residual < REST else millimetres(residual)


def _peak(name: str, task: PointToPoint, motion: Motion) -> str:
    peak, unit = motion.peak(name), joint_unit(QUANTITIES[name].unit, task.plant.joint)
    if unit == "m":
        return f"{millimetres(peak)}{_large(task, motion)}"
    return f"{peak:.4g} {unit}{_hard(name, task, peak)}"


def _hard(name: str, task: PointToPoint, peak: float) -> str:
    """A warning where nothing limits a motion that accelerates far harder than the cycloid."""
    cycloid = 2 * math.pi * abs(task.span) / task.duration**2  # of eq (1) with U = t / TE
    if name != "acceleration" or task.limits or peak <= _HARD * cycloid:
        return ""
    return f"  (warning: {peak / cycloid:.2g} times the plain cycloid's; {HARD_REMEDY})"


def _large(task: PointToPoint, motion: Motion) -> str:
    """A warning where the tip leaves what the plant's equations are made for."""
    limit = task.plant.small_deflection
    if limit is None or max(motion.peak_deflection, motion.residual) <= limit:
        return ""
    return (
        f"  (warning: beyond {millimetres(limit)}, up to which the plant's deflections count as "
        "small; its equations are less exact there)"
    )


def _choice(plan: Plan) -> tuple[str, str]:
    """What makes the motion differ from others of its task, and its name."""
    if isinstance(plan.profile, ShapedCycloid):
        impulses = len(plan.profile.impulses.times)
        shaper = f"{impulses} impulses within {plan.profile.length:.4g} s"
        return "profile", f"{plan.profile.label}: {shaper}"
    coefficients = ", ".join(f"{value:.6g}" for value in plan.coefficients)
    if not isinstance(plan.profile, CycloidPolynomial):
        return "profile", f"{plan.profile.label}: {coefficients}"
    return "coefficients", coefficients or "none: the plain cycloid"


def _terms_rows(plan: Plan) -> list[Row]:
    """How many terms the plan chose, and what six would cost; none where they were given."""
    found = plan.provenance.search
    if CHOSEN not in found:
        return []
    energy, duration = (float(found.get(name) or 0) for name in (OF_SIX, DURATION_OF_SIX))
    six = "six terms find no motion" if not found.get(OF_SIX) else ""
    if plan.worst is not None:
        six = ""
    if energy:
        six = f"six would take {energy:.4g} J ({energy / plan.energy - 1:+.0%})"
    if duration:
        six = f"six would take {duration:.4g} s"
    return [("terms", ", ".join(filter(None, [f"{found[CHOSEN]}, chosen for the limits", six])))]


def _tip(task: PointToPoint) -> str:
    tips = task.plant.tips
    words, scenarios = "tip" if tips == 1 else f"worst of {tips} tips", len(task.scenarios)
    return words if scenarios == 1 else f"{words}, worst of {scenarios} samples"


def _limit(name: str, limit: float, peak: float, joint: str) -> str:
    """A limit, and how it is broken; nothing where it is kept to the README's tolerance."""
    unit = joint_unit(QUANTITIES[name].unit, joint)
    broken = "" if peak <= limit * 1.001 else f" (broken: {peak:.4g} {unit})"
    return f"{name} {limit:g} {unit}{broken}"
