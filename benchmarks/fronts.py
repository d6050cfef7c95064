"""Fronts by the gradient: against as many cold solves, and against the metaheuristics in wall time.

    pip install ".[benchmark]"
    python benchmarks/fronts.py [--points 50] [--repetitions 3] [--figure hypervolume.png]

The paper's first conditions, six terms, its boxes, one process.

- A front of 50 points by epsilon-constraint (both ends, sweeps both ways, verification by CVODES)
  against 50 solves of `plan_move` at the same residual limits: each from one start with everything
  built already, as a loop over limits would run; from the four starts that `plan_move` takes by
  itself; and, for one limit in ten, with everything built anew, as 50 separate commands would.
- Hypervolume by time spent: the gradient's fronts of 3, 5, 9, 17, 33 and 65 points, and NSGA-II and
  VEPSO with the paper's settings generation by generation, seeds 0 to 4. One corner for all: the
  plain cycloid's residual and twice its energy. Printed is the share that is missing from the
  hypervolume of all points together. A front counts as the staircase of its points, by which a
  front of few points loses; so the gradient's count a second time with motions between their points
  (coefficients interpolated, evaluated, and no less drivable), as `quietarm compare` fills them.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from time import process_time

import moocore
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from parts.measuring import console, forget_compiled, load_plugins, machine, timed
from rich.table import Table

from quietarm.metaheuristics import SearchProgress, search
from quietarm.metaheuristics.score import filled, objectives
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint, epsilon_front, plan_move

PROFILE = CycloidPolynomial(6)
CASES = {
    "arm on flexible link, 0 to pi/2 in 0.8 s": (
        PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), 0.5),
    "single link, 0 to pi/6 in 0.8 s": (
        PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), 0.2),
}  # fmt: skip
SIZES, SEEDS = (3, 5, 9, 17, 33, 65), range(5)
METHODS = {"NSGA-II": "nsga2", "VEPSO": "vepso"}
COLOURS = {
    "gradient": "tab:blue",
    "gradient, filled": "tab:purple",
    "NSGA-II": "tab:orange",
    "VEPSO": "tab:green",
}


def against_cold_solves(task: PointToPoint, bound: float, points: int, repetitions: int) -> Table:
    """Time of a front and of as many solves on their own: medians, and ratios in a repetition."""

    def solves(
        limits: Sequence[float], starts: int, anew: bool = False
    ) -> Callable[[], list[float]]:
        def run() -> list[float]:
            energies: list[float] = []
            for limit in limits:
                if anew:
                    forget_compiled()
                plan = plan_move(task, PROFILE, bound=bound, residual_limit=limit, starts=starts)
                energies.append(plan.energy)
            return energies

        return run

    rows: dict[str, list[float]] = {}
    for _ in range(repetitions):
        forget_compiled()
        seconds, front = timed(
            lambda: epsilon_front(task, PROFILE, bound=bound, points=points), process_time
        )
        limits = [point.residual if point.residual > 1e-8 else 0.0 for point in front.points]
        tenth = limits[::10]
        measured = {
            "the front": (seconds, front.energies),
            "one start each, all built": timed(solves(limits, 1), process_time),
            "four starts each, all built": timed(solves(limits, 4), process_time),
        }
        fraction, _ = timed(solves(tenth, 1, anew=True), process_time)
        measured["one start each, built anew"] = (fraction * len(limits) / len(tenth), np.empty(0))
        for name, (value, _) in measured.items():
            rows.setdefault(name, []).append(value)
    table = Table(title=f"{points} points")
    for heading in ("", "[s]", "/ the front", "dearest against the front"):
        table.add_column(heading, justify="left" if not heading else "right")
    for name, values in rows.items():
        ratio = np.median(np.array(values) / rows["the front"])
        energies = np.array(measured[name][1])
        excess = f"{(energies / front.energies - 1).max():+.1e}" if len(energies) else ""
        table.add_row(name, f"{np.median(values):.2f}", f"{ratio:.1f}", excess)
    return table


def hypervolume_by_time(
    task: PointToPoint, bound: float
) -> tuple[Table, dict[str, list[NDArray[np.float64]]]]:
    """Seconds and missing hypervolume: a curve for the gradient, one a seed for the others."""
    curves: dict[str, list[NDArray[np.float64]]] = {name: [] for name in COLOURS}
    fronts: list[Front] = []
    gradient: list[tuple[float, float]] = []
    dense: list[tuple[float, float]] = []
    clouds: list[NDArray[np.float64]] = []
    for size in SIZES:
        forget_compiled()
        seconds, front = timed(lambda: epsilon_front(task, PROFILE, bound=bound, points=size))  # noqa: B023
        fronts.append(front)
        filling, cloud = timed(lambda: filled(front))  # noqa: B023
        clouds.append(cloud)
        gradient.append((seconds, share(objectives(front), front)))
        dense.append((seconds + filling, share(cloud, front)))
    curves["gradient"], curves["gradient, filled"] = [np.array(gradient)], [np.array(dense)]
    for name, method in METHODS.items():
        for seed in SEEDS:
            records: list[SearchProgress] = []
            front = search(task, PROFILE, algorithm=method, bound=bound, seed=seed,
                           report=records.append)  # fmt: skip
            fronts.append(front)
            curves[name].append(np.array([(r.seconds, r.hypervolume) for r in records]))
    together = np.vstack([*(objectives(front) for front in fronts), *clouds])
    whole = float(moocore.hypervolume(together / fronts[0].reference, ref=[1.0, 1.0]))
    for name, found in curves.items():
        curves[name] = [np.column_stack([c[:, 0], 1 - c[:, 1] / whole]) for c in found]
    table = Table(title="hypervolume still missing, by time spent")
    table.add_column("")
    times = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
    for seconds in times:
        table.add_column(f"{seconds:g} s", justify="right")
    for name, found in curves.items():
        table.add_row(name, *(reached(found, seconds) for seconds in times))
    return table, curves


def share(figures: NDArray[np.float64], front: Front) -> float:
    """Share of a front's reference box that residuals and energies dominate."""
    return float(moocore.hypervolume(figures / front.reference, ref=[1.0, 1.0]))


def reached(curves: Sequence[NDArray[np.float64]], seconds: float) -> str:
    """Median over the seeds of what is missing after a time."""
    values = [curve[curve[:, 0] <= seconds, 1].min(initial=np.inf) for curve in curves]
    middle = float(np.median(values))
    return f"{middle:.1e}" if np.isfinite(middle) else "-"


def draw(results: dict[str, dict[str, list[NDArray[np.float64]]]], path: Path) -> None:
    """The curves, a panel a task."""
    figure = Figure(figsize=(10, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (title, curves) in zip(figure.subplots(1, 2), results.items(), strict=True):
        for name, found in curves.items():
            style = (
                {"marker": "o", "markersize": 4}
                if name.startswith("gradient")
                else {"linewidth": 0.9}
            )
            for i, curve in enumerate(found):
                axes.loglog(*curve.T, color=COLOURS[name], label=name if i == 0 else None, **style)
        axes.set(title=title, xlabel="time spent [s]", ylabel="hypervolume missing, as a share")
        axes.grid(alpha=0.25)
        axes.legend()
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description="Fronts: against cold solves, and in wall time.")
    parser.add_argument("--points", type=int, default=50)
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--figure", type=Path)
    options = parser.parse_args()
    load_plugins()
    screen = console()
    screen.print(machine("pymoo", "moocore"))
    results: dict[str, dict[str, list[NDArray[np.float64]]]] = {}
    for title, (task, bound) in CASES.items():
        screen.rule(title)
        screen.print(against_cold_solves(task, bound, options.points, options.repetitions))
        table, results[title] = hypervolume_by_time(task, bound)
        screen.print(table)
    if options.figure:
        draw(results, options.figure)


if __name__ == "__main__":
    main()
