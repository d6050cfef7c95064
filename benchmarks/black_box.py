"""A black box, which the gradient cannot take as it is, and what it still gives a search.

    python benchmarks/black_box.py [--seeds 15]

The electric energy of a motor known from a map: efficiencies of a table's cells, friction with a
sign, braking that is fed back above a speed. A function of arrays without derivatives, and with
jumps. The gradient minimises the mechanical energy, eq (11), and its motions are evaluated on the
black box, as they are and as a search's first population; or SLSQP takes differences of it. An
integer beside the coefficients is an axis of crossover.py.

Each search has 5,000 candidates; what is compiled first is not counted. Missing hypervolume is
against the best of all runs together.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import casadi as ca
import moocore
import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from scipy.stats import mannwhitneyu

import quietarm as qa
from quietarm.metaheuristics import PRESETS, NamedProblem, problem_of
from quietarm.metaheuristics.algorithms.differences import slsqp
from quietarm.metaheuristics.score import CORNER, within
from quietarm.ocp import symbolic_rollout
from quietarm.ocp.front.points import LEVELS

Array = NDArray[np.float64]
MOVES = ("single-link-90deg-1s", "arm-on-flexible-link-90deg-0.8s")
STEPS, POPULATION = 60, 100
SEEDS, BUDGET = 15, 5_000
"""Runs of a search, and candidates of each."""
POINTS = 100
TORQUES, SPEEDS = (0.02, 0.05, 0.1, 0.2), (0.5, 1.0, 2.0, 3.5)
"""Edges of the map's cells [N m, rad/s]."""
EFFICIENCY = np.array([
    (0.20, 0.30, 0.40, 0.45, 0.40), (0.35, 0.50, 0.60, 0.65, 0.60),
    (0.40, 0.60, 0.75, 0.80, 0.75), (0.35, 0.60, 0.80, 0.85, 0.80),
    (0.25, 0.50, 0.70, 0.80, 0.85),
])  # fmt: skip
"""Rows by torque, columns by speed."""
COULOMB, STICTION, STRIBECK, FED_BACK = 0.01, 0.02, 0.3, 1.5
"""Friction [N m] in motion and at its beginning, the speed between [rad/s]; and the speed above
which braking feeds power back."""


def electric_power(torque: Array, speed: Array) -> Array:
    """Return the power that the motor takes [W]."""
    friction = COULOMB + (STICTION - COULOMB) * np.exp(-((speed / STRIBECK) ** 2))
    torque = torque + np.sign(speed) * friction
    cell = np.digitize(np.abs(torque), TORQUES), np.digitize(np.abs(speed), SPEEDS)
    power, efficiency = torque * speed, EFFICIENCY[cell]
    braking = np.where(np.abs(speed) > FED_BACK, power * efficiency, 0.0)
    return np.where(power > 0, power / efficiency, braking)


class SpentError(Exception):
    """Every candidate is spent."""


class Function:
    """Residual [m] and cost [J] of many candidates; keeps what none of them dominates."""

    def __init__(self, problem: NamedProblem) -> None:
        self.move = problem.function()
        self.lower, self.upper = self.move.lower, self.move.upper
        self.points, self.left = np.empty((0, 2)), np.inf

    def __call__(self, candidates: Array) -> tuple[Array, Array]:
        """Objectives and no violations, rows by rows, up to what is left."""
        rows = np.asarray(candidates, dtype=float)
        afforded = rows[: int(min(len(rows), self.left))]
        self.left -= len(afforded)
        found = self.objectives(afforded) if len(afforded) else np.empty((0, 2))
        points = np.vstack([self.points, found])
        self.points = points[moocore.is_nondominated(points)]
        if len(afforded) < len(rows):
            raise SpentError
        return found, np.empty((len(rows), 0))


class BlackBox(Function):
    """The electric energy."""

    def __init__(self, problem: NamedProblem) -> None:
        super().__init__(problem)
        a = ca.SX.sym("a", problem.profile.size)
        motion = symbolic_rollout(problem.task.plant, problem.profile, a, problem.task.move, STEPS)
        speeds = [sample.path.speed for sample in motion.samples]
        nodes = [ca.vertcat(*map(ca.vec, each)) for each in (motion.torque, speeds, motion.weights)]
        self._simulate = ca.Function("simulate", [a], nodes)

    def objectives(self, rows: Array) -> Array:
        """Return residual [m] and cost [J] of rows."""
        torque, speed, weights = (part.full() for part in self._simulate(rows.T))
        energy = (weights * electric_power(torque, speed)).sum(axis=0)
        return np.column_stack([self.move(rows)[0][:, 0], energy])


def searched(name: str, function: Function, seed: int, budget: int, first: Any = None) -> None:
    """Search by a method of pymoo with its preset's settings."""
    problem = Problem(
        n_var=len(function.lower), n_obj=2, xl=function.lower, xu=function.upper,
    )  # fmt: skip
    problem._evaluate = lambda x, out, *_, **__: out.update(F=function(x)[0])
    algorithm = PRESETS[name].build(POPULATION)
    if first is not None:
        algorithm.initialization.sampling = first
    minimize(problem, algorithm, ("n_eval", budget), seed=seed)


def gradient_rows(problem: NamedProblem, points: int, seed: int) -> Array:
    """Coefficients of a front of the mechanical energy."""
    asked: Any = {"bound": problem.bound, "points": points, "at": LEVELS, "seed": seed}
    return qa.epsilon_front(problem.task, problem.profile, **asked).coefficients


def by_gradient(problem: NamedProblem, function: Function, seed: int, budget: int) -> None:
    """The mechanical energy's front, evaluated."""
    function(gradient_rows(problem, POINTS, seed))


def begun_there(problem: NamedProblem, function: Function, seed: int, budget: int) -> None:
    """A search whose first population is that front."""
    rows = gradient_rows(problem, POPULATION - len(LEVELS), seed)
    searched("gde3", function, seed, budget, rows)


Way = Callable[[Function, int, int], None]


def ways_of(problem: NamedProblem) -> dict[str, Way]:
    """Return what is compared, by name."""
    searches: dict[str, Way] = {
        PRESETS[name].label: partial(searched, name) for name in ("nsga2", "gde3", "cmopso")
    }
    return searches | {
        "gradient, mechanical energy": partial(by_gradient, problem),
        "GDE3 from the gradient's front": partial(begun_there, problem),
        "finite-difference SLSQP": partial(slsqp, step=1e-3),
    }


def run(problem: NamedProblem, way: Way, seed: int, budget: int) -> Any:
    """Points that a way finds, and its processor seconds."""
    function = BlackBox(problem)
    began = time.process_time()
    function.left = budget
    with suppress(SpentError):
        way(function, seed, budget)
    return function.points, time.process_time() - began


def runs_of(name: str, seeds: int) -> dict[str, list[Any]]:
    """Points and seconds of every way on one move, by its name and seed."""
    problem = problem_of(name)
    ways = ways_of(problem)
    for way in ways.values():  # what is compiled and loaded first
        run(problem, way, 99, 3 * POPULATION)
    return {
        label: [run(problem, way, seed, BUDGET) for seed in range(seeds)]
        for label, way in ways.items()
    }


def compare(found: dict[str, list[Any]]) -> pd.DataFrame:
    """Medians over seeds; p is against the gradient, by Mann and Whitney."""
    best = np.vstack([points for runs in found.values() for points, _ in runs])
    best = best[moocore.is_nondominated(best)]
    ideal, extent = best.min(axis=0), np.ptp(best, axis=0)
    whole = _hypervolume((best - ideal) / extent)
    missing = {
        label: [100 - 100 * _hypervolume((points - ideal) / extent) / whole for points, _ in runs]
        for label, runs in found.items()
    }
    (base,) = (label for label in found if label.startswith("gradient"))
    rows = [
        {
            "": label,
            "missing [%]": np.median(missing[label]),
            "least to most": f"{min(missing[label]):.2g} to {max(missing[label]):.2g}",
            "cost at 1 mm [J]": np.median([within(points, [1e-3])[0] for points, _ in runs]),
            "seconds": np.median([seconds for _, seconds in runs]),
            "p": np.nan if label == base else mannwhitneyu(missing[label], missing[base]).pvalue,
        }
        for label, runs in found.items()
    ]
    return pd.DataFrame(rows).sort_values("missing [%]")


def _hypervolume(points: Sequence[Any] | Array) -> float:
    return float(moocore.hypervolume(points, ref=[CORNER] * 2))


def main() -> None:
    """Print a table for each move."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=SEEDS)
    given = parser.parse_args()
    for name in MOVES:
        print(f"\nelectric energy, {name}\n", flush=True)
        print(compare(runs_of(name, given.seeds)).to_markdown(index=False, floatfmt=".3g"))
    print(f"\n{time.process_time():.0f} s")


if __name__ == "__main__":
    main()
