"""Features of a problem from its values, which may tell which kind of method wins.

`pflacco` has such features, too; its release of this time needs a numpy older than quietarm's, so
that those used here are computed by the lines below, each by its published definition.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import quietarm as qa
from quietarm.metaheuristics import NamedProblem
from quietarm.ocp.front.tradeoff import Tradeoff
from quietarm.ocp.planning.request import Request

from .problems import CENTRE_TERMS, Case
from .tables import write_table

Array = NDArray[np.float64]
STARTS, FEWER = 200, 50
"""Local searches; fewer with more coefficients than at the centre, where each takes longer."""
WITHIN = 1e-3
"""Residual [m] within which local searches minimise the energy."""
SAME = 0.01
"""Local optima whose energies differ by a smaller share are one basin."""
SAMPLES = 10_000
WALKS, STEPS, STEP = 10, 200, 0.02
"""Random walks through the box, their steps, and a step's share of the box."""


def features(case: Case, folder: Path) -> dict[str, float | str | int]:
    """Every feature of a case."""
    problem = case.problem(folder)
    random = np.random.default_rng(52)
    return {
        "problem": case.name,
        "coefficients": case.terms,
        **local_searches(problem, random),
        **ruggedness(problem, random),
        **sampled(problem, random),
    }


def local_searches(problem: NamedProblem, random: np.random.Generator) -> dict[str, float]:
    """Basins of the least energy within 1 mm: SQP from random starts of the box.

    solved : share of starts that reach an optimum
    basins : energies that differ by more than a per cent
    best_basin : share of the solved ones within a per cent of the best
    funnel : correlation of an optimum's energy with its distance from the best one (Jones and
        Forrest 1995), 1 in a funnel; 0 where all optima are one
    condition : largest by least curvature of the energy at the best one, by differences
    """
    tradeoff = Tradeoff.begin(Request(problem.task, problem.profile, bound=problem.bound))
    lower, upper = problem.profile.box(problem.bound)
    starts = STARTS if problem.profile.size <= CENTRE_TERMS else FEWER
    guesses = random.uniform(lower, upper, (starts, problem.profile.size))
    programs = [tradeoff.problem(WITHIN)] * starts
    solutions = [
        solution
        for solution in tradeoff.solver.solve(programs, list(guesses))
        if solution.status.solved
    ]
    if not solutions:
        return {"solved": 0.0}
    energies = np.array([solution.energy for solution in solutions])
    places = np.array([solution.coefficients for solution in solutions])
    best = int(energies.argmin())
    distances = np.linalg.norm(places - places[best], axis=1)
    spread = np.ptp(energies) > SAME * energies.min() and np.ptp(distances) > 0
    ordered = np.sort(energies)
    return {
        "starts": starts,
        "solved": len(solutions) / starts,
        "basins": 1 + int((np.diff(ordered) > SAME * ordered[0]).sum()),
        "best_basin": float((energies <= (1 + SAME) * energies.min()).mean()),
        "funnel": float(np.corrcoef(energies, distances)[0, 1]) if spread else 0.0,
        "condition": condition(problem, places[best]),
    }


def condition(problem: NamedProblem, place: Array) -> float:
    """Return the condition of the energy's curvature at a motion, by central differences.

    Their step is a hundredth of the box.
    """
    function = problem.function()
    step = 0.01 * problem.bound
    size = len(place)
    shifts = step * np.eye(size)
    rows = [
        place + first * shifts[i] + second * shifts[j]
        for i in range(size)
        for j in range(i + 1)
        for first, second in ((1, 1), (1, -1), (-1, 1), (-1, -1))
    ]
    energies = function(np.array(rows))[0][:, 1].reshape(-1, 4)
    mixed = (energies[:, 0] - energies[:, 1] - energies[:, 2] + energies[:, 3]) / (4 * step**2)
    curvature = np.zeros((size, size))
    curvature[np.tril_indices(size)] = mixed
    curvature = curvature + np.tril(curvature, -1).T
    sizes = np.abs(np.linalg.eigvalsh(curvature))
    return float(sizes.max() / sizes.min())


def ruggedness(problem: NamedProblem, random: np.random.Generator) -> dict[str, float]:
    """Autocorrelation length of residual and energy along random walks (Weinberger 1990)."""
    lower, upper = (np.asarray(side) for side in problem.profile.box(problem.bound))
    function = problem.function()
    lengths = {"residual": [], "energy": []}
    for _ in range(WALKS):
        place = random.uniform(lower, upper)
        places = [place]
        for _ in range(STEPS):
            step = random.uniform(-1, 1, len(place)) * STEP * (upper - lower)
            place = np.where(
                (place + step < lower) | (place + step > upper), place - step, place + step
            )
            places.append(place)
        values = function(np.clip(places, lower, upper))[0]
        for column, name in enumerate(lengths):
            series = values[:, column] - values[:, column].mean()
            correlation = (series[1:] @ series[:-1]) / (series @ series)
            lengths[name].append(-1 / np.log(correlation) if 0 < correlation < 1 else np.nan)
    return {f"walk_{name}": float(np.nanmedian(values)) for name, values in lengths.items()}


def sampled(problem: NamedProblem, random: np.random.Generator) -> dict[str, float]:
    """Shares of uniform samples within 1 and 5 mm, and how far the objectives oppose each other."""
    lower, upper = problem.profile.box(problem.bound)
    rows = random.uniform(lower, upper, (SAMPLES, problem.profile.size))
    residuals, energies = problem.function()(rows)[0].T
    ranks = pd.DataFrame({"residual": residuals, "energy": energies}).rank()
    return {
        "within_1mm": float((residuals <= 1e-3).mean()),
        "within_5mm": float((residuals <= 5e-3).mean()),
        "opposed": -float(ranks.corr().iloc[0, 1]),
    }


def add_features(cases: list[Case], folder: Path, path: Path) -> None:
    """The table of features with those that are missing."""
    table = pd.read_csv(path) if path.exists() else pd.DataFrame({"problem": []})
    for case in cases:
        if case.name in set(table["problem"]):
            continue
        try:
            row = features(case, folder)
        except qa.QuietarmError as error:
            print(f"{case.name}: {error}", flush=True)
            continue
        table = pd.concat([table, pd.DataFrame([row])], ignore_index=True)
        write_table(table.sort_values("problem"), path, 5)
        print(f"landscape of {case.name}", flush=True)
