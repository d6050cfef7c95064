"""Figures of problems with several basins, from basins.csv.xz and basins_optima.csv.

A gap is the share of the best known hypervolume that the points of a front lack [%]; the best known
points are those of all runs of a problem together, and the scale goes from their least to their
largest values.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import moocore
import numpy as np

from .areas import gaps_to_best
from .runs import Array, numbers, rows_of
from .significance import holm, signed_ranks

LEAST_SEEDS = 2
"""Runs of every problem without which a method is in no table."""
GRADIENT = "gradient"
ALL_STARTS = "gradient, all starts"
DIFFERENCES = ("slsqp", "slsqp random starts")
CLEARLY = 0.1
"""Per cent by which a median has to be smaller to count."""
TWENTY = "(1+1)-ES of twenty lines"
OUTSIDE = ("COBYQA", "Py-BOBYQA", "DMulti-MADS", "COMO-CMA-ES")
FAMILIES = {
    "posts": "posts-",
    "simulated": "simulated-post-4",
    "anecdotes": "simulated-",
    "named": "named ",
    "limits": "",
}
"""What the names of their problems begin with; anecdotes have one seed and are left out."""
Gaps = Mapping[tuple[str, int], Mapping[str, Sequence[float]]]
"""By method and candidates, then by problem: a gap for each seed."""
Seconds = Mapping[tuple[str, int], Sequence[float]]
"""By method and candidates: processor time of every run."""


@dataclass(frozen=True)
class BasinsRun:
    """A row of the table."""

    problem: str
    method: str
    candidates: int
    seed: int
    seconds: float
    points: Array


def basins_figures(folder: Path) -> dict[str, Any]:
    """All figures, by family and candidates; and the optima of the problems between posts."""
    rows = read(folder / "basins.csv.xz")
    runs = with_all_starts(rows)
    hours = sum(run.seconds for run in runs) / 3600
    figures: dict[str, Any] = {"runs": len(rows), "hours": hours}
    for family in FAMILIES:
        of_family = [run for run in runs if family_of(run.problem) == family]
        if not of_family or family == "anecdotes":
            continue
        gaps, seconds = gaps_of(of_family)
        budgets = sorted({run.candidates for run in of_family} - {0})
        cells = [cell(gaps, seconds, budget) for budget in budgets]
        figures[family] = {
            "problems": len({run.problem for run in of_family}),
            "cells": [one for one in cells if one],
            "gradient": table(gaps, seconds, 0),
        }
    figures["optima"] = optima(folder / "basins_optima.csv")
    return figures


def read(path: Path) -> list[BasinsRun]:
    """The runs of the table; none where it is missing. Of two rows of a run the last counts."""
    rows = {tuple(row.values())[:4]: row for row in rows_of(path)}
    return [
        BasinsRun(
            row["problem"],
            row["method"],
            int(row["candidates"] or 0),
            int(row["seed"]),
            float(row["seconds"]),
            np.column_stack([numbers(row["residuals_mm"]), numbers(row["energies_J"])]),
        )
        for row in rows.values()
    ]


def family_of(problem: str) -> str:
    """The family of a problem by its name."""
    return next(name for name, begin in FAMILIES.items() if problem.startswith(begin))


def with_all_starts(runs: Sequence[BasinsRun]) -> list[BasinsRun]:
    """The gradient's fronts from single starts, and of each problem the one of all together."""
    starts = defaultdict[str, list[BasinsRun]](list)
    for run in runs:
        if run.method == GRADIENT:
            starts[run.problem].append(run)
    together = [
        BasinsRun(
            problem, ALL_STARTS, 0, 0, sum(run.seconds for run in of_problem),
            even(np.vstack([run.points for run in of_problem])),
        )
        for problem, of_problem in starts.items()
    ]  # fmt: skip
    return [*runs, *together]


def even(points: Array, most: int = 50) -> Array:
    """At most so many points of a front, at even distances along it."""
    front = moocore.filter_dominated(points)
    front = front[np.argsort(front[:, 0])]
    if len(front) <= most:
        return front
    steps = np.diff(front / np.ptp(front, axis=0), axis=0)
    along = np.append(0.0, np.cumsum(np.hypot(*steps.T)))
    places = np.searchsorted(along, np.linspace(0.0, along[-1], most))
    return front[np.unique(places.clip(0, len(front) - 1))]


def gaps_of(runs: Sequence[BasinsRun]) -> tuple[Gaps, Seconds]:
    """Gaps and seconds."""
    gaps = defaultdict[tuple[str, int], dict[str, list[float]]](lambda: defaultdict(list))
    seconds = defaultdict[tuple[str, int], list[float]](list)
    for problem in sorted({run.problem for run in runs}):
        of_problem = [run for run in runs if run.problem == problem]
        fronts = [run.points for run in of_problem]
        for run, gap in zip(of_problem, gaps_to_best(fronts), strict=True):
            key = run.method, run.candidates
            gaps[key][problem].append(gap)
            seconds[key].append(run.seconds)
    return gaps, seconds


def table(gaps: Gaps, seconds: Seconds, candidates: int) -> list[dict[str, Any]]:
    """A row for every method with so many candidates, the best first."""
    problems = problems_in(gaps)
    rows = list[dict[str, Any]]()
    for (method, budget), of_problem in gaps.items():
        seeds = min(len(of_problem.get(name, ())) for name in problems)
        if budget != candidates or seeds < (LEAST_SEEDS if budget else 1):
            continue
        medians = [float(np.median(values)) for values in of_problem.values()]
        rows.append({
            "method": method,
            "problems": len(medians),
            "seeds": seeds,
            "gap": float(np.median(medians)),
            "least": min(medians),
            "most": max(medians),
            "spread": float(np.median([quartile_range(gap) for gap in of_problem.values()])),
            "seconds": float(np.median(seconds[method, budget])),
        })  # fmt: skip
    return sorted(rows, key=lambda row: row["gap"])


def problems_in(gaps: Mapping[Any, Mapping[str, Sequence[float]]]) -> list[str]:
    """The problems that any method was run on."""
    return sorted({name for of_problem in gaps.values() for name in of_problem})


def quartile_range(values: Sequence[float]) -> float:
    """Return how far the quartiles over seeds are apart."""
    return float(np.ptp(np.quantile(values, [0.25, 0.75])))


def cell(gaps: Gaps, seconds: Seconds, candidates: int) -> dict[str, Any]:
    """The methods with so many candidates, and who is better than whom."""
    rows = table(gaps, seconds, candidates)
    names = [row["method"] for row in rows]
    built_in = [name for name in names if name not in (*OUTSIDE, TWENTY)]
    searches = [name for name in built_in if name not in DIFFERENCES]
    search = best_of(rows, searches)
    slsqp = best_of(rows, DIFFERENCES)
    if not (search and slsqp):
        return {}
    of_budget = {method: of for (method, budget), of in gaps.items() if budget == candidates}
    tests = against_one(of_budget, searches, slsqp["method"])
    own = best_of(rows, built_in)
    return {
        "candidates": candidates,
        "rows": rows,
        "search": search,
        "slsqp": slsqp,
        "own": own,
        "against_slsqp": tests,
        "search_against_slsqp": tests[search["method"]],
        **outside_figures(of_budget, rows, own, built_in),
        **twenty_figures(of_budget, rows, own, built_in),
        "gradient": {
            name: against(of_budget[search["method"]], gaps[name, 0])
            for name in (GRADIENT, ALL_STARTS)
            if (name, 0) in gaps
        },
    }


def best_of(rows: Sequence[dict[str, Any]], methods: Iterable[str]) -> dict[str, Any]:
    """The first row of one of the methods; empty where they have none."""
    return next((row for row in rows if row["method"] in methods), {})


OfMethods = Mapping[str, Mapping[str, Sequence[float]]]
"""Gaps with a number of candidates: by method and problem."""


def outside_figures(
    gaps: OfMethods, rows: Sequence[dict[str, Any]], own: Mapping[str, Any], built_in: Sequence[str]
) -> dict[str, Any]:
    """Libraries from outside against the best method that is built in."""
    known = [row["method"] for row in rows if row["method"] in OUTSIDE]
    return {
        "outside": best_of(rows, OUTSIDE),
        "outside_against_own": against_one(gaps, known, own["method"]),
        "outside_wins": wins(gaps, known, built_in),
    }


def twenty_figures(
    gaps: OfMethods, rows: Sequence[dict[str, Any]], own: Mapping[str, Any], built_in: Sequence[str]
) -> dict[str, Any]:
    """The program of twenty lines against what is built in."""
    twenty = best_of(rows, [TWENTY])
    if not twenty:
        return {
            "twenty": {}, "twenty_against_own": {}, "twenty_wins": [], "beaten_by_twenty": [],
        }  # fmt: skip
    return {
        "twenty": twenty,
        "twenty_against_own": against(gaps[TWENTY], gaps[own["method"]]),
        "twenty_wins": wins(gaps, [TWENTY], built_in),
        "beaten_by_twenty": [
            name for name in built_in if best_of(rows, [name])["gap"] > twenty["gap"]
        ],
    }


def against(
    ours: Mapping[str, Sequence[float]], theirs: Mapping[str, Sequence[float]]
) -> dict[str, Any]:
    """Medians of problems that both have: on how many the first is better, and Wilcoxon's p."""
    problems = [name for name in ours if name in theirs]
    differences = np.array([np.median(ours[name]) - np.median(theirs[name]) for name in problems])
    return {
        "better": int((differences < 0).sum()),
        "of": len(problems),
        "p": signed_ranks(differences) if differences.any() else 1.0,
    }


def against_one(gaps: OfMethods, methods: Iterable[str], rival: str) -> dict[str, dict[str, Any]]:
    """Each of the methods against one of them or another, with Holm's p over all."""
    tests = {name: against(gaps[name], gaps[rival]) for name in methods if name != rival}
    adjusted = holm([test["p"] for test in tests.values()])
    return {
        name: test | {"holm": p} for (name, test), p in zip(tests.items(), adjusted, strict=True)
    }


def wins(gaps: OfMethods, rivals: Sequence[str], built_in: Sequence[str]) -> list[dict[str, Any]]:
    """Problems on which a rival's median is better than those of all methods that are built in."""
    rows = list[dict[str, Any]]()
    for problem in problems_in(gaps) if rivals else ():
        mine = min((float(np.median(gaps[name][problem])), name) for name in built_in)
        theirs = min((float(np.median(gaps[name][problem])), name) for name in rivals)
        if theirs[0] < mine[0] - CLEARLY:
            rows.append({
                "problem": problem, "rival": theirs[1], "gap": theirs[0],
                "built_in": mine[1], "built_in_gap": mine[0],
            })  # fmt: skip
    return rows


def optima(path: Path) -> list[dict[str, Any]]:
    """The family's problems, with their local optima."""
    return [
        {"problem": row["problem"]}
        | {name: float(row[name]) if "." in row[name] else int(row[name]) for name in list(row)[1:]}
        for row in rows_of(path)
    ]
