"""Kinds of energy: searches against the gradient and against differences."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np

from .comparing import by_label, compare
from .experiment import DIFFERENCES, KINDS, takes_slopes
from .gaps import Results
from .runs import Problem


def kind_figures(results: Results) -> dict[str, Any]:
    """By the kind of energy, on the moves that all kinds have, with motions between."""
    figures = {}
    moves = moves_with_other_kinds(results)
    for kind in KINDS:
        problems = [name for name in results.problems(kind=kind) if Problem(name).move in moves]
        methods = {run.label for run in results.runs if run.axis == "energy" and run.budget}
        searches = [
            (label, 10_000)
            for label in sorted(methods)
            if sum(bool(results.of(label, 10_000, name)) for name in problems) >= 8
        ]
        figures[kind] = compare(results, problems, searches, "between") if problems else []
    return figures


def against_differences(results: Results, crossed: Sequence[str]) -> dict[str, Any]:
    """By the kind of energy, the searches against differences with as many candidates.

    And at the centre against differences whose starts are random; and what differences lack where
    an integer is among the variables, by seed.
    """
    budget = 10_000
    moves = moves_with_other_kinds(results)
    by_kind = {}
    for kind in KINDS:
        problems = [name for name in results.problems(kind=kind) if Problem(name).move in moves]
        searches = [
            (label, budget)
            for label in crossed
            if not takes_slopes(label)
            and sum(bool(results.of(label, budget, name)) for name in problems) >= 8
        ]
        by_kind[kind] = compare(
            results,
            problems,
            searches,
            "between",
            by_label(results, DIFFERENCES, budget),
        )
    random = f"{DIFFERENCES} continuation=False"
    by_seed = defaultdict[int, list[float]](list)
    for name in results.problems(kind="integer"):
        for run in results.of(DIFFERENCES, budget, name):
            by_seed[run.seed].append(results.gap(run, "between"))
    return {
        "kinds": by_kind,
        "random_starts": compare(
            results,
            results.problems(),
            [("moead-de", budget)],
            "between",
            by_label(results, random, budget),
        ),
        "integer_by_seed": [float(np.median(values)) for _, values in sorted(by_seed.items())],
    }


def moves_with_other_kinds(results: Results) -> set[str]:
    """The moves that were run with several kinds of energy."""
    return {Problem(name).move for name in results.whole if Problem(name).kind in KINDS[1:]}
