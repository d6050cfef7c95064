"""`plan_move`: least energy within a residual limit, from several starts, certified."""

from __future__ import annotations

from numpy.typing import ArrayLike
from quietarm.ocp.errors import InfeasibleTaskError
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.planning.best_of_starts import plan_from_starts
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.feasibility import UNITS
from quietarm.ocp.planning.plan import Plan, evaluate_coefficients
from quietarm.ocp.planning.robust import plan_robustly
from quietarm.ocp.planning.terms import plan_with_chosen_terms
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.solvers.choice import SolverName
from quietarm.ocp.solvers.transcription import RESIDUAL, STILL
from quietarm.ocp.task import PointToPoint


def only_motion(
    task: PointToPoint, profile: JointProfile, residual_limit: float | None = None
) -> Plan:
    """The figures of the only motion that a profile has, within the task's limits."""
    asked = {} if residual_limit is None else {"residual_limit": residual_limit}
    plan = evaluate_coefficients(task, [], profile=profile, method="evaluated", settings=asked)
    residual = {} if residual_limit is None else {RESIDUAL: max(residual_limit, STILL)}
    limits = {**residual, **task.limits}
    broken = [
        f"its {name} reaches {plan.motion.peak(name):.4g} {UNITS[name]}, above {limits[name]:g}"
        for name in plan.motion.exceeded(limits, OVERRUN)
    ]
    if broken:
        raise InfeasibleTaskError(
            f"the {profile.label} has one motion for this move, and {'; '.join(broken)}: "
            "widen what is broken, or give a longer duration or another profile"
        )
    return plan


@one_at_a_time
def plan_move(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    residual_limit: float | None = None,
    bound: float | None = None,
    starts: int = 4,
    seed: int = 0,
    steps: int | None = None,
    guess: ArrayLike | None = None,
    solver: SolverName = "sqp",
    print_level: int = 0,
) -> Plan:
    """Find the motion of least energy whose residual vibration is within a limit.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile, optional
        How the joint moves; by default the cycloid of a polynomial, of six terms without limits,
        and of 18 or 24 within limits (`ocp.planning.terms`); the plan's record then says what six
        would cost. The only motion of a profile without coefficients, such as `shaped_cycloid`, is
        evaluated, not optimised.
    residual_limit : float, optional
        Largest F1 [m]; 0 asks for rest on arrival, or for the task's `final` state, where there
        are coefficients to choose. By default 0; of an uncertain task, which hardly ever arrives
        at rest whatever its errors, 5 % of how far the plain cycloid of the same duration bends the
        nominal plant's tip on its way, or less: what the plan of the nominal plant leaves in the
        worst case. Where neither can be reached, the least worst case. `Plan.residual_limit` is
        the one that was taken.
    bound : float, optional
        Largest absolute coefficient; none by default.
    starts : int
        How many starts: the guess or the plain cycloid first, then random ones; all at once. Once
        half of them, and more than one, have ended at the least energy found, the others are left.
        Gaussians and networks take four random starts for each: they have many minima.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, chosen from the task by default; they are doubled
        while the verification disagrees.
    guess : array_like, shape (profile.size,), optional
        Coefficients to start from first, such as a metaheuristic's, to be improved; six without a
        profile.
    solver : {"sqp", "ipopt"}
        Sequential quadratic programs, all starts at once, or IPOPT, one after another. Where the
        first solves no start, IPOPT takes over.
    print_level : int
        How much of its log IPOPT prints, 0 to 12.

    Returns
    -------
    Plan
        The coefficients, with the figures of an independent integrator. Of an uncertain task the
        residual limit holds between the scenarios as well, as its ``worst`` states; its task has
        the scenarios that this took.

    Raises
    ------
    ValueError
        When an argument is out of range.
    InfeasibleTaskError, SolverFailedError
        When no motion of this profile meets the task, with what would be feasible; when no start
        ended at an optimum for another reason.
    """
    chosen = profile is None and guess is None
    profile = CycloidPolynomial() if profile is None else profile
    if guess is not None:
        guess = profile.checked(guess)
    least = 0.0 if residual_limit is None else residual_limit
    settings = SolveSettings(least, bound, starts, seed, steps, guess, solver, print_level)
    if profile.size == 0:
        return only_motion(task, profile, residual_limit)

    def plan(profile: JointProfile, settings: SolveSettings) -> Plan:
        if task.uncertainty is not None:
            return plan_robustly(task, profile, settings, residual_limit)
        return plan_from_starts(task, profile, settings)[0]

    return plan_with_chosen_terms(task, settings, plan) if chosen else plan(profile, settings)
