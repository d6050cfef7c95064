"""`quietarm reproduce`: the paper recomputed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from quietarm.studies.cli.files import FOLDER, ending_of, finish, output_option, report_files
from quietarm.studies.cli.options import command, option, quiet
from rich.console import Console


@command()
@option("--full", is_flag=True, help="Judge every claim as well, with several seeds.")
@option("--seeds", type=int, help="Seeds of VEPSO and NSGA-II. [default: 1; --full: 9]")
@option("--workers", type=int, help="Processes that share the work. [default: one a core]")
@output_option({FOLDER: "Markdown, CSV and pictures", ".html": "a page", ".tex": "the tables"})
def reproduce(full: bool, seeds: int | None, workers: int | None, output: Sequence[Path]) -> None:
    """Recompute the paper's Tables 2, 3, 5 and 6 and its figures; --full also judges its claims.

    Fronts are kept in the folder's `fronts` as they are found: the same line goes on after an
    interruption.

    \b
    Examples:
      quietarm reproduce --output results
      quietarm reproduce --full --output results
    """  # noqa: D301  # \b is click's: do not rewrap
    import joblib
    from quietarm.ocp.checks import whole
    from quietarm.studies.report.progress import progress
    from quietarm.studies.reproduce.recompute import Effort, number_of_pieces, recompute_paper
    from quietarm.studies.reproduce.report import reproduction_report

    number = (9 if full else 1) if seeds is None else whole("seeds", seeds, 1)
    effort = Effort(full=full, seeds=number)
    processes = joblib.cpu_count() if workers is None else whole("workers", workers, 1)
    with progress(number_of_pieces(effort), Console(stderr=True), quiet=quiet()) as begin:
        folder = next((path / "fronts" for path in output if ending_of(path) == FOLDER), None)
        report = reproduction_report(recompute_paper(effort, processes, begin, folder))
    finish(report_files(output, report), report)
