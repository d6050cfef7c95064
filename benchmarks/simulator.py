"""Methods with 300 candidates on black boxes: MuJoCo with dry friction, backlash and a post.

    python benchmarks/simulator.py [three] [drawn] [drawn-1000] [--seeds 5] [--methods gp slsqp]

Three problems of one machine, and ten drawn machines and moves (`parts/simulated_arm.py`); each
method has the same seeds. A run of the three is a row of black_box.csv as soon as it is done, runs
of the ten are packed in arms.csv.xz every minute, and the same line goes on after a stop. The
appendix has tables of them. TPE is Optuna's, COBYQA a library of its own: each is left out if it
is missing.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import moocore
import numpy as np
from basins import POINTS, add, keys_of, of_function, words_of
from numpy.typing import NDArray
from parts.outside_rivals import RIVALS
from parts.simulated_arm import ARMS, SimulatedArm, drawn

import quietarm as qa
from quietarm.metaheuristics.problems.recorded import BudgetSpentError
from quietarm.metaheuristics.thinning import thinned

Array = NDArray[np.float64]
RESULTS = Path(__file__).parents[1] / "docs" / "results"
COLUMNS = ("problem", "method", "candidates", "seed", "seconds", "residuals_mm", "energies_mJ")
BUDGET = 300
LONG, LONGEST, LONG_SEED = 2_000, 10_000, 100
"""Candidates of longer searches, from a seed of their own: what is best known is better for them.

Only drawn problems have one with `LONGEST`.
"""
METHODS = ("slsqp", "slsqp step=0.01", "es", "gp", "moead-de", "gde3", "nsga2", "random")
SOME, SOME_SEEDS = 1_000, 2
SOME_METHODS = ("slsqp", "slsqp step=0.01", "es", "moead-de", "gde3")
LONG_METHODS = ("moead-de", "gde3")
"""Of the longer searches of drawn problems, in turn."""
TPE, COBYQA = "tpe", "COBYQA"


def searched(arm: SimulatedArm, method: str, seed: int, candidates: int) -> Array:
    """The points of a search of quietarm that keep the constraints."""
    name, _, setting = method.partition(" step=")
    front = qa.search(
        arm, lower=arm.lower, upper=arm.upper, algorithm=name, evaluations=candidates, seed=seed,
        settings={"step": float(setting)} if setting else None,
    )  # fmt: skip
    return np.array([[point.residual, point.energy] for point in front.points]).reshape(-1, 2)


def by_tpe(arm: SimulatedArm, method: str, seed: int, candidates: int) -> Array:
    """The points of Optuna's tree-structured Parzen estimator that keep the constraints."""
    import optuna

    warnings.simplefilter("ignore", FutureWarning)  # constraints of Optuna 4 are called so
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    limits = dict[int, list[float]]()
    box = list(zip(arm.lower, arm.upper, strict=True))
    sampler = optuna.samplers.TPESampler(
        seed=seed, multivariate=True,
        constraints_func=(lambda trial: limits[trial.number]) if arm.post else None,
    )  # fmt: skip
    study = optuna.create_study(directions=["minimize"] * 2, sampler=sampler)
    points = list[Array]()
    for _ in range(candidates):
        trial = study.ask()
        row = [trial.suggest_float(f"a{i}", *ends) for i, ends in enumerate(box)]
        values = arm(np.array([row]))
        objectives, violations = values if arm.post else (values, np.zeros((1, 0)))
        limits[trial.number] = violations[0].tolist()
        study.tell(trial, objectives[0].tolist())
        if (violations <= 0).all():
            points.append(objectives[0])
    found = np.array(points).reshape(-1, 2)
    return found[moocore.is_nondominated(found)] if len(found) else found


def by_cobyqa(arm: SimulatedArm, method: str, seed: int, candidates: int) -> Array:
    """The points of COBYQA that keep the constraints."""
    function = of_function(arm.name, arm).recorded(candidates)
    with suppress(BudgetSpentError):
        RIVALS[method](function, seed, candidates)
    points = function.front(method, seed).points
    return np.array([[point.residual, point.energy] for point in points]).reshape(-1, 2)


Way = Callable[[SimulatedArm, str, int, int], Array]
Planned = tuple[SimulatedArm, str, int, int, Way]


def outside() -> Iterator[tuple[str, Way]]:
    """Methods of other libraries that can be imported."""
    if find_spec("optuna"):
        yield TPE, by_tpe
    if find_spec("cobyqa"):
        yield COBYQA, by_cobyqa


def of_seed(arms: Iterable[SimulatedArm], seed: int) -> Iterator[Planned]:
    """All methods of a seed."""
    for arm in arms:
        for method in METHODS:
            yield arm, method, seed, BUDGET, searched
        for method, way in outside():
            yield arm, method, seed, BUDGET, way


def three_plan(seeds: int) -> Iterator[Planned]:
    """The three problems: one seed after another, and a longer search of each problem first."""
    for arm in ARMS:
        yield arm, "moead-de", LONG_SEED, LONG, searched
    for seed in range(seeds):
        yield from of_seed(ARMS, seed)


def drawn_plan(seeds: int) -> Iterator[Planned]:
    """The ten drawn problems in the same way, with a longest search of each."""
    for place, arm in enumerate(drawn()):
        yield arm, LONG_METHODS[place % 2], LONG_SEED, LONG, searched
        yield arm, LONG_METHODS[0], LONG_SEED, LONGEST, searched
    for seed in range(seeds):
        yield from of_seed(drawn(), seed)


def some_plan(seeds: int) -> Iterator[Planned]:
    """The ten drawn problems with 1,000 candidates, from two seeds at most."""
    for seed in range(min(seeds, SOME_SEEDS)):
        for arm in drawn():
            for method in SOME_METHODS:
                yield arm, method, seed, SOME, searched


def key_of(planned: Planned) -> tuple[str, str, str, str]:
    """Return what tells a run from others."""
    arm, method, seed, candidates, _ = planned
    return arm.name, method, str(candidates), str(seed)


def is_wanted(planned: Planned, methods: Sequence[str]) -> bool:
    """Return whether a run is of one of the methods, with any step; of any if none are given."""
    _, method, *_ = planned
    return not methods or method.partition(" ")[0] in methods


def timed(planned: Planned) -> tuple[str, Array]:
    """Return a run's processor time [s] and its points, by residual."""
    arm, method, seed, candidates, way = planned
    began = time.process_time()
    points = way(arm, method, seed, candidates)
    seconds = f"{time.process_time() - began:.3g}"
    print(*key_of(planned), f"{seconds} s", flush=True)
    return seconds, points[np.argsort(points[:, 0])]


def run_three(seeds: int, methods: Sequence[str], results: Path) -> None:
    """Run what is missing of the three problems, and add each run as a row."""
    path = results / "black_box.csv"
    done = set[tuple[str, ...]]()
    if path.exists():
        with path.open(newline="") as file:
            done = {tuple(row[name] for name in COLUMNS[:4]) for row in csv.DictReader(file)}
    else:
        path.write_text(",".join(COLUMNS) + "\n")
    for planned in three_plan(seeds):
        if key_of(planned) in done or not is_wanted(planned, methods):
            continue
        seconds, points = timed(planned)
        with path.open("a", newline="") as file:
            csv.writer(file, lineterminator="\n").writerow(
                [*key_of(planned), seconds, *words_of(points * 1e3)]
            )


def run_drawn(
    plan: Callable[[int], Iterator[Planned]], seeds: int, methods: Sequence[str], results: Path
) -> None:
    """Run what is missing of the drawn problems; 50 points of each run are kept every minute."""
    path = results / "arms.csv.xz"
    done = keys_of(path)
    rows = list[list[str]]()
    began = time.monotonic()
    for planned in plan(seeds):
        if key_of(planned) in done or not is_wanted(planned, methods):
            continue
        seconds, points = timed(planned)
        points = points[thinned(points, POINTS)] if len(points) else points
        rows.append([*key_of(planned), seconds, *words_of(points * (1e3, 1))])
        if time.monotonic() - began > 60:
            add(rows, path)
            rows = []
            began = time.monotonic()
    if rows:
        add(rows, path)


PLANS: dict[str, Callable[[int, Sequence[str], Path], None]] = {
    "three": run_three,
    "drawn": partial(run_drawn, drawn_plan),
    "drawn-1000": partial(run_drawn, some_plan),
}


def main() -> int:
    """Run what is missing of some plans."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("plans", nargs="*", choices=[*PLANS, []], default=["three", "drawn"])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--methods", nargs="*", default=(), help="only these, with any step")
    parser.add_argument("--results", type=Path, default=RESULTS)
    options = parser.parse_args()
    for name in options.plans:
        PLANS[name](options.seeds, options.methods, options.results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
