"""Gaps after a time on many cores, where every evaluation takes as long."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .experiment import BUDGETS, DIFFERENCES
from .gaps import Results
from .runs import Array, rows_of
from .significance import add_holm, signed_ranks

CORES = 100
TIMES = {1: (100, 1_000, 10_000), CORES: (10, 30, 100, 250)}
"""By cores: times, in evaluations that follow one another."""


def parallel_figures(results: Results, folder: Path) -> dict[str, Any]:
    """Return the gaps after a time on many cores, where every evaluation takes as long.

    A call for so many candidates takes as many evaluations one after another as there are rounds
    of all cores. A run counts as it stood at its last mark before: 10,000 candidates, then
    100,000. SLSQP from random starts has as many of them side by side as cores are enough for, and
    is taken from a run of one after another.
    """
    rows = rows_of(folder / "batches.csv")
    if not rows:
        return {}
    rates = defaultdict[str, list[float]](list)
    calls = defaultdict[str, list[float]](list)
    for row in rows:
        label = f"{row['method']} {row['settings']}".strip()
        rates[label].append(candidates_a_time(row, "continuation=False" in label))
        calls[label].append(int(row["candidates"]) / int(row["calls"]))
    candidates = {label: float(np.median(values)) for label, values in rates.items()}
    long_runs = {run.problem for run in results.runs if run.axis == "large"}
    problems = [name for name in results.problems() if name in long_runs]
    return {
        "moves": len(problems),
        "candidates": candidates,
        "per_call": {label: float(np.median(values)) for label, values in calls.items()},
        "times": {
            f"{cores}, {time}": {
                "cores": cores,
                "time": time,
                "rows": rows_after(results, problems, candidates, cores, time),
            }
            for cores, times in TIMES.items()
            for time in times
        },
    }


def candidates_a_time(row: Mapping[str, str], side_by_side: bool) -> float:
    """Candidates of a run in the time of one evaluation, on all cores.

    Where its starts can be side by side, as many are as cores are enough for.
    """
    starts = CORES // int(row["largest_call"]) if side_by_side else 1
    return starts * (int(row["candidates"]) / int(row[f"time_on_{CORES}_cores"]))


def rows_after(
    results: Results,
    problems: Sequence[str],
    candidates: Mapping[str, float],
    cores: int,
    time: int,
) -> list[dict[str, Any]]:
    """The methods after a time; without those whose runs are too short for it."""
    gaps = dict[str, Array]()
    for label, rate in candidates.items():
        afforded = time * (rate if cores > 1 else 1.0)
        values = np.array([gap_after(results, name, label, afforded) for name in problems])
        if np.isfinite(values).all():
            gaps[label] = values
    return against_best_differences(gaps)


def against_best_differences(gaps: Mapping[str, Array]) -> list[dict[str, Any]]:
    """Medians over moves, and each search against the way of SLSQP with the smaller median."""
    ways = [label for label in gaps if label.startswith(DIFFERENCES)]
    rival = min(ways, key=lambda label: float(np.median(gaps[label])))
    rows = [
        {
            "method": label,
            "missing": float(np.median(values)),
            "better": int((values < gaps[rival]).sum()),
            "p": float("nan") if label in ways else signed_ranks(values - gaps[rival]),
        }
        for label, values in gaps.items()
    ]
    add_holm(rows)
    return rows


def gap_after(results: Results, problem: str, label: str, candidates: float) -> float:
    """Gap of 50 points when a method has asked for so many candidates [%], median over seeds.

    NaN where no run is long enough, but for a run of 100,000, which is as long as any.
    """
    for budget in (10_000, 100_000):
        runs = results.of(label, budget, problem)
        if runs and (candidates <= budget or budget == BUDGETS[-1]):
            areas = [run.marks[run.marks[:, 0] <= candidates, 2] for run in runs]
            last = [reached[-1] if len(reached) else 0.0 for reached in areas]
            return float(np.median([100 * (1 - area / results.whole[problem]) for area in last]))
    return float("nan")
