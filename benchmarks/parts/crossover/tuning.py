"""Settings tuned on the twelve moves of tuning, by Optuna and cell; each trial is a table's row.

A trial runs a search once on every move, each with another seed, and its score is the mean over
moves of the decimal logarithm of the missing hypervolume [%], against the quick front that fixes a
problem's scale. The first trial has the library's settings; a factor that it draws at random is 0.5
there. The sampler (a tree of Parzen estimators, of one seed) is told the trials that the table has,
and goes on.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import optuna
import pandas as pd

from quietarm.metaheuristics import PRESETS, search
from quietarm.metaheuristics.score import objectives

from .moves import Move
from .packed import area
from .plan import BUDGETS, SMALL_POPULATION
from .problems import Case
from .tables import read_trials, write_table
from .tuned_cells import TUNED_CELLS, TunedCell

FLOOR = 1e-2
"""A missing hypervolume [%] that counts as least: a trial may come nearer than the quick front."""
AGAIN = "reevaluate"
"""Evaluations of a candidate among the settings: an argument of a search, for any method."""
Space = dict[str, optuna.distributions.BaseDistribution]


def space_of(method: str, cell: TunedCell) -> Space:
    """Return what is tuned, and its ranges: settings of `quietarm list METHOD`.

    And the evaluations of a candidate, where a cell has noise.
    """
    share = optuna.distributions.FloatDistribution(0.0, 1.0)
    eta = optuna.distributions.FloatDistribution(1.0, 60.0, log=True)
    population = optuna.distributions.IntDistribution(12, 200, log=True)
    names = {setting.name for setting in PRESETS[method].settings}
    known: Space = {
        "crossover": share,
        "crossover_gene": share,
        "crossover_eta": eta,
        "mutation": share,
        "mutation_gene": share,
        "mutation_eta": eta,
        "scale": optuna.distributions.FloatDistribution(0.1, 1.0),
        "variant": optuna.distributions.CategoricalDistribution(
            ("DE/rand/1/bin", "DE/best/1/bin", "DE/rand/2/bin")
        ),
        "velocity_limit": optuna.distributions.FloatDistribution(0.02, 1.0, log=True),
        "elites": optuna.distributions.IntDistribution(2, 12),
        "neighbour_mating": share,
        "step": optuna.distributions.FloatDistribution(1e-7, 0.3, log=True),
        "first": optuna.distributions.IntDistribution(2, 60, log=True),
        "differences": share,
        "training": optuna.distributions.IntDistribution(40, 150, log=True),
        "pool": optuna.distributions.IntDistribution(100, 1_000, log=True),
    }
    tuned = {name: known[name] for name in known if name in names}
    if PRESETS[method].population > 1:
        tuned = {"population": population, **tuned}
    if cell.noise:
        tuned[AGAIN] = optuna.distributions.IntDistribution(1, 10, log=True)
    return tuned


def defaults_of(method: str, cell: TunedCell) -> dict[str, Any]:
    """The library's settings of what is tuned; what has no value is in the middle of its range.

    Of few candidates the population is the small one of the map.
    """
    preset = PRESETS[method]
    values = {setting.name: setting.default for setting in preset.settings}
    small = dict(SMALL_POPULATION) if cell.budget <= BUDGETS[0] else {}
    stated = {"population": preset.population, **small} if preset.population > 1 else {}
    for name in space_of(method, cell):
        value = values.get(name)
        if name == AGAIN:
            stated[name] = 1
        elif value is not None:
            stated[name] = value
        elif name != "population":
            stated[name] = 1 / 6 if name == "mutation_gene" else 0.5
    return stated


def score(
    method: str, settings: dict[str, Any], cases: Sequence[Case], cell: TunedCell, folder: Path
) -> float:
    """Mean over moves of the logarithm of the missing hypervolume [%]."""
    lacks = list[float]()
    for seed, case in enumerate(cases):
        problem = case.problem(folder)
        scale = problem.reference()
        front = search(
            problem.task,
            problem.profile,
            algorithm=method,
            bound=problem.bound,
            population=settings.get("population"),
            settings={
                name: settings[name] for name in settings if name not in ("population", AGAIN)
            },
            evaluations=cell.trials,
            seed=1000 + seed,
            noise=cell.noise,
            reevaluate=settings.get(AGAIN, 1),
        )
        whole = area(scale.stations)
        lacks.append(100 * (1 - area(scale.scaled(objectives(front))) / whole))
    return float(np.mean(np.log10(np.maximum(lacks, FLOOR))))


def tune(
    method: str, name: str, moves: Sequence[Move], trials: int, folder: Path, path: Path
) -> None:
    """Go on until so many trials of a method in a cell are in the table."""
    cell = TUNED_CELLS[name]
    cases = cell.to_tune(moves)
    table = read_trials(path)
    rows = table[(table["method"] == method) & (table["cell"] == name)]
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    # of few trials only a third is drawn at random before the sampler learns
    sampler = optuna.samplers.TPESampler(seed=52 + len(rows), n_startup_trials=min(10, trials // 3))
    study = optuna.create_study(sampler=sampler)
    space = space_of(method, cell)
    for row in rows.itertuples():
        # a table of before has no evaluations of a candidate: they were 1
        known = {AGAIN: 1} if AGAIN in space else {}
        study.add_trial(
            optuna.trial.create_trial(
                params=known | json.loads(row.settings), distributions=space, value=row.score
            )
        )
    if not len(rows):
        study.enqueue_trial(defaults_of(method, cell))
    for number in range(len(rows), trials):
        trial = study.ask(space)
        settings = dict(trial.params)
        value = score(method, settings, cases, cell, folder)
        study.tell(trial, value)
        row = {
            "cell": name,
            "method": method,
            "budget": cell.trials,
            "trial": number,
            "score": value,
            "settings": json.dumps({name: _short(value) for name, value in settings.items()}),
        }
        table = pd.concat([table, pd.DataFrame([row])], ignore_index=True)
        write_table(table, path, 6)
        print(f"{method} {name} trial {number}: {value:.4f}", flush=True)


def _short(value: Any) -> Any:
    return float(f"{value:.4g}") if isinstance(value, float) else value
