"""A plan, a floor or a recorded path in rows of a name and a value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from quietarm.models import Plant, RobotOnPath
from quietarm.models.dimensions import ACCELERATION
from quietarm.models.notes import about
from quietarm.ocp import (
    CycloidPolynomial,
    Floor,
    JointSpline,
    Plan,
    PointToPoint,
    ShapedCycloid,
)
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.figures import ENERGY, Figure, Figures, figures_in
from quietarm.ocp.joint_words import figure_words, peak_words
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import REPORT, RESIDUAL, Limit
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.choose_profile import CHOSEN, OF_SIX
from quietarm.ocp.planning.default_jerk import rise_time
from quietarm.ocp.planning.plan_along import EXCESS
from quietarm.ocp.record import AGREEMENT
from quietarm.ocp.rest import is_at_rest, rest_of
from quietarm.ocp.robustness import OF_MODES
from quietarm.views.report.drive_rows import cycle_rows, drive_rows
from quietarm.views.report.robot_rows import free_joints_words, way_rows
from quietarm.views.report.words import (
    move_of,
    moved,
    residual_place,
    signed_errors,
    state_words,
    unit_of_way,
)
from quietarm.views.tips import tip_words

if TYPE_CHECKING:
    from quietarm.machine.recordings.recorded_path import RecordedPath

Row = tuple[str, str]
HARD_REMEDIES: Mapping[str, str] = {
    "acceleration": "give what the drive can do, such as --acceleration-limit or --torque-limit",
    "jerk": "give what the drive can do, such as --jerk-limit",
}
"""What to do about a peak that a drive may not follow, by quantity."""
_OF_ACCELERATION = {"acceleration": HARD_REMEDIES["acceleration"]}
"""Of a floor, which nobody drives, and of a recorded path, whose smoothness has its own row."""
_HARD = 5
"""Times the plain cycloid's acceleration from which on a plan without limits is warned of."""
_FAR = 0.1
"""A limit that a motion does not come to this share of does not act, and silences no warning."""
_SEEN = 1e-6
_SECOND = "by a second integrator (CVODES)"
_ROUNDING = 1e-9
"""A joint passes its target where it does so by more [rad, m]; less is a rounding error."""


def plan_rows(
    plan: Plan,
    remedies: Mapping[str, str] = HARD_REMEDIES,
    *,
    verbose: bool = False,
    off: str = "",
) -> list[Row]:
    """Return a plan's limits and figures, how sure they are, how it was found, its coefficients.

    `verbose` adds how the solver ended and by how much the two integrators differ; `remedies` are
    named where a motion is too hard for a drive; `off` says what is left off the model.
    """
    back = plan.turns_back
    worst = [] if plan.worst is None else [("worst case", _worst_of_plan(plan, plan.worst))]
    return [
        *_move_rows(plan.task, plan.motion, plan.residual_limit or 0.0),
        *_figure_rows(plan.task, plan.candidate, remedies),
        *note_rows(plan.task.plant),
        *([("turns back", f"by {_way(back, plan.task)} on the way")] if back > _SEEN else []),
        *worst,
        *_off_rows(off),
        *_full_rows(plan),
        *drive_rows(plan),
        *cycle_rows(plan),
        _verified_row(plan, verbose),
        *_status_rows(plan.status, verbose),
        *_terms_rows(plan),
        ("time", f"{plan.record.seconds:.3g} s"),
        _choice(plan),
    ]


def _off_rows(words: str) -> list[Row]:
    """Return what is left if the plant is off its model, where that is known."""
    return [("off the model", words)] if words else []


def _status_rows(status: SolveStatus, verbose: bool) -> list[Row]:
    """Return how a solve ended; the two usual ends only where all is asked for."""
    usual = (SolveStatus.OPTIMAL, SolveStatus.NOT_OPTIMISED)
    return [("status", status.text)] if verbose or status not in usual else []


def floor_rows(
    floor: Floor, plan: Plan | None, *, verbose: bool = False, off: str = ""
) -> list[Row]:
    """Return the motion without a profile that takes least energy, beside a plan of the move."""
    motion = floor.motion
    check = floor.verification
    beside = "none within these limits"
    if plan is not None:
        beside = f"{plan.energy:.4g} J, {plan.energy / floor.energy:.3g} times as much"
    worst = max(floor.starts) / min(floor.starts) - 1
    missing = int(floor.record.settings["starts"] or 0) - len(floor.starts)
    starts = [
        f"{floor.agreeing()} of {len(floor.starts)} end within 0.5 % of the best",
        *([f"the worst is {worst:.1%} above it"] if worst > 0.005 else []),
        *([f"{missing} failed"] if missing > 0 else []),
    ]
    unsettled = "" if floor.settled else "; on a finer one it failed"
    error = floor.discretisation_error
    share = abs(check.energy_difference) / motion.energy
    differ = f"{check.steps} intervals differ by {share:.0e} of the energy"
    levels = ", ".join(f"{level.steps}: {level.energy:.4g} J" for level in floor.levels)
    return [
        *_move_rows(floor.task, motion),
        *_figure_rows(floor.task, floor.candidate, _OF_ACCELERATION),
        *note_rows(floor.task.plant),
        *_off_rows(off),
        (f"{_size(plan)} terms", beside),
        ("finer grids", f"would save about {error:.2g} J ({error / floor.energy:.2%}){unsettled}"),
        ("verified", _SECOND + f", restarted at every jump: {differ}" * verbose),
        *_status_rows(floor.status, verbose),
        ("starts", ", ".join(starts)),
        *([("intervals", levels)] if verbose else []),
        ("time", f"{floor.record.seconds:.3g} s"),
        ("profile", "none: the jerk is free" if floor.smooth else "none: the acceleration is free"),
    ]


def _size(plan: Plan | None) -> int:
    return CycloidPolynomial().terms if plan is None else plan.profile.size


def path_rows(candidate: JudgedMotion, path: RecordedPath) -> list[Row]:
    """The figures of a motion along a recorded path; of an uncertain plant also at the corners."""
    task = candidate.task
    free = path.motion
    ends = (f"{1e3 * gap:.3g}" for gap in (free.lengths.min(), free.lengths.max()))
    jump = np.abs(np.diff(free.acceleration)).max(initial=0.0)
    unit = ACCELERATION.of(task.plant.joint)
    rows = [
        *_move_rows(task, candidate.motion),
        ("path", f"{free.steps + 1} points, {' to '.join(dict.fromkeys(ends))} ms apart"),
        ("smoothness", f"acceleration changes by up to {jump:.3g} {unit} from point to point"),
        *_figure_rows(task, candidate, _OF_ACCELERATION),
        *note_rows(task.plant),
    ]
    for scenario in task.scenarios[1:]:
        errors = dict(zip(task.error_names, scenario))
        residual = candidate.perturbed(errors).residual
        words = _tip(task, residual)
        rows.append(("residual", f"{words} with {_signed(errors)}"))
    return [*rows, ("verified", "by one integrator alone (CVODES), along the spline")]


def sensitivity_rows(plan: Plan) -> list[Row]:
    """Return what a parameter that is 1 % larger adds to residual and energy.

    The frequency and the damping of a plant of one mode are one row with its own parameter.
    """
    said = {
        change.parameter: (
            f"{_tip(plan.task, change.residual / 100)}, {change.energy / plan.energy:+.3g} %"
        )
        for change in plan.sensitivities
    }
    rows = list[Row]()
    for name, words in said.items():
        twins = [other for other in said if other != name and said[other] == words]
        of_mode = [other for other in twins if other in OF_MODES]
        if name in OF_MODES and not {*twins} <= {*OF_MODES}:
            continue
        rows.append((f"{name} ({of_mode[0]})" if of_mode else name, words))
    return rows


def worst_in_words(worst: JudgedMotion, tip_unit: str) -> str:
    """The residual of the worst case, and the parameter errors that it comes with."""
    return f"{tip_words(worst.residual, tip_unit)} with {_signed(worst.errors)}"


def _signed(errors: Mapping[str, float]) -> str:
    return signed_errors(errors)


def _worst_of_plan(plan: Plan, worst: JudgedMotion) -> str:
    """The worst case of a robust plan, and how far it is from the residual limit."""
    words = worst_in_words(worst, plan.task.plant.tip_unit)
    if plan.excess is None:
        return words
    share = f"{100 * abs(plan.excess):.1f} %"
    side = "above" if plan.excess > 0 else "below"
    words += ", at the limit" if share == "0.0 %" else f", {share} {side} the limit"
    if plan.excess > EXCESS:
        words += (
            f"; not robust enough: more than {EXCESS:.0%} above; give a larger --residual-limit, "
            "more --terms or a smaller --error"
        )
    return words


def _verified_row(plan: Plan, verbose: bool) -> Row:
    """Return how far the two integrators agree; the word `verified` only where they do."""
    check = plan.verification
    residual = _tip(plan.task, abs(check.residual_difference))
    differ = f"{check.energy_share:.0e} of the energy and {residual}"
    if check.agrees:
        return "verified", _SECOND + f", within {differ}" * verbose
    remedy = "smaller coefficients" if plan.profile.size else "a longer duration"
    return "not verified", (
        f"the two integrators, CVODES and {check.steps} fixed steps, differ by {differ} in "
        f"residual, where {AGREEMENT:g} of each is agreement; the figures are those of CVODES; "
        f"give {remedy}"
    )


def _full_rows(plan: Plan) -> list[Row]:
    """Return a row of what the whole equations say of a motion whose plant reduces them."""
    figures = plan.candidate.in_full
    if figures is None:
        return []
    share = abs(figures.energy / plan.energy - 1)
    residual = tip_words(figures.residual, plan.task.plant.tip_unit)
    more = figures.residual - plan.residual
    certain = plan.task.uncertainty is None
    remedy = "; --in-full corrects the plan for that" if certain and more > _LEFT else ""
    return [
        (
            "in full",
            f"{figures.energy:.4g} J ({100 * share:.2g} % from the above) and {residual} left, "
            f"by the whole equations, without modes and tables{remedy}",
        )
    ]


_LEFT = 1e-4
"""What a plan may leave by the whole equations, beyond its residual, before a remedy is named [m]:
the figure that paths are held to."""


def _path_rows(task: PointToPoint) -> list[Row]:
    """Return rows of what to know of a robot's path; none for other plants."""
    plant = task.plant
    return way_rows(plant.robot, plant.path) if isinstance(plant, RobotOnPath) else []


def _move_rows(task: PointToPoint, motion: Figures, residual_limit: float = 0.0) -> list[Row]:
    """The move and its limits, and which of them the motion breaks."""
    tip_unit = task.plant.tip_unit
    limits = [f"residual {_tip(task, residual_limit)}"] if residual_limit > 0 else []
    for limit in task.limits:
        peak = limit.peak_of(motion)
        broken = "" if limit.keeps(peak, OVERRUN) else f" (broken: {_reached(limit, motion)})"
        limits.append(f"{limit}{_without(limit, task.plant)}{broken}")
    return [
        ("move", f"{moved(task)}, {move_of(task)}"),
        *_path_rows(task),
        *([("at the start", state_words(task.initial, tip_unit))] if task.initial else []),
        *([("on arrival", state_words(task.final, tip_unit))] if task.final else []),
        *([("limits", ", ".join(limits))] if limits else []),
    ]


def _reached(limit: Limit, motion: Figures) -> str:
    """The peak that passes a limit, in words; of several joints with their names."""
    if motion.candidate is None:
        return limit.describe(limit.peak_of(motion))
    return peak_words(limit, motion.candidate, OVERRUN)


def _without(limit: Limit, plant: Plant) -> str:
    """The joints that a limit of some joints leaves free, in words."""
    limited = [bounds.name for bounds in limit.bounds_of_joints(plant)]
    return free_joints_words(plant.joint_names, limited)


def _figure_rows(
    task: PointToPoint, candidate: JudgedMotion, remedies: Mapping[str, str]
) -> list[Row]:
    """A motion's energy, residual, peaks and overshoot; remedies of those that are too hard."""
    motion = candidate.motion
    residual = _tip(task, motion.residual)
    if is_at_rest(motion.residual, task):
        where = "as wanted" if task.final else "at rest"
        residual = f"{where} (below {_tip(task, rest_of(task))})"
    energy = f"{motion.energy:.4g} J  (net work {motion.net_work:.4g} J)"
    rows = {
        ENERGY: ("energy", f"{energy}{_warnings(task, ENERGY)}"),
        RESIDUAL: (
            "residual",
            f"{residual} {residual_place(task)}{_warnings(task, RESIDUAL)}",
        ),
    }
    for figure in figures_in(REPORT, task):
        if figure.name not in rows and figure.name in motion:  # a jump has no jerk
            label = figure.label_on(task.plant)
            rows[figure.name] = label, _figure(figure, candidate, remedies)
    return list(rows.values())


def _figure(figure: Figure, candidate: JudgedMotion, remedies: Mapping[str, str]) -> str:
    """A figure in words, with what is to be said of it."""
    if figure.quantity:
        return _peak(figure, candidate, remedies)
    if figure.name == "overshoot":
        size = candidate.overshoot
        return _way(size, candidate.task) if size > _ROUNDING else "none"
    plant = candidate.task.plant
    value = candidate.figures[figure.name]
    if figure.unit.is_tip_way:
        return tip_words(value, plant.tip_unit)
    return f"{figure.words(value, plant)}{_warnings(candidate.task, figure.name)}"


def note_rows(plant: Plant) -> list[Row]:
    """Notes on a plant that are about none of the figures."""
    return [("warning", note.words) for note in plant.notes if not note.about]


def _warnings(task: PointToPoint, figure: str) -> str:
    """The notes on the plant that touch a figure, to stand beside it."""
    return "".join(f"  (warning: {words})" for words in about(task.plant.notes, figure))


def _tip(task: PointToPoint, displacement: float) -> str:
    """A displacement of the tip in the unit that is shown."""
    return tip_words(displacement, task.plant.tip_unit)


def _way(size: float, task: PointToPoint) -> str:
    """A way of the joint in its unit; of several joints a share of their path."""
    return f"{size:.3g} {unit_of_way(task.plant)}"


def _peak(figure: Figure, candidate: JudgedMotion, remedies: Mapping[str, str]) -> str:
    """A peak, with a warning where the drive or the plant's equations may not follow."""
    task = candidate.task
    motion = candidate.figures
    name = figure.quantity
    if figure.unit.is_tip_way:
        small = task.plant.small_deflection
        peak = motion[figure.name]
        words = _tip(task, peak)
        if name != "deflection" or small is None or max(peak, motion.residual) <= small:
            return words
        return (
            f"{words}  (warning: beyond {_tip(task, small)}, up to which the plant's "
            "deflections count as small; its equations are less exact there)"
        )
    warnings = {"acceleration": _hard_acceleration, "jerk": _hard_jerk}
    too_hard = warnings[name](task, motion) if name in remedies else ""
    warning = f"  (warning: {too_hard}; {remedies[name]})" if too_hard else ""
    return f"{figure_words(candidate, figure)}{warning}{_warnings(task, name)}"


def _hard_acceleration(task: PointToPoint, motion: Figures) -> str:
    """Say how far the acceleration is above the plain cycloid's, if no limit is near."""
    plain = CycloidPolynomial(0).path([], task.start, task.target, task.duration)
    times = motion.peak_acceleration / abs(float(plain(task.duration / 4, order=2)))  # its peak
    limited = any(_is_near(limit, motion) for limit in task.limits)
    return "" if limited or times <= _HARD else f"{times:.2g} times the plain cycloid's"


def _hard_jerk(task: PointToPoint, motion: Figures) -> str:
    """Say how fast the acceleration changes, if no limit of the jerk is near."""
    limit = task.limit_of("jerk")
    ramp = motion.peak_acceleration / motion.peak("jerk")
    limited = limit is not None and _is_near(limit, motion)
    if limited or ramp >= rise_time(task.duration):
        return ""
    return f"at this rate the acceleration changes by its peak in {1e3 * ramp:.2g} ms"


def _is_near(limit: Limit, motion: Figures) -> bool:
    return limit.peak_of(motion) > _FAR * limit.size


def _choice(plan: Plan) -> Row:
    """Return the name of what sets the motion apart from others of its task, and that in words."""
    if isinstance(plan.profile, ShapedCycloid):
        impulses = len(plan.profile.impulses.times)
        shaper = f"{impulses} impulses within {plan.profile.length:.4g} s"
        return "profile", f"{plan.profile.label}: {shaper}"
    coefficients = ", ".join(f"{value:.6g}" for value in plan.coefficients)
    if isinstance(plan.profile, JointSpline):
        return "profile", f"quintic spline, {plan.profile.amount} where the acceleration changes"
    if not isinstance(plan.profile, CycloidPolynomial):
        return "profile", f"{plan.profile.label}: {coefficients}"
    return "coefficients", coefficients or "none: the plain cycloid"


def _terms_rows(plan: Plan) -> list[Row]:
    """Say how many terms the plan chose, and what six would cost; nothing if they were given."""
    settings = plan.record.settings
    if CHOSEN not in settings:
        return []
    words = f"{settings[CHOSEN]}, chosen for the limits"
    energy_of_six = float(settings.get(OF_SIX) or 0.0)
    if energy_of_six:
        words += f", six would take {energy_of_six:.4g} J ({energy_of_six / plan.energy - 1:+.0%})"
    elif plan.worst is None:
        words += ", six terms find no motion"
    return [("terms", words)]
