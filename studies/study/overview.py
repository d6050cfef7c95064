"""The tasks of a study side by side: energy above the best, in a table and a picture."""

from __future__ import annotations

from math import isfinite, nan

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from quietarm.studies.display.words import millimetres, title_of
from quietarm.studies.figures.axes import axes_or_new, new_figure
from quietarm.studies.figures.comparison import looks
from quietarm.studies.registry.methods import Method
from quietarm.studies.report.table import Cell, Column, Table
from quietarm.studies.study.findings import STILL_LEVEL, at_rest, gap
from quietarm.studies.study.work import Study


def overview_table(study: Study) -> Table:
    """Energy above the best at the residual of the summary, for each task and method."""
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    columns = [
        Column("task"),
        *(Column(title_of(f.case.task), "{:.2f}".format) for f in study.cases),
    ]
    rows: list[list[Cell]] = []
    for method in _methods(study):
        shares = [100 * gap(found.comparison, method) for found in study.cases]
        rows.append([method.label, *(s if isfinite(s) else None for s in shares)])
    best = [f"{found.comparison.best[STILL_LEVEL]:.4g} J" for found in study.cases]
    floors = [found.floor.energy if found.floor else nan for found in study.cases]
    ratios = [at_rest(found) / floor for found, floor in zip(study.cases, floors, strict=True)]
    rows.append([f"best at {level}", *best])
    rows.append(["best at rest, times the floor", *(r if isfinite(r) else None for r in ratios)])
    return Table(
        f"Energy above the best at {level} [%], motions between points counted",
        columns,
        rows,
    )


def _methods(study: Study) -> list[Method]:
    """The methods of all cases, in order."""
    found = [group.method for found in study.cases for group in found.comparison.groups]
    return list(dict.fromkeys(found))


def gap_figure(study: Study) -> Figure:
    """The picture at the top of the page: `draw_study_gaps` with its legend."""
    figure = new_figure(4.8, 1.6 + 0.45 * len(study.cases))
    draw_study_gaps(study, figure.subplots())
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8.5)
    return figure


def draw_study_gaps(study: Study, ax: Axes | None = None) -> Axes:
    """Draw the energy above the best: one row for each task, one mark for each method."""
    ax = axes_or_new(ax)
    seen: set[Method] = set()
    for i, found in enumerate(study.cases):
        for group in found.comparison.groups:
            own = looks(found.comparison)[group.label]
            spread, method = group.spread("gaps_between", STILL_LEVEL), group.method
            if len(group.runs) > 1:
                ax.plot([100 * spread.lower, 100 * spread.upper], [i, i], color=own.colour,
                          linewidth=4, alpha=0.35, solid_capstyle="round")  # fmt: skip
            label = "_" if method in seen else method.label
            seen.add(method)
            ax.plot(100 * spread.median, i, own.mark, color=own.colour,
                      markersize=7, markeredgecolor="white", label=label)  # fmt: skip
    titles = [title_of(found.case.task).replace(", ", "\n", 1) for found in study.cases]
    ax.set_yticks(range(len(study.cases)), titles, fontsize=8)
    ax.set_ylim(len(study.cases) - 0.5, -0.5)
    ax.set_xscale("symlog", linthresh=0.1, linscale=0.5)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_xlim(-0.02, None)
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    ax.set_xlabel(f"energy above the best at {level} [%]")
    return ax
