"""Methods with 300 candidates on a black box: MuJoCo with dry friction, backlash and a post.

    python benchmarks/simulator.py [--seeds 3] [--results docs/results]

Three problems (`parts/simulated_arm.py`), and each method from the same seeds. A run is a row of
black_box.csv as soon as it is done, and the same line goes on after a stop. The appendix has a
table of it, by docs/results/recompute.py. TPE is Optuna's, and is left out where that is missing.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import moocore
import numpy as np
from numpy.typing import NDArray
from parts.simulated_arm import ARMS, SimulatedArm

import quietarm as qa

Array = NDArray[np.float64]
RESULTS = Path(__file__).parents[1] / "docs" / "results"
COLUMNS = ("problem", "method", "candidates", "seed", "seconds", "residuals_mm", "energies_mJ")
BUDGET = 300
LONG, LONG_SEED = 2_000, 100
"""Candidates of a longer search, from a seed of its own: what is best known is better for it."""
METHODS = ("slsqp", "slsqp step=0.01", "es", "gp", "moead-de", "gde3", "nsga2", "random")
TPE = "tpe"


def searched(arm: SimulatedArm, method: str, seed: int, candidates: int) -> Array:
    """The points of a search of quietarm that keep the constraints."""
    name, _, setting = method.partition(" step=")
    lower, upper = arm.box
    front = qa.search(
        arm, lower=lower, upper=upper, algorithm=name, evaluations=candidates, seed=seed,
        settings={"step": float(setting)} if setting else None,
    )  # fmt: skip
    return np.array([[point.residual, point.energy] for point in front.points]).reshape(-1, 2)


def by_tpe(arm: SimulatedArm, method: str, seed: int, candidates: int) -> Array:
    """The points of Optuna's tree-structured Parzen estimator that keep the constraints."""
    import optuna

    warnings.simplefilter("ignore", FutureWarning)  # constraints of Optuna 4 are called so
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    limits = dict[int, list[float]]()
    sampler = optuna.samplers.TPESampler(
        seed=seed, multivariate=True,
        constraints_func=(lambda trial: limits[trial.number]) if arm.crosses else None,
    )  # fmt: skip
    study = optuna.create_study(directions=["minimize"] * 2, sampler=sampler)
    points = list[Array]()
    for _ in range(candidates):
        trial = study.ask()
        row = [
            trial.suggest_float(f"a{i}", *ends) for i, ends in enumerate(zip(*arm.box, strict=True))
        ]
        values = arm(np.array([row]))
        objectives, violations = values if arm.crosses else (values, np.zeros((1, 0)))
        limits[trial.number] = violations[0].tolist()
        study.tell(trial, objectives[0].tolist())
        if (violations <= 0).all():
            points.append(objectives[0])
    found = np.array(points).reshape(-1, 2)
    return found[moocore.is_nondominated(found)] if len(found) else found


Way = Callable[[SimulatedArm, str, int, int], Array]


def planned(seeds: int) -> Iterator[tuple[SimulatedArm, str, int, int, Way]]:
    """All runs: one seed after another, and a longer search of each problem first."""
    for arm in ARMS:
        yield arm, "moead-de", LONG_SEED, LONG, searched
    for seed in range(seeds):
        for arm in ARMS:
            for method in METHODS:
                yield arm, method, seed, BUDGET, searched
            if has_optuna():
                yield arm, TPE, seed, BUDGET, by_tpe


def has_optuna() -> bool:
    """Return whether Optuna can be imported."""
    from importlib.util import find_spec

    return find_spec("optuna") is not None


def run(seeds: int, path: Path) -> None:
    """Run what is missing in a table, and add each run as a row."""
    done = set[tuple[str, ...]]()
    if path.exists():
        with path.open(newline="") as file:
            done = {tuple(row[name] for name in COLUMNS[:4]) for row in csv.DictReader(file)}
    else:
        path.write_text(",".join(COLUMNS) + "\n")
    for arm, method, seed, candidates, way in planned(seeds):
        key = (arm.name, method, str(candidates), str(seed))
        if key in done:
            continue
        began = time.process_time()
        points = way(arm, method, seed, candidates)
        seconds = time.process_time() - began
        residuals, energies = (1e3 * points[np.argsort(points[:, 0])]).T
        with path.open("a", newline="") as file:
            csv.writer(file, lineterminator="\n").writerow(
                [*key, f"{seconds:.3g}", _words(residuals), _words(energies)]
            )
        print(*key, f"{seconds:.3g} s", flush=True)


def _words(values: Array) -> str:
    return " ".join(f"{value:.6g}" for value in values)


def main() -> int:
    """Run what is missing."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--results", type=Path, default=RESULTS)
    options = parser.parse_args()
    run(options.seeds, options.results / "black_box.csv")
    return 0


if __name__ == "__main__":
    sys.exit(main())
