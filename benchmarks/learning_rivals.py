"""Measure what a rival of `learn` leaves, move by move: iterative learning of the set point.

    python benchmarks/learning_rivals.py [--machine gantry picker] [--moves 4] [--seeds 1]

The machines, the first plans and the noise are those of `learning.py`; what changes the set point
is `parts/iterative_learning.py`, with the same model as the plan.
"""

from __future__ import annotations

import argparse

import numpy as np
from learning import EVERY, REST, first_plan, set_points
from parts.drive.measures import outcomes
from parts.drive.moves import MOVES, Move
from parts.drive.simulate import simulate
from parts.iterative_learning import SetPointLearning
from parts.measuring import console, machine

from quietarm import Plan


def residuals(move: Move, plan: Plan, moves: int, seed: int) -> tuple[list[float], float]:
    """Return what each move leaves [m], and the energy of the last [J]."""
    random = np.random.default_rng(seed)
    plant = plan.task.plant
    rival = SetPointLearning(plant.omega1 / (2 * np.pi), plant.zeta1)
    asked = set_points(plan)
    left = list[float]()
    energy = 0.0
    for _ in range(1 + moves):
        runs = simulate([move.machine], [asked], rest=REST)
        (found,) = outcomes(runs, [move.machine], [asked], [1e-4])
        left.append(found.residual)
        energy = found.energy
        tool = runs.tool[runs.time >= asked.duration, 0][::EVERY]
        seen = tool + random.normal(0, move.noise, len(tool)) - move.target
        asked = rival.next(asked, seen)
    return left, energy


def main() -> None:
    """Print what every move leaves, by machine and by the error of the model."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machine", nargs="+", choices=MOVES, default=list(MOVES))
    parser.add_argument("--moves", type=int, default=4)
    parser.add_argument("--seeds", type=int, default=1)
    options = parser.parse_args()
    out = console()
    out.print(machine())
    for name in options.machine:
        for error in (0.0, -0.08, 0.08):
            plan = first_plan(MOVES[name], error)
            for seed in range(options.seeds):
                left, energy = residuals(MOVES[name], plan, options.moves, seed)
                moves = ", ".join(f"{1e3 * each:.3g}" for each in left)
                out.print(f"{name}, model {error:+.0%}, seed {seed}: {moves} mm; {energy:.4g} J")


if __name__ == "__main__":
    main()
