"""Figures of problems with several basins, from basins.csv.xz and basins_optima.csv.

`recompute.py` has them under "basins". A gap is the share of the best known hypervolume that the
points of a front lack [%]; the best known points are those of all runs of a problem together, and
the scale goes from their least to their largest values.
"""

from __future__ import annotations

import csv
import lzma
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from scipy.stats import wilcoxon

Array = NDArray[np.float64]
CORNER = 1.1
LEAST_SEEDS = 2
"""Runs of every problem without which a method is in no table."""
GRADIENT, DIFFERENCES = "gradient", ("slsqp", "slsqp random starts")
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
Gaps = dict[tuple[str, int], dict[str, list[float]]]
"""By method and candidates, then by problem: a gap for each seed."""


@dataclass(frozen=True)
class Run:
    """A row of the table."""

    problem: str
    method: str
    candidates: int
    seed: int
    seconds: float
    points: Array


def read(path: Path) -> list[Run]:
    """The runs of the table; none where it is missing."""
    if not path.exists():
        return []
    with lzma.open(path, "rt", newline="") as file:
        rows = {tuple(row.values())[:4]: row for row in csv.DictReader(file)}
    return [
        Run(
            row["problem"],
            row["method"],
            int(row["candidates"] or 0),
            int(row["seed"]),
            float(row["seconds"]),
            np.column_stack([
                np.array(row[name].split(), dtype=float) for name in ("residuals_mm", "energies_J")
            ]),
        )
        for row in rows.values()
    ]  # fmt: skip


def family_of(problem: str) -> str:
    """The family of a problem by its name."""
    return next(name for name, begin in FAMILIES.items() if problem.startswith(begin))


def area(points: Array) -> float:
    """Return the area that points of a scale dominate, up to the corner."""
    return float(moocore.hypervolume(points, ref=[CORNER] * 2)) if len(points) else 0.0


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


def with_all_starts(runs: Sequence[Run]) -> list[Run]:
    """The gradient's fronts from single starts, and of each problem the one of all together."""
    starts = defaultdict[str, list[Run]](list)
    for run in runs:
        if run.method == GRADIENT:
            starts[run.problem].append(run)
    together = [
        Run(
            problem, f"{GRADIENT}, all starts", 0, 0, sum(run.seconds for run in of_problem),
            even(np.vstack([run.points for run in of_problem])),
        )
        for problem, of_problem in starts.items()
    ]  # fmt: skip
    return [*runs, *together]


def gaps_of(runs: Sequence[Run]) -> tuple[Gaps, dict[tuple[str, int], list[float]]]:
    """Gaps and seconds."""
    gaps: Gaps = defaultdict(lambda: defaultdict(list))
    seconds = defaultdict[tuple[str, int], list[float]](list)
    for problem in sorted({run.problem for run in runs}):
        of_problem = [run for run in runs if run.problem == problem]
        best = moocore.filter_dominated(np.vstack([run.points for run in of_problem]))
        least, extent = best.min(axis=0), np.ptp(best, axis=0)
        whole = area((best - least) / extent)
        for run in of_problem:
            key = run.method, run.candidates
            gaps[key][problem].append(100 * (1 - area((run.points - least) / extent) / whole))
            seconds[key].append(run.seconds)
    return gaps, seconds


def quartile_range(values: Sequence[float]) -> float:
    """Return how far the quartiles over seeds are apart."""
    return float(np.ptp(np.quantile(values, [0.25, 0.75])))


def holm(values: Sequence[float]) -> list[float]:
    """Adjusted p values."""
    adjusted = [1.0] * len(values)
    largest = 0.0
    for rank, place in enumerate(np.argsort(values)):
        largest = max(largest, min(1.0, values[place] * (len(values) - rank)))
        adjusted[place] = largest
    return adjusted


def against(ours: dict[str, list[float]], theirs: dict[str, list[float]]) -> dict[str, Any]:
    """Medians of problems that both have: on how many the first is better, and Wilcoxon's p."""
    problems = [name for name in ours if name in theirs]
    differences = np.array([np.median(ours[name]) - np.median(theirs[name]) for name in problems])
    moved = differences[differences != 0]
    return {
        "better": int((differences < 0).sum()),
        "of": len(problems),
        "p": float(wilcoxon(moved).pvalue) if len(moved) else 1.0,
    }


def table(gaps: Gaps, seconds: Any, candidates: int) -> list[dict[str, Any]]:
    """A row for every method with so many candidates, the best first; against SLSQP."""
    problems = {name for of_problem in gaps.values() for name in of_problem}
    rows = list[dict[str, Any]]()
    for (method, budget), of_problem in gaps.items():
        seeds = min(len(of_problem.get(name, ())) for name in problems)
        if budget != candidates or seeds < (1 if not budget else LEAST_SEEDS):
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


def cell(gaps: Gaps, seconds: Any, candidates: int) -> dict[str, Any]:
    """The methods with so many candidates, and who is better than whom."""
    rows = table(gaps, seconds, candidates)

    def best(is_one: Callable[[str], bool]) -> dict[str, Any]:
        return next((row for row in rows if is_one(row["method"])), {})

    def compared(names: Iterable[str], rival: str) -> dict[str, Any]:
        known = [name for name in names if name != rival]
        results = {name: against(gaps[name, candidates], gaps[rival, candidates]) for name in known}
        adjusted = holm([result["p"] for result in results.values()])
        return {
            name: result | {"holm": p}
            for (name, result), p in zip(results.items(), adjusted, strict=True)
        }

    names = [row["method"] for row in rows]
    built_in = [name for name in names if name not in (*OUTSIDE, TWENTY)]
    searches = [name for name in built_in if name not in DIFFERENCES]
    search = best(lambda name: name in searches)
    slsqp = best(lambda name: name in DIFFERENCES)
    own = best(lambda name: name in built_in)
    outside = best(lambda name: name in OUTSIDE)
    twenty = best(lambda name: name == TWENTY)
    problems = sorted({name for of_problem in gaps.values() for name in of_problem})

    def medians(method: str, problem: str) -> float:
        return float(np.median(gaps[method, candidates][problem]))

    def winners(rivals: Sequence[str]) -> list[dict[str, Any]]:
        """Problems on which a rival's median is better than those of all methods of the list."""
        rows = list[dict[str, Any]]()
        for problem in problems:
            mine = min((medians(name, problem), name) for name in built_in)
            theirs = min((medians(name, problem), name) for name in rivals)
            if theirs[0] < mine[0] - CLEARLY:
                rows.append({
                    "problem": problem, "rival": theirs[1], "gap": theirs[0],
                    "built_in": mine[1], "built_in_gap": mine[0],
                })  # fmt: skip
        return rows

    if not (search and slsqp):
        return {}
    tests = compared(searches, slsqp["method"])
    result: dict[str, Any] = {
        "candidates": candidates,
        "rows": rows,
        "search": search,
        "slsqp": slsqp,
        "own": own,
        "against_slsqp": tests,
        "search_against_slsqp": tests[search["method"]],
        "outside": outside,
        "outside_against_own": {},
        "outside_wins": [],
        "twenty": twenty,
        "twenty_against_own": {},
        "twenty_wins": [],
        "beaten_by_twenty": [],
    }
    known_outside = [name for name in names if name in OUTSIDE]
    if outside:
        result |= {
            "outside_against_own": compared(known_outside, own["method"]),
            "outside_wins": winners(known_outside),
        }
    if twenty:
        result |= {
            "twenty_against_own": against(
                gaps[TWENTY, candidates], gaps[own["method"], candidates]
            ),
            "twenty_wins": winners([TWENTY]),
            "beaten_by_twenty": [
                name for name in built_in if best(lambda m, n=name: m == n)["gap"] > twenty["gap"]
            ],
        }
    result["gradient"] = {
        name: against(gaps[search["method"], candidates], gaps[name, 0])
        for name in (GRADIENT, f"{GRADIENT}, all starts")
        if (name, 0) in gaps
    }
    return result


def optima(path: Path) -> list[dict[str, Any]]:
    """The family's problems, with their local optima."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return [
            {"problem": row["problem"]}
            | {
                name: float(row[name]) if "." in row[name] else int(row[name])
                for name in list(row)[1:]
            }
            for row in csv.DictReader(file)
        ]


def basins_figures(folder: Path) -> dict[str, Any]:
    """All figures, by family and candidates; and the optima of the problems between posts."""
    read_runs = read(folder / "basins.csv.xz")
    runs = with_all_starts(read_runs)
    hours = sum(run.seconds for run in runs) / 3600
    figures: dict[str, Any] = {"runs": len(read_runs), "hours": hours}
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


if __name__ == "__main__":
    import json

    print(json.dumps(basins_figures(Path(__file__).parent), indent=1))
