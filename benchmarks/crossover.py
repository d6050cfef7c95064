"""When does a metaheuristic win? The runs behind docs/results, and its page.

    python benchmarks/crossover.py FOLDER [--workers N] [--part 1/4] [--axis centre]
    python benchmarks/crossover.py FOLDER --deciding centre limits --of-plant 2
    python benchmarks/crossover.py FOLDER --plan
    python benchmarks/crossover.py FOLDER --tune slsqp [--cell jumps] [--trials 100]
    python benchmarks/crossover.py FOLDER --landscapes
    python benchmarks/crossover.py FOLDER --batches
    python benchmarks/crossover.py FOLDER --page

Goes on where it stopped, on a new machine, too: what docs/results/runs has is not run again. A run
is a file of FOLDER; what the page needs of it becomes a row of docs/results/runs/AXIS.csv.xz after
every batch. With --part the tables are those of --results, a folder of each part's own: copy
docs/results there before, and bring the rows together with --merge OTHER after.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

RESULTS = Path(__file__).parents[1] / "docs" / "results"


def parser() -> argparse.ArgumentParser:
    """Return the parser of what may be typed."""
    arguments = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--workers", type=int, default=1)
    arguments.add_argument("--scheduler", help="address of a Dask scheduler, as tcp://host:8786")
    arguments.add_argument("--part", default="1/1", help="which part of how many, as 2/4")
    arguments.add_argument("--axis", nargs="*", default=[], help="only these")
    arguments.add_argument("--methods", nargs="*", default=[], help="only these")
    arguments.add_argument(
        "--candidates", nargs="*", type=int, default=[], help="only runs of so many"
    )
    arguments.add_argument(
        "--deciding", nargs="*", help="only runs on which a row of the report rests, by its name"
    )
    arguments.add_argument("--of-plant", type=int, help="only so many moves of each plant")
    arguments.add_argument("--rounds", type=int, default=15, help="only so many seeds")
    arguments.add_argument("--from-round", type=int, default=0, help="only seeds from this one on")
    arguments.add_argument("--results", type=Path, default=RESULTS, help="where rows are kept")
    arguments.add_argument("--plan", action="store_true", help="count jobs and hours, run nothing")
    arguments.add_argument(
        "--tune", nargs="*", default=[], help="methods whose settings are sought"
    )
    arguments.add_argument("--trials", type=int, default=100)
    arguments.add_argument("--cell", default="centre", help="where settings are tuned")
    arguments.add_argument("--landscapes", action="store_true", help="features of the problems")
    arguments.add_argument("--batches", action="store_true", help="candidates asked for at once")
    arguments.add_argument("--page", action="store_true", help="write the page of what is there")
    arguments.add_argument("--merge", type=Path, help="results whose rows are added to these")
    return arguments


def main(typed: list[str] | None = None) -> int:
    """Run what is missing, or what else is asked for."""
    options = parser().parse_args(typed)

    from parts.crossover.deciding import refuse_rows
    from parts.crossover.problems import read_moves
    from parts.crossover.run import describe, merge, part_of, print_plan, refuse_axes
    from parts.crossover.tuned_cells import refuse_cell

    try:
        part = part_of(options.part)
        refuse_axes(options.axis)
        refuse_rows(options.deciding or ())
        refuse_cell(options.cell)
    except ValueError as error:
        parser().error(str(error))
    if options.plan:
        print_plan(options.results)
    elif options.merge:
        merge(options.results, options.merge)
    elif options.landscapes:
        describe(options.folder, options.results)
    elif options.batches:
        from parts.crossover.batches import write_batches

        write_batches(read_moves(options.results / "moves.csv"), options.results / "batches.csv")
    elif options.page:
        from parts.crossover.page import write_page

        write_page(options.results)
    elif options.tune:
        from parts.crossover.limits import OF_TUNING, write_limits
        from parts.crossover.tuning import tune

        moves = read_moves(options.results / "moves.csv")
        if options.cell.startswith("limits") and not OF_TUNING.exists():
            write_limits([move for move in moves if move.tuning], OF_TUNING)
        table = options.results / "tuning.csv"
        for method in options.tune:
            tune(method, options.cell, moves, options.trials, options.folder, table)
    else:
        return run_missing(options, part)
    return 0


def run_missing(options: argparse.Namespace, part: tuple[int, int]) -> int:
    """Run what is missing of the plan; 1 where some jobs failed."""
    from parts.crossover.deciding import rows_of
    from parts.crossover.run import missing_of, run_jobs_of

    missing = missing_of(
        options.results,
        part,
        options.axis,
        range(options.from_round, options.rounds),
        options.methods,
        options.candidates,
        options.of_plant,
        rows_of(options.deciding),
    )
    workers = options.scheduler or options.workers
    return int(run_jobs_of(missing, options.folder, options.results, workers) > 0)


if __name__ == "__main__":
    sys.exit(main())
