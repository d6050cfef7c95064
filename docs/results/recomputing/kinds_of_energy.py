"""Kinds of energy: searches against the gradient and against differences."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np

from .comparing import Search, by_label, compare, count_with_runs, of_values
from .experiment import DIFFERENCES, KINDS
from .gaps import Results
from .runs import Problem

BUDGET = 10_000
MOST = 8
"""Problems of a kind without which a method is left out."""


def kind_figures(results: Results) -> dict[str, Any]:
    """By the kind of energy, on the moves that all kinds have, with motions between."""
    figures = {}
    labels = sorted({run.label for run in results.runs if run.axis == "energy" and run.budget})
    for kind in KINDS:
        problems = problems_of_kind(results, kind)
        searches = searches_on_most(results, labels, problems)
        figures[kind] = compare(results, problems, searches, "between") if problems else []
    return figures


def against_differences(results: Results, crossed: Sequence[str]) -> dict[str, Any]:
    """By the kind of energy, the searches against differences with as many candidates.

    And at the centre against differences whose starts are random; and what differences lack where
    an integer is among the variables, by seed.
    """
    rival = by_label(results, DIFFERENCES, BUDGET)
    by_kind = {}
    for kind in KINDS:
        problems = problems_of_kind(results, kind)
        searches = of_values(searches_on_most(results, crossed, problems))
        by_kind[kind] = compare(results, problems, searches, "between", rival)
    random = by_label(results, f"{DIFFERENCES} continuation=False", BUDGET)
    by_seed = defaultdict[int, list[float]](list)
    for name in results.problems(kind="integer"):
        for run in results.of(DIFFERENCES, BUDGET, name):
            by_seed[run.seed].append(results.gap(run, "between"))
    return {
        "kinds": by_kind,
        "random_starts": compare(
            results, results.problems(), [("moead-de", BUDGET)], "between", random
        ),
        "integer_by_seed": [float(np.median(values)) for _, values in sorted(by_seed.items())],
    }


def problems_of_kind(results: Results, kind: str) -> list[str]:
    """The problems of a kind of energy, of the moves that were run with other kinds as well."""
    moves = {Problem(name).move for name in results.whole if Problem(name).kind in KINDS[1:]}
    return [name for name in results.problems(kind=kind) if Problem(name).move in moves]


def searches_on_most(
    results: Results, labels: Sequence[str], problems: Sequence[str]
) -> list[Search]:
    """Those of the methods that were run on most of the ten problems of a kind."""
    searches = [(label, BUDGET) for label in labels]
    return [search for search in searches if count_with_runs(results, search, problems) >= MOST]
