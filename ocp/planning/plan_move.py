"""`plan_move`: the move of least energy, from a task to a certified plan.

The way of a task: with the profile that is named, or that it takes (`choose_profile`), and all else
that a plan depends on it becomes one value (`request`). Of this the plan is made (`plan_along`):
solutions from several starts (`best_of_starts`), of which CVODES has the last word (`certify`).
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from quietarm.ocp.checks import count_of, takes
from quietarm.ocp.errors import InfeasibleTaskError
from quietarm.ocp.planning.choose_profile import choose_profile, plan_on_chosen_profile
from quietarm.ocp.planning.plan import Plan, only_motion
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.remedies import offers_for
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.too_short import arrives_at_rest, refuse_to_hold, refuse_too_short
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint


@takes(task=PointToPoint, profile=JointProfile, solver=Solver)
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
    solver: Solver = Sqp(),
) -> Plan:
    """Find the motion of least energy whose residual vibration is within a limit.

    Without a profile that is named a task is refused only if, within its limits, a `JointSpline`
    finds no motion either, or without limits 18 or 24 terms.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile, optional
        How the joint moves; by default the cycloid of a polynomial, of six terms without limits,
        and of 18 or 24 with limits (`choose_profile`); the plan's record then has the energy of
        six. The only motion of a profile without coefficients, such as `shaped_cycloid`, is
        evaluated, not optimised.
    residual_limit : float, optional
        Largest residual [m]; 0, the default, requires rest on arrival, or the task's `final` state.
        For an uncertain task, where rest in all scenarios is infeasible, the default is 5 % of the
        largest deflection during the plain cycloid of the same duration on the nominal plant, or
        the worst case of the nominal plant's plan if that is smaller. If neither is feasible, it is
        the least worst case. `Plan.residual_limit` is the limit that was used.
    bound : float, optional
        Largest absolute coefficient; none by default.
    starts : int
        How many starts: the guess or the plain cycloid first, then random ones; all at once. Once
        half of them, and more than one, have ended at the lowest energy, the others are stopped.
        Gaussians and networks take four random starts for each: they have many local minima.
        With limits and no named profile these are starts of six terms; 18 or 24 terms start from
        the plain cycloid, and from the answer with six terms where that fails.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, chosen from the task by default; they are doubled
        while the verification disagrees.
    guess : array_like, shape (profile.size,), optional
        Coefficients of the first start, such as a metaheuristic's; without a profile the polynomial
        has as many terms.
    solver : Solver
        `Sqp` solves all starts at once, `Ipopt` one after another. If the first solves no start,
        IPOPT is tried with the same options.

    Returns
    -------
    Plan
        The coefficients, with values by CVODES. For an uncertain task the residual limit holds
        between the scenarios as well, see ``worst``; its task has the scenarios that were used.

    Raises
    ------
    ValueError
        When an argument is out of range.
    InfeasibleTaskError, SolverFailedError
        When no motion of this profile is feasible, with what would be; when no start ended at an
        optimum for another reason.
    """
    takes_its_profile = profile is None and guess is None
    if profile is None:
        profile = (
            choose_profile(task)
            if guess is None
            else CycloidPolynomial.of_size(count_of("coefficients", guess))
        )
    request = Request(task, profile, solver, bound, starts, seed, steps)
    if profile.size == 0:
        return only_motion(task, profile, residual_limit)
    request = request.stating(residual_limit)
    if guess is not None:
        request = request.from_guess(guess)
    if takes_its_profile:
        return plan_on_chosen_profile(request)
    refuse_to_hold(task)  # with what holds it, at once
    try:
        refuse_too_short(task, arrives_at_rest(task, request.residual_limit))
    except InfeasibleTaskError as error:
        if task.plant.along_path:  # a robot's offers take up to a minute
            raise
        offers = offers_for(request.problem(), request.guesses, solver)
        raise InfeasibleTaskError(error.what, offers) from None
    return plan_along(request)
