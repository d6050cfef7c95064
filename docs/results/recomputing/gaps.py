"""Gaps: how far the front of a run is from the best that is known of its problem."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property

import moocore
import numpy as np

from .areas import area, best_known
from .experiment import CENTRE, CONTROL, GRADIENT_FRONT
from .runs import Array, Problem, Run

MEASURES = ("points", "between")
"""Hypervolume of 50 points; of the 100 best with motions between them."""
INDICATORS = (*MEASURES, "igd+", "epsilon", "energy")
"""IGD+ and additive epsilon of 50 points; energy within 1 mm."""
NO_SUCH_MOTION = 1e3
"""Excess of energy [%] that counts for a front without a motion within 1 mm."""


def median_energy(runs: Iterable[Run]) -> float:
    """Energy within 1 mm, median over seeds; infinite for a run without such a motion."""
    energies = [run.energy if np.isfinite(run.energy) else np.inf for run in runs]
    return float(np.median(energies))


class Results:
    """Runs, and what each lacks of the best that is known of its problem."""

    def __init__(self, runs: Sequence[Run]) -> None:
        self.runs = runs
        points_of = defaultdict[str, list[Array]](list)
        energies = defaultdict[str, list[float]](list)
        for run in self.runs:
            points_of[run.problem].append(run.points)
            if len(run.between):  # of two objectives alone
                points_of[run.problem].append(run.between)
            energies[run.problem].append(run.energy)
        self.points = {name: np.vstack(points) for name, points in points_of.items()}
        self.whole = {name: best_known(points) for name, points in self.points.items()}
        self.least_energy = {
            name: min(filter(np.isfinite, values), default=np.inf)
            for name, values in energies.items()
        }
        self.known_gaps = dict[tuple[int, str], float]()
        self.runs_of = defaultdict[tuple[str, int, str], list[Run]](list)
        for run in self.runs:
            self.runs_of[run.label, run.budget, run.problem].append(run)

    def excess(self, run: Run) -> float:
        """Energy within 1 mm over the least known [%]; infinite where there is no such motion."""
        if not np.isfinite(run.energy):
            return np.inf
        return 100 * (run.energy / self.least_energy[run.problem] - 1)

    @cached_property
    def reference(self) -> dict[str, Array]:
        """The best points of all runs of a problem, without and with motions between."""
        return {name: moocore.filter_dominated(points) for name, points in self.points.items()}

    def gap(self, run: Run, indicator: str) -> float:
        """How far a front is from the best that is known [%], by an indicator.

        Of the best known hypervolume, of the problem's scale (IGD+, epsilon), or of the energy.
        """
        key = id(run), indicator
        if key not in self.known_gaps:
            self.known_gaps[key] = self.gap_anew(run, indicator)
        return self.known_gaps[key]

    def gap_anew(self, run: Run, indicator: str) -> float:
        """A gap as `gap` keeps it."""
        if indicator in MEASURES:
            points = run.points if indicator == "points" else run.between
            return 100 * (1 - area(points) / self.whole[run.problem])
        if indicator == "energy":
            return min(self.excess(run), NO_SUCH_MOTION)
        if not len(run.points):
            return NO_SUCH_MOTION
        distance = moocore.igd_plus if indicator == "igd+" else moocore.epsilon_additive
        return 100 * float(distance(run.points, ref=self.reference[run.problem]))

    def of(self, label: str, budget: int, problem: str) -> list[Run]:
        """The runs of a method with its settings on a problem."""
        return self.runs_of.get((label, budget, problem), [])

    def median_gap(self, runs: Iterable[Run], indicator: str) -> float:
        """The median over seeds; a method that repeats itself counts once as it is."""
        return float(np.median([self.gap(run, indicator) for run in runs]))

    def median_gaps(self, of_problems: Iterable[Sequence[Run]], indicator: str) -> Array:
        """Medians over seeds, of the runs of each problem."""
        return np.array([self.median_gap(runs, indicator) for runs in of_problems])

    def control(self, problem: str) -> list[Run]:
        """The gradient's front of 50 points; of 20 where the energy jumps, of 200 with peaks."""
        several = Problem(problem).kind.endswith("objectives")
        runs = self.of(f"{CONTROL} points=200" if several else GRADIENT_FRONT, 0, problem)
        return runs or self.of(f"{CONTROL} points=20", 0, problem)

    def control_within(self, problem: str, seconds: float) -> list[Run]:
        """The gradient's front that took longest, and no longer; none where all took longer."""
        rungs = [
            run
            for run in self.runs_of_problem[problem]
            if run.method == CONTROL and run.seed == 0 and run.seconds <= seconds
        ]
        return sorted(rungs, key=lambda run: run.seconds)[-1:]

    @cached_property
    def runs_of_problem(self) -> Mapping[str, list[Run]]:
        """All runs by problem."""
        table = defaultdict[str, list[Run]](list)
        for run in self.runs:
            table[run.problem].append(run)
        return table

    def problems(self, terms: int = CENTRE, kind: str = "absolute") -> list[str]:
        """Names of the problems that have runs."""
        return [
            name
            for name in sorted(self.whole)
            if (Problem(name).terms, Problem(name).kind) == (terms, kind)
        ]
