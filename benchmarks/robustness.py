"""What robustness costs: insensitivity to the frequency over energy, against input shapers.

    pip install ".[benchmark]"
    python benchmarks/robustness.py [--starts 2] [--figure robustness.png]

One move of each plant, six terms. A robust plan leaves within 5 % of what the plain cycloid leaves
for every frequency wrong by up to a range; the insensitivity is how far the range of errors reaches
within which it leaves no more, by `evaluate_robustness`. The shapers' motions take as long as the
plans; where ZVD or EI are longer than the move they are left out.
"""

from __future__ import annotations

import argparse
from math import pi
from pathlib import Path
from typing import NamedTuple

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from parts.measuring import console, machine
from rich.table import Table

from models import ArmOnFlexibleLink, DualLinkManipulator, SingleLinkManipulator
from ocp import (
    InfeasibleTaskError,
    Plan,
    PointToPoint,
    UncertainPlant,
    evaluate_robustness,
    plan_move,
    shaped_cycloid,
)

MOVES = {
    "single link, 0 to pi/6, 0.8 s": (SingleLinkManipulator(), pi / 6, 0.8),
    "arm, 0 to pi/2, 0.8 s": (ArmOnFlexibleLink(), pi / 2, 0.8),
    "two links, 0 to pi/2, 0.9 s": (DualLinkManipulator(), pi / 2, 0.9),
}
RANGES = (0.05, 0.1, 0.15)
SHAPERS = ("zv", "zvd", "ei")
WIDEST = 0.3
"""Errors of the frequency up to which a motion is looked at."""


class Row(NamedTuple):
    """A motion: what it is called, its energy [J], its insensitivity [%]."""

    name: str
    energy: float
    acceleration: float
    low: float
    high: float

    @property
    def width(self) -> float:
        """Width of the range of insensitivity [%]."""
        return self.high - self.low


def row_of(name: str, plan: Plan) -> Row:
    """The figures of a plan on the assumed plant, and its insensitivity."""
    ranges = {"frequency": WIDEST}
    found = evaluate_robustness(plan.task, plan.profile, plan.coefficients, ranges, samples=1)
    low, high = found.sweeps[0].insensitivity or (0.0, 0.0)
    return Row(name, plan.energy, plan.motion.peak_acceleration, 100 * low, 100 * high)


def rows_of(task: PointToPoint, starts: int) -> list[Row]:
    """Every motion of a move that there is."""
    rows = [row_of("plan at rest", plan_move(task, starts=starts))]
    for size in RANGES:
        plant = UncertainPlant(task.plant, {"frequency": size})
        robust = PointToPoint(plant, task.target, task.duration)
        try:
            plan = plan_move(robust, starts=starts)
        except InfeasibleTaskError:
            continue
        rows.append(row_of(f"robust, {100 * size:g} %", plan))
    for shaper in SHAPERS:
        try:
            profile = shaped_cycloid(task, shaper)
        except ValueError:  # longer than the move
            continue
        rows.append(row_of(shaper.upper(), plan_move(task, profile)))
    return rows


def draw(of_moves: dict[str, list[Row]], path: Path) -> None:
    """Insensitivity over energy, a panel for each move."""
    figure = Figure(figsize=(4.2 * len(of_moves), 3.8), layout="constrained")
    FigureCanvasAgg(figure)
    for ax, (title, rows) in zip(
        figure.subplots(1, len(of_moves), squeeze=False)[0], of_moves.items(), strict=True
    ):
        plans = [row for row in rows if row.name.upper() != row.name]
        ax.plot([row.energy for row in plans], [row.width for row in plans], "-", color="#0072b2")
        for i, row in enumerate(rows):
            ours = row in plans
            marker, colour = ("o", "#0072b2") if ours else ("s", "#d55e00")
            ax.plot(row.energy, row.width, marker, color=colour)
            place = (6, {0: -12, 1: -6, 2: 7}.get(i, 4))  # labels of near points stay apart
            ax.annotate(
                row.name, (row.energy, row.width), xytext=place, textcoords="offset points",
                fontsize=8,
            )  # fmt: skip
        ax.set_title(title, loc="left", fontsize=10)
        ax.set_xlabel("energy [J]")
        ax.margins(0.4, 0.12)
        ax.set_ylim(bottom=-1)
        ax.grid(alpha=0.25)
    figure.axes[0].set_ylabel("width of insensitivity to frequency [%]")
    figure.savefig(path, dpi=110)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=2, help="starts of every plan")
    parser.add_argument("--figure", type=Path, help="draw insensitivity over energy to this file")
    options = parser.parse_args()
    out, of_moves = console(), dict[str, list[Row]]()
    out.print(machine())
    for title, (plant, target, duration) in MOVES.items():
        task = PointToPoint(plant, target, duration)
        of_moves[title] = rows_of(task, options.starts)
        table = Table(title=title)
        for column in ("motion", "energy [J]", "peak acceleration [rad/s^2]", "from [%]", "to [%]"):
            table.add_column(column)
        for row in of_moves[title]:
            table.add_row(
                row.name, f"{row.energy:.4g}", f"{row.acceleration:.3g}", f"{row.low:.1f}",
                f"{row.high:.1f}",
            )  # fmt: skip
        out.print(table)
        if options.figure is not None:
            draw(of_moves, options.figure)


if __name__ == "__main__":
    main()
