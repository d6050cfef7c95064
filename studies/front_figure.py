"""Fronts on paper: energy against residual, and how they grew."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from metaheuristics.ensemble import hypervolumes
from ocp import Front


def front_figure(fronts: Sequence[Front], title: str = "") -> Figure:
    """Draw fronts of one method, a line a seed, and their hypervolume by evaluations.

    Parameters
    ----------
    fronts : sequence of Front
        One for every seed.
    title : str, optional
        Title of the picture.

    Returns
    -------
    matplotlib.figure.Figure
        Left: energy against residual (logarithmic). Right: median hypervolume with its quartiles.
    """
    figure = Figure(figsize=(10, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    for front in fronts:
        if front.points:
            left.plot(
                front.residuals * 1e3, front.energies, ".-", markersize=3, linewidth=0.8,
                alpha=0.8, label=f"seed {front.seed}",
            )  # fmt: skip
    left.set_xscale("log")
    left.set_xlabel("residual F1 [mm]")
    left.set_ylabel("energy F2 [J]")
    left.grid(alpha=0.25, which="both")
    if 1 < len(fronts) <= 10:
        left.legend(fontsize=8)
    histories = [front.history for front in fronts if front.history]
    if histories:
        length = min(len(history) for history in histories)
        evaluations = [generation.evaluations for generation in histories[0][:length]]
        table = np.array([[g.hypervolume for g in history[:length]] for history in histories])
        low, middle, high = np.quantile(table, [0.25, 0.5, 0.75], axis=0)
        right.plot(evaluations, middle, color="tab:blue", label="median")
        if len(histories) > 1:
            right.fill_between(evaluations, low, high, alpha=0.3, label="quartiles")
            spread = hypervolumes(fronts)
            right.set_title(
                f"{spread.median:.4f} ({spread.lower:.4f} to {spread.upper:.4f})", fontsize=9
            )
            right.legend(fontsize=8)
    right.set_xlabel("candidates evaluated")
    right.set_ylabel("hypervolume, share of the reference box")
    right.grid(alpha=0.25)
    if title:
        figure.suptitle(title, fontsize=12)
    return figure
