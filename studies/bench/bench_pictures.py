"""The pictures of a bench."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from quietarm.metaheuristics.score import GAP
from quietarm.studies.bench.results import Results, bench_label, derivative_free
from quietarm.studies.bench.statistics import ALPHA, Ranking
from quietarm.views.pictures.axes import TITLE, legend_below, logarithmic, new_figure
from quietarm.views.pictures.grammar import PLAN, SEARCH, Look, looks

_COSTS = {"seconds": "processor time [s]", "evaluations": "candidates simulated"}


def curves_figure(results: Results, by: str = "seconds") -> Figure:
    """Median of what is missing on every problem, over processor time or evaluations."""
    # shares below are drawn here: the reference front's own hypervolume is no better known
    least = 1e-4
    problems = results.problems
    columns = min(3, len(problems))
    rows = -(-len(problems) // columns)
    figure = new_figure(max(4.2 * columns, 5.5), 3.0 * rows + 0.8)
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    methods = [m for m in results.methods if by == "seconds" or derivative_free(m)]
    styles = _looks_of(methods)
    for ax, problem in zip(axes, problems):
        costs = [0.0]
        for method, style in zip(methods, styles):
            if not results.of(problem.name, method):
                continue
            at, missing = results.missing(problem.name, method, by)
            median = np.median(missing, axis=0)
            few = len(at) <= len(missing)  # it ends by itself: a point a run
            ax.plot(
                at,
                100 * np.maximum(median, least),
                drawstyle="steps-post",
                color=style.colour,
                linestyle=style.dash,
                marker="o" if few else "",
                markersize=4,
                label=bench_label(method),
            )
            costs += at.tolist()
        logarithmic(ax, costs)
        logarithmic(ax, [least, 1.0], "y")
        ax.set_ylim(100 * least, 110)
        ax.set_title(problem.name, **TITLE)
        ax.grid(alpha=0.25)
    for ax in axes[len(problems) :]:
        ax.axis("off")
    for ax in axes[max(len(problems) - columns, 0) : len(problems)]:
        ax.set_xlabel(_COSTS[by])
    for ax in axes[: len(problems) : columns]:
        ax.set_ylabel(GAP)
    legend_below(figure, axes, 4 if columns > 1 else 1, 8)
    return figure


def profiles_figure(results: Results, by: str = "seconds") -> Figure:
    """Share of targets on all problems that a method's runs reached, over what that had cost.

    Costs are processor time; or by evaluations the candidates over the number of coefficients, as
    in COCO's runtime profiles, of methods without derivatives. The band is an interval of 95 %:
    runs of every problem drawn again with replacement.
    """
    # targets of the running-time profiles: shares of the hypervolume that may be missing
    targets = np.geomspace(1.0, 1e-3, 51)
    figure = new_figure(7.2, 4.4)
    ax = figure.subplots()
    random = np.random.default_rng(0)
    methods = [m for m in results.methods if by == "seconds" or derivative_free(m)]
    size = {
        problem.name: 1 if by == "seconds" else problem.profile.size for problem in results.problems
    }
    costs = np.concatenate([
        run.history.cost(by) / size[run.problem.name]
        for run in results.runs if run.method in methods
    ])  # fmt: skip
    places = np.geomspace(costs[costs > 0].min(), costs.max(), 200)
    for method, style in zip(methods, _looks_of(methods)):
        # of each problem, how many of a run's targets were reached by then: (runs, places)
        reached = [
            np.array(
                [
                    np.searchsorted(np.sort(hits) / size[problem.name], places, side="right")
                    for hits in results.hits(problem.name, method, targets.tolist(), by)
                ]
            )
            for problem in results.problems
            if results.of(problem.name, method)
        ]
        total = len(targets) * sum(map(len, reached))
        # for the band: runs drawn again so many times
        drawn = [
            np.sum([_drawn_again(counts, random) for counts in reached], axis=0) / total
            for _ in range(200)
        ]
        share = sum(counts.sum(axis=0) for counts in reached) / total
        ax.plot(
            places,
            share,
            color=style.colour,
            linestyle=style.dash,
            label=bench_label(method),
        )
        ax.fill_between(
            places,
            *np.quantile(drawn, (0.025, 0.975), axis=0),
            color=style.colour,
            alpha=0.12,
            linewidth=0,
        )
    logarithmic(ax, places)
    spent = _COSTS[by] if by == "seconds" else "candidates per coefficient"
    ax.set(ylim=(0, 1), xlabel=spent, ylabel="share of targets reached")
    ax.grid(alpha=0.25)
    figure.legend(loc="outside right center", fontsize=8, frameon=False)
    return figure


def _looks_of(methods: Sequence[str]) -> list[Look]:
    """Looks of methods: the first by the gradient is a plan's, the first other one a search's."""
    return looks(["search" if derivative_free(method) else "plan" for method in methods])


def _drawn_again(counts: NDArray[np.int64], random: np.random.Generator) -> NDArray[np.int64]:
    """Sum over the runs of a problem, a row each, drawn again with replacement."""
    runs = random.integers(0, len(counts), len(counts))
    return counts[runs].sum(axis=0)


def ranks_figure(ranking: Ranking) -> Figure:
    """Critical differences: mean ranks; a bar joins methods that do not differ significantly."""
    import pandas as pd
    from scikit_posthocs import critical_difference_diagram

    ranks = pd.Series(ranking.ranks, index=[bench_label(method) for method in ranking.methods])
    apart = np.abs(np.subtract.outer(ranks.to_numpy(), ranks.to_numpy())) > ranking.critical
    p_values = pd.DataFrame(
        np.where(apart, ALPHA / 2, 1.0),
        index=ranks.index,
        columns=ranks.index,
    )
    figure = new_figure(8.0, 0.28 * len(ranks) + 1.2)
    with warnings.catch_warnings():  # it warns of its own use of pandas
        warnings.simplefilter("ignore")
        critical_difference_diagram(
            ranks,
            p_values,
            ax=figure.subplots(),
            label_props={"size": 8},
            color_palette={
                bench_label(method): (SEARCH if derivative_free(method) else PLAN).colour
                for method in ranking.methods
            },
        )
    return figure
