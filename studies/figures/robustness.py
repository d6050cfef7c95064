"""Residuals over errors of the plant as a picture, one curve for each plan."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from quietarm.ocp import Robustness
from quietarm.ocp.checks import has_no
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.studies.figures.axes import axes_or_new, legend_of, side_by_side
from quietarm.studies.figures.looks import look


def draw_robustness(plans: Mapping[str, Robustness], name: str, ax: Axes | None = None) -> Axes:
    """Draw what plans leave over the errors of one thing.

    Parameters
    ----------
    plans : mapping of str to Robustness
        The figures of each plan by what the legend calls it.
    name : str
        What is wrong: ``"frequency"``, ``"damping"`` or a parameter; each has a sweep of it.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes: residual, in per cent of what the plain cycloid leaves on the assumed plant,
        against the error [%]; where a curve first leaves the limit, it is marked.

    Raises
    ------
    ValueError
        When there is no plan, one is something else, or has no sweep of that name.
    """
    ax = axes_or_new(ax)
    limit = 100 * TOLERATED
    for number, (label, plan) in enumerate(plans.items()):
        sweeps = {sweep.name: sweep for sweep in plan.sweeps}
        if name not in sweeps:
            raise ValueError(has_no(f"plan {label!r}", "sweep of", name, sweeps))
        sweep, how = sweeps[name], look(number)
        per_cent = 100 / plan.cycloid if plan.cycloid > 0 else 0.0  # a joint that moves no mode
        ax.plot(
            100 * sweep.errors, per_cent * sweep.figures.residual, color=how.colour,
            linestyle=how.dash, linewidth=1.6, label=label,
        )  # fmt: skip
        if sweep.insensitivity is not None:
            both = zip(sweep.insensitivity, sweep.open_ends, strict=True)
            ends = [100 * end for end, is_open in both if not is_open]
            ax.plot(ends, [limit] * len(ends), how.mark, color=how.colour, markersize=5)
    ax.axhline(limit, color="0.3", linewidth=0.8, linestyle="--", label=f"{limit:g} %")
    ax.set(xlabel=f"error of {name} [%]", ylabel="residual [% of the plain cycloid's]")
    ax.set_ylim(bottom=0)
    ax.margins(x=0)
    return ax


def robustness_figure(plans: Mapping[str, Robustness], title: str = "") -> Figure:
    """The picture of `quietarm robustness`: `draw_robustness`, one panel for each parameter."""
    names = next(iter(plans.values())).ranges
    figure, axes = side_by_side(len(names), title, width=max(4.8, 7.2 / len(names)))
    for name, ax in zip(names, axes, strict=True):
        draw_robustness(plans, name, ax)
    figure.legend(*legend_of(axes), loc="outside lower center", ncols=3, fontsize=8)
    return figure
