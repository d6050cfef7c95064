"""`quietarm reproduce`: the paper recomputed."""

from __future__ import annotations

from pathlib import Path

import click
from quietarm.studies.cli.options import command, quiet_option
from quietarm.studies.cli.types import FOLDER, WHOLE
from rich.console import Console


@command()
@click.option("--full", is_flag=True, help="Judge every claim as well, with several seeds.")
@click.option("--seeds", type=WHOLE, help="Seeds of VEPSO and NSGA-II. [default: 1; --full: 9]")
@click.option("--workers", type=WHOLE, help="Processes that share the work. [default: one a core]")
@click.option("--output", type=FOLDER, help="Write Markdown, CSV and pictures to this folder.")
@quiet_option
def reproduce(
    full: bool, seeds: int | None, workers: int | None, output: Path | None, quiet: bool
) -> None:
    """Recompute the paper's Tables 2, 3, 5 and 6 and its figures; --full also judges its claims.

    \b
    Examples:
      quietarm reproduce --output results
      quietarm reproduce --full --output results
    """  # noqa: D301  # \b is click's: do not rewrap
    import joblib
    from quietarm.ocp.checks import whole
    from quietarm.studies.cli.ending import finish
    from quietarm.studies.display.progress import progress
    from quietarm.studies.reproduce.recompute import Effort, number_of_pieces, recompute_paper
    from quietarm.studies.reproduce.report import reproduction_report

    number = (9 if full else 1) if seeds is None else whole("seeds", seeds, 1)
    effort = Effort(full=full, seeds=number)
    processes = joblib.cpu_count() if workers is None else whole("workers", workers, 1)
    with progress(number_of_pieces(effort), Console(stderr=True), quiet=quiet) as begin:
        report = reproduction_report(recompute_paper(effort, processes, begin))
    finish(report.files(output), report, quiet=quiet)
