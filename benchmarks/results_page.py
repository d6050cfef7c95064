"""The runs behind docs/results, and its page: methods of both kinds on independent moves.

    python benchmarks/results_page.py FOLDER [--workers N] [--page docs/results]
    python benchmarks/results_page.py --check docs/results

Goes on where it stopped; about an hour of one core. The page has the histories of all runs beside
it; the second line computes every expected running time from them again. Seven named moves that
share nothing but their plants, and three on which the gradient should have a hard time: Gaussians
and a network as profiles, whose coefficients enter nonlinearly, and an energy in stages, flat in
many places. Their reference fronts are the best of long runs of both kinds.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from functools import partial
from math import pi
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pandas as pd

import quietarm as qa
from quietarm.metaheuristics import (
    Job,
    LostJobsError,
    NamedProblem,
    finished_jobs,
    problem_of,
    run_jobs,
)
from quietarm.metaheuristics.gradient import multistart_front
from quietarm.ocp import CycloidGaussians, CycloidNetwork

MOVES = (
    "single-link-30deg-0.8s", "single-link-90deg-1s", "single-link-90deg-1.1s",
    "arm-on-flexible-link-90deg-0.8s", "arm-on-flexible-link-135deg-1s",
    "arm-on-flexible-link-180deg-1.2s", "dual-link-90deg-0.9s",
)  # fmt: skip
SEARCHES = (
    "nsga2", "nsga2-paper", "vepso", "smsemoa", "spea2", "gde3", "mopso-cd", "cmopso", "agemoea2",
    "nsga3", "random",
)  # fmt: skip
HISTORIES = "histories.csv.gz"
"""Beside the page: what every run lacked at the marks that improve it, and at its end."""
SEEDS, FEW = 15, 3
BUDGET, LARGE = 5_000, 50_000


@dataclass(frozen=True)
class Stages(qa.Energy):
    """Power from a supply that rises in stages: a smooth staircase, flat at every whole stage."""

    name = "stages"
    stage: float = 0.1

    def smooth(self, torque: Any, speed: Any) -> Any:
        """The power [W] with ripple: no slope where it is a whole number of stages."""
        x = ca.sqrt((torque * speed / self.stage) ** 2 + 1e-6)
        return self.stage * (x - ca.sin(2 * pi * x) / (2 * pi))


def hard_tasks() -> dict[str, tuple[qa.PointToPoint, Any, float]]:
    """Task, profile and bound of the moves that are hard for the gradient, by name."""
    link, arm = qa.SingleLinkManipulator(), qa.ArmOnFlexibleLink()
    gaussians, network = CycloidGaussians(3), CycloidNetwork(3)
    return {
        "link-60deg-0.9s-gaussians": (
            qa.PointToPoint(link, pi / 3, 0.9, residual_window=1.0),
            gaussians, gaussians.default_bound,
        ),
        "arm-60deg-0.7s-network": (
            qa.PointToPoint(arm, pi / 3, 0.7, residual_window=1.0), network, network.default_bound,
        ),
        "link-45deg-0.85s-stages": (
            qa.PointToPoint(link, pi / 4, 0.85, residual_window=1.0, energy=Stages()),
            qa.CycloidPolynomial(6), 0.2,
        ),
    }  # fmt: skip


def hard_problem(name: str, folder: Path) -> NamedProblem:
    """A hard move with its reference front, which is found once: the best of both kinds."""
    path = folder / "references" / f"{name}.json"
    task, profile, bound = hard_tasks()[name]
    if not path.exists():
        fronts = [
            qa.search(task, profile, algorithm=method, bound=bound, evaluations=30_000, seed=seed)
            for method in ("gde3", "cmopso") for seed in (1000,)
        ]  # fmt: skip
        for find in (partial(qa.epsilon_front, points=60, starts=12), multistart_front):
            try:
                fronts.append(find(task, profile, bound=bound, seed=1000))
            except qa.QuietarmError as error:
                print(f"{name}: {error}", flush=True)
        fronts += [qa.polish_front(front).front for front in fronts[:2]]
        table = np.vstack([front.coefficients for front in fronts])
        lower, upper = profile.box(bound)
        best = qa.Front.from_coefficients(
            task, np.clip(table, lower, upper), method="the best of both kinds", profile=profile,
            bound=bound,
        )  # fmt: skip
        for front in fronts:
            print(
                name, front.record.method, len(front.points), front.least_energy(1e-3), flush=True
            )
        path.parent.mkdir(parents=True, exist_ok=True)
        best.save(path)
    return NamedProblem.of_front(name, qa.Front.load(path))


def jobs_of(problems: list[Any]) -> list[Job]:
    """Every job, one seed after another."""
    searches = (*SEARCHES, "nsga2+polish", "gde3+polish", "slsqp")
    ipopt = ("epsilon:ipopt", "weighted:ipopt")
    jobs = list[Job]()
    for seed in range(SEEDS):
        for problem in problems:
            own = partial(Job, problem, seed=seed)
            jobs += [own(name, budget=BUDGET) for name in searches]
            jobs += [own(name) for name in ("epsilon", "weighted", "multistart")]
        for problem in problems if FEW <= seed < 2 * FEW else []:  # what takes long, after some
            own = partial(Job, problem, seed=seed - FEW)
            jobs += [own(name, budget=LARGE) for name in ("nsga2", "gde3")]
            if isinstance(problem.profile, qa.CycloidPolynomial):  # others take it minutes a front
                jobs += [own(name, settings={"points": 20}) for name in ipopt]
    return jobs


def check_running_times(page: Path) -> float:
    """The largest relative difference of the page's running times from those of its histories."""
    from quietarm.studies.bench.running_times import read_histories, running_times

    keys = ["problem", "method", "target"]
    published = pd.read_csv(page / "running_times.csv").set_index(keys).sort_index()
    again = running_times(read_histories(page / HISTORIES)).set_index(keys).sort_index()
    if not (published.index.equals(again.index) and published.isna().equals(again.isna())):
        raise ValueError(f"{page} has running times of other runs than its histories")
    return float((published / again - 1).abs().max().max())


def main() -> None:
    """Run what is missing, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--page", type=Path)
    parser.add_argument("--only-page", action="store_true", help="of the runs that are there")
    parser.add_argument("--check", type=Path, help="a page whose running times are checked")
    given = parser.parse_args()
    if given.check:
        print(f"differences are {check_running_times(given.check):.1g} at most")
    if given.folder:
        run(given)


def run(given: argparse.Namespace) -> None:
    """Run the jobs that are missing, and write the page where one is asked for."""
    hard = [hard_problem(name, given.folder) for name in hard_tasks()]
    jobs = jobs_of([*(problem_of(name) for name in MOVES), *hard])

    def report(job: Job, front: qa.Front, done: int, total: int) -> None:
        print(f"{done}/{total} {job.name} {front.record.seconds:.2f} s", flush=True)

    try:
        fronts = (
            finished_jobs(jobs, given.folder) if given.only_page
            else run_jobs(jobs, given.folder, workers=given.workers, report=report)
        )  # fmt: skip
    except LostJobsError as error:
        print(error)
        fronts = error.fronts
    if given.page:
        from quietarm.studies.bench import Results, bench_report

        line = f"python {' '.join(sys.argv)}"
        template = Path(__file__).with_name("results_page.md")
        results = Results.of_jobs(fronts)
        for path, write in bench_report(results, line, template).files(given.page):
            write(path)
        results.write_histories(given.page / HISTORIES)


if __name__ == "__main__":
    main()
