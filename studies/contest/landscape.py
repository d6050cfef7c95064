"""What makes a problem hard: its local minima, how they lie, and what the box costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics import NamedProblem, PopulationObjective
from quietarm.ocp import QuietarmError, plan_move
from quietarm.ocp.checks import CountFromOne, Positive, Share
from quietarm.ocp.front.curve import Curve
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.saved import Saved

LEVEL = 1e-3
"""Residual [m] within which the energy is minimised."""
STARTS = 40
"""Random starts in the box; the share of those that end at the best is then known to 8 %."""
CANDIDATES = 1000
"""Random candidates in the box whose energies are held against their distance."""
BOXES = (0.5, 2.0, 4.0)
"""Boxes that are tried, as multiples of the problem's own."""
_SAME = 1e-3
"""Minima whose energies differ by less than this share are one."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Landscape(Saved):
    """Local minima of a problem: least energies within `LEVEL`, from random starts in its box."""

    kind: ClassVar[str] = "landscape"
    version: ClassVar[int] = 1

    problem: str
    starts: CountFromOne
    solved: Share
    best: Share
    minima: int
    correlation: float | None
    candidates: float
    boxes: tuple[tuple[Positive, float | None], ...]

    @property
    def place(self) -> str:
        """Its file in the folder of a contest."""
        return f"landscape/{self.problem}.json"


def landscape_of(problem: NamedProblem, seed: int = 0) -> Landscape:
    """Look for the local minima of a problem."""
    settings = SolveSettings(bound=problem.bound, starts=1)
    curve, random = (
        Curve.begin(problem.task, problem.profile, settings),
        np.random.default_rng(seed),
    )
    box = problem.profile.box(problem.bound)
    starts = random.uniform(*box, (STARTS, problem.profile.size))
    found = curve.solver.solve([curve.problem(LEVEL)] * STARTS, list(starts))
    solved = [one for one in found if one.status.solved]
    if not solved:
        raise QuietarmError(f"none of {STARTS} random starts ended at a minimum")
    energies = np.array([one.energy for one in solved])
    places = np.array([one.coefficients for one in solved])
    lowest, width = energies.min(), box[1] - box[0]
    (cheapest,) = curve.solver.solve([curve.problem()], [places[energies.argmin()]])
    drawn = random.uniform(*box, (CANDIDATES, problem.profile.size))
    costs = PopulationObjective(problem.task, problem.profile)(drawn).energy
    far = np.linalg.norm((drawn - cheapest.coefficients) / width, axis=1)
    return Landscape(
        problem=problem.name,
        starts=STARTS,
        solved=len(energies) / STARTS,
        best=float((energies <= lowest * (1 + _SAME)).sum()) / STARTS,
        minima=_different(energies),
        correlation=_correlation(energies, (places - places[energies.argmin()]) / width),
        candidates=float(np.corrcoef(costs, far)[0, 1]),
        boxes=tuple((share, _in_box(problem, share, float(lowest))) for share in BOXES),
    )


def _different(energies: Array) -> int:
    """How many of the energies are none of the others', to `_SAME`."""
    ordered = np.sort(energies)
    return 1 + int((np.diff(ordered) > _SAME * ordered[:-1]).sum())


def _correlation(energies: Array, steps: Array) -> float | None:
    """Of energies and lengths of the steps to the best; None where all are one minimum."""
    if _different(energies) == 1:
        return None
    return float(np.corrcoef(energies, np.linalg.norm(steps, axis=1))[0, 1])


def _in_box(problem: NamedProblem, share: float, own: float) -> float | None:
    bound = share * problem.bound
    try:
        plan = plan_move(problem.task, problem.profile, residual_limit=LEVEL, bound=bound)
    except QuietarmError:
        return None
    return plan.energy / own
