"""The two ends of a front: at rest on arrival, or of least residual, and the cheapest."""

from __future__ import annotations

from dataclasses import dataclass, replace

from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.front.curve import RESIDUAL_LIMIT, Certificate, Curve
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.planning.best_of_starts import (
    SAME,
    best_of_starts,
    least_peaks_of,
    solve_from_starts,
)
from quietarm.ocp.planning.certify import OF_A_PLAN, Tolerances, certify_one
from quietarm.ocp.solvers.problem import (
    ENERGY,
    LEAST_ENERGY,
    STILL,
    Problem,
    Solution,
    Transcription,
)

_ENERGY_WEIGHTS = (1.0, 0.1, 0.02, 2e-3)
"""Weights of the energy beside the residual, one solve after the other, on the way to the end of
least residual of an uncertain task. At the last one, reducing the residual by a further hundredth
of the cheapest end's would cost five times the energy of the nominal plant's motion at rest."""
_SAMPLING = 1e-4
"""Share by which the residual between its samples may exceed that at them."""


@dataclass(frozen=True)
class Ends:
    """The ends of a front, on a curve of the steps that the end of least residual needs."""

    curve: Curve
    still: Solution
    cheapest: Solution
    certificates: tuple[Certificate, Certificate]

    @property
    def width(self) -> float:
        """How far apart they are in the residual [m]."""
        return self.cheapest.residual - self.still.residual

    @property
    def height(self) -> float:
        """How far apart they are in the energy [J]."""
        return self.still.energy - self.cheapest.energy

    @property
    def are_one(self) -> bool:
        """Whether the two ends are the same motion, and there is no front between."""
        return self.width <= STILL or self.height <= SAME * self.still.energy


def find_ends(curve: Curve) -> Ends:
    """Find the motion of least energy that arrives at rest, and that whose residual is free.

    The number of steps is raised until CVODES agrees at the end of least residual. If no motion
    arrives at rest, this end is the motion of least residual; for an uncertain task it is where a
    smaller residual would cost too much energy. Errors are those of `solve_from_starts`.
    """
    if curve.task.uncertainty is not None:
        return _of_scenarios(curve)
    at_rest = _at_rest(curve)  # first: it settles the number of steps
    curve = curve if at_rest is None else at_rest[0]
    cheapest, _ = solve_from_starts(curve.problem(), curve.starts, curve.solver)
    still, certificate = at_rest[1:] if at_rest else _least_residual(curve, cheapest)
    return Ends(curve, still, cheapest, (certificate, _certify_cheapest(curve, cheapest)))


def _certify_cheapest(curve: Curve, cheapest: Solution) -> Certificate:
    (end,) = curve.certify([(cheapest, {RESIDUAL_LIMIT: cheapest.residual})], free=True)
    return end


def _at_rest(curve: Curve) -> tuple[Curve, Solution, Certificate] | None:
    """The motion at rest, on a curve of the steps that it takes; None where there is none."""
    try:
        first, _ = solve_from_starts(curve.problem(0.0), curve.starts, curve.solver)
        found = certify_one(
            curve.problem(0.0), first, curve.solver, Tolerances(curve.tolerances.energy)
        )
        curve = replace(curve, transcription=found.problem.transcription)
        end = certify_one(curve.problem(0.0), found.solution, curve.solver)
    except SolverFailedError:
        return None
    return curve, found.solution, curve.point_of(end)


def _least_residual(curve: Curve, cheapest: Solution) -> tuple[Solution, Certificate]:
    """The motion of least residual, and of motions of that residual the cheapest.

    Limits are tightened while the residual is minimised: at the least residual there is no room to
    tighten them in.
    """
    least = least_peaks_of(curve.problem(), curve.starts, curve.solver).get(RESIDUAL)
    if least is None:
        return cheapest, _certify_cheapest(curve, cheapest)
    transcription, asked = curve.problem(minimise={RESIDUAL: 1.0})
    limits, solver = curve.problem().scalarization.limits, curve.solver
    try:
        reached = certify_one(Problem(transcription, asked), least, solver, limits=limits)
        transcription, asked = reached.problem
        residual = Limit.of_residual(reached.solution.residual * (1 + _SAMPLING))
        others = [limit for limit in asked.limits if limit.name != RESIDUAL]
        asked = asked._replace(limits=(*others, residual), minimise=LEAST_ENERGY, offset=0.0)
        problem = Problem(transcription, asked)
        (found,) = solver.solve([problem], [reached.solution.coefficients], warm=True)
        still = found if found.status.solved else reached.solution
        end = certify_one(problem, still, solver, OF_A_PLAN, limits)
    except SolverFailedError:
        (end,) = curve.certify([(least, {RESIDUAL_LIMIT: least.residual})])
        return least, end
    point, iterations = curve.point_of(end)
    return still, Certificate(point, least.iterations + iterations)


def _of_scenarios(curve: Curve) -> Ends:
    """The ends of an uncertain task, from those of the nominal one.

    Its energy is that of the nominal plant, so the cheapest motion is the same. Neither rest in all
    scenarios nor the least residual is asked for: both would cost any energy.
    """
    nominal = find_ends(Curve.begin(curve.task.certain, curve.transcription.profile, curve.setup))
    steps = nominal.curve.transcription.steps
    curve = replace(curve, transcription=Transcription(
        curve.task, curve.transcription.profile, steps))  # fmt: skip
    starts = [nominal.cheapest.coefficients, nominal.still.coefficients]
    (cheapest,) = best_of_starts([curve.problem()], [starts], curve.solver)
    still = cheapest
    for weight in _ENERGY_WEIGHTS if cheapest.residual > STILL else ():
        weights = {RESIDUAL: 1 / cheapest.residual, ENERGY: weight / nominal.still.energy}
        problem = curve.problem(minimise=weights)
        (found,) = curve.solver.solve([problem], [still.coefficients])
        still = found if found.status.solved else still
    (certificate,) = curve.certify([(still, {RESIDUAL_LIMIT: still.residual})])
    return Ends(curve, still, cheapest, (certificate, _certify_cheapest(curve, cheapest)))
