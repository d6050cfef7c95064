"""Further axes: robust residuals, other profiles, integers, and any with a table of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .comparing import by_label, compare, of_values, searches_in
from .experiment import CENTRE, DIFFERENCES, GRADIENT_FRONT
from .gaps import Results, median_energy
from .runs import Problem

FURTHER = {
    "robust": (CENTRE, "absolute-robust"),
    "polynomial": (10, "absolute"),
    "spline": (10, "absolute-spline"),
    "gaussians": (10, "absolute-gaussians"),
    "terms": (CENTRE, "integer"),
    "shaper": (CENTRE, "shaper"),
}
"""Those with a name of their own: coefficients and kind of their problems."""
TABLES = ("robust", "profiles", "integers")
"""Tables that have their runs; those of the polynomial and of an integer are in SHARED as well."""
SHARED = ("crossing", "energy")
OTHER_TABLES = (
    *SHARED, "centre", "few", "large", "limits", "million", "noise", "objectives", "paper", "tuned",
)  # fmt: skip
"""Tables that other files of this folder are about."""
METHODS = ("moead-de", "gde3", "nsga2", "es", DIFFERENCES)
IN_TURN = f"{DIFFERENCES} in-turn=True"
"""SLSQP that takes every value of an integer in turn."""
SEARCH = ("moead-de", 10_000)
"""The search whose energies are compared between families."""


def further_figures(results: Results) -> dict[str, list[dict[str, Any]]]:
    """By further axis: for each budget all methods against the gradient, and searches by rival."""
    tables = {run.axis for run in results.runs} - set(OTHER_TABLES)
    figures = dict[str, list[dict[str, Any]]]()
    for axis, (terms, kind) in further_axes(results).items():
        problems = [name for name in results.problems(terms, kind) if results.control(name)]
        if axis == "polynomial":  # on the moves of the other families
            moves = {Problem(name).move for name in results.problems(terms, "absolute-spline")}
            problems = [name for name in problems if Problem(name).move in moves]
        cells = [
            further_cell(results, (*tables, *SHARED), problems, budget)
            for budget in (1_000, 10_000)
        ]
        figures[axis] = [cell for cell in cells if cell]
    return figures


def further_axes(results: Results) -> dict[str, tuple[int, str]]:
    """Coefficients and kind of every axis: those of FURTHER, and of tables that no file knows.

    An axis without a name of its own is called by its kind and coefficients.
    """
    known = {*TABLES, *OTHER_TABLES}
    names = {run.problem for run in results.runs if run.axis not in known}
    cases = {(Problem(name).terms, Problem(name).kind) for name in names} - {*FURTHER.values()}
    others = {f"{kind}, {terms} coefficients": (terms, kind) for terms, kind in sorted(cases)}
    return FURTHER | others


def further_cell(
    results: Results, tables: Sequence[str], problems: Sequence[str], budget: int
) -> dict[str, Any]:
    """An axis with a budget; nothing where no method was run on the problems of differences."""
    run_there = [name for name in problems if results.of(DIFFERENCES, budget, name)]
    methods = searches_in(results, tables, budget, run_there, max(len(run_there), 5))
    methods = [search for search in methods if search[0].split()[0] in METHODS]
    if not methods:
        return {}
    rival = IN_TURN if (IN_TURN, budget) in methods else DIFFERENCES
    against = by_label(results, rival, budget)
    return {
        "budget": budget,
        "rival": rival,
        "methods": compare(results, problems, methods, "between"),
        "differences": compare(results, problems, of_values(methods), "between", against),
    }


def energy_of_families(results: Results) -> list[dict[str, Any]]:
    """Energy within 1 mm of each family's fronts over that of the polynomial's by the gradient [%].

    Medians over the moves of all families, with as many coefficients; a front without such a
    motion counts as infinite.
    """
    names = {
        family: {
            Problem(name).move: name
            for name in results.problems(*FURTHER[family])
            if results.control(name) and results.of(*SEARCH, name)
        }
        for family in ("polynomial", "spline", "gaussians")
    }
    names = {family: by_move for family, by_move in names.items() if by_move}
    moves = sorted(set.intersection(*(set(by_move) for by_move in names.values())))
    of_polynomial = {
        move: results.control(name)[0].energy for move, name in names["polynomial"].items()
    }
    figures = list[dict[str, Any]]()
    for family, by_move in names.items():
        for method in ((GRADIENT_FRONT, 0), SEARCH):
            ratios = [
                median_energy(runs) / of_polynomial[move]
                for move in moves
                if (runs := results.of(*method, by_move[move]))
            ]
            if ratios:
                above = 100 * (float(np.median(ratios)) - 1)
                figures.append(
                    {"family": family, "method": method[0], "moves": len(ratios), "above": above}
                )
    return figures
