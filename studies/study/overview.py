"""The tasks of a study side by side: energy above the best, in a table and a picture."""

from __future__ import annotations

from math import nan

from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from quietarm.studies.display.words import millimetres, title_of
from quietarm.studies.figures.axes import legend_below, new_figure
from quietarm.studies.figures.comparison import looks
from quietarm.studies.registry.methods import Method
from quietarm.studies.report.table import Line, Table, table_of
from quietarm.studies.study.findings import STILL_LEVEL, at_rest, gap
from quietarm.studies.study.work import Study


def overview_table(study: Study) -> Table:
    """Energy above the best at the residual of the summary, for each task and method."""
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    comparisons = [found.comparison for found in study.cases]
    methods = dict.fromkeys(group.method for one in comparisons for group in one.groups)
    names = [*(method.label for method in methods), f"best at {level}"]
    columns: list[Line] = [("task", "", [*names, "best at rest, times the floor"])]
    for found in study.cases:
        gaps = [100 * gap(found.comparison, method) for method in methods]
        ratio = at_rest(found) / found.floor.energy if found.floor else nan
        best = f"{found.comparison.best[STILL_LEVEL]:.4g} J"
        columns.append((title_of(found.case.task), "{:.2f}", [*gaps, best, ratio]))
    title = f"Energy above the best at {level} [%], motions between points counted"
    return table_of(title, columns)


def gap_figure(study: Study) -> Figure:
    """The energy above the best: one row for each task, one mark for each method."""
    figure = new_figure(4.8, 1.6 + 0.45 * len(study.cases))
    ax = figure.subplots()
    ax.grid(alpha=0.25)
    seen = set[Method]()
    for row, comparison in enumerate(found.comparison for found in study.cases):
        for group in comparison.groups:
            own, method = looks(comparison)[group.label], group.method
            spread = group.spread("gaps_between", STILL_LEVEL)
            if len(group.runs) > 1:
                ax.plot(
                    [100 * spread.lower, 100 * spread.upper], [row, row], color=own.colour,
                    linewidth=4, alpha=0.35, solid_capstyle="round",
                )  # fmt: skip
            ax.plot(
                100 * spread.median, row, own.mark, color=own.colour, markersize=7,
                markeredgecolor="white", label="_" if method in seen else method.label,
            )  # fmt: skip
            seen.add(method)
    titles = [title_of(found.case.task).replace(", ", "\n", 1) for found in study.cases]
    ax.set_yticks(range(len(study.cases)), titles, fontsize=8)
    ax.set_ylim(len(study.cases) - 0.5, -0.5)
    ax.set_xscale("symlog", linthresh=0.1, linscale=0.5)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_xlim(-0.02, None)
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    ax.set_xlabel(f"energy above the best at {level} [%]")
    legend_below(figure, [ax], 3, 8.5)
    return figure
