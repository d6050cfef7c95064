"""The fast answer: sequential quadratic programs with derivatives of their own, many at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.solvers.funnel import SHARP, WIDTHS, Course, End, Ended, minimise
from quietarm.ocp.solvers.problem import Program, Solution, evaluate, shadow_prices
from quietarm.ocp.solvers.programs import Programs
from quietarm.ocp.solvers.solver import Solver

Array = NDArray[np.float64]
_STATUS = {
    End.SOLVED: SolveStatus.OPTIMAL,
    End.CREEPING: SolveStatus.ACCEPTABLE,
    End.VANISHED: SolveStatus.ACCEPTABLE,
    End.UNFINISHED: SolveStatus.ITERATION_LIMIT,
    End.INFEASIBLE: SolveStatus.INFEASIBLE,
    End.AGREED: SolveStatus.SUPERSEDED,
}


@dataclass(frozen=True)
class Sqp(Solver):
    """Sequential quadratic programming, as `funnel` has it; all problems of one form at once.

    Its log is about the start with the least objective. Options are those of `Solver`.
    """

    name: ClassVar[str] = "sqp"

    @on_one_thread
    def solve(
        self,
        problems: Sequence[Program],
        starts: Sequence[Array],
        *,
        warm: bool = False,
        groups: Sequence[int] | None = None,
    ) -> list[Solution]:
        """Solve each problem from its start; see `Solver.solve`."""
        solutions: dict[int, Solution] = {}
        course = Course(
            self,
            widths=SHARP if warm else WIDTHS,
            # Minima of the paper's conditions lie within 0.2 of the cycloid.
            reach=0.02 if warm else 0.25,
        )
        for places in _group_by_form(problems):
            alike = [problems[i] for i in places]
            alike[0].batch.prepare(len(alike), len(alike[0].errors))
            programs = Programs(alike)
            x = programs.start(np.array([starts[i] for i in places]))
            ended = minimise(
                programs,
                x,
                course,
                groups=None if groups is None else np.array([groups[i] for i in places]),
            )
            solutions.update(zip(places, _in_units(programs, ended, alike)))
        return [replace(solutions[i], solved_by=self.stated) for i in range(len(problems))]


def _group_by_form(problems: Sequence[Program]) -> Iterable[list[int]]:
    """The places of the problems that are solved together."""
    forms: dict[tuple[object, ...], list[int]] = {}
    for i, problem in enumerate(problems):
        form = (
            problem.batch,
            len(problem.errors),
            problem.peak,
            problem.at_rest,
            problem.bounds_residual,
        )
        forms.setdefault(form, []).append(i)
    return forms.values()


def _in_units(programs: Programs, ended: Ended, problems: Sequence[Program]) -> list[Solution]:
    """The solutions in SI units."""
    coefficients = programs.coefficients(ended.x)
    motions = evaluate(problems, coefficients)
    prices = _shadow_prices(programs, ended, problems)
    solutions = list[Solution]()
    for i, (problem, motion) in enumerate(zip(problems, motions)):
        peaks = problem.measure(motion, problem.offset).peaks_of(0)
        end = ended.ends[i]
        # A scaled state on arrival that is no larger counts as rest.
        if problem.at_rest and ended.violation[i] <= 1e-8:
            peaks[RESIDUAL] = 0.0
        solutions.append(
            Solution(
                coefficients[i],
                float(motion.energy[0]),
                peaks,
                _STATUS[end],
                int(ended.iterations[i]),
                arrival=motion.arrival + problem.offset,
                shadow_prices=prices[i],
                reason=end.value,
            )
        )
    return solutions


def _shadow_prices(
    programs: Programs, ended: Ended, problems: Sequence[Program]
) -> list[dict[str, float]]:
    """Return the decrease of each least energy per unit of each widened limit [J by its unit]."""
    multipliers = programs.split(ended.multipliers.bounded)
    prices = list[dict[str, float]]()
    for i, problem in enumerate(problems):
        bounded = {
            limit.name: multipliers[limit.name][i] / problem.scale_of(limit.name)
            for limit in problem.limits
            if limit.name in multipliers
        }
        of_energy = programs.weights[i, 0] / problem.energy_scale
        of_arrival = np.zeros(0)
        if problem.at_rest:
            of_arrival = ended.multipliers.equality[i] / problem.arrival_scale
        tips = problem.tip_rows[0]
        prices.append(
            shadow_prices(
                problem,
                of_energy,
                bounded,
                of_arrival,
                tips,
            )
        )
    return prices
