"""From a sweep's solutions to a front: its two ends, and its points put together."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.front.answer import Front, reference_corner
from quietarm.ocp.front.checking import RESIDUAL_LIMIT, SAMPLING, care_of, checked, front_point
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated
from quietarm.ocp.front.robust import held_between
from quietarm.ocp.front.sweep import SAME, Sweep
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.planning.feasibility import least_peaks_of
from quietarm.ocp.planning.starts import from_starts
from quietarm.ocp.planning.verification import MOST_SOLVER_STEPS, verified
from quietarm.ocp.solvers.solution import ENERGY, RESIDUAL, STILL, Solution

_ENERGY_WEIGHTS = (1.0, 0.1, 0.02, 2e-3)
"""Weights of the energy beside the residual, one solve after the other, on the way to the still end
of an uncertain plant. At the last one, another hundredth of the cheapest end's residual less would
cost five times the energy of the assumed plant's motion at rest."""


@dataclass(frozen=True)
class Ends:
    """The ends of a front."""

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
    """
    if between and sweep.task.uncertainty is not None:
        return _ends_of_uncertain(sweep)
    still = _at_rest(sweep)  # first: it settles the number of steps
    cheapest = _best(sweep, np.inf)
    if still is None:
        least = least_peaks_of(sweep.program, sweep.ask(), sweep.guesses)
        if RESIDUAL not in least:
            return Ends(
                cheapest,
                checked(sweep, cheapest, {RESIDUAL_LIMIT: cheapest.peaks[RESIDUAL]}),
                cheapest,
            )
        limit = least[RESIDUAL].peaks[RESIDUAL] * (1 + SAMPLING)
        found = sweep.best([least[RESIDUAL].coefficients], sweep.ask(limit))
        found = found if found.status.solved else least[RESIDUAL]
        still = found, checked(sweep, found, {RESIDUAL_LIMIT: limit})
    return Ends(*still, cheapest)


def _best(sweep: Sweep, residual_limit: float) -> Solution:
    """The best of all starts; KeyboardInterrupt after Ctrl-C."""
    ask, solver = sweep.ask(residual_limit), sweep.settings.solver
    found = from_starts(sweep.program, ask, sweep.guesses, solver)
    sweep.iterations += found.solution.iterations
    if found.stopped:
        raise KeyboardInterrupt
    return found.solution


def _ends_of_uncertain(sweep: Sweep) -> Ends:
    """The ends of an uncertain plant, from those of the assumed one.

    Its energy is that of the assumed plant, so the cheapest motion is the same.

    Neither rest at all samples nor the least residual is asked for: the first costs much energy
    and leaves no rest between the samples, the second any energy. The still end is where less
    residual costs too much energy.
    """
    alone = Sweep(sweep.task.certain, sweep.profile, sweep.settings)
    assumed = find_ends(alone)
    sweep.steps, sweep.iterations = alone.steps, sweep.iterations + alone.iterations
    guesses = [assumed.cheapest.coefficients, assumed.still.coefficients]
    cheapest = sweep.best(guesses, sweep.ask())
    still = cheapest
    for weight in _ENERGY_WEIGHTS if cheapest.residual > STILL else ():
        weights = {RESIDUAL: 1 / cheapest.residual, ENERGY: weight / assumed.still.energy}
        found = sweep.best([still.coefficients], sweep.ask(minimise=weights))
        still = found if found.status.solved else still
    return Ends(still, checked(sweep, still, {RESIDUAL_LIMIT: still.residual}), cheapest)


def _at_rest(sweep: Sweep) -> tuple[Solution, FrontPoint] | None:
    try:
        first, ask, solver = _best(sweep, 0.0), sweep.ask(0.0), sweep.settings.solver
        care = replace(care_of(sweep), most_steps=MOST_SOLVER_STEPS)
        found, _, sweep.steps = verified(sweep.program, ask, first, solver, care)
        end, simulated, _ = verified(sweep.program, ask, found, solver)
    except SolverFailedError:
        return None
    sweep.iterations += end.iterations - first.iterations
    return found, front_point(sweep, end, simulated)


def front_of(
    sweep: Sweep,
    method: str,
    found: Sequence[FrontPoint | FailedPoint],
    points: int,
    *,
    gaps: Sequence[tuple[float, float]] = (),
    complete: bool = True,
    between: bool = True,
    also: Mapping[str, str] = {},
) -> Front:
    """Put points together to a front."""
    excess = None
    if between and complete:
        found, excess, complete = held_between(sweep, found)
    with note_interrupts():  # the points are found; the rest takes a moment
        reference = reference_corner(sweep.task)
    failures = tuple(point for point in found if isinstance(point, FailedPoint))
    settings = sweep.settings
    return Front(
        task=sweep.task,
        profile=sweep.profile,
        points=non_dominated(point for point in found if isinstance(point, FrontPoint)),
        method=method,
        settings={"bound": settings.bound, "points": points, "starts": settings.starts,
                  "steps": sweep.steps, "solver": settings.solver, **also},
        seed=settings.seed,
        reference=reference,
        iterations=sweep.iterations,
        failed=len(failures),
        failures=failures,
        gaps=tuple(gaps),
        excess=excess,
        complete=complete,
        seconds=time.perf_counter() - sweep.began,
    )  # fmt: skip
