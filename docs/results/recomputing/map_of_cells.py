"""The map: coefficients and budget crossed, a cell by six ways, and by every indicator."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .comparing import LEAST_GAP, Rival, Search, by_label, compare, of_values, searches_in
from .experiment import BUDGETS, CENTRE, DIFFERENCES, GRADIENT_FRONT, OF_MAP, TERMS
from .gaps import INDICATORS, MEASURES, Results
from .runs import Problem, Run
from .significance import LEVEL, holm, least_p

FEWEST_MOVES = 5
"""Moves without which a place of a line is left out."""


def map_figures(results: Results, crossed: Sequence[str]) -> dict[str, Any]:
    """Coefficients and budget crossed, and the lines through the centre."""
    over_terms = [(terms, terms, 10_000) for terms in TERMS]
    over_budgets = [(budget, CENTRE, budget) for budget in BUDGETS]
    return {
        "crossed": list(crossed),
        "map": [cell(results, terms, budget, crossed) for budget in BUDGETS for terms in TERMS],
        "map_rows": {
            "by_terms": lines_over(results, over_terms, crossed),
            "by_budget": lines_over(results, over_budgets, crossed),
        },
    }


def cell(results: Results, terms: int, budget: int, crossed: Sequence[str]) -> dict[str, Any]:
    """A cell of the map: the nearest search against the gradient or differences, in six ways."""
    problems = results.problems(terms)
    searches = searches_of_cell(results, terms, budget, crossed)
    rivals: dict[str, Rival] = {
        "to its end": lambda name, spent: results.control(name),
        "same time": results.control_within,
        "differences": by_label(results, DIFFERENCES, budget),
    }
    ways = {}
    for measure in MEASURES:
        for title, rival in rivals.items():
            rows = compare(results, problems, searches, measure, rival)
            rows = [row for row in rows if row["moves"]]
            if rows:
                ways[f"{measure}, {title}"] = with_verdict(nearest(rows), len(rows))
    return {"terms": terms, "budget": budget, "ways": ways}


def nearest(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The row with the least gap."""
    return min(rows, key=lambda row: row["missing"])


def with_verdict(row: dict[str, Any], searches: int) -> dict[str, Any]:
    """The row of one of so many searches, and whether its moves are enough for a verdict."""
    moves = row["moves"] - row["no_control"]
    least_p_holm = least_p(moves) * searches
    enough = bool(least_p_holm <= LEVEL)
    return row | {
        "compared": moves,
        "least_p_holm": least_p_holm,
        "enough": enough,
        "verdict": bool(enough and row["holm"] <= LEVEL),
        "no_front": 2 * row["no_control"] > row["moves"],
    }


def searches_of_cell(
    results: Results, terms: int, budget: int, crossed: Sequence[str]
) -> list[Search]:
    """The searches of a cell of the map that see values alone."""
    methods = searches_in(results, OF_MAP, budget, results.problems(terms), 5)
    return [search for search in of_values(methods) if search[0].partition(" ")[0] in crossed]


def by_indicator(results: Results, crossed: Sequence[str]) -> dict[str, dict[str, int]]:
    """The best search of each cell of the map against the gradient to its end, by indicator.

    Comparisons over cells and moves, and cells with a verdict before and after Holm's correction
    over the cells.
    """
    figures = {}
    for indicator in INDICATORS:
        best = best_of_cells(results, crossed, indicator)
        over_cells = holm([row["holm"] for row in best])
        verdicts = {"search": 0, "gradient": 0, "search_over_cells": 0, "gradient_over_cells": 0}
        for row, p in zip(best, over_cells, strict=True):
            winner = "search" if row["log_ratio"] < 0 else "gradient"
            verdicts[winner] += row["holm"] <= LEVEL
            verdicts[f"{winner}_over_cells"] += p <= LEVEL
        figures[indicator] = {
            "cells": len(best),
            "comparisons": sum(row["moves"] for row in best),
            "search_better": sum(row["moves_nearer"] for row in best),
            **{name: int(count) for name, count in verdicts.items()},
        }
    return figures


def best_of_cells(results: Results, crossed: Sequence[str], indicator: str) -> list[dict[str, Any]]:
    """The search with the least gap of each cell of the map, by an indicator."""
    best = list[dict[str, Any]]()
    for budget in BUDGETS:
        for terms in TERMS:
            problems = results.problems(terms)
            searches = searches_of_cell(results, terms, budget, crossed)
            rows = compare(results, problems, searches, indicator, with_intervals=False)
            rows = [row for row in rows if row["moves"]]
            if rows:
                best.append(nearest(rows))
    return best


def lines_over(
    results: Results,
    places: Sequence[tuple[float, int, int]],
    methods: Sequence[str],
) -> dict[str, dict[str, dict[str, list[float]]]]:
    """Medians over moves of what methods and the gradient lack, by measure and method.

    A place is where a line goes on, and its coefficients and budget. All places of a line have the
    moves that every one of them has.
    """
    table = {
        (method, x): runs_at(results, method, terms, 0 if method == GRADIENT_FRONT else budget)
        for method in (GRADIENT_FRONT, *methods)
        for x, terms, budget in places
    }
    table = {place: by_move for place, by_move in table.items() if len(by_move) >= FEWEST_MOVES}
    moves = set.intersection(*map(set, table.values())) if table else set()
    lines: dict[str, dict[str, dict[str, list[float]]]] = {}
    for measure in MEASURES:
        lines[measure] = {}
        for (method, x), by_move in table.items():
            lacks = results.median_gaps([by_move[move] for move in moves], measure)
            line = lines[measure].setdefault(method, {"x": [], "y": []})
            line["x"].append(x)
            line["y"].append(max(float(np.median(lacks)), LEAST_GAP))
    return lines


def runs_at(results: Results, method: str, terms: int, budget: int) -> dict[str, list[Run]]:
    """By move, the runs of a method with its usual settings."""
    label = usual_label(results, method, budget)
    runs_of = {name: results.of(label, budget, name) for name in results.problems(terms)}
    return {Problem(name).move: runs for name, runs in runs_of.items() if runs}


def usual_label(results: Results, method: str, budget: int) -> str:
    """The label by which a method's usual settings stand in the map.

    Where its runs state a population these are the settings with most individuals: smaller ones
    are for few candidates.
    """
    stated = [
        label
        for label, _ in searches_in(results, OF_MAP, budget, list(results.whole), 1)
        if label.startswith(f"{method} population=")
    ]
    return max(stated, key=lambda label: int(label.rpartition("=")[2]), default=method)
