"""Measure what robustness costs: insensitivity to the frequency over energy, against shapers.

    pip install ".[benchmark]"
    python benchmarks/robustness.py [--starts 2] [--figure robustness.png]

Two moves of each plant, six terms: those of the README, and longer ones on which ZVD and EI have
room for their impulses. A robust plan leaves within 5 % of what the plain cycloid leaves for every
frequency wrong by up to a range; the insensitivity is how far the range of errors reaches within
which it leaves no more, by `evaluate_robustness`. The shapers' motions take as long as the plans;
where ZVD or EI are longer than the move they are left out.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import NamedTuple

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from parts.measuring import console, machine
from rich.table import Table

from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, SingleLinkManipulator
from quietarm.ocp import (
    Plan,
    PointToPoint,
    SolverFailedError,
    Uncertainty,
    evaluate_robustness,
    plan_move,
    shaped_cycloid,
)
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.views.pictures import BLUE, RED, stack
from quietarm.views.pictures.axes import head

LINK, ARM, LINKS = SingleLinkManipulator(), ArmOnFlexibleLink(), DualLinkManipulator()
MOVES = {
    "single link, 0 to 30 deg, 0.8 s": (LINK, 0.0, pi / 6, 0.8),
    "arm, 0 to 90 deg, 0.8 s": (ARM, 0.0, pi / 2, 0.8),
    "two links, 0 to 90 deg, 0.9 s": (LINKS, 0.0, pi / 2, 0.9),
    "single link, 0 to 90 deg, 1.0 s": (LINK, 0.0, pi / 2, 1.0),
    "arm, -90 to 90 deg, 1.2 s": (ARM, -pi / 2, pi / 2, 1.2),
    "two links, 0 to 90 deg, 1.4 s": (LINKS, 0.0, pi / 2, 1.4),
}
RANGES = (0.05, 0.1, 0.15)
REST = "at rest"
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
    found = evaluate_robustness(plan.candidate, ranges, samples=1)
    low, high = found.sweeps[0].insensitivity or (0.0, 0.0)
    return Row(name, plan.energy, plan.motion.peak_acceleration, 100 * low, 100 * high)


def rows_of(task: PointToPoint, starts: int) -> list[Row]:
    """Every motion of a move that there is."""
    at_rest = plan_move(task, starts=starts)
    rows = [row_of(REST, at_rest)]
    nominal = evaluate_robustness(at_rest.candidate, {"frequency": WIDEST}, samples=1)
    limit = TOLERATED * nominal.cycloid
    for size in RANGES:
        robust = replace(task, uncertainty=Uncertainty({"frequency": size}))
        try:
            plan = plan_move(robust, residual_limit=limit, starts=starts)
        except SolverFailedError as none:
            console().print(f"{100 * size:g} %: {none}")
            continue
        rows.append(row_of(f"{100 * size:g} %", plan))
    for shaper in SHAPERS:
        try:
            profile = shaped_cycloid(task, shaper)
        except ValueError:  # longer than the move
            continue
        rows.append(row_of(shaper.upper(), plan_move(task, profile)))
    return rows


def label_place(row: Row, series: list[Row], size: tuple[float, float]) -> tuple[int, int]:
    """Where a label stands beside its point, clear of lines, axes and other labels [points]."""
    energy, width = size
    is_shaper = row.name.lower() in SHAPERS
    near = 0.12
    away = [
        ((point.energy - row.energy) / energy, (point.width - row.width) / width)
        for point in series
    ]
    right = (7, 4)
    left = (-7, 4)
    if is_shaper:
        crowded = any(0 < x < near and abs(y) < near for x, y in away)
        return left if crowded else right
    if row is series[-1]:
        return right
    if row.name == REST:
        return (9, -9)
    # below where the next point of the line stands close above
    return (-7, -9) if any(abs(x) < near and 0 < y < near for x, y in away) else left


def draw(of_moves: dict[str, list[Row]], path: Path) -> None:
    """Insensitivity over energy, a panel for each move."""
    figure = Figure(figsize=(12.6, 7.9), layout="constrained")
    FigureCanvasAgg(figure)
    head(
        figure,
        "A plan tolerates as wide a range of errors as a shaper, or a wider one, with less energy",
        "Six terms; frequency errors with at most 5 % of the plain cycloid's residual, by CVODES",
    )
    panels = figure.subplots(2, 3)
    for ax, (title, rows) in zip(panels.flat, of_moves.items(), strict=False):
        far = max(row.energy for row in rows)
        high = max(row.width for row in rows)
        shaped = [row for row in rows if row.name.lower() in SHAPERS]
        plans = [row for row in rows if row not in shaped]
        for series, style, colour in ((plans, "o-", BLUE), (shaped, "s", RED)):
            energies = [row.energy for row in series]
            ax.plot(energies, [row.width for row in series], style, color=colour)
            for row in series:
                place = label_place(row, series, (far, high))
                ax.annotate(
                    row.name, (row.energy, row.width), xytext=place, fontsize=9,
                    textcoords="offset points", ha="right" if place[0] < 0 else "left",
                )  # fmt: skip
        ax.set_title(title, loc="left", fontsize=10)
        ax.set_xlim(0, 1.2 * far)
        ax.set_ylim(-2, 1.12 * high)
        ax.grid(alpha=0.25)
    for ax in panels[1]:
        ax.set_xlabel("energy [J]")
    for ax in panels[:, 0]:
        ax.set_ylabel("width of insensitivity to frequency [%]")
    marks = [
        Line2D(
            [], [], color=BLUE, marker="o", label="plan: at rest, or robust to so many per cent"
        ),
        Line2D([], [], color=RED, marker="s", linestyle="", label="input shaper"),
    ]
    figure.legend(handles=marks, loc="outside lower center", ncols=2, frameon=False)
    figure.savefig(path, dpi=100)
    stacked = stack(figure)
    if stacked is not None:
        stacked.savefig(path.with_name(f"{path.stem}-narrow.png"), dpi=150)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=2, help="starts of every plan")
    parser.add_argument("--figure", type=Path, help="draw insensitivity over energy to this file")
    options = parser.parse_args()
    out, of_moves = console(), dict[str, list[Row]]()
    out.print(machine())
    for title, (plant, start, target, duration) in MOVES.items():
        task = PointToPoint(plant, target, duration, start=start)
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
