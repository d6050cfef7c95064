"""Measure by how much a learned plan acts earlier than ZVD over ruckig, and for what energy.

    python benchmarks/learning_fastest.py [--machine gantry picker] [--seeds 10] [--shares 0.9 ...]

The machines, the noise and the first model (8 % too slow) are those of `learning.py`. A plan lasts
a share of the time that ZVD over ruckig takes within the same limits, which has the right frequency
and does not learn. The csv has when the tool may act, from then on within 0.1 mm, and the energy.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from learning import REST, Case, Course, march
from parts.drive.measures import outcomes
from parts.drive.moves import MOVES, Move, shaper_over_ruckig
from parts.drive.recordings import identified
from parts.drive.simulate import simulate
from parts.measuring import console, machine

from quietarm import QuietarmError, plan_move

RESULTS = Path(__file__).parent / "results" / "learning_fastest.csv"
ERROR = -0.08
MOVES_LEARNED = 3
COLUMNS = ("machine", "motion", "share", "seed", "duration_s", "acts_s", "left_mm", "energy_j")
"""The share is that of ZVD's duration."""


def rows(name: str, shares: list[float], seeds: int) -> Iterator[list[str]]:
    """ZVD over ruckig, and plans of shorter durations after so many moves that were learned."""
    move = MOVES[name]
    frequency, damping, _ = identified("on the way", move, move.machine)
    duration = move.shortest("zvd", frequency, damping)
    asked = shaper_over_ruckig(move.task(frequency, damping, duration), "zvd")
    runs = simulate([move.machine], [asked], rest=REST)
    (zvd,) = outcomes(runs, [move.machine], [asked], [1e-4])
    yield _row(name, "ZVD over ruckig", 1.0, 0, duration, zvd.acts_after, zvd.residual, zvd.energy)
    for share in shares:
        yield from _learned(move, share, share * duration, (frequency, damping), seeds)


def _learned(
    move: Move, share: float, duration: float, model: tuple[float, float], seeds: int
) -> Iterator[list[str]]:
    """A plan of one duration, after its moves, from every seed."""
    frequency, damping = model
    name = move.machine.name
    try:
        plan = plan_move(move.task((1 + ERROR) * frequency, damping, duration))
    except QuietarmError:
        yield _row(name, "within no limits", share, 0, duration, np.inf, np.inf, np.inf)
        return
    case = Case("model 8 % too slow", error=ERROR)
    courses = [Course(case, plan, np.random.default_rng(seed)) for seed in range(seeds)]
    for number in range(1 + MOVES_LEARNED):
        march(move, courses, last=number == MOVES_LEARNED)
    for seed, course in enumerate(courses):
        figures = course.acts[-1], course.residuals[-1], course.energies[-1]
        yield _row(name, "learned", share, seed, duration, *figures)


def _row(
    name: str,
    motion: str,
    share: float,
    seed: int,
    duration: float,
    acts: float,
    left: float,
    energy: float,
) -> list[str]:
    return [
        name, motion, f"{share:g}", str(seed), f"{duration:.4g}", f"{acts:.4g}",
        f"{1e3 * left:.3g}", f"{energy:.4g}",
    ]  # fmt: skip


def main() -> None:
    """Write the csv of all machines."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machine", nargs="+", choices=MOVES, default=list(MOVES))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--shares", nargs="+", type=float, default=[0.86, 0.88, 0.9, 0.92, 0.95])
    parser.add_argument("--output", type=Path, default=RESULTS)
    options = parser.parse_args()
    out = console()
    out.print(machine())
    with options.output.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for name in options.machine:
            for row in rows(name, options.shares, options.seeds):
                writer.writerow(row)
                file.flush()
                out.print(*row)


if __name__ == "__main__":
    main()
