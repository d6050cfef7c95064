"""Methods of the list against programs of twenty lines, at 200, 1,000 and 10,000 candidates.

    python benchmarks/rivals.py [--seeds 3] [--budgets 200,1000,10000]

Each method and each rival searches named problems, two of them within limits, with its default
settings for the budget. Missing hypervolume [%] is against the reference front, of the points that
were found alone. What is done is kept in `results/rivals.csv`, and left out when it runs again.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

import quietarm as qa
from quietarm.metaheuristics import NamedProblem, problem_of
from quietarm.metaheuristics.problems.recorded import BudgetSpentError
from quietarm.metaheuristics.score import HYPERVOLUME

PROBLEMS = (
    "single-link-30deg-0.8s", "arm-on-flexible-link-90deg-0.8s", "single-link-30deg-0.8s-limits",
    "arm-on-flexible-link-90deg-0.8s-limits", "dual-link-90deg-0.9s",
)  # fmt: skip
OF_BUDGET = {
    200: ("gp", "es", "slsqp", "nsga2", "moead-de", "smsemoa", "gde3"),
    1_000: ("gp", "es", "slsqp", "nsga2", "moead-de", "smsemoa", "gde3"),
    10_000: ("es", "slsqp", "nsga2", "moead-de"),
}
"""Methods by the number of candidates: a surrogate takes too long for many."""
RESULTS = Path(__file__).parent / "results" / "rivals.csv"
COLUMNS = ("problem", "budget", "method", "seed", "missing_percent")


def one_plus_one(function: Any, seed: int, budget: int) -> None:
    """Take steps of one length, by the rule of success, from a random member of an archive."""
    random = np.random.default_rng(seed)
    size, step = function.upper - function.lower, 0.2
    x = random.uniform(function.lower, function.upper)
    archive = [(x, *valued(function, x))]
    while True:
        x = archive[random.integers(len(archive))][0]
        x = x + step * size * random.standard_normal(len(x))
        x = np.clip(x, function.lower, function.upper)
        F, violation = valued(function, x)
        if any(beats(*known[1:], F, violation) for known in archive):
            step = max(0.96 * step, 1e-3)
            continue
        archive = [known for known in archive if not beats(F, violation, *known[1:])]
        archive.append((x, F, violation))
        step = min(1.2 * step, 0.5)


def differences(function: Any, seed: int, budget: int) -> None:
    """Add differences of two members to a third, and replace a parent that is not better."""
    random = np.random.default_rng(seed)
    size = len(function.lower)
    X = list(random.uniform(function.lower, function.upper, (max(10, budget // 100), size)))
    values = [valued(function, x) for x in X]
    while True:
        for i in range(len(X)):
            one, two, three = random.choice(len(X), 3, replace=False)
            child = X[one] + 0.5 * (X[two] - X[three])
            child = np.where(random.random(size) < 0.9, child, X[i])
            child = np.clip(child, function.lower, function.upper)
            of_child = valued(function, child)
            if not beats(*values[i], *of_child):
                X[i], values[i] = child, of_child


def annealed(function: Any, seed: int, budget: int) -> None:
    """Walk to the least of a random weighted norm, with steps that shrink; then the next weight."""
    random = np.random.default_rng(seed)
    size = function.upper - function.lower
    scale = np.maximum(valued(function, (function.lower + function.upper) / 2)[0], 1e-9)
    best = random.uniform(function.lower, function.upper)
    while True:
        weight = random.uniform(0.02, 0.98)
        weights = np.array([weight, 1 - weight]) / scale
        least = np.inf
        for step in np.geomspace(0.3, 0.003, max(30, budget // 30)):
            x = best + step * size * random.standard_normal(len(size))
            x = np.clip(x, function.lower, function.upper)
            F, violation = valued(function, x)
            cost = (weights * F).max() + 1e3 * violation
            if cost < least:
                best, least = x, cost


def valued(function: Any, x: Any) -> tuple[Any, float]:
    """Objectives of one candidate, and the sum of what it violates."""
    F, violations = function(x[None])
    return F[0], float(np.maximum(violations, 0.0).sum())


def beats(one: Any, of_one: float, other: Any, of_other: float) -> bool:
    """Return whether one candidate violates less than another, or as much and is as good."""
    return of_one < of_other or (of_one == of_other and bool((one <= other).all()))


RIVALS: dict[str, Callable[..., None]] = {
    "rival: (1+1)-ES": one_plus_one,
    "rival: differential evolution": differences,
    "rival: annealed walks": annealed,
}


def missing(problem: NamedProblem, method: str, seed: int, budget: int) -> float:
    """Run a method or a rival; hypervolume that its points miss, in per cent."""
    if method in RIVALS:
        function = problem.recorded(budget)
        with suppress(BudgetSpentError):
            RIVALS[method](function, seed, budget)
        front = function.front(method, seed)
    else:
        front = qa.search(
            problem.task, problem.profile, bound=problem.bound, algorithm=method,
            evaluations=budget, seed=seed,
        )  # fmt: skip
    return 100 * (1 - problem.reference().score(front.objective_values, HYPERVOLUME))


def done_before() -> dict[tuple[str, int, str, int], float]:
    """Return the hypervolume deficits that the file has."""
    if not RESULTS.exists():
        return {}
    with open(RESULTS, encoding="utf-8") as file:
        return {
            (row["problem"], int(row["budget"]), row["method"], int(row["seed"])): float(
                row["missing_percent"]
            )
            for row in csv.DictReader(file)
        }


def table(known: dict[tuple[str, int, str, int], float]) -> str:
    """Medians over the seeds, a row a method and a column a problem and budget, in Markdown."""
    budgets = sorted({key[1] for key in known})
    lines = list[str]()
    for budget in budgets:
        problems = [name for name in PROBLEMS if any(key[:2] == (name, budget) for key in known)]
        methods = dict.fromkeys([*OF_BUDGET[budget], *RIVALS])
        lines += [f"\n{budget} candidates:\n", f"| method | {' | '.join(problems)} |"]
        lines.append("|---|" + "---:|" * len(problems))
        for method in methods:
            cells = list[str]()
            for name in problems:
                values = [
                    value for key, value in known.items() if key[:3] == (name, budget, method)
                ]
                cells.append(f"{np.median(values):.1f}" if values else "")
            if any(cells):
                lines.append(f"| {method} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Run what is missing, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--budgets", default="200,1000,10000")
    parser.add_argument("--problems", default=",".join(PROBLEMS))
    parser.add_argument("--methods", default="")
    given = parser.parse_args()
    known = done_before()
    for budget in map(int, given.budgets.split(",")):
        for name in given.problems.split(","):
            methods = given.methods.split(",") if given.methods else [*OF_BUDGET[budget], *RIVALS]
            for method in methods:
                for seed in range(given.seeds):
                    key = (name, budget, method, seed)
                    if key in known:
                        continue
                    known[key] = missing(problem_of(name), method, seed, budget)
                    new = not RESULTS.exists()
                    with open(RESULTS, "a", encoding="utf-8", newline="") as file:
                        rows = csv.writer(file, lineterminator="\n")
                        if new:
                            rows.writerow(COLUMNS)
                        rows.writerow([*key, f"{known[key]:.3f}"])
    print(table(known))


if __name__ == "__main__":
    main()
