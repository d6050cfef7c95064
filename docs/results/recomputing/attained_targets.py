"""Targets that runs attain: over processor time, and over candidates per coefficient."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .comparing import searches_in
from .experiment import CENTRE, LIMITS
from .gaps import Results
from .runs import Array

TARGETS = (50, 20, 10, 5, 2, 1)
"""Missing hypervolumes [%] that a run may attain."""
DRAWN = (
    "epsilon points=10", "epsilon points=50", "multistart starts=100", "memetic", "gde3",
    "moead-de", "nsga2", "slsqp",
)  # fmt: skip
"""What the picture of attained targets shows: eight lines at most."""


def attained_figures(
    results: Results, problems: Sequence[str], methods: Sequence[tuple[str, int]]
) -> dict[str, Any]:
    """Shares of targets by method, over processor time up to half a minute."""
    times = np.logspace(-2, 1.5, 36)
    return {
        "seconds": times.tolist(),
        "shares": attained(results, problems, methods, times),
        "drawn": DRAWN,
    }


def attained(results: Results, problems: Sequence[str], labels: Sequence[tuple[str, int]],
             times: Array) -> dict[str, list[float]]:  # fmt: skip
    """Share of targets on all problems that a method has attained, over processor time."""
    shares = {}
    for label, budget in labels:
        reached = np.zeros(len(times))
        total = 0
        for name in problems:
            for run in results.of(label, budget, name):
                lacks = 100 * (1 - run.marks[:, 2] / results.whole[name])
                for target in TARGETS:
                    at = run.marks[lacks <= target, 1]
                    total += 1
                    if len(at):
                        reached += times >= at[0]
        if total:
            shares[label] = [float(share) for share in reached / total]
    return shares


def runtime_profiles(results: Results) -> dict[str, Any]:
    """Share of targets attained over candidates per coefficient, as COCO's runtime profiles.

    Six coefficients and 10,000 candidates, without and with limits. A run's values are those of 50
    points at its marks. Runs are not restarted: one that ends above a target never attains it. The
    best of all is, for each problem and target, the method whose runs need the fewest candidates in
    the median.
    """
    per_coefficient = np.logspace(0, np.log10(10_000 / CENTRE), 61)
    targets = np.logspace(np.log10(50), 0, 51)
    limited = [name for kind in LIMITS for name in results.problems(kind=f"absolute-{kind}")]
    profiles = dict[str, dict[str, list[float]]]()
    problems_of = dict[str, int]()
    for title, axis, problems in (
        ("no limits", "centre", results.problems()),
        ("limits", "limits", limited),
    ):
        labels = [label for label, _ in searches_in(results, (axis,), 10_000, problems, 10)]
        labels = [label for label in labels if "memetic" not in label and "polish" not in label]
        of_all = [name for name in problems if all(results.of(m, 10_000, name) for m in labels)]
        if not (labels and of_all):
            continue
        spent = {label: candidates_to(results, of_all, label, targets) for label in labels}
        spent["best of all"] = np.min([np.median(rows, axis=1) for rows in spent.values()], axis=0)
        problems_of[title] = len(of_all)
        profiles[title] = {
            label: [float((rows <= limit * CENTRE).mean()) for limit in per_coefficient]
            for label, rows in spent.items()
        }
    return {
        "per_coefficient": per_coefficient.tolist(),
        "targets": [float(targets[0]), float(targets[-1]), len(targets)],
        "problems": problems_of,
        "shares": profiles,
    }


def candidates_to(results: Results, problems: Sequence[str], label: str, targets: Array) -> Array:
    """Candidates of a method's runs until each target, shape (problems, runs, targets).

    Infinite where a run never attains it. Of each problem as many runs count as every one has.
    """
    of_problem = [results.of(label, 10_000, name) for name in problems]
    count = min(map(len, of_problem))
    rows = list[list[Array]]()
    for name, runs in zip(problems, of_problem, strict=True):
        rows.append([])
        for run in runs[:count]:
            lacks = 100 * (1 - run.marks[:, 2] / results.whole[name])
            lowest = np.minimum.accumulate(np.append(np.inf, lacks))[1:]
            first = np.searchsorted(-lowest, -targets)
            rows[-1].append(np.append(run.marks[:, 0], np.inf)[first])
    return np.array(rows)
