"""Measure what rivals of `learn` leave, move by move.

    python benchmarks/learning_rivals.py [--machine gantry picker] [--moves 3] [--seeds 3]

The machines, the first plans and the noise are those of `learning.py`. One rival is iterative
learning of the set point (`parts/iterative_learning.py`), with the same model as the plan. The
other identifies anew: `quietarm.identify` on the ring-downs of all moves, and a plan of that model,
at rest at arrival.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol

import numpy as np
from learning import EVERY, REST, first_plan, set_points
from parts.drive.measures import outcomes
from parts.drive.moves import MOVES, Move
from parts.drive.simulate import TICKS, SetPoints, simulate
from parts.iterative_learning import SetPointLearning
from parts.measuring import console, machine

from quietarm import Plan, QuietarmError, Recording, identify, plan_move

RESULTS = Path(__file__).parent / "results" / "learning_rivals.csv"
ERRORS = (0.0, -0.08)
SETTLES = 0.25
"""Periods after arrival that are not identified from."""


class Rival(Protocol):
    """A way to make the next set points from what swung after a move [m], a row each."""

    def next(self, asked: SetPoints, swing: np.ndarray) -> SetPoints:
        """The set points of the next move."""
        ...


class Identification:
    """Identify the plant anew from the ring-downs of all moves, and plan with it.

    Parameters
    ----------
    plan
        The first one.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._recordings = list[Recording]()

    def next(self, asked: SetPoints, swing: np.ndarray) -> SetPoints:
        """The set points of a plan with what is identified; the same where nothing is."""
        task = self._plan.task
        begin = round(SETTLES * 2 * np.pi / task.plant.omega1 * TICKS / EVERY)
        time = np.arange(len(swing)) * EVERY / TICKS
        name = f"move {len(self._recordings) + 1}"
        self._recordings.append(Recording(time[begin:], tip=swing[begin:], name=name))
        try:
            plant = identify(self._recordings, task.plant).plant
            plan = plan_move(replace(task, plant=plant), self._plan.profile, starts=1)
        except (ValueError, QuietarmError):
            return asked
        return set_points(plan)


def rivals_of(plan: Plan) -> dict[str, Rival]:
    """Each rival by its name, with the model of a plan."""
    plant = plan.task.plant
    return {
        "iterative learning": SetPointLearning(plant.omega1 / (2 * np.pi), plant.zeta1),
        "identify anew": Identification(plan),
    }


def rows(move: Move, plans: dict[float, Plan], moves: int, seeds: int) -> Iterator[list[str]]:
    """Every rival with every model from every seed, side by side: what each move left [mm]."""
    courses = [
        (label, error, seed, rival)
        for error, plan in plans.items()
        for seed in range(seeds)
        for label, rival in rivals_of(plan).items()
    ]
    randoms = [np.random.default_rng(seed) for _, _, seed, _ in courses]
    asked = [set_points(plans[error]) for _, error, _, _ in courses]
    left: list[list[float]] = [[] for _ in courses]
    energies = np.zeros(len(courses))
    for number in range(1 + moves):
        machines = [move.machine] * len(courses)
        runs = simulate(machines, asked, rest=REST)
        for k, found in enumerate(outcomes(runs, machines, asked, [1e-4] * len(courses))):
            left[k].append(found.residual)
            energies[k] = found.energy
        if number == moves:
            break
        for k, (*_, rival) in enumerate(courses):
            tool = runs.tool[runs.time >= asked[k].duration, k][::EVERY]
            seen = tool + randoms[k].normal(0, move.noise, len(tool)) - move.target
            asked[k] = rival.next(asked[k], seen)
    for (label, error, seed, _), sizes, energy in zip(courses, left, energies):
        yield _row(move.machine.name, label, error, seed, sizes, energy)


def _row(
    name: str, label: str, error: float, seed: int, sizes: Sequence[float], energy: float
) -> list[str]:
    moves = (f"{1e3 * size:.3g}" for size in sizes)
    return [name, label, f"{error:+.0%}", str(seed), *moves, f"{energy:.4g}"]


def main() -> None:
    """Write what every move leaves, by machine, rival, error of the model and seed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machine", nargs="+", choices=MOVES, default=list(MOVES))
    parser.add_argument("--moves", type=int, default=3)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--output", type=Path, default=RESULTS)
    options = parser.parse_args()
    out = console()
    out.print(machine())
    moves = [f"mm_{number}" for number in range(1 + options.moves)]
    with options.output.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["machine", "rival", "model", "seed", *moves, "energy_j"])
        for name in options.machine:
            plans = {error: first_plan(MOVES[name], error) for error in ERRORS}
            for row in rows(MOVES[name], plans, options.moves, options.seeds):
                writer.writerow(row)
                out.print(*row)
            file.flush()


if __name__ == "__main__":
    main()
