"""The two ends of a front: at rest on arrival, and with any residual."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ocp.base.errors import SolverFailedError
from ocp.front.checking import RESIDUAL_LIMIT, SAMPLING, care_of, checked, front_point
from ocp.front.points import FailedPoint, FrontPoint
from ocp.front.sweep import SAME, Sweep
from ocp.plan.feasibility import least_peaks
from ocp.plan.solver import least_energy
from ocp.plan.verification import MOST_SOLVER_STEPS, verified
from ocp.program.solution import ENERGY, STILL, Solution
from ocp.program.transcription import RESIDUAL
from ocp.robustness.uncertain import UncertainPlant, on_assumed

_LESS_AND_LESS = (1.0, 0.1, 0.02, 2e-3)
"""Weights of the energy beside the residual, one solve after the other, on the way to the still end
of an uncertain plant. There, to take another hundredth of the cheapest end's residual off would
cost five times the energy of the assumed plant's motion at rest."""


@dataclass(frozen=True)
class Ends:
    """The ends of a front.

    Attributes
    ----------
    still : Solution
        Least energy at rest on arrival.
    still_point : FrontPoint or FailedPoint
        The same, checked.
    cheapest : Solution
        Least energy with any residual.
    """

    still: Solution
    still_point: FrontPoint | FailedPoint
    cheapest: Solution

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
        """Whether the cheapest motion is the still one, and there is no front between."""
        return self.width <= STILL or self.height <= SAME * self.still.energy


def find_ends(sweep: Sweep, *, between: bool = True) -> Ends:
    """Find the motion of least energy that arrives at rest, and that whose residual is free.

    The number of steps is raised until the independent integrator agrees with the still end.
    Where no motion arrives at rest, that end is the motion of least residual.

    Parameters
    ----------
    sweep : Sweep
        What is asked.
    between : bool
        Whether an uncertain plant is meant between its samples as well, where no motion rests.

    Returns
    -------
    Ends
        The ends of the front.

    Raises
    ------
    InfeasibleTaskError
        When no motion of this profile keeps the task's limits.
    SolverFailedError
        When no start ended at an optimum for another reason.
    """
    if between and isinstance(sweep.task.plant, UncertainPlant):
        return _of_uncertain(sweep)
    still = _at_rest(sweep)  # first: it settles the number of steps
    free = sweep.problem(np.inf)
    cheapest = least_energy(free)
    sweep.iterations += cheapest.iterations
    if still is None:
        least = least_peaks(free.limits, free.guesses, free.least)
        if RESIDUAL not in least:
            return Ends(
                cheapest,
                checked(sweep, cheapest, {RESIDUAL_LIMIT: cheapest.peaks[RESIDUAL]}),
                cheapest,
            )
        limit = least[RESIDUAL].peaks[RESIDUAL] * (1 + SAMPLING)
        found = sweep.solve(least[RESIDUAL].coefficients, limit)
        found = found if found.status.solved else least[RESIDUAL]
        still = found, checked(sweep, found, {RESIDUAL_LIMIT: limit})
    return Ends(*still, cheapest)


def _of_uncertain(sweep: Sweep) -> Ends:
    """The ends from those of the assumed plant, whose energy it is: the cheapest is the same.

    Neither rest at all samples nor the least residual is asked for: the first costs much energy
    and leaves no rest between the samples, the second any energy. The still end is where less
    residual costs too much energy.
    """
    alone = Sweep(on_assumed(sweep.task), sweep.profile, sweep.settings)
    assumed = find_ends(alone)
    sweep.steps, sweep.iterations = alone.steps, sweep.iterations + alone.iterations
    guesses = [assumed.cheapest.coefficients, assumed.still.coefficients]
    free = replace(sweep.problem(np.inf), guesses=guesses)
    cheapest = free.solve(assumed.cheapest.coefficients)
    if not cheapest.status.solved:
        cheapest = least_energy(free)
    sweep.iterations += cheapest.iterations
    still = cheapest
    for weight in _LESS_AND_LESS if cheapest.residual > STILL else ():
        weights = {RESIDUAL: 1 / cheapest.residual, ENERGY: weight / assumed.still.energy}
        found = sweep.solve(still.coefficients, minimise=weights)
        still = found if found.status.solved else still
    return Ends(still, checked(sweep, still, {RESIDUAL_LIMIT: still.residual}), cheapest)


def _at_rest(sweep: Sweep) -> tuple[Solution, FrontPoint] | None:
    try:
        found = least_energy(sweep.problem(0.0))
        care = replace(care_of(sweep), enough_steps=sweep.steps, most_steps=MOST_SOLVER_STEPS)
        found, _, sweep.steps = verified(sweep.problem(0.0), found, care=care)
        end, simulated, _ = verified(sweep.problem(0.0), found)
    except SolverFailedError:
        return None
    sweep.iterations += end.iterations
    return found, front_point(sweep, end, simulated)
