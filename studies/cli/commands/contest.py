"""`quietarm contest`: methods with equal evaluations against exact fronts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from quietarm.studies.cli.options import (
    command,
    family_option,
    latex_option,
    method_settings_option,
    part_option,
    quiet_option,
    settings_by_method,
    terms_option,
    typed,
    typed_line,
    warn_of_workers,
    workers_options,
)
from quietarm.studies.cli.task import own_grid_options
from quietarm.studies.cli.types import FOLDER, OUTPUT, WHOLE
from quietarm.studies.registry.profiles import profile_of
from quietarm.studies.sweep.grid import Grid
from rich.console import Console

if TYPE_CHECKING:
    from quietarm.metaheuristics.sharing.pieces import Done

_FEW = 6
"""Problems of which each has its table on the screen."""


@command()
@click.argument("problems", nargs=-1, metavar="[PROBLEM]... | PLANT")
@own_grid_options
@family_option
@terms_option
@click.option("--bound", type=float,
              help="Largest coefficient on conditions of a PLANT: the box that is searched."
              )  # fmt: skip
@click.option(
    "--methods", default="nsga2,vepso", show_default=True, metavar="NAME,NAME,...",
    help="Methods, with commas between them: those of quietarm front, as they are or with the "
    "gradient's help (nsga2+polish, nsga2+seeds); multistart is the gradient alone.",
)  # fmt: skip
@click.option("--runs", type=WHOLE, default=31, show_default=True, help="Seeds of each method.")
@click.option(
    "--evaluations", type=WHOLE, default=20_000, show_default=True, help="Evaluations of each run."
)
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="First seed.")
@click.option("--population", type=WHOLE, help="Of every method; each method's own by default.")
@method_settings_option(
    "as in --setting nsga2.crossover=0.7, or its population; it takes part beside the same method "
    "with others"
)
@click.option(
    "--import", "given", multiple=True, metavar="[NAME=]PATH",
    help="Results of another tool on the one PROBLEM: a file of coefficients as quietarm import "
    "reads it, or a folder with such a file for each run; may be repeated. Without NAME the method "
    "is called as the file or folder.",
)  # fmt: skip
@click.option(
    "--import-evaluations", type=WHOLE,
    help="Evaluations that each imported run took. Where they are not known, or not as many as "
    "--evaluations, the runs are shown and marked, and left out of the tests.",
)  # fmt: skip
@click.option(
    "--explain", is_flag=True,
    help="Look for the local minima of each problem as well, and say what the box costs.",
)  # fmt: skip
@click.option(
    "--output", type=FOLDER, required=True,
    help="Folder for the runs and what they say; runs that are there are not done again.",
)  # fmt: skip
@click.option(
    "--report", type=FOLDER,
    help="Write what each method misses after parts of the evaluations to this folder, as Markdown "
    "with its pictures and tables.",
)  # fmt: skip
@latex_option
@click.option("--ioh", type=OUTPUT, help="Write the runs as a csv for IOHanalyzer.")
@click.option("--coco", type=FOLDER, help="Write archives as those of COCO to this folder.")
@part_option("run")
@workers_options
@quiet_option
def contest(
    problems: tuple[str, ...],
    grid: Grid | None,
    profile: str,
    terms: int | None,
    bound: float | None,
    methods: str,
    runs: int,
    evaluations: int,
    seed: int,
    population: int | None,
    setting: tuple[tuple[str, str], ...],
    given: tuple[str, ...],
    import_evaluations: int | None,
    explain: bool,
    output: Path,
    report: Path | None,
    latex: Path | None,
    ioh: Path | None,
    coco: Path | None,
    part: tuple[int, int],
    workers: int,
    scheduler: str | None,
    quiet: bool,
) -> None:
    """Hold methods with equal evaluations against the exact front of each PROBLEM.

    Without PROBLEM, on the six conditions of the paper, with `all` on every named problem that has
    two objectives; on conditions of your own where a PLANT
    with --target and --duration is given: these, --start and --set may be axes, from:to:step or a
    list with commas. Every run is a file in the folder as soon
    as it is done. The same line again goes on after any stop; one with another method adds that
    one's runs. The page, tables and pictures show all that is in the folder.

    \b
    Examples:
      quietarm contest --methods nsga2,vepso --runs 31 --output contest
      quietarm contest single-link-30deg-0.8s --runs 5 --evaluations 5000 --output small
      quietarm contest single-link --target 20deg:60deg:10deg --duration 0.8,1 --bound 0.2 \\
          --runs 5 --evaluations 5000 --output conditions
      quietarm contest single-link-30deg-0.8s --runs 5 --import "my swarm=results" --output small
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.metaheuristics.sharing.workers import Workers
    from quietarm.ocp import QuietarmError
    from quietarm.studies.cli.ending import Together, finish
    from quietarm.studies.cli.folders import check_inside
    from quietarm.studies.contest.archives import coco_files, ioh_file
    from quietarm.studies.contest.asked import Contest
    from quietarm.studies.contest.conditions import conditions
    from quietarm.studies.contest.measures import arenas_of
    from quietarm.studies.contest.page import (
        PLACES,
        contest_document,
        report_files,
        results_document,
    )
    from quietarm.studies.contest.sentences import not_alike, wrong_claims
    from quietarm.studies.contest.statistics import why_none
    from quietarm.studies.contest.store import FOLDERS, Store, problems_of
    from quietarm.studies.contest.tables import over_table, summary_table
    from quietarm.studies.contest.work import (
        named_files,
        pieces_of,
        run_contest,
        set_up,
        without_front,
    )
    from quietarm.studies.display.progress import progress, working
    from quietarm.studies.display.words import print_lines
    from quietarm.studies.document.blocks import Document, Lines
    from quietarm.studies.document.files import document_files
    from quietarm.studies.document.latex import latex_file

    names = tuple(name.strip() for name in methods.split(","))
    for name in ("profile", "terms", "bound"):
        if grid is None and typed(name):
            raise ValueError(f"--{name} is for conditions of a PLANT; leave it out")
    chosen = (
        problems_of(problems) if grid is None
        else conditions(grid, profile_of(profile, grid.task, terms), bound)
    )  # fmt: skip
    asked = Contest(
        chosen, names, runs, evaluations, seed, population,
        settings_by_method(setting, names), explain, part, Workers(workers, scheduler),
    )  # fmt: skip
    if import_evaluations is not None and not given:
        raise ValueError("--import-evaluations says how long imported runs are; give --import too")
    files, errors = named_files(given), Console(stderr=True)
    with working("reading", errors, quiet=quiet):
        inner = [f"{folder}/any" for folder in FOLDERS]
        check_inside(output, [output / place for place in (*PLACES, *inner, *asked.planned)])
        store = Store(output)
        set_up(asked, store, files, import_evaluations)
    pieces = pieces_of(asked, store)
    if not quiet and any(place.startswith("runs/") for place in store.kept):
        print_lines(errors, asked.how_far(store))
    warn_of_workers(errors, workers, len(pieces))
    if not quiet:
        few = (one.too_few(evaluations) for one in asked.entries.values())
        print_lines(errors, *filter(None, few))
    with progress(len(pieces), errors, quiet=quiet) as begin:
        done = run_contest(pieces, store, asked.workers, begin)
    # of the folder, to which other parts may have added
    arenas, trouble = arenas_of(Store(output)), _why_not_whole(done, len(pieces))
    if not arenas:
        raise QuietarmError(trouble or "no run was done")

    shown = arenas if len(arenas) <= _FEW else ()
    tables = [block for one in shown for block in (Lines([one.problem]), summary_table(one))]
    over = [over_table(arenas)] if len(arenas) > 1 else []
    left_out = [*asked.left_out, *without_front(done)]
    notes = [why_none(arenas), *not_alike(arenas), *wrong_claims(arenas), *left_out]
    document = Document("", [*tables, *over, Lines([*filter(None, notes)])])
    page, *others = report_files(arenas, output, left_out)
    every = contest_document(arenas, left_out)
    results = [] if report is None else document_files(
        report, results_document(arenas, typed_line())
    )  # fmt: skip
    finish(
        [page, latex_file(latex, every), ioh_file(ioh, arenas), *coco_files(coco, arenas),
         *results],
        document, quiet=quiet,
        trouble=QuietarmError(trouble) if trouble else None,
        together=Together("tables and pictures", output, others),
    )  # fmt: skip


def _why_not_whole(done: Done, pieces: int) -> str:
    """What was not done, and why; empty where all was that can be."""
    from quietarm.studies.contest.work import failures_of

    failures = [f"{piece}: {error}" for piece, error in failures_of(done).items()]
    words = [f"{done.stopped}: {len(done.answers)} of {pieces} pieces of work are done; give the "
             "same line again to go on"] if done.stopped else []  # fmt: skip
    if failures:
        more = f"; and {len(failures) - 1} more" if len(failures) > 1 else ""
        words.append(f"{failures[0]}{more}")
    return "; ".join(words)
