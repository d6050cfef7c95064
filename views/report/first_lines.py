"""The first line of an answer about one motion: what it takes and leaves, beside the cycloid."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.ocp import CycloidPolynomial, Floor, JudgedMotion, Plan, SolverFailedError
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.joint_words import broken_limits
from quietarm.ocp.planning.as_timed import TimedAnswer
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.rest import is_at_rest
from quietarm.views.report.acting_words import ranges_words
from quietarm.views.report.captions import left_words
from quietarm.views.report.terminal import LEAST_WIDTH
from quietarm.views.tips import tip_words


def plan_answer(plan: Plan, *, fastest: bool = False) -> list[str]:
    """Return what a plan takes and leaves, beside the plain cycloid, in a line or two."""
    optimised = plan.status is not SolveStatus.NOT_OPTIMISED
    subject = "this plan takes" if optimised else "this motion takes"
    if fastest:
        subject = f"the fastest plan takes {plan.task.duration:.4g} s,"
    words = f"{subject} {_energy_and_end(plan.candidate, plan.worst)}"
    return _beside_the_cycloid([words, *_left_on_drive(plan)], plan.candidate)


def _left_on_drive(plan: Plan) -> list[str]:
    """Return what a plan leaves on its drive; nothing if the drive cannot be simulated."""
    try:
        figures = plan.candidate.on_drive
    except SolverFailedError:
        return ["its drive does not follow it"]
    if figures is None or is_at_rest(figures.residual, plan.task):
        return []
    nominal = "" if plan.worst is None else " without an error"
    return [
        f"on its drive it leaves {tip_words(figures.residual, plan.task.plant.tip_unit)}{nominal}"
    ]


def floor_answer(floor: Floor, plan: Plan | None) -> list[str]:
    """Return what the best free motion takes and leaves, beside a plan and the plain cycloid."""
    words = [f"this free motion takes {_energy_and_end(floor.candidate)}"]
    if plan is not None:
        terms = plan.profile.size
        words.append(f"a plan of {terms} coefficients takes {_energy_and_end(plan.candidate)}")
    return _beside_the_cycloid(words, floor.candidate)


def path_answer(motion: JudgedMotion) -> list[str]:
    """Return what a recorded path takes and leaves, beside the plain cycloid."""
    return _beside_the_cycloid([f"this path takes {_energy_and_end(motion)}"], motion)


def timed_answer(answer: TimedAnswer) -> str:
    """Return what a trajectory with its own times takes and leaves."""
    return _sentence(
        f"this trajectory takes {answer.energy:.3g} J in {answer.motion.duration:.3g} s and leaves "
        f"{tip_words(answer.residual, 'm')} at the tip"
    )


def _energy_and_end(motion: JudgedMotion, worst: JudgedMotion | None = None) -> str:
    """Return energy and residual in words, in the worst case if there are errors."""
    end = _end(motion, motion.residual)
    if worst is not None:
        at_most = "" if is_at_rest(worst.residual, motion.task) else "at most "
        end = _end(motion, worst.residual).replace("leaves ", f"leaves {at_most}")
        end = f"{end} {ranges_words(motion.task.ranges)}"
    return f"{motion.energy:.3g} J and {end}{_broken(motion)}"


def _end(motion: JudgedMotion, residual: float) -> str:
    """Return how a motion ends: at rest, as wanted, or what it leaves."""
    if motion.task.final and is_at_rest(residual, motion.task):
        return "arrives as wanted"
    return left_words(residual, motion.task)


def _broken(motion: JudgedMotion) -> str:
    """Return the limits that a motion breaks, in words; nothing where it keeps all."""
    broken = broken_limits(motion, motion.task.limits, OVERRUN)
    return f", beyond its limit of {' and '.join(broken)}" if broken else ""


def _beside_the_cycloid(words: Sequence[str], motion: JudgedMotion) -> list[str]:
    """Return clauses with the plain cycloid's behind them, unless that is the motion or fails."""
    cycloid = plain_cycloid(motion)
    clauses = [*words]
    if cycloid is not None and not _is_the_same(motion, cycloid):
        clauses.append(f"the plain cycloid takes {_energy_and_end(cycloid)}")
    line = "; ".join(clauses)
    whole = [line] if len(line) < LEAST_WIDTH else clauses
    return [_sentence(words) for words in whole]


def plain_cycloid(motion: JudgedMotion) -> JudgedMotion | None:
    """Return the plain cycloid of a motion's move; None where CVODES fails on it."""
    profile = motion.profile
    if not isinstance(profile, CycloidPolynomial):  # else its equations are built
        profile = CycloidPolynomial(0)
    cycloid = JudgedMotion.of_profile(motion.task, profile, profile.plain)
    try:
        cycloid.figures  # noqa: B018  # computed when they are first asked for
    except SolverFailedError:
        return None
    return cycloid


def _is_the_same(motion: JudgedMotion, other: JudgedMotion) -> bool:
    """Return whether two motions have the same figures to the digits that are shown."""
    first, second = (f"{one.energy:.3g} {one.residual:.3g}" for one in (motion, other))
    return first == second


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."
