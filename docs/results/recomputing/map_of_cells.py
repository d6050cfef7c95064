"""The map: coefficients and budget crossed, a cell by six ways, and by every indicator."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .comparing import Rival, by_label, compare, searches_in
from .experiment import (
    BUDGETS,
    CENTRE,
    CONTROL,
    CONTROL_SETTINGS,
    DIFFERENCES,
    OF_MAP,
    TERMS,
    takes_slopes,
)
from .gaps import INDICATORS, MEASURES, Results
from .runs import Problem, Run
from .significance import LEVEL, holm, least_p


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
            if not rows:
                continue
            best = min(rows, key=lambda row: row["missing"])
            compared = best["moves"] - best["no_control"]
            best["compared"] = compared
            best["least_p_holm"] = least_p(compared) * len(rows)
            best["enough"] = bool(best["least_p_holm"] <= LEVEL)
            best["verdict"] = bool(best["enough"] and best["holm"] <= LEVEL)
            best["no_front"] = 2 * best["no_control"] > best["moves"]
            ways[f"{measure}, {title}"] = best
    return {"terms": terms, "budget": budget, "ways": ways}


def searches_of_cell(
    results: Results, terms: int, budget: int, crossed: Sequence[str]
) -> list[tuple[str, int]]:
    """The searches of a cell of the map that see values alone."""
    return [
        (label, spent)
        for label, spent in searches_in(results, OF_MAP, budget, results.problems(terms), 5)
        if label.partition(" ")[0] in crossed and not takes_slopes(label)
    ]


def by_indicator(results: Results, crossed: Sequence[str]) -> dict[str, dict[str, int]]:
    """The best search of each cell of the map against the gradient to its end, by indicator.

    Comparisons over cells and moves, and cells with a verdict before and after Holm's correction
    over the cells.
    """
    figures = {}
    for indicator in INDICATORS:
        best = list[dict[str, Any]]()
        for budget in BUDGETS:
            for terms in TERMS:
                problems = results.problems(terms)
                searches = searches_of_cell(results, terms, budget, crossed)
                rows = compare(results, problems, searches, indicator, with_intervals=False)
                rows = [row for row in rows if row["moves"]]
                if rows:
                    best.append(min(rows, key=lambda row: row["missing"]))
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


def lines_over(
    results: Results,
    places: Sequence[tuple[float, int, int]],
    methods: Sequence[str],
) -> dict[str, dict[str, dict[str, list[float]]]]:
    """Medians over moves of what methods and the gradient lack, by measure and method.

    A place is where a line goes on, and its coefficients and budget. All places of a line have the
    moves that every one of them has.
    """
    control = f"{CONTROL} {CONTROL_SETTINGS}"
    fewest = 5

    def runs_at(method: str, terms: int, budget: int) -> dict[str, list[Run]]:
        spent = 0 if method == control else budget
        label = usual_label(results, method, spent)
        runs_of = {name: results.of(label, spent, name) for name in results.problems(terms)}
        return {Problem(name).move: runs for name, runs in runs_of.items() if runs}

    table = {
        (method, x): runs_at(method, terms, budget)
        for method in (control, *methods)
        for x, terms, budget in places
    }
    table = {place: by_move for place, by_move in table.items() if len(by_move) >= fewest}
    moves = set.intersection(*map(set, table.values())) if table else set()
    lines: dict[str, dict[str, dict[str, list[float]]]] = {}
    for measure in MEASURES:
        lines[measure] = {}
        for (method, x), by_move in table.items():
            lacks = [results.median(by_move[move], results.gap, measure) for move in moves]
            line = lines[measure].setdefault(method, {"x": [], "y": []})
            line["x"].append(x)
            line["y"].append(max(float(np.median(lacks)), 1e-3))
    return lines


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
