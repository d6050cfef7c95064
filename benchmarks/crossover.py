"""When does a metaheuristic win? The runs behind docs/results, and its page.

    python benchmarks/crossover.py FOLDER [--workers N] [--axis centre ...] [--part 1/4]
    python benchmarks/crossover.py FOLDER --plan
    python benchmarks/crossover.py FOLDER --tune gde3 [--trials 100] [--budget 5000]
    python benchmarks/crossover.py FOLDER --landscapes
    python benchmarks/crossover.py FOLDER --page docs/results

Goes on where it stopped, also on a new machine: runs that docs/results/runs has are not run again.
Every run is a file of FOLDER; what a page needs of it becomes a row of docs/results/runs/AXIS.csv.gz
after each batch.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

RESULTS = Path(__file__).parents[1] / "docs" / "results"


def main(arguments: list[str] | None = None) -> int:
    """Run what is missing, print the plan, or write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--scheduler", help="address of a Dask scheduler, as tcp://host:8786")
    parser.add_argument("--part", default="1/1", help="which part of how many, as 2/4")
    parser.add_argument("--axis", nargs="*", default=[], help="only these")
    parser.add_argument("--rounds", type=int, default=15, help="only so many seeds")
    parser.add_argument("--results", type=Path, default=RESULTS, help="where rows are kept")
    parser.add_argument("--plan", action="store_true", help="count jobs and hours, run nothing")
    parser.add_argument("--tune", nargs="*", default=[], help="methods whose settings are sought")
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--budget", type=int, default=5_000, help="candidates of a trial")
    parser.add_argument("--landscapes", action="store_true", help="features of the problems")
    parser.add_argument("--page", action="store_true", help="write the page of what is there")
    given = parser.parse_args(arguments)

    from parts.crossover.problems import read_moves
    from parts.crossover.run import describe, part_of, print_plan, run

    if given.plan:
        print_plan(given.results)
        return 0
    if given.landscapes:
        describe(given.folder, given.results)
        return 0
    if given.page:
        from parts.crossover.page import write_page

        write_page(given.results)
        return 0
    if given.tune:
        from parts.crossover.tuning import tune

        moves = read_moves(given.results / "moves.csv")
        table = given.results / "tuning.csv"
        for method in given.tune:
            tune(method, moves, given.budget, given.trials, given.folder, table)
        return 0
    return run(
        given.folder,
        given.results,
        workers=given.scheduler or given.workers,
        part=part_of(given.part),
        axes=given.axis,
        most_rounds=given.rounds,
    )


if __name__ == "__main__":
    sys.exit(main())
