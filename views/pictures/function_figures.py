"""Fronts of a user's own function as pictures, alone or compared: objectives over the first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.score import HYPERVOLUME, gap
from quietarm.ocp import Front
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.ocp.objectives import Objective
from quietarm.views.pictures.axes import (
    LOGARITHMIC_FROM,
    legend_below,
    logarithmic,
    side_by_side,
)
from quietarm.views.pictures.comparison_figures import draw_band, drawn_groups, up_to
from quietarm.views.pictures.grammar import Look
from quietarm.views.report.method_rows import described
from quietarm.views.report.words import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from quietarm.studies.compare.front_comparison import Comparison, RunsOfMethod


def draw_function_fronts(
    fronts: Sequence[FunctionFront], names: Sequence[str], colours: Sequence[Look], facts: str
) -> Figure:
    """Draw each objective over the first: staircases of two, marks of three and more.

    Parameters
    ----------
    fronts : sequence of FunctionFront
        Fronts of one function.
    names : sequence of str
        What the legend calls them.
    colours : sequence of Look
        How each is drawn.
    facts : str
        What stands below the sentence at the head.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each objective after the first.
    """
    first, *others = fronts[0].outputs
    width = 4.2 if len(others) > 1 else 6.4
    figure, axes = side_by_side(len(others), _sentence(fronts), facts, width)
    for column, (ax, other) in enumerate(zip(axes, others), start=1):
        ax.grid(alpha=0.25)
        for front, name, look in zip(fronts, names, colours):
            table = front.objective_values
            steps = "steps-post" if len(others) == 1 else "default"
            ax.plot(
                table[:, 0], table[:, column], marker=look.mark, color=look.colour, markersize=3,
                linewidth=0.8 if len(others) == 1 else 0, drawstyle=steps, label=name, alpha=0.8,
            )  # fmt: skip
        _name_axes(ax, first, other, [front.objective_values for front in fronts])
    if len(fronts) > 1:
        legend_below(figure, axes, 3, 8)
    return figure


@interruptible
def function_comparison_figure(comparison: Comparison) -> Figure:
    """Draw compared fronts of a function: each objective over the first, a method a line.

    Parameters
    ----------
    comparison : Comparison
        The fronts, by `compare_fronts`.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each objective after the first. Of two objectives and several seeds there is the
        median attainment surface, in a band from the best to the worst; of three and more stand the
        points of all seeds.
    """
    fronts: list[Any] = [run.front for run in comparison.runs]
    first, *others = fronts[0].outputs
    figure, axes = side_by_side(
        len(others), _best_words(comparison), _compared_facts(comparison), 4.2 if others[1:] else 7
    )
    tables = [front.objective_values for front in fronts]
    right = 1.02 * max(table[:, 0].max() for table in tables)
    for column, (ax, other) in enumerate(zip(axes, others), start=1):
        ax.grid(alpha=0.25)
        for group, look, wider in drawn_groups(comparison):
            if others[1:]:
                _draw_points(ax, group, look, column)
                continue
            shown = up_to(group.median, right)
            ax.plot(
                *shown.T, color=look.colour, linestyle=look.dash, linewidth=1.2 + wider,
                drawstyle="steps-post", label=group.label,
            )  # fmt: skip
            draw_band(ax, group, look, right)
        _name_axes(ax, first, other, tables)
    legend_below(figure, axes, 3, 8)
    return figure


def _draw_points(ax: Axes, group: RunsOfMethod, look: Look, column: int) -> None:
    """Draw the points of all runs of a method, an objective over the first."""
    table = np.vstack([run.front.objective_values for run in group.runs])
    ax.plot(
        table[:, 0], table[:, column], look.mark, color=look.colour, markersize=3, alpha=0.8,
        label=group.label,
    )  # fmt: skip


def _name_axes(
    ax: Axes, first: Objective, other: Objective, tables: Sequence[NDArray[np.float64]]
) -> None:
    """Label the axes; the first objective is logarithmic where it is positive and spans much."""
    ax.set_xlabel(_axis(first.label, first.unit))
    ax.set_ylabel(_axis(other.label, other.unit))
    values = np.concatenate([table[:, 0] for table in tables])
    if len(values) and (values > 0).all():
        logarithmic(ax, values, least_span=LOGARITHMIC_FROM)


def facts_of(fronts: Sequence[Front]) -> str:
    """Say what was searched, and by what."""
    methods = dict.fromkeys(described(front.record.method) for front in fronts)
    return f"{', '.join(methods)}: {_function_words(fronts[0])}"


def _function_words(front: Front) -> str:
    function: Any = front.task
    return f"function {function.name}, {counted(function.size, 'coefficient')}"


def _compared_facts(comparison: Comparison) -> str:
    """Say of what the fronts are, and what lines and bands are of several seeds."""
    words = _function_words(comparison.runs[0].front)
    if len(comparison.objectives) == 2 and any(len(group.runs) > 1 for group in comparison.groups):
        words += "; lines: half of the seeds, bands: best to worst"
    return words


def _best_words(comparison: Comparison) -> str:
    """Say which methods have the smallest hypervolume gaps, in the median of their seeds."""
    gaps = {
        group.label: gap(group.spread("scores", HYPERVOLUME.name).median)
        for group in comparison.groups
    }
    best = sorted(gaps, key=lambda label: gaps[label])
    if len(best) == 1:
        return f"{best[0]}, {counted(len(comparison.runs), 'front')}"
    return f"Hypervolume gap: {', '.join(f'{label} {gaps[label]:.2g} %' for label in best[:4])}"


def _sentence(fronts: Sequence[FunctionFront]) -> str:
    """The ends of the fronts in a sentence."""
    known = [front.objective_values for front in fronts if front.points]
    if not known:
        return "No point of this front was found"
    table = np.vstack(known)
    ends = [
        f"{entry.label} from {least:.3g} to {most:.3g} {entry.unit}".rstrip()
        for entry, least, most in zip(fronts[0].outputs, table.min(axis=0), table.max(axis=0))
    ]
    what = f"{counted(len(table), 'candidate')} that no other dominates"
    if len(fronts) > 1:
        what = f"{len(fronts)} fronts"
    return f"{what}: {', '.join(ends)}"


def _axis(label: str, unit: str) -> str:
    return f"{label} [{unit}]" if unit else label
