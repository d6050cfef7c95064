"""Measure how plan time grows with the number of terms and of steps.

    pip install ".[benchmark]"
    python benchmarks/plan_scaling.py [--repetitions 3]

The arm on a flexible link, 0 to pi/2 in 0.8 s, at rest on arrival, from one start, the plain
cycloid. Terms 2 to 28 at 100 steps, with the paper's box on the coefficients and without a box;
then 100 to 1600 steps at six terms. Every repetition begins cold, with nothing built. Columns:

- build: what a first solve takes longer than a second: making the functions of the motion's
  values and derivatives;
- solve: one solve with all built, how many iterations it took, and the time of one of them;
- plan: the whole of `plan_move`, cold: build, solve, verification by CVODES, and where that asks
  for them more steps and another solve. `steps used` is how many it ended with;
- / first: plan time over that of the table's first row, the median of the ratios within a
  repetition;
- energy: the plan's, by CVODES.

Times are medians over repetitions, each of which runs through all rows of a table. They are the
processor's, not the wall clock's: on one thread the two are the same on an idle machine, and other
work on a shared one disturbs the processor's less.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from statistics import median
from time import process_time

import numpy as np
from parts.measuring import console, forget_compiled, load_plugins, machine, timed
from rich.progress import track
from rich.table import Table

from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import CycloidPolynomial, PointToPoint, QuietarmError, plan_move
from quietarm.ocp.solvers.problem import (
    Program,
    Solution,
)
from quietarm.ocp.solvers.sqp import Sqp

TASK = PointToPoint(ArmOnFlexibleLink(), target=pi / 2, duration=0.8)
BOX = 0.5
TERMS = (2, 4, 6, 8, 10, 12, 16, 20, 28)
STEPS = (100, 200, 400, 800, 1600)


@dataclass(frozen=True)
class Case:
    """One row: terms, steps, and the largest absolute coefficient, None without a box."""

    terms: int
    steps: int = 100
    bound: float | None = BOX


@dataclass(frozen=True)
class Timing:
    """Times [s] of one cold run, and what it did."""

    build: float
    solve: float
    iterations: int
    plan: float
    steps_used: str
    energy: float


def measure(case: Case) -> Timing:
    """Build, solve; then, from cold again, plan."""
    profile, guess = CycloidPolynomial(case.terms), np.zeros(case.terms)
    forget_compiled()

    def solved() -> Solution:
        problem = Program(TASK, profile, case.steps).within(0.0, case.bound)
        (solution,) = Sqp().solve([problem], [guess])
        return solution

    first, _ = timed(solved, process_time)
    again, solution = timed(solved, process_time)
    forget_compiled()
    try:
        plan, answer = timed(
            lambda: plan_move(TASK, profile, bound=case.bound, starts=1, steps=case.steps),
            process_time,
        )
    except QuietarmError:
        return Timing(first - again, again, solution.iterations, np.nan, "failed", np.nan)
    used = str(answer.steps)
    return Timing(first - again, again, solution.iterations, plan, used, answer.energy)


def scaling_table(title: str, cases: Sequence[Case], runs: Sequence[Sequence[Timing]]) -> Table:
    """The table of some cases: `runs` has a row a repetition, a column a case."""
    table = Table(title=title)
    for name in ("terms", "steps", "build", "solve", "iterations", "per iteration", "plan",
                 "/ first", "steps used", "energy"):  # fmt: skip
        table.add_column(name, justify="right")
    for column, case in enumerate(cases):
        timings = [run[column] for run in runs]
        solve_time = median(timing.solve for timing in timings)
        last = timings[-1]
        ratio = median(run[column].plan / run[0].plan for run in runs)
        table.add_row(
            str(case.terms),
            str(case.steps),
            f"{median(timing.build for timing in timings):.3f} s",
            f"{solve_time:.3f} s",
            str(last.iterations),
            f"{1e3 * solve_time / max(last.iterations, 1):.1f} ms",
            f"{median(timing.plan for timing in timings):.3f} s",
            f"{ratio:.1f}",
            last.steps_used,
            f"{last.energy:.6f} J",
        )
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="Plan time over terms and steps.")
    parser.add_argument("--repetitions", type=int, default=3, help="3 by default")
    arguments = parser.parse_args()
    load_plugins()
    screen = console()
    screen.print(machine())
    screen.print(f"one start, median of {arguments.repetitions} cold repetitions")
    tables = {
        f"terms, |a_n| <= {BOX:g}": [Case(terms) for terms in TERMS],
        "terms, no box": [Case(terms, bound=None) for terms in TERMS],
        f"steps, |a_n| <= {BOX:g}": [Case(6, steps) for steps in STEPS],
    }
    measure(Case(2))  # imports and first calls
    for title, cases in tables.items():
        runs = [
            [measure(case) for case in cases]
            for _ in track(
                range(arguments.repetitions), title, console=screen, transient=True,
                disable=not screen.is_terminal,
            )
        ]  # fmt: skip
        screen.print(scaling_table(title, cases, runs))


if __name__ == "__main__":
    main()
