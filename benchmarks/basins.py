"""Searches, SLSQP and the gradient where a problem has several basins, and rivals from outside.

    python benchmarks/basins.py [PLAN ...]

Ten drawn moves between posts (`parts/posts.py`), two black boxes in MuJoCo with a post that crosses
(`parts/simulated_arm.py`), three moves of the map with limits, and five named problems. Runs are
packed in basins.csv.xz as they finish, and the same line goes on after a stop. Rivals need their
libraries (`parts/outside_rivals.py`), and are left out where these are missing.
"""

from __future__ import annotations

import argparse
import csv
import io
import lzma
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from parts.outside_rivals import RIVALS
from rivals import PROBLEMS as NAMED

import quietarm as qa
from quietarm.metaheuristics import problem_of
from quietarm.metaheuristics.problems.given_function import GivenFunction
from quietarm.metaheuristics.problems.recorded import BudgetSpentError, RecordedFunction
from quietarm.metaheuristics.thinning import thinned

Array = NDArray[np.float64]
RESULTS = Path(__file__).parents[1] / "docs" / "results"
COLUMNS = ("problem", "method", "candidates", "seed", "seconds", "residuals_mm", "energies_J")
POINTS = 50
FEW, SOME, MANY = 200, 1_000, 10_000
LONG = 3_000
SEEDS = 10
RANDOM_STARTS = "slsqp random starts"
SMALL = {"population": 20}
"""Of searches with a population that have 1,000 candidates or fewer."""
SETTINGS: dict[str, dict[str, Any]] = {RANDOM_STARTS: {"settings": {"continuation": False}}}
WITH_POPULATION = ("moead-de", "gde3", "nsga2")
METHODS = {
    FEW: ("slsqp", RANDOM_STARTS, "es", "moead-de", "gde3", "nsga2", "random"),
    SOME: ("slsqp", RANDOM_STARTS, "es", "moead-de", "gde3", "nsga2", "mo-cma-es", "random"),
    MANY: ("slsqp", RANDOM_STARTS, "moead-de", "gde3", "nsga2", "mo-cma-es"),
}
"""Methods by candidates; `es` sorts its whole archive, which takes long with many."""
NEEDS = {
    "(1+1)-ES of twenty lines": "numpy", "COBYQA": "cobyqa", "Py-BOBYQA": "pybobyqa",
    "DMulti-MADS": "PyNomad", "COMO-CMA-ES": "comocma",
}  # fmt: skip
TWENTY = "(1+1)-ES of twenty lines"
OUTSIDE = ("COBYQA", "Py-BOBYQA", "DMulti-MADS", "COMO-CMA-ES")
AT_MANY = ("COMO-CMA-ES", "DMulti-MADS", "COBYQA")
MOVES = ("single-link-m4", "arm-on-flexible-link-m3", "dual-link-m3")
"""Of the map: the first tested move of three plants, with tight limits on torque."""


class Subject(NamedTuple):
    """A problem: its name, its function, and how a method of quietarm searches it."""

    name: str
    recorded: Callable[[int], RecordedFunction]
    search: Callable[..., Any]


class Run(NamedTuple):
    """A run of the plan."""

    subject: Subject
    method: str
    candidates: int
    seed: int

    @property
    def key(self) -> tuple[str, str, str, str]:
        """Return the key that tells it from others."""
        return self.subject.name, self.method, str(self.candidates or ""), str(self.seed)


def of_function(name: str, function: Any) -> Subject:
    """A black box as a subject."""
    given = GivenFunction(function, lower=function.lower, upper=function.upper)
    search = partial(qa.search, function, lower=function.lower, upper=function.upper)
    return Subject(name, lambda budget: RecordedFunction(given, budget=budget), search)


@cache
def family() -> dict[str, Any]:
    """The moves between posts by name."""
    from parts.posts import drawn

    return {move.name: move for move in drawn()}


@cache
def of_posts() -> tuple[Subject, ...]:
    """The family as subjects."""
    return tuple(of_function(name, move) for name, move in family().items())


@cache
def of_simulator() -> tuple[Subject, ...]:
    """MuJoCo's arm with a post that crosses, four and eight coefficients."""
    from parts.simulated_arm import CROSSING, SimulatedArm

    arms = [SimulatedArm(f"simulated-post-{terms}", terms, CROSSING) for terms in (4, 8)]
    return tuple(of_function(arm.name, arm) for arm in arms)


@cache
def of_limits() -> tuple[Subject, ...]:
    """Three moves of the map with limits."""
    from parts.crossover.limits import limits_of
    from parts.crossover.problems import read_moves

    subjects = list[Subject]()
    for move in read_moves(RESULTS / "moves.csv"):
        if move.name in MOVES:
            limits = limits_of(move.name, "torque-tight")
            task = qa.PointToPoint(move.plant, move.target, move.duration, **limits)
            profile = qa.CycloidPolynomial(6)
            subjects.append(
                Subject(
                    f"{move.name}-torque-tight",
                    lambda budget, task=task, profile=profile, move=move: RecordedFunction(
                        task, profile, bound=move.bound, budget=budget
                    ),
                    partial(qa.search, task, profile, bound=move.bound),
                )
            )
    return tuple(subjects)


@cache
def of_names() -> tuple[Subject, ...]:
    """The problems of `rivals.py`, known to quietarm by name."""
    return tuple(
        Subject(
            f"named {name}",
            problem_of(name).recorded,
            partial(
                qa.search,
                problem_of(name).task,
                problem_of(name).profile,
                bound=problem_of(name).bound,
            ),
        )
        for name in NAMED
    )


def rivals(names: Iterable[str]) -> list[str]:
    """Return the rivals whose library can be imported."""
    return [name for name in names if find_spec(NEEDS[name])]


def of_seed(
    subjects: Iterable[Subject], budget: int, seed: int, others: Iterable[str] = ()
) -> Iterator[Run]:
    """All methods of a budget from one seed, and rivals."""
    for subject in subjects:
        for method in (*METHODS[budget], TWENTY, *rivals(others)):
            yield Run(subject, method, budget, seed)


def posts_plan() -> Iterator[Run]:
    """The family with few candidates, from ten seeds."""
    for seed in range(SEEDS):
        for budget in (FEW, SOME):
            yield from of_seed(of_posts(), budget, seed)


def many_plan() -> Iterator[Run]:
    """The family with many candidates."""
    for seed in range(SEEDS):
        yield from of_seed(of_posts(), MANY, seed)


def processes_plan() -> Iterator[Run]:
    """Gaussian processes on the family, whose own arithmetic takes long."""
    for seed in range(SEEDS):
        for subject in of_posts():
            yield Run(subject, "gp", FEW, seed)


def rivals_plan(budget: int) -> Iterator[Run]:
    """Other libraries' solvers on the family."""
    for seed in range(SEEDS if budget < MANY else 1):
        for subject in of_posts():
            for method in rivals(OUTSIDE if budget < MANY else AT_MANY):
                yield Run(subject, method, budget, seed)


def simulator_plan() -> Iterator[Run]:
    """The black boxes in MuJoCo: 200 and 1,000 candidates, which take long.

    A longer search of each comes first, so that the best known front is better.
    """
    for subject in of_simulator():
        yield Run(subject, "moead-de", LONG, 100)
        for seed in range(SEEDS):
            yield from of_seed([subject], FEW, seed, OUTSIDE)
            yield Run(subject, "gp", FEW, seed)
    for seed in range(3):
        yield from of_seed(of_simulator(), SOME, seed, OUTSIDE)


def limits_plan() -> Iterator[Run]:
    """Moves of the map with limits; the gradient has no seed there."""
    for subject in of_limits():
        yield Run(subject, "gradient", 0, 0)
    for seed in range(5):
        for budget in (FEW, SOME):
            yield from of_seed(of_limits(), budget, seed, OUTSIDE)
        for subject in of_limits():
            yield Run(subject, "gp", FEW, seed)


def limits_many_plan() -> Iterator[Run]:
    """Moves of the map with limits and many candidates; rivals, which take long, from one seed."""
    for seed in range(3):
        yield from of_seed(of_limits(), MANY, seed)
    for method in rivals(AT_MANY):
        for subject in of_limits():
            yield Run(subject, method, MANY, 0)


def named_plan() -> Iterator[Run]:
    """Problems that quietarm knows by name, against the program of twenty lines."""
    for subject in of_names():
        yield Run(subject, "gradient", 0, 0)
    for seed in range(5):
        for budget in (FEW, SOME):
            yield from of_seed(of_names(), budget, seed)
    for seed in range(3):
        for subject in of_names():
            yield Run(subject, "gp", FEW, seed)
        yield from of_seed(of_names(), MANY, seed)


def gradient_plan() -> Iterator[Run]:
    """One start of the gradient after another."""
    for seed in range(SEEDS):
        for subject in of_posts():
            yield Run(subject, "gradient", 0, seed)


PLANS = {
    "posts": posts_plan,
    "many": many_plan,
    "processes": processes_plan,
    "rivals-200": partial(rivals_plan, FEW),
    "rivals-1000": partial(rivals_plan, SOME),
    "rivals-10000": partial(rivals_plan, MANY),
    "simulator": simulator_plan,
    "limits": limits_plan,
    "limits-10000": limits_many_plan,
    "named": named_plan,
    "gradient": gradient_plan,
}


def points_of(run: Run) -> Array:
    """Residuals [m] and energies [J] of the front of a run."""
    subject, method, candidates, seed = run
    if method == "gradient" and subject.name.startswith("named "):
        return problem_of(subject.name.removeprefix("named ")).reference().front.objective_values
    if method == "gradient" and subject.name not in family():
        front = qa.epsilon_front(*subject.search.args, **subject.search.keywords, points=POINTS)
        return np.array([(point.residual, point.energy) for point in front.points])
    if method == "gradient":
        from parts.posts_gradient import chain

        return chain(family()[subject.name], seed)
    if method in RIVALS:
        function = subject.recorded(candidates)
        with suppress(BudgetSpentError):
            RIVALS[method](function, seed, candidates)
        front = function.front(method, seed)
    else:
        small = SMALL if method in WITH_POPULATION and candidates <= SOME else {}
        front = subject.search(
            algorithm=method.partition(" ")[0], evaluations=candidates, seed=seed,
            **small, **SETTINGS.get(method, {}),
        )  # fmt: skip
    return np.array([(point.residual, point.energy) for point in front.points]).reshape(-1, 2)


def row_of(run: Run) -> list[str]:
    """Carry a run out, as a row."""
    began = time.process_time()
    points = points_of(run)
    seconds = time.process_time() - began
    points = points[thinned(points, POINTS)] if len(points) else points
    print(*run.key, f"{seconds:.3g} s", flush=True)
    return [*run.key, f"{seconds:.3g}", *words_of(points * (1e3, 1))]


def words_of(points: Array) -> list[str]:
    """Return the two cells of a table that hold points."""
    return [" ".join(f"{value:.6g}" for value in column) for column in points.T]


def add(rows: list[list[str]], path: Path) -> None:
    """Add rows to a table, as a stream of their own."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    if not path.exists():
        writer.writerow(COLUMNS)
    writer.writerows(rows)
    with path.open("ab") as file:
        file.write(lzma.compress(text.getvalue().encode()))


def read(path: Path) -> list[dict[str, str]]:
    """The rows of a table; none where it is missing."""
    if not path.exists():
        return []
    with lzma.open(path, "rt", newline="") as file:
        return list(csv.DictReader(file))


def keys_of(path: Path) -> set[tuple[str, ...]]:
    """Return what tells the runs of a table from others."""
    return {tuple(row[column] for column in COLUMNS[:4]) for row in read(path)}


def run_plan(name: str, path: Path, first_seed: int) -> None:
    """Run what is missing of a plan from a seed on; rows are kept after a minute or twenty runs."""
    done = keys_of(path)
    rows = list[list[str]]()
    began = time.monotonic()
    rehearsed = set[str]()
    for run in PLANS[name]():
        if run.key in done or run.seed < first_seed:
            continue
        if name in ("posts", "gradient") and run.subject.name not in rehearsed:
            move = family()[run.subject.name]  # compiled before the clock starts
            move(np.zeros((1, move.size)))
            if name == "gradient":
                move.with_derivatives(np.zeros(move.size))
            rehearsed.add(run.subject.name)
        rows.append(row_of(run))
        if len(rows) >= 20 or time.monotonic() - began > 60:
            add(rows, path)
            done = keys_of(path)  # another process may have added some
            rows = []
            began = time.monotonic()
    if rows:
        add(rows, path)


def count_basins(path: Path) -> None:
    """A table of the family's problems with their local optima."""
    import pandas as pd
    from parts.posts_gradient import basins

    table = pd.read_csv(path) if path.exists() else pd.DataFrame({"problem": []})
    for name, move in family().items():
        if name not in set(table["problem"]):
            row = basins(move)
            print(row, flush=True)
            table = pd.concat([table, pd.DataFrame([row])], ignore_index=True)
            table.to_csv(path, index=False, float_format="%.4g")


def main() -> int:
    """Run what is missing of some plans."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "plans", nargs="*", choices=[*PLANS, "basins", []], default=[*PLANS, "basins"]
    )
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--from-seed", type=int, default=0, help="for processes side by side")
    options = parser.parse_args()
    for name in options.plans:
        if name == "basins":
            count_basins(options.results / "basins_optima.csv")
        else:
            run_plan(name, options.results / "basins.csv.xz", options.from_seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
