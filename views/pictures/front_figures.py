"""Fronts as pictures: energy over residual, and what several seeds of a search make of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from quietarm.metaheuristics.score import shares_of_box
from quietarm.metaheuristics.spread import SEARCH_RESIDUAL, Spread, energies_at, hypervolumes
from quietarm.ocp import Front, Polish
from quietarm.ocp.checks import takes
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.ocp.front.tradeoff import RESIDUAL_LIMIT
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.rest import rest_of
from quietarm.views.pictures.axes import (
    LOGARITHMIC_FROM,
    TITLE,
    axes_or_new,
    draw_front,
    logarithmic,
    name_objectives,
    residual_label,
    side_by_side,
)
from quietarm.views.pictures.function_figures import draw_function_fronts, facts_of
from quietarm.views.pictures.grammar import PALE, PLAN, RED, Look, looks, variants
from quietarm.views.pictures.marked_points import mark_points
from quietarm.views.pictures.surface_figures import draw_parallel, draw_peak
from quietarm.views.report.captions import caption_of_fronts, caption_of_polish
from quietarm.views.report.method_rows import described, is_gradient
from quietarm.views.report.words import spread_words, title_of_picture
from quietarm.views.tips import tip_scale, tip_words

_MOST_NAMED = 10
"""More fronts than this are drawn without a name."""


@takes(fronts=[Front])
def draw_fronts(
    fronts: Sequence[Front],
    ax: Axes | None = None,
    labels: Sequence[str] | None = None,
    *,
    linear: bool = False,
) -> Axes:
    """Draw energy against residual: a search's front as a staircase, one by gradient as a line.

    Parameters
    ----------
    fronts : sequence of Front
        Of one task, by any methods. Residual limits that failed are crosses, and ranges that no
        weight reaches are grey. Of three objectives and more the points stand without lines.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.
    labels : sequence of str, optional
        What the legend calls them; by default their methods, seeds or numbers.
    linear : bool
        Whether the axis of residuals is; logarithmic by default, where they span a factor of five.
        Residuals below 0.001 mm, which count as rest, are drawn there.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, with a legend where there are a few fronts.

    Raises
    ------
    ValueError
        When there are not as many labels as fronts.
    """
    ax = axes_or_new(ax)
    tip_unit = _tip_unit(fronts)
    scale = tip_scale(tip_unit)[1]
    for k, (begin, end) in enumerate(gap for front in fronts for gap in front.gaps):
        label = "_" if k else "no weight reaches these"  # once in the legend
        ax.axvspan(begin * scale, end * scale, color=PALE, linewidth=0, label=label)
    names = _names(fronts) if labels is None else labels
    if len(names) != len(fronts):
        raise ValueError(f"{len(fronts)} fronts have {len(names)} labels; give each front one")
    for front, name, look_of_front in zip(fronts, names, _looks_of(fronts)):
        shown = np.maximum(front.residuals, rest_of(front.task))  # none has no logarithm
        if len(front.objectives) > len(RESIDUAL_AND_ENERGY):  # of a surface no line joins points
            ax.plot(
                shown * scale, front.energies, look_of_front.mark,
                color=look_of_front.colour, markersize=3, alpha=0.8, label=name,
            )  # fmt: skip
            continue
        middles = [(begin + end) / 2 for begin, end in front.gaps]
        places = np.searchsorted(front.residuals, middles)  # no line crosses a gap
        draw_front(
            ax,
            np.insert(shown, places, np.nan),
            np.insert(front.energies, places, np.nan),
            tip_unit, exact=is_gradient(front.record.method), color=look_of_front.colour,
            marker=look_of_front.mark, markersize=3, alpha=0.8, label=name,
        )  # fmt: skip
    failures = [failure for front in fronts for failure in front.failures]
    if failures:  # weights have no residual
        limits = [scale * failure.asked.get(RESIDUAL_LIMIT, np.nan) for failure in failures]
        ax.plot(
            limits, np.full(len(limits), 0.03), "x", color=RED,
            transform=ax.get_xaxis_transform(), label=f"{len(limits)} not found",
        )  # fmt: skip
    if not linear:
        all_residuals = [
            max(point.residual, rest_of(front.task)) for front in fronts for point in front.points
        ]
        logarithmic(ax, all_residuals, least_span=LOGARITHMIC_FROM)
    name_objectives(ax, tip_unit)
    if len(fronts) <= _MOST_NAMED and len(ax.get_legend_handles_labels()[1]) > 1:
        ax.legend(fontsize=8)
    return ax


def _looks_of(fronts: Sequence[Front]) -> list[Look]:
    """Looks of fronts; runs of one method have one colour."""
    methods = [front.record.method for front in fronts]
    searches = not any(is_gradient(method) for method in methods)
    if searches and len(set(methods)) == 1:
        return variants("search", len(fronts))
    return looks(["plan" if is_gradient(method) else "search" for method in methods])


def _tip_unit(fronts: Sequence[Front]) -> str:
    """The unit of the tips of fronts' plants."""
    return next((front.task.plant.tip_unit for front in fronts), "m")


def _names(fronts: Sequence[Front]) -> list[str]:
    """Return the fronts' names: the method if there are several, the seed for several runs."""
    methods = [described(front.record.method) for front in fronts]
    several = len(set(methods)) > 1
    names = list[str]()
    for i, (front, method) in enumerate(zip(fronts, methods), start=1):
        runs = methods.count(method) > 1
        seed = front.record.seed
        run = f"front {i}" if seed is None else f"seed {seed}"
        names.append(", ".join([method] * (several or not runs) + [run] * runs))
    return names


@takes(fronts=[Front])
def draw_hypervolume(fronts: Sequence[Front], ax: Axes | None = None) -> Axes:
    """Draw hypervolume against candidates: the median over the seeds, and the quartiles.

    Parameters
    ----------
    fronts : sequence of Front
        Of one method and task, one for every seed.
    ax : matplotlib.axes.Axes, optional
        Where to draw; new axes by default.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; the box that the hypervolume is a share of is named beside them.
    """
    ax = axes_or_new(ax)
    residual, energy, *peaks = fronts[0].reference
    length = min(len(front.history) for front in fronts)
    evaluations = [mark.evaluations for mark in fronts[0].history[:length]]
    shares = np.array([shares_of_box(front)[:length] for front in fronts])
    spreads = [Spread.of(column) for column in shares.T.tolist()]
    colour = _looks_of(fronts)[0].colour
    ax.plot(
        evaluations, [spread.median for spread in spreads], color=colour, marker=".", label="median"
    )
    if len(fronts) > 1:
        low = [spread.lower for spread in spreads]
        high = [spread.upper for spread in spreads]
        ax.fill_between(evaluations, low, high, color=colour, alpha=0.3, linewidth=0,
                        label="quartiles")  # fmt: skip
        ax.legend(fontsize=8, loc="lower right")
    ax.set_title(f"hypervolume: {spread_words(hypervolumes(fronts), '.4f')}", **TITLE)
    ax.set_xlabel("candidates evaluated")
    corner = f"{tip_words(residual, _tip_unit(fronts))} and {energy:.4g} J"
    if peaks:
        corner = f"twice the plain cycloid's energy and peak{'s' * (len(peaks) > 1)}"
    ax.set_ylabel(f"share of the area\nup to {corner}")
    ax.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    return ax


@takes(fronts=[Front])
def draw_seed_energies(fronts: Sequence[Front], ax: Axes | None = None) -> Axes:
    """Draw every seed's least energy within 1 mm, with median and quartiles.

    Parameters and what is returned are those of `draw_hypervolume`; a seed that never reaches that
    residual is a cross.
    """
    # the axis of energies spans at least this share of their median: seeds that agree lie close
    least_span = 0.01
    ax = axes_or_new(ax)
    spread = energies_at(fronts)
    level = tip_words(SEARCH_RESIDUAL, _tip_unit(fronts))
    look_of_fronts = _looks_of(fronts)
    colour = look_of_fronts[0].colour
    for place, (front, seed) in enumerate(zip(fronts, look_of_fronts)):
        energy = front.least_energy(SEARCH_RESIDUAL)
        if np.isfinite(energy):
            ax.plot(place, energy, seed.mark, color=seed.colour, markersize=6)
        else:
            ax.plot(place, 0.02, "x", color=seed.colour, transform=ax.get_xaxis_transform())
    figures = ""
    quartiles = ""
    if np.isfinite(spread.median):
        ax.axhline(spread.median, color=colour, linewidth=1.0)
        figures = f": {spread.median:.4g} J"
    if np.isfinite(spread.upper):
        ax.axhspan(spread.lower, spread.upper, alpha=0.2, color=colour)
        quartiles = f"({spread.lower:.4g} to {spread.upper:.4g} J), "
    words = f"{spread.count} of {spread.seeds} seeds"
    ax.set_title(f"energy at {level}{figures}\n{quartiles}{words}", **TITLE)
    ax.set_xlabel(f"seed (x: never within {level})")
    ax.set_ylabel("energy [J]")
    if len(fronts) <= 2 * _MOST_NAMED:
        ax.set_xticks(range(len(fronts)), [str(front.record.seed) for front in fronts])
    ax.margins(x=0.1, y=0.2)
    ax.ticklabel_format(axis="y", useOffset=False)
    low, high = ax.get_ylim()
    room = max(0.0, least_span * (low + high) / 2 - (high - low)) / 2
    ax.set_ylim(low - room, high + room)
    return ax


@takes(fronts=[Front])
def front_figure(fronts: Sequence[Front]) -> Figure:
    """Draw fronts of one method, a line for each seed; of a search what it found on the way, too.

    Parameters
    ----------
    fronts : sequence of Front
        One for every seed.

    Returns
    -------
    matplotlib.figure.Figure
        Energy against residual, of a single front with its ends, its knee and 1 mm; of searches the
        median hypervolume with its quartiles against candidates; for several seeds also the least
        energy of each within 1 mm. Of three objectives the third is the colour; of four and more
        there are parallel coordinates as well.
    """
    method = fronts[0].record.method
    if of_functions := [front for front in fronts if isinstance(front, FunctionFront)]:
        return draw_function_fronts(
            of_functions, _names(fronts), _looks_of(fronts), facts_of(fronts)
        )
    gradient = is_gradient(method)
    panels = 1 + (not gradient and all(front.history for front in fronts))
    panels += panels > 1 and len(fronts) > 1
    peaks = len(fronts[0].objectives) - len(RESIDUAL_AND_ENERGY)
    parallel = int(peaks > 1)
    panels += parallel
    facts = f"{described(method)}: {title_of_picture(fronts[0].task)}"
    width = 4.2 if panels > 1 else 6.4
    figure, axes = side_by_side(panels, caption_of_fronts(fronts), facts, width)
    if peaks:
        draw_peak(fronts, axes[0])
        if parallel:
            draw_parallel(fronts, axes[1])
        for draw, ax in zip((draw_hypervolume, draw_seed_energies), axes[1 + parallel :]):
            draw(fronts, ax)
        return figure
    draw_fronts(fronts, axes[0], linear=gradient)
    tip_unit = fronts[0].task.plant.tip_unit
    name_objectives(axes[0], tip_unit, fronts[0].task.residual_window)
    if len(fronts) == 1:
        front = fronts[0]
        points = np.column_stack([front.residuals, front.energies])
        mark_points(axes[0], points, front.task, front.reference)
        axes[0].legend(fontsize=8)
    for draw, ax in zip((draw_hypervolume, draw_seed_energies), axes[1:]):
        draw(fronts, ax)
    return figure


@takes(before=Front)
def polish_figure(before: Front, polish: Polish) -> Figure:
    """Draw a front before and after polishing, and the energy that this saved point by point."""
    facts = f"{described(polish.front.record.method)}: {title_of_picture(before.task)}"
    figure, (ax, saved) = side_by_side(2, caption_of_polish(polish), facts, width=5.6)
    draw_fronts([before, polish.front], ax, ("before", "after"))
    tip_unit = before.task.plant.tip_unit
    name_objectives(ax, tip_unit, before.task.residual_window)
    residuals = [max(gain.residual, rest_of(before.task)) for gain in polish.gains]
    shown_residuals = np.multiply(tip_scale(tip_unit)[1], residuals)
    shares = [100 * gain.share for gain in polish.gains]
    axes_or_new(saved).plot(shown_residuals, shares, PLAN.mark, color=PLAN.colour, markersize=3)
    label = residual_label(tip_unit, before.task.residual_window)
    saved.set(xlabel=label, ylabel="energy saved [%]")
    saved.set_ylim(bottom=0)
    logarithmic(saved, residuals, least_span=LOGARITHMIC_FROM)
    return figure
