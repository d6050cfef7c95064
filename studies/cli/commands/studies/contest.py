"""`quietarm contest`: methods with equal evaluations against exact fronts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console

from studies.cli.options import FOLDER, quiet_option, workers_options

if TYPE_CHECKING:
    from metaheuristics.sharing.pieces import Done


@click.command()
@click.argument("problems", nargs=-1, metavar="[PROBLEM]...")
@click.option(
    "--methods", default="nsga2,vepso", show_default=True, metavar="NAME,NAME,...",
    help="Methods, with commas between them: those of quietarm front, as they are or with the "
    "gradient's help (nsga2+polish, nsga2+seeds); multistart is the gradient alone.",
)  # fmt: skip
@click.option("--runs", type=int, default=31, show_default=True, help="Seeds of each method.")
@click.option(
    "--evaluations", type=int, default=20_000, show_default=True, help="Evaluations of each run."
)
@click.option("--seed", type=int, default=0, show_default=True, help="First seed.")
@click.option("--population", type=int, help="Of every method; each method's own by default.")
@click.option(
    "--explain", is_flag=True,
    help="Look for the local minima of each problem as well, and say what the box costs.",
)  # fmt: skip
@click.option(
    "--output", type=FOLDER, required=True,
    help="Folder for the runs and what they say; runs that are there are not done again.",
)  # fmt: skip
@workers_options
@quiet_option
def contest(
    problems: tuple[str, ...],
    methods: str,
    runs: int,
    evaluations: int,
    seed: int,
    population: int | None,
    explain: bool,
    output: Path,
    workers: int,
    scheduler: str | None,
    quiet: bool,
) -> None:
    """Hold methods with equal evaluations against the exact front of each PROBLEM.

    Without PROBLEM, on the six conditions of the paper. Every run is a file in the folder as soon
    as it is done. The same line again goes on after any stop; one with another method adds that
    one's runs. The page, tables and pictures show all that is in the folder.

    \b
    Examples:
      quietarm contest --methods nsga2,vepso --runs 31 --output contest
      quietarm contest single-link-30deg-0.8s --runs 5 --evaluations 5000 --output small
    """  # noqa: D301  # \b is click's: do not rewrap
    from metaheuristics.sharing.workers import Workers
    from ocp import QuietarmError
    from studies.contest.files import report_files
    from studies.contest.measures import arenas_of
    from studies.contest.problems import problems_of
    from studies.contest.runs import Folder
    from studies.contest.statistics import why_none
    from studies.contest.tables import summary_table
    from studies.contest.work import Contest, pieces_of, run_contest
    from studies.display.progress import progress
    from studies.display.saving import Together, finish
    from studies.display.tables import print_table
    from studies.display.words import print_lines
    from studies.runs.files import warn_of_workers

    asked = Contest(
        problems_of(problems), tuple(name.strip() for name in methods.split(",")), runs,
        evaluations, seed, population, explain, Workers(workers, scheduler),
    )  # fmt: skip
    folder, errors = Folder(output), Console(stderr=True)
    pieces = pieces_of(asked, folder)
    warn_of_workers(errors, workers, len(pieces))
    with progress(len(pieces), errors, quiet=quiet) as begin:
        done = run_contest(pieces, folder, asked.workers, begin)
    arenas = arenas_of(folder.runs(), folder.yardsticks(), folder.landscapes())
    if not arenas:
        raise QuietarmError(_why_not_whole(done, len(pieces)) or "no run was done")

    def show(console: Console) -> None:
        for arena in arenas:
            print_lines(console, arena.problem)
            print_table(console, summary_table(arena))
        none = why_none(arenas)
        if none:
            print_lines(console, none)

    trouble = _why_not_whole(done, len(pieces))
    page, *others = report_files(arenas, output)
    finish(
        [page], show, trouble=QuietarmError(trouble) if trouble else None, quiet=quiet,
        together=Together("tables and pictures", output, others),
    )  # fmt: skip


def _why_not_whole(done: Done, pieces: int) -> str:
    """What was not done, and why; empty where all was."""
    failures = [f"{piece}: {error}" for piece, error in done.failures.items()]
    words = [f"{done.stopped}: {len(done.answers)} of {pieces} pieces of work are done; give the "
             "same line again to go on"] if done.stopped else []  # fmt: skip
    if failures:
        more = f"; and {len(failures) - 1} more" if len(failures) > 1 else ""
        words.append(f"{failures[0]}{more}")
    return "; ".join(words)
