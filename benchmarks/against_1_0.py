"""A checkout against version 1.0, both in one run: how many times as long each takes.

    git worktree add ../one-0 9b4f93f8
    python benchmarks/against_1_0.py ../one-0 [--repetitions 5] [--only "first plans" fronts ...]

Each checkout works in an interpreter of its own, and they take turns, one piece of work at a time,
so that other load on the machine affects both alike. Times are the processor's. Only public
functions are called. Printed are medians over the repetitions, their ratio new / old (below 1 is
faster), and by how much the new energies are higher (+) or lower (-).

- first plans: one start, in a fresh interpreter that has imported quietarm and built nothing;
- second plans: the same again, with all built;
- ipopt plans: the second plan by IPOPT, one start;
- fronts: 50 points by the epsilon constraint, all built;
- robust plans: frequency known within 5 %, with a stated residual limit; second plan;
- moves: 200 moves of the plant at once, all built.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from pathlib import Path
from statistics import median
from typing import Any

HERE = Path(__file__).resolve().parents[1]
FIRST = "first plans"
SIZE_OF_A_LOT, POINTS = 200, 50


@dataclass(frozen=True)
class Move:
    """A plant by its public name, a move [rad, s], the box, and a robust plan's limit [m]."""

    plant: str
    target: float
    duration: float
    bound: float
    worst: float


MOVES = {
    "link": Move("SingleLinkManipulator", pi / 6, 0.8, 0.2, 8e-3),
    "arm": Move("ArmOnFlexibleLink", pi / 2, 1.2, 0.5, 5e-3),
    "dual link": Move("DualLinkManipulator", pi / 2, 0.9, 0.5, 2e-2),
}


def main() -> None:
    """Compare two checkouts, or do the work of one."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("old", nargs="?", type=Path, help="folder of a checkout of 9b4f93f8")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--only", nargs="*", choices=WORK, default=list(WORK))
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.serve:
        serve()
    elif options.old is None:
        parser.error("give the folder of a checkout of 9b4f93f8")
    else:
        compare([options.old.resolve(), HERE], options.only, options.repetitions)


def compare(folders: list[Path], works: list[str], repetitions: int) -> None:
    """Print a row for each kind of work and plant."""
    print("| work | plant | 1.0 [s] | now [s] | now / 1.0 | energy |")
    print("|---|---|---|---|---|---|")
    kept = [Checkout(folder) for folder in folders]
    for work in works:
        ratios: list[float] = []
        for name in MOVES:
            times: list[list[float]] = []
            energies: list[float] = []
            for _ in range(repetitions):
                both = [Checkout(folder) for folder in folders] if work == FIRST else kept
                answers = [checkout(work, name) for checkout in both]
                times.append([answer["seconds"] for answer in answers])
                energies = [answer["energy"] for answer in answers]
            old, new = (median(row[i] for row in times) for i in range(2))
            ratios.append(median(row[1] / row[0] for row in times))
            change = f"{energies[1] / energies[0] - 1:+.1e}"
            print(f"| {work} | {name} | {old:.3f} | {new:.3f} | {ratios[-1]:.2f} | {change} |")
        print(f"| {work} | median | | | {median(ratios):.2f} | |", flush=True)


class Checkout:
    """An interpreter that has imported quietarm from a checkout; it ends with this object."""

    def __init__(self, folder: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-W", "ignore", __file__, "--serve"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=folder,
            env={"PYTHONPATH": str(folder), "PATH": "/usr/bin:/bin", "OPENBLAS_NUM_THREADS": "1"},
        )  # fmt: skip

    def __call__(self, work: str, name: str) -> dict[str, float]:
        """Do one piece of work there: its seconds and its energy [J]."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps([work, name]) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def __del__(self) -> None:
        self._process.communicate()  # it ends at the end of its input


# -- in the interpreter of one checkout --


def serve() -> None:
    """Answer a line with a line, until there are no more."""
    import quietarm as qa

    known = set[tuple[str, str]]()
    for name in dir(qa):  # nothing is imported while the clock runs
        getattr(qa, name)
    for line in sys.stdin:
        work, name = json.loads(line)
        do = WORK[work](qa, MOVES[name])
        if work != FIRST and (work, name) not in known:
            known.add((work, name))
            do()
        began = time.process_time()
        energy = do()
        seconds = time.process_time() - began
        print(json.dumps({"seconds": seconds, "energy": energy}), flush=True)


def plans(qa: Any, move: Move, **solver: Any) -> Callable[[], float]:
    """A plan at rest on arrival."""
    task = qa.PointToPoint(getattr(qa, move.plant)(), move.target, move.duration)
    return lambda: qa.plan_move(task, bound=move.bound, starts=1, **solver).energy


def ipopt_plans(qa: Any, move: Move) -> Callable[[], float]:
    """Return a function that plans the move by IPOPT, and its energy."""
    return plans(qa, move, solver=qa.Ipopt() if hasattr(qa, "Ipopt") else "ipopt")


def fronts(qa: Any, move: Move) -> Callable[[], float]:
    """The mean energy of a front: comparable where its points are spaced alike."""
    task = qa.PointToPoint(getattr(qa, move.plant)(), move.target, move.duration)
    return lambda: qa.epsilon_front(task, bound=move.bound, points=POINTS).energies.mean()


def robust_plans(qa: Any, move: Move) -> Callable[[], float]:
    """A plan whose residual keeps a limit whatever the frequency within 5 %."""
    plant, ranges = getattr(qa, move.plant)(), {"frequency": 0.05}
    if hasattr(qa, "Uncertainty"):
        task = qa.PointToPoint(
            plant, move.target, move.duration, uncertainty=qa.Uncertainty(ranges)
        )
    else:
        task = qa.PointToPoint(qa.UncertainPlant(plant, ranges), move.target, move.duration)
    return lambda: qa.plan_move(task, residual_limit=move.worst, starts=1).energy


def moves(qa: Any, move: Move) -> Callable[[], float]:
    """The mean energy of many moves at rest."""
    import numpy as np

    plant, random = getattr(qa, move.plant)(), np.random.default_rng(1)
    given = random.uniform([0.4, 0.8], [1.5, 1.2], (SIZE_OF_A_LOT, 2)).tolist()
    tasks = [qa.PointToPoint(plant, *one) for one in given]
    return lambda: float(np.mean(qa.plan_moves(tasks).energy))


WORK: dict[str, Callable[[Any, Move], Callable[[], float]]] = {
    FIRST: plans,
    "second plans": plans,
    "ipopt plans": ipopt_plans,
    "fronts": fronts,
    "robust plans": robust_plans,
    "moves": moves,
}


if __name__ == "__main__":
    main()
