"""The certificate of a reference front: what it is, and how it was tested."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from make import LIMITED_STEPS, exact_front
from quietarm.metaheuristics import PROBLEMS, NamedProblem
from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.metaheuristics.problems.catalogue import FRONTS
from quietarm.ocp import Front, PointToPoint, QuietarmError
from quietarm.ocp.limits import Limit
from quietarm.ocp.planning.certify import judge
from quietarm.ocp.planning.plan_move import plan_from_starts
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.solvers.problem import STILL, Problem, Scalarization, Solution, Transcription
from quietarm.ocp.solvers.sqp import Sqp

_TRIED, _STARTS, _SEED = 20, 5, 2000
"""Points that are also tried from so many random starts, others than found the front."""
_TELLING = 1e-5
SAME = 1e-7
"""[m]: residuals were sampled when the fronts were found, and missed 1.2e-6 of a peak."""
FIXED_STEPS = 384
"""Of the other integrator, which finds no front: a population's."""
CONFIRMED = 0.9
"""Share of the points that the solver, started there, has to call optimal."""
BEATEN, DIFFERENT, SAMPLED = 1e-4, 1e-6, 1e-4
"""A certificate holds where nothing is cheaper by more than the first share of the energy, where
CVODES gives the stated energies within the second, and residuals within `SAME`, and fixed steps
give the energies of CVODES within the second share and residuals within the third of the front's
largest: a population's are sampled, and miss up to 5e-5 of a peak."""


@dataclass(frozen=True)
class Certificate:
    """What is known of a reference front.

    The largest differences from what CVODES gives, of the energies as a share and of the residuals
    [m]; the largest shares by which fixed steps give other energies and residuals than CVODES does;
    how many points the solver, started there, calls optimal; from how many starts it was tried to
    beat some; and the largest share by which any solution is cheaper than its point, by CVODES and
    at its residual and limits by their prices.
    """

    front: str
    points: int
    energy_difference: float
    residual_difference: float
    energy_by_steps: float
    residual_by_steps: float
    confirmed: int
    tried: int
    gained: float

    @property
    def holds(self) -> bool:
        """Whether what was found now is within the tolerances."""
        same = self.energy_difference <= DIFFERENT and self.residual_difference <= SAME
        close = self.energy_by_steps <= DIFFERENT and self.residual_by_steps <= SAMPLED
        most = self.confirmed >= CONFIRMED * self.points
        return same and close and most and self.gained <= BEATEN


def certified(
    problem: NamedProblem, report: Callable[[str], None] = lambda name: None
) -> list[Certificate]:
    """Check the reference fronts of a problem anew.

    Every point is evaluated by CVODES and is the start of a solve at its residual; some are solved
    from random starts as well. `report` is called with the name of each front when it begins.
    """
    found = list[Certificate]()
    for (name, task), front in zip(problem.tasks().items(), problem.fronts(), strict=True):
        report(name)
        found.append(_certified(name, task, front, problem))
    return found


def _certified(name: str, task: PointToPoint, front: Front, problem: NamedProblem) -> Certificate:
    steps = Transcription.of(task, front.profile, LIMITED_STEPS if task.limits else None)
    problems = [
        Problem(
            steps,
            Scalarization(
                (Limit.of_residual(r if r > STILL else 0.0), *task.limits), problem.bound
            ),
        )
        for r in front.residuals.tolist()
    ]
    motions = [np.array(point.coefficients) for point in front.points]
    warm = Sqp().solve(problems, motions, warm=True)
    places = np.unique(np.linspace(0, len(motions) - 1, _TRIED).astype(int)).tolist()
    random, box = np.random.default_rng(_SEED), front.profile.start_box(problem.bound)
    tried = np.repeat(places, _STARTS).tolist()
    cold = Sqp().solve([problems[i] for i in tried], [random.uniform(*box) for _ in tried])
    found = [*enumerate(warm), *zip(tried, cold, strict=True)]
    solved = [(i, one) for i, one in found if one.status.solved]
    judged = [judge(steps, one) for one in motions]
    energies, residuals = (np.array([getattr(one, name) for one in judged])
                           for name in ("energy", "residual"))  # fmt: skip
    by_steps = PopulationObjective(task, front.profile, steps=FIXED_STEPS)(np.array(motions))
    return Certificate(
        front=name,
        points=len(motions),
        energy_difference=float(np.abs(energies / front.energies - 1).max()),
        residual_difference=float(np.abs(residuals - front.residuals).max()),
        energy_by_steps=float(np.abs(by_steps.energy / energies - 1).max()),
        residual_by_steps=float(np.abs(by_steps.residual - residuals).max() / residuals.max()),
        confirmed=sum(one.status.solved for one in warm),
        tried=len(tried),
        gained=_gained(front, [(i, problems[i], one) for i, one in solved]),
    )  # fmt: skip


def _gained(front: Front, found: Sequence[tuple[int, Problem, Solution]]) -> float:
    """The largest share by which a solution is cheaper than its point; 0 where none is.

    By CVODES, with what its prices ask for what it passes its limits by, between the steps. Where
    that is worth a second look, a solution is corrected until it passes none.
    """
    shares = [_priced(problem, one, front.points[i].energy) for i, problem, one in found]
    gained = 0.0
    for k in np.argsort(shares)[::-1].tolist():
        if shares[k] < max(_TELLING, gained):
            return max(gained, min(shares[k], _TELLING))
        i, (steps, asked), one = found[k]
        settings = SolveSettings(
            asked.residual_limit, asked.bound, 1, steps=steps.steps,
            guess=tuple(one.coefficients.tolist()),
        )  # fmt: skip
        with suppress(QuietarmError):
            plan, _ = plan_from_starts(steps.task, steps.profile, settings)
            gained = max(gained, 1 - plan.energy / front.points[i].energy)
    return gained


def _priced(problem: Problem, found: Solution, energy: float) -> float:
    """The share by which a solution is cheaper at the price of what it passes its limits by."""
    checked, limits = judge(problem.transcription, found.coefficients), problem.scalarization.limits
    over = {one.name: max(0.0, one.peak_of(checked) - one.size) for one in limits}
    priced = sum(found.shadow_prices.get(name, 0.0) * most for name, most in over.items())
    return 1 - (checked.energy + priced) / energy


def write_how_tried(front: Front, tried: int, gained: float, path: Path) -> None:
    """Put into a front's file from how many random starts it was tried, and what the best gained.

    As a share of the energy; a point that CVODES confirms and that is better counts.
    """
    settings = {**front.record.settings, "tried_starts": tried, "best_improvement": gained}
    replace(front, record=replace(front.record, settings=settings)).save(path)


def main() -> None:
    """Verify the reference fronts that are named, or all; with --make, find them anew first."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("names", nargs="*", default=list(PROBLEMS))
    parser.add_argument("--make", type=Path, help="folder for fronts that are found anew")
    parser.add_argument("--record", action="store_true", help="write the outcome into the files")
    given = parser.parse_args()
    for name in given.names:
        problem = PROBLEMS[name]
        for (part, task), known in zip(problem.tasks().items(), problem.fronts(), strict=True):
            if given.make:
                found = exact_front(task, problem.profile, problem.bound, known.points)
                given.make.mkdir(parents=True, exist_ok=True)
                found.save(given.make / f"{part}.json")
        for one, front in zip(certified(problem), problem.fronts(), strict=True):
            if given.record:
                (path,) = FRONTS.rglob(f"{one.front}.json")
                write_how_tried(front, one.tried, one.gained, path)
            words = "holds" if one.holds else "does not hold"
            print(f"{one.front}: {words}; gained {one.gained:.1e}, {one.confirmed} confirmed")


if __name__ == "__main__":
    main()
