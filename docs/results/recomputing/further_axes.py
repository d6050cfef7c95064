"""Further axes: a robust residual, other profiles, integers."""

from __future__ import annotations

from typing import Any

import numpy as np

from .comparing import by_label, compare, searches_in
from .experiment import CENTRE, CONTROL, CONTROL_SETTINGS, DIFFERENCES, takes_slopes
from .gaps import Results
from .runs import Problem

FURTHER = {
    "robust": (CENTRE, "absolute-robust"),
    "polynomial": (10, "absolute"),
    "spline": (10, "absolute-spline"),
    "gaussians": (10, "absolute-gaussians"),
    "terms": (CENTRE, "integer"),
    "shaper": (CENTRE, "shaper"),
}
"""Further axes: coefficients and kind of their problems."""
FURTHER_METHODS = ("moead-de", "gde3", "nsga2", DIFFERENCES)
OF_FURTHER = ("robust", "profiles", "integers", "crossing", "energy")
"""Tables that have their runs."""
IN_TURN = f"{DIFFERENCES} in-turn=True"
"""SLSQP that takes every value of an integer in turn."""


def further_figures(results: Results) -> dict[str, list[dict[str, Any]]]:
    """By further axis: for each budget all methods against the gradient, and searches by rival."""
    figures = dict[str, list[dict[str, Any]]]()
    for axis, (terms, kind) in FURTHER.items():
        problems = [name for name in results.problems(terms, kind) if results.control(name)]
        if axis == "polynomial":  # on the moves of the other families
            moves = {Problem(name).move for name in results.problems(terms, "absolute-spline")}
            problems = [name for name in problems if Problem(name).move in moves]
        figures[axis] = []
        for budget in (1_000, 10_000):
            run_there = [name for name in problems if results.of(DIFFERENCES, budget, name)]
            methods = searches_in(results, OF_FURTHER, budget, run_there, max(len(run_there), 5))
            methods = [pair for pair in methods if pair[0].split()[0] in (*FURTHER_METHODS, "es")]
            if not methods:
                continue
            rival = IN_TURN if (IN_TURN, budget) in methods else DIFFERENCES
            searches = [pair for pair in methods if not takes_slopes(pair[0])]
            figures[axis].append(
                {
                    "budget": budget,
                    "rival": rival,
                    "methods": compare(results, problems, methods, "between"),
                    "differences": compare(
                        results, problems, searches, "between", by_label(results, rival, budget)
                    ),
                }
            )
    return figures


def energy_of_families(results: Results) -> list[dict[str, Any]]:
    """Energy within 1 mm of each family's fronts over that of the polynomial's by the gradient [%].

    Medians over the moves of all families, with as many coefficients; a front without such a
    motion counts as infinite.
    """
    names = {
        family: {
            Problem(name).move: name
            for name in results.problems(*FURTHER[family])
            if results.control(name) and results.of("moead-de", 10_000, name)
        }
        for family in ("polynomial", "spline", "gaussians")
    }
    names = {family: by_move for family, by_move in names.items() if by_move}
    moves = sorted(set.intersection(*(set(by_move) for by_move in names.values())))
    figures = list[dict[str, Any]]()
    for family in names:
        for label, budget in ((f"{CONTROL} {CONTROL_SETTINGS}", 0), ("moead-de", 10_000)):
            ratios = [
                np.median([run.energy if np.isfinite(run.energy) else np.inf for run in runs])
                / results.control(names["polynomial"][move])[0].energy
                for move in moves
                if (runs := results.of(label, budget, names[family][move]))
            ]
            if ratios:
                above = 100 * (float(np.median(ratios)) - 1)
                figures.append(
                    {"family": family, "method": label, "moves": len(ratios), "above": above}
                )
    return figures
