"""Ten drawn arms in a simulator, from arms.csv.xz: who is better where only a black box is known.

A gap is the share of the best known hypervolume that the points of a front lack [%]; the best known
points are those of all runs of a problem together, and the scale goes from their least to their
largest values. The method of the report's row is chosen on the first seeds, and fresh ones judge.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import moocore
import numpy as np

from .areas import gaps_to_best, scaled_by_best
from .basins import BasinsRun, read
from .runs import Array
from .significance import add_holm, signed_ranks

FIRST_SEEDS = 2
"""Seeds below choose, the others judge."""
LONG_SEED = 100
"""Of the longer searches, which are in no table: what is best known is better for them."""
EQUAL = 0.5
"""Two gaps that differ by less [percentage points] are equal for practice."""
DIFFERENCES = "slsqp"
OUTSIDE = ("tpe", "COBYQA")
INDICATORS = ("points", "igd+", "epsilon")
NO_POINTS = 1e3
"""Distance [%] of a front without points, by IGD+ and additive epsilon."""
FEW = 300


class Key(NamedTuple):
    """What tells runs of a problem from others."""

    method: str
    candidates: int
    seed: int


Gaps = dict[str, dict[Key, float]]
"""By problem, then by run."""


def gaps_by(runs: Sequence[BasinsRun], indicator: str) -> Gaps:
    """Return how far every front is from the best that is known of its problem [%]."""
    problems = dict.fromkeys(run.problem for run in runs)
    return {
        problem: gaps_of_problem([run for run in runs if run.problem == problem], indicator)
        for problem in problems
    }


def gaps_of_problem(runs: Sequence[BasinsRun], indicator: str) -> dict[Key, float]:
    """Return the gaps of a problem's runs, by an indicator."""
    fronts = [run.points for run in runs]
    gaps = gaps_to_best(fronts) if indicator == "points" else distances_to_best(fronts, indicator)
    keys = [Key(run.method, run.candidates, run.seed) for run in runs]
    return dict(zip(keys, gaps, strict=True))


def distances_to_best(fronts: Sequence[Array], indicator: str) -> list[float]:
    """Return IGD+ or the additive epsilon of every front [% of the problem's scale]."""
    distance = moocore.igd_plus if indicator == "igd+" else moocore.epsilon_additive
    scaled, best = scaled_by_best(fronts)
    return [
        100 * float(distance(points, ref=best)) if len(points) else NO_POINTS for points in scaled
    ]


def medians(gaps: Gaps, method: str, candidates: int, seeds: Iterable[int]) -> dict[str, float]:
    """Return a method's median over seeds, for every problem on which it was run."""
    wanted = {Key(method, candidates, seed) for seed in seeds}
    values = {
        problem: [gap for key, gap in of_problem.items() if key in wanted]
        for problem, of_problem in gaps.items()
    }
    return {problem: float(np.median(known)) for problem, known in values.items() if known}


def against(ours: Mapping[str, float], theirs: Mapping[str, float]) -> dict[str, Any]:
    """Compare two methods on the problems that both have: counts, the difference, Wilcoxon's p."""
    shared = [problem for problem in ours if problem in theirs]
    differences = np.array([ours[problem] - theirs[problem] for problem in shared])
    return {
        "missing": float(np.median([ours[problem] for problem in shared])),
        "control": float(np.median([theirs[problem] for problem in shared])),
        "difference": float(np.median(differences)),
        "better": int((differences < 0).sum()),
        "equal": int((np.abs(differences) < EQUAL).sum()),
        "of": len(shared),
        "p": signed_ranks(differences),
    }


def table(runs: Sequence[BasinsRun], gaps: Gaps, candidates: int) -> list[dict[str, Any]]:
    """Return a row for every method with so many candidates, the best first, against SLSQP.

    The rival is SLSQP with the step of the smaller median gap; p is Holm's over the methods.
    """
    seeds_of = defaultdict[tuple[str, str], set[int]](set)
    seconds_of = defaultdict[str, list[float]](list)
    for run in runs:
        if run.candidates == candidates and run.seed != LONG_SEED:
            seeds_of[run.method, run.problem].add(run.seed)
            seconds_of[run.method].append(run.seconds)
    by_method = {
        method: medians(gaps, method, candidates, range(LONG_SEED)) for method in seconds_of
    }
    typical = {method: float(np.median([*values.values()])) for method, values in by_method.items()}
    order = sorted(typical, key=lambda method: typical[method])
    rival = next((method for method in order if is_slsqp(method)), "")
    rows = [
        {
            "method": method,
            "candidates": candidates,
            "problems": len(by_method[method]),
            "seeds": min(len(seeds_of[method, problem]) for problem in by_method[method]),
            "gap": typical[method],
            "least": min(by_method[method].values()),
            "most": max(by_method[method].values()),
            "seconds": float(np.median(seconds_of[method])),
        }
        for method in order
    ]
    tests = {
        method: against(by_method[method], by_method[rival])
        for method in order
        if rival and not is_slsqp(method)
    }
    add_holm([*tests.values()])
    return [row | against_slsqp(tests.get(row["method"])) for row in rows]


def against_slsqp(test: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return what a row of the table says of a comparison with SLSQP, if there is one."""
    return {name: test[name] for name in ("better", "of", "holm")} if test else {}


def is_slsqp(method: str) -> bool:
    """Return whether a method is finite-difference SLSQP, with any step."""
    return method.partition(" ")[0] == DIFFERENCES


def chosen(gaps: Gaps, methods: Iterable[str]) -> str:
    """Return the method of the least median gap on the first seeds; nothing where none was run."""
    known = {method: medians(gaps, method, FEW, range(FIRST_SEEDS)) for method in methods}
    typical = {
        method: float(np.median([*values.values()])) for method, values in known.items() if values
    }
    return min(typical, key=lambda method: typical[method], default="")


def blocks_of(problem: str) -> tuple[str, str]:
    """Return the blocks of a problem: with or without a post, and its coefficients."""
    terms = "4 coefficients" if "-4-" in problem else "8 coefficients"
    return "post" if "-post-" in problem else "no post", terms


def seeds_of(gaps: Gaps, method: str) -> set[int]:
    """Return the seeds that a method has on every problem."""
    return set.intersection(
        *(
            {key.seed for key in of_problem if (key.method, key.candidates) == (method, FEW)}
            for of_problem in gaps.values()
        )
    )


def judged(gaps_of: Mapping[str, Gaps]) -> dict[str, Any]:
    """The report's row: a search and SLSQP's step, chosen on the first seeds, on fresh ones.

    Fresh are the seeds that both have on every problem; a rival from outside may have fewer.
    """
    gaps = gaps_of["points"]
    methods = sorted(methods_in(gaps) - set(OUTSIDE))
    search = chosen(gaps, [method for method in methods if not is_slsqp(method)])
    rival = chosen(gaps, [method for method in methods if is_slsqp(method)])
    if not (search and rival):
        return {}
    fresh = (seeds_of(gaps, search) & seeds_of(gaps, rival)) - set(range(FIRST_SEEDS))
    if not fresh:
        return {}

    def compared(other: str, indicator: str = "points", block: str = "") -> dict[str, Any]:
        shared = fresh & seeds_of(gaps, other)
        values = [medians(gaps_of[indicator], method, FEW, shared) for method in (search, other)]
        if block:
            values = [in_block(of_method, block) for of_method in values]
        test = against(*values)
        return test | {"seeds": len(shared)}

    blocks = sorted({block for problem in gaps for block in blocks_of(problem)})
    return {
        "search": search,
        "rival": rival,
        **compared(rival),
        "by": {name: compared(rival, name) for name in INDICATORS},
        "blocks": {block: compared(rival, "points", block) for block in blocks},
        "outside": {
            method: compared(method) for method in OUTSIDE if fresh & seeds_of(gaps, method)
        },
    }


def methods_in(gaps: Gaps) -> set[str]:
    """Return the methods that were run with few candidates."""
    keys = [key for of_problem in gaps.values() for key in of_problem]
    return {key.method for key in keys if key.candidates == FEW and key.seed != LONG_SEED}


def in_block(values: Mapping[str, float], block: str) -> dict[str, float]:
    """Return the values of the problems of a block."""
    return {problem: value for problem, value in values.items() if block in blocks_of(problem)}


def of_problems(gaps: Gaps, row: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return each problem's gaps over all seeds: of the row's search and rival, and the best."""
    methods = sorted(methods_in(gaps))
    every = {method: medians(gaps, method, FEW, range(LONG_SEED)) for method in methods}
    rows = list[dict[str, Any]]()
    for problem in sorted(gaps):
        best = min(methods, key=lambda method: every[method].get(problem, np.inf))
        rows.append(
            {
                "problem": problem,
                "post": "post" in blocks_of(problem),
                "search": every[row["search"]][problem],
                "slsqp": every[row["rival"]][problem],
                "best": best,
                "gap": every[best][problem],
            }
        )
    return rows


def arm_figures(folder: Path) -> dict[str, Any]:
    """All figures of the drawn arms; none where the file is missing."""
    runs = read(folder / "arms.csv.xz")
    if not runs:
        return {}
    gaps_of = {indicator: gaps_by(runs, indicator) for indicator in INDICATORS}
    row = judged(gaps_of)
    budgets = sorted({run.candidates for run in runs if run.seed != LONG_SEED})
    return {
        "runs": len(runs),
        "hours": sum(run.seconds for run in runs) / 3600,
        "problems": len(gaps_of["points"]),
        "cells": {str(budget): table(runs, gaps_of["points"], budget) for budget in budgets},
        "judged": row,
        "of_problems": of_problems(gaps_of["points"], row) if row else [],
    }
