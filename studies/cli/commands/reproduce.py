"""`quietarm reproduce`: the paper recomputed."""

from __future__ import annotations

from pathlib import Path

import click
from rich.console import Console

from studies.cli.arguments import say_written
from studies.cli.options import FOLDER


@click.command()
@click.option("--output", type=FOLDER, help="Write Markdown, CSV and pictures to this folder.")
@click.option(
    "--seeds",
    type=int,
    default=1,
    show_default=True,
    help="Seeds of VEPSO and NSGA-II; 5 give medians and quartiles.",
)
@click.option("--quiet", is_flag=True, help="Show no progress.")
def reproduce(output: Path | None, seeds: int, quiet: bool) -> None:
    """Recompute the paper's Tables 2, 3, 5 and 6 beside the printed figures, and its claims.

    \b
    Example:
      quietarm reproduce --output results
    """  # noqa: D301  # \b is click's: do not rewrap
    from studies.display.progress import progress
    from studies.reproduction.claims import claims
    from studies.reproduction.recompute import pieces_of_paper, recompute_paper
    from studies.reproduction.report import print_reproduction, write_reproduction

    with progress(len(pieces_of_paper(seeds)), Console(stderr=True), quiet=quiet) as begin:
        result = recompute_paper(begin, seeds)
    verdicts = claims(result)
    print_reproduction(Console(), result, verdicts)
    if output is not None:
        output.mkdir(exist_ok=True)
        say_written(*write_reproduction(output, result, verdicts))
