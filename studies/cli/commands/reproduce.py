"""`quietarm reproduce`: the paper recomputed."""

from __future__ import annotations

from pathlib import Path

import click
from quietarm.studies.cli.options import (
    command,
    quiet_option,
    warn_of_workers,
    workers_at_hand_options,
)
from quietarm.studies.cli.types import FOLDER, WHOLE
from rich.console import Console


@command()
@click.option("--output", type=FOLDER, help="Write Markdown, CSV and pictures to this folder.")
@click.option(
    "--seeds", type=WHOLE, default=1, show_default=True,
    help="Seeds of VEPSO and NSGA-II; 9 give medians and quartiles, in some 6 times the time.",
)  # fmt: skip
@workers_at_hand_options
@quiet_option
def reproduce(
    output: Path | None, seeds: int, workers: int | None, scheduler: str | None, quiet: bool
) -> None:
    """Recompute the paper's Tables 2, 3, 5 and 6 and its claims; compare every system.

    \b
    Examples:
      quietarm reproduce --output results
      quietarm reproduce --output results --workers 1
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.metaheuristics.sharing.pieces import InterruptedPiece
    from quietarm.metaheuristics.sharing.workers import Workers, cores_at_hand
    from quietarm.ocp import QuietarmError
    from quietarm.studies.cli.ending import finish
    from quietarm.studies.display.progress import progress
    from quietarm.studies.display.saving import inside
    from quietarm.studies.document.blocks import Document, Lines
    from quietarm.studies.document.files import document_files
    from quietarm.studies.reproduction.recompute import pieces_of_paper, recompute_paper
    from quietarm.studies.reproduction.report import reproduction_document
    from quietarm.studies.reproduction.tables import unfinished_table

    if workers is None:
        workers = cores_at_hand() if scheduler is None else 1
    where, errors = Workers(workers, scheduler), Console(stderr=True)
    pieces = pieces_of_paper(seeds)
    warn_of_workers(errors, workers, len(pieces))
    try:
        with progress(len(pieces), errors, quiet=quiet) as begin:
            result = recompute_paper(begin, seeds, where)
    except InterruptedPiece as stop:
        if not stop.part.answers:
            raise
        table = unfinished_table(pieces, stop.part)
        finish(
            inside(output, {"unfinished.csv": table.save_csv}),
            Document("", [Lines([table.csv().rstrip()])]),
            trouble=QuietarmError(
                f"{stop.part.stopped}: {stop.part.number} of {len(pieces)} pieces of work are done"
            ),
        )
    else:
        document = reproduction_document(result)
        finish(document_files(output, document), document, quiet=quiet)
