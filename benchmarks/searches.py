"""Searches with the paper's settings: how long a run takes, and how many seeds reach its energies.

    pip install ".[benchmark]"
    python benchmarks/searches.py [--repetitions 5] [--seeds 12] [--workers 2]

- Time: NSGA-II 200 x 500 on the arm on a flexible link and VEPSO 2 x 100 x 200 on the single link,
  each plant's first condition, the building of functions included; and how much of it is spent in
  evaluating the objective. A seed a repetition.
- Energies: the cheapest point of every seed's front whose residual is no larger than that of the
  paper's own coefficients (N = 6 of the plant's first condition, a_5 mended), against the energy
  that Tables 3 and 6 print.
"""

from __future__ import annotations

import argparse
from functools import partial
from time import perf_counter, process_time

import numpy as np
from parts.measuring import console, forget_compiled, load_plugins, machine, timed
from rich.table import Table

from quietarm.metaheuristics import PRESETS, MoveFunction, search
from quietarm.metaheuristics.parallel import side_by_side
from quietarm.metaheuristics.spread import energies_at
from quietarm.ocp import Front, evaluate_coefficients
from quietarm.studies.reproduce.paper import (
    ARM_HALF,
    COEFFICIENTS,
    MENDED,
    ROWS,
    SINGLE_LINK_SIXTH,
    Case,
)

METHODS = {"vepso": SINGLE_LINK_SIXTH, "nsga2": ARM_HALF}
TARGETS = {"vepso": 2.0, "nsga2": 10.0}
"""Seconds that a whole run may take."""
SHARE = 0.25
"""Largest share of the evaluation in a run of NSGA-II."""


def evaluation_clock() -> list[float]:
    """Processor time [s] of every call of the objective from now on, in a list that grows."""
    spent: list[float] = []
    evaluate = MoveFunction.__call__

    def clocked(self: MoveFunction, *arguments: object) -> object:
        began = process_time()
        values = evaluate(self, *arguments)
        spent.append(process_time() - began)
        return values

    MoveFunction.__call__ = clocked
    return spent


def times(repetitions: int) -> Table:
    spent = evaluation_clock()
    table = Table(title=f"a whole run: medians (least to most) of {repetitions} seeds")
    for heading in ("", "processor [s]", "wall [s]", "evaluation", "target", ""):
        table.add_column(heading, justify="left" if not heading else "right")
    for method, condition in METHODS.items():
        figures: list[tuple[float, float, float]] = []
        for seed in range(repetitions):
            forget_compiled()
            spent.clear()
            began = perf_counter()
            processor, _ = timed(
                lambda method=method, condition=condition, seed=seed: search(
                    condition.task, algorithm=method, bound=condition.bound, seed=seed
                ),
                process_time,
            )
            figures.append((processor, perf_counter() - began, sum(spent) / processor))
        processor, wall, share = np.array(figures).T
        met = np.median(processor) <= TARGETS[method]
        met &= method != "nsga2" or np.median(share) <= SHARE
        target = f"{TARGETS[method]:g} s" + f", {SHARE:.0%}" * (method == "nsga2")
        preset = PRESETS[method]
        table.add_row(
            f"{method}, {'2 x ' * (method == 'vepso')}{preset.population} x {preset.generations}",
            *(f"{np.median(c):.2f} ({c.min():.2f} to {c.max():.2f})" for c in (processor, wall)),
            f"{np.median(share):.0%}",
            target,
            "met" if met else "missed",
        )
    return table


def searched(condition: Case, method: str, seed: int) -> Front:
    return search(condition.task, algorithm=method, bound=condition.bound, seed=seed)


def energies(seeds: int, workers: int) -> Table:
    levels = {method: residual_level(first) for method, first in METHODS.items()}
    shown = ", ".join(f"{level * 1e3:.3g} mm for {method}" for method, level in levels.items())
    table = Table(title=f"energy at the paper's own residual ({shown}), {seeds} seeds")
    for heading in ("", "paper [J]", "median [J]", "quartiles [J]", "best [J]", "at or below"):
        table.add_column(heading, justify="left" if not heading else "right")
    for method, first in METHODS.items():
        level = levels[method]
        for row in ROWS:
            if row.earlier_energy is None or row.condition.task.plant != first.task.plant:
                continue
            condition = row.condition
            one = partial(searched, condition, method)
            fronts = list(side_by_side(one, range(seeds), workers))
            found = np.array([front.least_energy(level) for front in fronts])
            spread = energies_at(fronts, level)
            table.add_row(
                f"{method}, {condition.label}",
                f"{row.energy:.3g}",
                f"{spread.median:.4f}",
                f"{spread.lower:.4f} to {spread.upper:.4f}",
                f"{np.nanmin(found):.4f}",
                f"{int((found <= row.energy).sum())} of {seeds}",
            )
    return table


def residual_level(first: Case) -> float:
    """Residual [m] of the paper's own coefficients for a plant's first condition."""
    coefficients = {**COEFFICIENTS, **MENDED}[first, 6]
    return evaluate_coefficients(first.task, coefficients).residual


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    load_plugins()
    search(SINGLE_LINK_SIXTH.task, bound=0.2, population=4, generations=2)  # pymoo's first imports
    output = console()
    output.print(machine("numpy", "pymoo"))
    output.print(times(arguments.repetitions))
    if arguments.seeds:
        output.print(energies(arguments.seeds, arguments.workers))


if __name__ == "__main__":
    main()
