"""The pictures of a bench."""

from __future__ import annotations

import warnings

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from quietarm.studies.bench.results import Results, derivative_free, label_of, quartiles
from quietarm.studies.bench.statistics import ALPHA, Ranking
from quietarm.studies.figures.axes import TITLE, legend_below, logarithmic, new_figure
from quietarm.studies.figures.looks import look

_LEAST = 1e-4
"""Shares below are drawn here: the reference front's own hypervolume is no better known."""
_PROFILE = np.geomspace(1.0, 1e-3, 51)
"""Targets of the running-time profiles: shares of the hypervolume that may be missing."""


def curves_figure(results: Results, by: str = "seconds") -> Figure:
    """Median of what is missing on every problem, over processor time or evaluations."""
    problems = results.problems
    columns = min(3, len(problems))
    figure = new_figure(max(4.2 * columns, 5.5), 3.0 * -(-len(problems) // columns) + 0.8)
    axes = figure.subplots(-(-len(problems) // columns), columns, squeeze=False).ravel()
    methods = [m for m in results.methods if by == "seconds" or derivative_free(m)]
    for ax, problem in zip(axes, problems, strict=False):
        for number, method in enumerate(methods):
            if not results.of(problem.name, method):
                continue
            at, missing = results.missing(problem.name, method, by)
            median = [max(quartiles(column)[1], _LEAST) for column in missing.T]
            own = look(number)
            style = {"color": own.colour, "linestyle": own.dash, "label": label_of(method)}
            marker = {"marker": "o", "markersize": 4} if len(at) <= len(missing) else {}
            ax.plot(at, 100 * np.array(median), drawstyle="steps-post", **style, **marker)
        _logarithmic_in(ax)
        logarithmic(ax, 1 / _LEAST, "y")
        ax.set_ylim(100 * _LEAST, 110)
        ax.set_title(problem.name, **TITLE)
        ax.grid(alpha=0.25)
    for ax in axes[len(problems) :]:
        ax.axis("off")
    words = "processor time [s]" if by == "seconds" else "candidates simulated"
    for ax in axes[max(len(problems) - columns, 0) : len(problems)]:
        ax.set_xlabel(words)
    for ax in axes[: len(problems) : columns]:
        ax.set_ylabel("hypervolume missing [%]")
    legend_below(figure, list(axes), 4 if columns > 1 else 1, 8)
    return figure


def _logarithmic_in(ax: Axes) -> None:
    """Make the axis of costs logarithmic, over what is drawn."""
    drawn = np.concatenate([[], *(np.asarray(line.get_xdata()) for line in ax.lines)])
    positive = drawn[drawn > 0]
    logarithmic(ax, float(positive.max() / positive.min()) if positive.size else 1.0)


def profiles_figure(results: Results) -> Figure:
    """Share of targets on all problems that a method's runs reached, over processor time."""
    figure = new_figure(7.2, 4.4)
    ax = figure.subplots()
    for number, method in enumerate(results.methods):
        hits = [
            results.hits(problem.name, method, float(target))
            for problem in results.problems for target in _PROFILE
            if results.of(problem.name, method)
        ]  # fmt: skip
        times = np.sort(np.concatenate(hits))
        share = np.arange(1, len(times) + 1) / len(times)
        reached = np.isfinite(times)
        own = look(number)
        ax.plot(times[reached], share[reached], drawstyle="steps-post", color=own.colour,
                linestyle=own.dash, label=label_of(method))  # fmt: skip
    _logarithmic_in(ax)
    ax.set(ylim=(0, 1), xlabel="processor time [s]", ylabel="share of targets reached")
    ax.grid(alpha=0.25)
    figure.legend(loc="outside right center", fontsize=8, frameon=False)
    return figure


def ranks_figure(ranking: Ranking) -> Figure:
    """Critical differences: mean ranks; a bar joins methods that the test does not tell apart."""
    import pandas as pd
    from scikit_posthocs import critical_difference_diagram

    names = [label_of(method) for method in ranking.methods]
    ranks = np.array(ranking.ranks)
    apart = np.abs(ranks[:, None] - ranks) > ranking.critical
    p_values = np.where(apart, ALPHA / 2, 1.0)
    figure = new_figure(8.0, 0.28 * len(names) + 1.2)
    with warnings.catch_warnings():  # it warns of its own use of pandas
        warnings.simplefilter("ignore")
        critical_difference_diagram(
            dict(zip(names, ranking.ranks, strict=True)),
            pd.DataFrame(p_values, index=names, columns=names),
            ax=figure.subplots(), label_props={"size": 8},
        )  # fmt: skip
    return figure
