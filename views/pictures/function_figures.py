"""Fronts of a user's own function as pictures: every objective over the first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from quietarm.ocp import Front
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.views.pictures.axes import LOGARITHMIC_FROM, logarithmic, side_by_side
from quietarm.views.pictures.grammar import Look
from quietarm.views.report.method_rows import described
from quietarm.views.report.words import counted


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
        ax.set_xlabel(_axis(first.label, first.unit))
        ax.set_ylabel(_axis(other.label, other.unit))
        values = np.concatenate([front.objective_values[:, 0] for front in fronts])
        if len(values) and (values > 0).all():
            logarithmic(ax, values, least_span=LOGARITHMIC_FROM)
    if len(fronts) > 1:
        axes[0].legend(fontsize=8)
    return figure


def facts_of(fronts: Sequence[Front]) -> str:
    """Say what was searched, and by what."""
    function: Any = fronts[0].task
    return (
        f"{described(fronts[0].record.method)}: function {function.name}, "
        f"{counted(function.size, 'coefficient')}"
    )


def _sentence(fronts: Sequence[FunctionFront]) -> str:
    """The ends of the first front in a sentence."""
    front = fronts[0]
    if not front.points:
        return "No point of this front was found"
    table = front.objective_values
    ends = [
        f"{entry.label} from {least:.3g} to {most:.3g} {entry.unit}".rstrip()
        for entry, least, most in zip(front.outputs, table.min(axis=0), table.max(axis=0))
    ]
    points = counted(len(front.points), "candidate")
    return f"{points} that no other dominates: {', '.join(ends)}"


def _axis(label: str, unit: str) -> str:
    return f"{label} [{unit}]" if unit else label
