"""Time per candidate of the population objective, against what one would write by hand.

    pip install ".[benchmark]"
    python benchmarks/population.py [--rounds 40] [--seed 0]

The arm on a flexible link, 0 to pi/2 in 0.8 s, six terms, 200 candidates with random coefficients
in the paper's box (|a_n| <= 0.5), one core; F1 over 1 s after arrival, F2 = integral |tau theta'|:

- quietarm: `Evaluator` with the residual as searches see it, as it comes;
- numba: a scalar loop over candidates and steps of RK4, compiled, without fastmath;
- NumPy: RK4 with the whole population in every operation, the joint's motion computed time by time,
  or for all times at once before the march;
- solve_ivp: DOP853 with rtol 1e-8 (atol 1e-10), one candidate at a time, with the equations in
  NumPy as one usually writes them, or in the standard library's floats; "F1 too" integrates the
  second after arrival as well, as eq (11) reads, instead of taking its peak in closed form.

All compute the same: eqs (1)-(7), (13), (14). The hand-written marches get the best that is known
of them: the joint's motion once for each distinct time, the plant reduced to W'' = g - K W - D W'
there, the peak after arrival in closed form, quietarm's graded steps beside even ones. Their F2 is
the integral of the absolute value of the quadratic through the power at a step's start, middle and
end, split at its zeros; "trapezoid" is the plain rule over the same three. solve_ivp's F2 is the
trapezoid rule over samples.

Equal error: each takes the fewest steps (solve_ivp: samples) of a list with which nine in ten
candidates are within 1e-4 of F2 (relative) and 1e-6 m of W at arrival; ratios are to quietarm with
these. Its default steps, in a second row, serve all of the paper's conditions. The reference is
quietarm's rollout with 1500 steps; solve_ivp is independent of it.

Methods take turns in every round and are called twice in a row: the first call pays for the caches
that the others left ("cold", its median), the second is what the other columns are of. Printed are
the least and the median CPU time per candidate (CPU time, since the machine may be shared), and the
median of the ratios to quietarm within a round. Then, in wall time: two threads, what a second task
costs, what 10,000 candidates add to the memory.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import pi

import numpy as np
from numpy.typing import NDArray
from parts.measuring import console, forget_compiled, machine, timed
from parts.population.equations import PROFILE, TASK
from parts.population.rows import CANDIDATES, SHARE, Method, methods
from rich.table import Table

from quietarm.metaheuristics.evaluation.population import objectives_of, search_evaluator
from quietarm.ocp import PointToPoint
from quietarm.ocp.cost import COST
from quietarm.ocp.simulation.evaluator import Evaluator

SECOND_TASK = replace(TASK, start=-pi / 2, target=pi / 4, duration=1.0)
BOX, MANY = 0.5, 10_000


def times_of(rows: Sequence[Method], rounds: int) -> NDArray[np.float64]:
    """CPU time per candidate [us]: rounds, methods, first and second call."""
    times = np.empty((rounds, len(rows), 2))
    for turn in range(rounds):
        for column, method in enumerate(rows):
            for call in range(2):
                began = time.process_time()
                method.call()
                seconds = time.process_time() - began
                times[turn, column, call] = 1e6 * seconds / method.candidates
    return times


def time_table(rows: Sequence[Method], times: NDArray[np.float64]) -> Table:
    table = Table(title=f"CPU time per candidate in us, {CANDIDATES} candidates")
    table.add_column("method")
    for name in ("steps", "cold", "least", "median", "/ quietarm", "target"):
        table.add_column(name, justify="right")
    for column, method in enumerate(rows):
        cold, warm = times[:, column].T
        ratio = float(np.median(warm / times[:, 0, 1]))
        verdict = ""
        if method.target is not None:
            verdict = f"{method.target:g} {'met' if ratio >= method.target else 'missed'}"
        table.add_row(
            method.title,
            method.steps,
            *(f"{value:,.2f}" for value in (np.median(cold), warm.min(), np.median(warm))),
            f"{ratio:,.2f}",
            verdict,
        )
    return table


def error_table(rows: Sequence[Method]) -> Table:
    table = Table(title=f"errors: {SHARE:.0%} quantile, root mean square, largest")
    table.add_column("method")
    for quantity in ("F2, relative", "W at arrival, m", "F1, relative"):
        table.add_column(quantity, justify="right")
    for method in rows:
        cells = [
            f"{np.quantile(e, SHARE):.0e} {np.sqrt(np.mean(e**2)):.0e} {e.max():.0e}"
            for e in method.errors
        ]
        table.add_row(method.title, *cells)
    return table


def threads_table(rng: np.random.Generator, rounds: int) -> Table:
    table = Table(title="two threads, wall time, least")
    for name in ("candidates", "one thread", "two threads", "one / two"):
        table.add_column(name, justify="right")
    evaluators = [search_evaluator(TASK, PROFILE, threads=threads) for threads in (1, 2)]
    for count in (CANDIDATES, 10 * CANDIDATES, MANY):
        population = rng.uniform(-BOX, BOX, (count, PROFILE.size))
        times = [
            [timed(partial(_objectives, evaluator, population))[0] for evaluator in evaluators]
            for _ in range(rounds)
        ]
        one, two = (1e6 * min(column) / count for column in zip(*times, strict=True))
        table.add_row(f"{count:,}", f"{one:.2f} us", f"{two:.2f} us", f"{one / two:.2f}")
    return table


def _objectives(evaluator: Evaluator, population: NDArray[np.float64]) -> NDArray[np.float64]:
    return objectives_of(evaluator(population))


def tasks_table(population: NDArray[np.float64]) -> Table:
    """Objective and first population of a task, when nothing is built and when a like one is."""

    def values(task: PointToPoint) -> float:
        return timed(lambda: objectives_of(search_evaluator(task, PROFILE)(population)))[0]

    forget_compiled()
    first = values(TASK)
    before = COST.copy()
    second = values(SECOND_TASK)
    table = Table(title=f"objective and {CANDIDATES} candidates, wall time")
    for name in ("first task", "second task", "first / second", "built for the second"):
        table.add_column(name, justify="right")
    built = f"{1e3 * COST.since(before).builds:.0f} ms"
    table.add_row(f"{1e3 * first:.0f} ms", f"{1e3 * second:.1f} ms", f"{first / second:.0f}", built)
    return table


MEMORY = f"""
import math, numpy as np
from quietarm.metaheuristics.evaluation.population import objectives_of, search_evaluator
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import CycloidPolynomial, PointToPoint

def peak():  # ru_maxrss would start from the parent's peak
    return next(int(line.split()[1]) for line in open("/proc/self/status") if "VmHWM" in line)

population = np.random.default_rng(0).uniform(-{BOX}, {BOX}, ({MANY}, {PROFILE.size}))
before = peak()
task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
objectives_of(search_evaluator(task, CycloidPolynomial({PROFILE.size}))(population))
print((peak() - before) / 1024)
"""


def memory_growth() -> float:
    """Growth of the peak memory by objective and population [MiB], in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", MEMORY], check=True, capture_output=True, text=True
    )
    return float(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description="The population objective against other ways.")
    parser.add_argument("--rounds", type=int, default=40, help="40 by default")
    parser.add_argument("--seed", type=int, default=0, help="of the candidates; 0 by default")
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    population = rng.uniform(-BOX, BOX, (CANDIDATES, PROFILE.size))
    screen = console()
    screen.print(machine("numpy", "numba", "scipy"))
    rows = methods(population)
    screen.print(time_table(rows, times_of(rows, arguments.rounds)))
    screen.print(error_table(rows))
    screen.print(threads_table(rng, arguments.rounds))
    screen.print(tasks_table(population))
    growth = memory_growth()
    screen.print(f"{MANY:,} candidates: peak memory grows by {growth:.0f} MiB, build included")


if __name__ == "__main__":
    main()
